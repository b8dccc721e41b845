//! Repeats a run from its file.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{CommandFactory, Parser, error::ErrorKind};
use tokosen::base::error::{Error, Result};

use super::file::RunFile;
use super::inputs::input;
use crate::cli::failure::Failure;
use crate::cli::flags::Flags;
use crate::cli::negative::joined;
use crate::cli::{Cli, Common};

/// Repeat a run that --save-run saved: the same verb with the same arguments
///
/// Relative paths start in the folder of the saved run. Changed inputs are told; missing ones are an error.
#[derive(Debug, Parser)]
#[command(name = "tokosen", version, override_usage = "tokosen --run <FILE> [OPTIONS]", max_term_width = 100)]
struct RepeatArgs {
    /// The saved run: .json
    #[arg(long, value_name = "FILE")]
    run: PathBuf,
    #[command(flatten)]
    common: Common,
}

/// A run from its file.
#[derive(Debug)]
pub struct Repeated {
    /// The run as it is repeated.
    pub cli: Cli,
    /// The flags that are given in it.
    pub flags: Flags,
    /// The run as it was saved.
    pub saved: RunFile,
    /// What is different now, in sentences.
    pub warnings: Vec<String>,
}

/// Whether these arguments of the program ask for a saved run.
pub fn is_repeat(arguments: &[OsString]) -> bool {
    let is_flag = |argument: &OsString| argument == "--run" || argument.to_string_lossy().starts_with("--run=");
    arguments.iter().take_while(|argument| *argument != "--").any(is_flag)
}

/// The saved run that the arguments of the program ask for. Ends the program if they are wrong. The working folder
/// becomes that of the run.
pub fn repeated(arguments: &[OsString]) -> std::result::Result<Repeated, Failure> {
    let RepeatArgs { run: path, common } = RepeatArgs::parse_from(arguments);
    let saved = RunFile::read(&path)?;
    let common = match common.save_run {
        // It starts in the folder of the user, not in that of the run.
        Some(file) => Common { save_run: Some(absolute(file)?), ..common },
        None => common,
    };
    std::env::set_current_dir(&saved.folder).map_err(|e| {
        let message = format!(
            "cannot go to the folder {} of the saved run, in which its paths start; if it was moved, change \"folder\" in \
             the file",
            saved.folder.display()
        );
        Error::file_cause(&path, message, e)
    })?;
    let mut warnings = Vec::new();
    if saved.version != env!("CARGO_PKG_VERSION") {
        let [then, now] = [saved.version.as_str(), env!("CARGO_PKG_VERSION")];
        warnings.push(format!("the run was saved by version {then}, this is {now}: results may differ"));
    }
    warnings.extend(changes(&saved).map_err(|error| match error {
        Error::Data(message) => Error::file(&path, message),
        error => error,
    })?);
    let arguments = std::iter::once("tokosen").chain(saved.arguments.iter().map(String::as_str)).map(OsString::from);
    let (cli, flags) = Cli::with_flags(joined(Cli::command(), arguments)).map_err(|error| unfit(&error))?;
    let common = merged(common, &cli.common);
    Ok(Repeated { cli: Cli { common, ..cli }, flags, saved, warnings })
}

fn absolute(path: PathBuf) -> Result<PathBuf> {
    std::path::absolute(&path).map_err(|e| Error::io("find", &path, e))
}

/// What is wrong with arguments that this version of the program does not take.
fn unfit(error: &clap::Error) -> Failure {
    let text = match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => "they ask for help only".to_owned(),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => {
            "there is no verb".to_owned()
        }
        _ => error.to_string(),
    };
    let text = text.trim().trim_start_matches("error: ");
    Failure::Usage(format!("the arguments of the saved run do not fit this version: {text}"))
}

/// The inputs that are different now, each in a sentence.
///
/// # Errors
/// [`Error::Data`] if inputs are missing. A file cannot be read.
fn changes(saved: &RunFile) -> Result<Vec<String>> {
    let missing: Vec<String> = saved
        .inputs
        .iter()
        .filter(|input| !input.file.exists())
        .map(|input| input.file.display().to_string())
        .collect();
    if !missing.is_empty() {
        return Err(Error::Data(format!("files that the saved run read are missing: {}", missing.join(", "))));
    }
    let mut found = Vec::new();
    for saved in &saved.inputs {
        let now = input(&saved.file)?;
        if now != *saved {
            let [then, now_size] = [saved.bytes, now.bytes];
            let size = if then == now_size {
                format!("{then} bytes, other content")
            } else {
                format!("{now_size} bytes, then {then}")
            };
            found.push(format!("the input {} has changed since the run was saved ({size})", saved.file.display()));
        }
    }
    Ok(found)
}

/// The options that every verb has: those given now have priority.
fn merged(now: Common, saved: &Common) -> Common {
    let is_told = now.quiet || now.verbose;
    Common {
        quiet: if is_told { now.quiet } else { saved.quiet },
        verbose: if is_told { now.verbose } else { saved.verbose },
        progress: now.progress,
        overwrite: now.overwrite || saved.overwrite,
        threads: now.threads.or(saved.threads),
        save_run: now.save_run,
    }
}
