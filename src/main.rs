//! The program tokosen.

use std::process::ExitCode;

fn main() -> ExitCode {
    tokosen::cli::main(std::env::args_os())
}
