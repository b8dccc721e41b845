//! `tokosen work`: does the tasks of a plan.

use std::path::PathBuf;
use std::process::{Child, Command};
use std::time::Duration;

use clap::Args;
use tokosen::base::error::Error;
use tokosen::tiling::{Folder, Task, Work, work};

use super::console::Console;
use super::failure::Failure;
use super::memory;

/// Do the tasks of a plan
///
/// Tasks whose results are there and whole are not done again: after a failure, the same command goes on where it stopped. A file that
/// was cut off is noticed, and its task is done again.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct WorkArgs {
    /// Folder of the plan
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Do this task only; manifest.json lists the tasks [default: all tasks]
    #[arg(long, value_name = "ID", conflicts_with = "jobs")]
    task: Vec<String>,
    /// Number of tasks at the same time, each in a process of its own. Each takes the memory that the plan allows
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    /// Print the names of the tasks that are not done yet, one a line, and do none: for other schedulers
    #[arg(long, conflicts_with_all = ["task", "jobs"])]
    list: bool,
}

const EXAMPLES: &str = "\
Examples:
  tokosen work plan --jobs 4
  tokosen work plan --task t07
  tokosen work plan --list | parallel tokosen work plan --task {}";

/// Time between two looks at the processes.
const TICK: Duration = Duration::from_millis(100);

/// Runs the verb.
pub fn run(args: &WorkArgs, console: &Console) -> Result<(), Failure> {
    let folder = Folder::open(&args.folder)?;
    let tasks: Vec<&Task> = match args.task.as_slice() {
        [] => folder.manifest.tasks.iter().collect(),
        some => some.iter().map(|id| folder.task(id)).collect::<Result<_, _>>()?,
    };
    if args.list {
        for task in &folder.manifest.tasks {
            if !folder.is_done(task)? {
                console.result(&task.id);
            }
        }
        return Ok(());
    }
    if args.jobs > 1 {
        return side_by_side(args, &folder, console);
    }
    for (k, task) in tasks.iter().enumerate() {
        let done = work(&folder, task, memory::available(), console);
        let done = done.map_err(|error| Error::Data(format!("task {}: {}", task.id, error.with_causes())))?;
        say(console, k + 1, tasks.len(), &task.id, done);
    }
    Ok(())
}

fn say(console: &Console, count: usize, of: usize, id: &str, done: Work) {
    let how = match done {
        Work::Done => "done",
        Work::WasDone => "was done before",
    };
    console.say(&format!("task {id}  {how}, {count} of {of}"));
}

/// Does the tasks in processes side by side. After a failure no further task is begun.
fn side_by_side(args: &WorkArgs, folder: &Folder, console: &Console) -> Result<(), Failure> {
    let (mut count, of) = (0, folder.manifest.tasks.len());
    let mut open = Vec::new();
    for task in &folder.manifest.tasks {
        if folder.is_done(task)? {
            count += 1;
            say(console, count, of, &task.id, Work::WasDone);
        } else {
            open.push(task);
        }
    }
    let threads = (rayon::current_num_threads() / usize::from(args.jobs)).max(1);
    let mut waiting = open.into_iter();
    let mut running: Vec<(&Task, Child)> = Vec::new();
    let mut failed: Vec<String> = Vec::new();
    loop {
        while failed.is_empty() && running.len() < usize::from(args.jobs) {
            let Some(task) = waiting.next() else { break };
            let child = process(args, task, threads)?.spawn();
            running.push((task, child.map_err(|e| Error::io("start", &program(), e))?));
        }
        if running.is_empty() {
            break;
        }
        let mut still = Vec::new();
        for (task, mut child) in running {
            match child.try_wait().map_err(|e| Error::io("wait for", &program(), e))? {
                None => still.push((task, child)),
                Some(status) if status.success() => {
                    count += 1;
                    say(console, count, of, &task.id, Work::Done);
                }
                Some(status) => failed.push(format!("{} ({status})", task.id)),
            }
        }
        running = still;
        std::thread::sleep(TICK);
    }
    match failed.is_empty() {
        true => Ok(()),
        false => Err(Failure::Work(Error::Data(format!(
            "these tasks failed: {}; {count} of {of} are done. The same command goes on with those that are left",
            failed.join(", ")
        )))),
    }
}

/// The program that runs: this one.
fn program() -> PathBuf {
    std::env::current_exe().unwrap_or_else(|_| "tokosen".into())
}

/// The process of a task.
fn process(args: &WorkArgs, task: &Task, threads: usize) -> Result<Command, Failure> {
    let program = program();
    let mut command = Command::new(&program);
    // In the Python package, the program that runs is Python.
    if program.file_stem().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with("python")) {
        command.args(["-m", "tokosen"]);
    }
    command.arg("work").arg(&args.folder).args(["--task", &task.id, "--quiet", "--threads", &threads.to_string()]);
    Ok(command)
}
