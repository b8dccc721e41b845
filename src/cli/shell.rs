//! `tokosen completions` and `tokosen man`: what shells and manuals need of the program. Both are hidden from its help.

use clap::{Args, Command};
use clap_complete::Shell;

use super::console::Console;
use super::failure::Failure;

/// Completions for a shell, on standard output
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

/// A manual page, on standard output: of the program, or of a verb
#[derive(Debug, Args)]
pub struct ManArgs {
    /// The verb
    verb: Option<String>,
}

/// Runs the verb `completions` of this program.
pub fn completions(args: &CompletionsArgs, mut program: Command, console: &Console) -> Result<(), Failure> {
    let mut text = Vec::new();
    let name = program.get_name().to_owned();
    clap_complete::generate(args.shell, &mut program, name, &mut text);
    console.result(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}

/// Runs the verb `man` of this program.
pub fn man(args: &ManArgs, mut program: Command, console: &Console) -> Result<(), Failure> {
    // Building gives each verb the options that all have.
    program.build();
    let page = match &args.verb {
        None => program,
        Some(verb) => {
            let found = program.find_subcommand(verb).filter(|found| !found.is_hide_set());
            found.ok_or_else(|| Failure::Usage(format!("there is no verb {verb}")))?.clone()
        }
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page)
        .render(&mut text)
        .map_err(|e| tokosen::Error::Data(format!("the manual page cannot be written: {e}")))?;
    console.result(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}
