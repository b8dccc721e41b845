//! Encodes the directories of a TIFF, and the header before them.
//!
//! The `tiff` crate writes the long values of a directory before the directory. A Cloud Optimized GeoTIFF has its first
//! directory at the beginning of the file, so that one request reads it. Therefore directories are encoded here. Every
//! directory is followed by its long values, and then by the next directory.

use tiff::tags::{Tag, Type};

/// Which of the two kinds of TIFF a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// With offsets of 32 bits.
    Classic,
    /// With offsets of 64 bits.
    Big,
}

/// The values of a tag.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Field {
    Ascii(String),
    Shorts(Vec<u16>),
    Longs(Vec<u32>),
    Doubles(Vec<f64>),
    /// Places or lengths in the file, which have as many bits as the kind of the file.
    Offsets(Vec<u64>),
}

/// A directory: tags with their values, in any order.
pub(super) type Directory = Vec<(Tag, Field)>;

impl Kind {
    /// The header of the file, up to the place of the first directory.
    fn header(self) -> &'static [u8] {
        match self {
            Self::Classic => b"II\x2a\0",
            Self::Big => b"II\x2b\0\x08\0\0\0",
        }
    }

    /// The bytes of an offset.
    fn width(self) -> usize {
        match self {
            Self::Classic => 4,
            Self::Big => 8,
        }
    }

    /// Appends an offset.
    fn put(self, bytes: &mut Vec<u8>, offset: u64) {
        bytes.extend_from_slice(&offset.to_le_bytes()[..self.width()]);
    }

    /// The number of entries of a directory.
    fn count(self, entries: usize) -> Vec<u8> {
        match self {
            Self::Classic => (entries as u16).to_le_bytes().to_vec(),
            Self::Big => (entries as u64).to_le_bytes().to_vec(),
        }
    }
}

impl Field {
    /// The type, the number and the bytes of the values.
    fn encode(&self, kind: Kind) -> (Type, usize, Vec<u8>) {
        match self {
            // A text ends with a byte of zero.
            Self::Ascii(text) => (Type::ASCII, text.len() + 1, [text.as_bytes(), b"\0"].concat()),
            Self::Shorts(values) => (Type::SHORT, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect()),
            Self::Longs(values) => (Type::LONG, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect()),
            Self::Doubles(values) => {
                (Type::DOUBLE, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect())
            }
            Self::Offsets(values) => {
                let mut bytes = Vec::with_capacity(values.len() * kind.width());
                values.iter().for_each(|&value| kind.put(&mut bytes, value));
                (if kind == Kind::Big { Type::LONG8 } else { Type::LONG }, values.len(), bytes)
            }
        }
    }
}

/// The beginning of a file: the header, `after_header`, and the directories, one after the other.
///
/// Its length depends only on the numbers of values, not on the values themselves.
pub(super) fn beginning(kind: Kind, after_header: &[u8], directories: &[Directory]) -> Vec<u8> {
    let mut bytes = kind.header().to_vec();
    // Directories and long values begin on whole words.
    let first = (bytes.len() + kind.width() + after_header.len()).next_multiple_of(kind.width());
    kind.put(&mut bytes, first as u64);
    bytes.extend_from_slice(after_header);
    bytes.resize(first, 0);
    for (k, directory) in directories.iter().enumerate() {
        append(kind, &mut bytes, directory, k + 1 == directories.len());
    }
    bytes
}

/// Appends a directory and its long values to a file.
fn append(kind: Kind, bytes: &mut Vec<u8>, directory: &Directory, is_last: bool) {
    let mut entries: Vec<(u16, &Field)> = directory.iter().map(|(tag, field)| (tag.to_u16(), field)).collect();
    entries.sort_by_key(|(tag, _)| *tag);
    bytes.extend(kind.count(entries.len()));
    let width = kind.width();
    let entry = size_of::<u16>() * 2 + width * 2;
    // The long values begin behind the entries and the place of the next directory.
    let start = bytes.len() + entries.len() * entry + width;
    let mut long: Vec<u8> = Vec::new();
    for (tag, field) in entries {
        let (of, count, mut values) = field.encode(kind);
        bytes.extend(tag.to_le_bytes());
        bytes.extend(of.to_u16().to_le_bytes());
        kind.put(bytes, count as u64);
        if values.len() <= width {
            values.resize(width, 0);
            bytes.append(&mut values);
        } else {
            kind.put(bytes, (start + long.len()) as u64);
            long.append(&mut values);
            long.resize(long.len().next_multiple_of(width), 0);
        }
    }
    kind.put(bytes, if is_last { 0 } else { (start + long.len()) as u64 });
    bytes.append(&mut long);
}
