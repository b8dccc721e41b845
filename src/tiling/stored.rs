//! Files of a plan's folder: each appears whole or not at all, and shows whether it was cut off or changed.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use tokosen_core::base::error::{Error, Result};
use tokosen_io::StagedOutput;

/// The first bytes of each file.
const MAGIC: &[u8; 8] = b"TOKOTILE";
/// Bytes before the content: the magic, what the content was made from, its length, its checksum.
pub const HEADER: u64 = 32;
/// Bytes that are read at once.
const BLOCK: usize = 1 << 20;

/// A checksum of bytes, FNV-1a over words of eight bytes. It notices damage; it is no protection against forgery.
#[derive(Debug, Clone, Copy)]
pub struct Checksum(u64);

impl Checksum {
    const PRIME: u64 = 0x0100_0000_01b3;

    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes bytes. All calls but the last take a multiple of eight.
    pub fn take(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            let mut eight = [0; 8];
            eight[..word.len()].copy_from_slice(word);
            // The rotation brings the upper bits, which a product does not mix, down.
            self.0 = ((self.0 ^ u64::from_le_bytes(eight)).wrapping_mul(Self::PRIME)).rotate_left(29);
        }
        self.0 = (self.0 ^ bytes.len() as u64).wrapping_mul(Self::PRIME);
    }

    pub fn value(self) -> u64 {
        self.0
    }

    pub fn of(bytes: &[u8]) -> u64 {
        let mut sum = Self::new();
        bytes.chunks(BLOCK).for_each(|block| sum.take(block));
        sum.value()
    }
}

/// Writes a file that was made from what `source` stands for. Returns the checksum of the content.
///
/// # Errors
/// The file cannot be written, for example because the disk is full.
pub fn write(path: &Path, source: u64, content: &[u8]) -> Result<u64> {
    let staged = StagedOutput::create(path)?;
    let sum = Checksum::of(content);
    let head = [*MAGIC, source.to_le_bytes(), (content.len() as u64).to_le_bytes(), sum.to_le_bytes()].concat();
    let written = File::create(staged.path()).and_then(|mut file| {
        file.write_all(&head)?;
        file.write_all(content)
    });
    written.map_err(|e| Error::io("write", path, e))?;
    staged.commit()?;
    Ok(sum)
}

/// What a file says about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Head {
    /// What it was made from.
    pub source: u64,
    /// Length of the content, bytes.
    pub length: u64,
    /// Checksum of the content.
    pub checksum: u64,
}

/// Reads the head of a file; `None` if the file is none of ours, or is cut off in its head.
fn head(file: &mut File) -> std::io::Result<Option<Head>> {
    let mut bytes = [0; HEADER as usize];
    match file.read_exact(&mut bytes) {
        Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(None),
        other => other?,
    }
    let word = |k: usize| {
        let mut eight = [0; 8];
        eight.copy_from_slice(&bytes[8 * k..8 * k + 8]);
        u64::from_le_bytes(eight)
    };
    Ok((bytes[..8] == *MAGIC).then(|| Head { source: word(1), length: word(2), checksum: word(3) }))
}

/// The head of a file that is there and whole; `None` otherwise. All of the file is read.
pub fn whole(path: &Path) -> Option<Head> {
    let mut file = File::open(path).ok()?;
    let head = head(&mut file).ok()??;
    let (mut sum, mut length) = (Checksum::new(), 0);
    let mut block = vec![0; BLOCK];
    loop {
        let mut filled = 0;
        while filled < BLOCK {
            match file.read(&mut block[filled..]).ok()? {
                0 => break,
                n => filled += n,
            }
        }
        if filled == 0 {
            break;
        }
        sum.take(&block[..filled]);
        length += filled as u64;
    }
    (length == head.length && sum.value() == head.checksum).then_some(head)
}

/// The content of a file.
///
/// # Errors
/// The file cannot be read. It is not whole, or not made from what `source` stands for; `remedy` says what to do.
pub fn read(path: &Path, source: u64, remedy: &str) -> Result<Vec<u8>> {
    let failed = |e| Error::io("read", path, e);
    let mut file = File::open(path).map_err(failed)?;
    let head = head(&mut file).map_err(failed)?;
    let Some(head) = head else {
        return Err(Error::file(path, format!("is cut off, or is no file of a plan; {remedy}")));
    };
    if head.source != source {
        return Err(Error::file(path, format!("belongs to another plan; {remedy}")));
    }
    let mut content = Vec::new();
    file.take(head.length + 1).read_to_end(&mut content).map_err(failed)?;
    if content.len() as u64 != head.length || Checksum::of(&content) != head.checksum {
        return Err(Error::file(path, format!("is cut off or damaged; {remedy}")));
    }
    Ok(content)
}

/// The content of a file of the plan itself, with a checksum that is known, as hexadecimal digits.
///
/// # Errors
/// As [`read`].
pub fn read_known(path: &Path, checksum: &str) -> Result<Vec<u8>> {
    const REMEDY: &str = "make the plan again: results that are whole are kept";
    let content = read(path, 0, REMEDY)?;
    match format!("{:016x}", Checksum::of(&content)) == checksum {
        true => Ok(content),
        false => Err(Error::file(path, format!("is not the file that the manifest names; {REMEDY}"))),
    }
}
