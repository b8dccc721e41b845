//! Runs that are saved to a file (`--save-run`) and repeated from it (`--run`).
//!
//! The file is JSON. It holds the arguments as they were given, the folder in which they were given, the version of the
//! program, the size and checksum of each input, and what was chosen automatically. What was chosen is for the reader:
//! a repeated run chooses it again.

mod arguments;
mod file;
mod inputs;
mod record;
mod repeat;

pub use arguments::saved_arguments;
pub use file::RunFile;
pub use inputs::further;
pub use record::Record;
pub use repeat::{Repeated, is_repeat, repeated};
