//! The program tokosen.

use std::ffi::OsString;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    tokosen::cli::share_address_space(&arguments);
    ExitCode::from(tokosen::cli::main(arguments))
}
