//! The command line of tokosen: parse, run, print what went wrong, exit status.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
