//! The program tokosen.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(tokosen::cli::main(std::env::args_os()))
}
