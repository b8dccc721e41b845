//! Reads a FlatGeobuf into a table.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use ::flatgeobuf::{Header, size_prefixed_root_as_feature, size_prefixed_root_as_header};

use super::{geometry, properties};
use crate::file_box::FileBox;
use crate::ordinary::open_to_read;
use crate::table::{Feature, NO_GEOMETRY, Request, Table};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// The first bytes of a file: the format's name and version, twice. The last byte may have any value.
const MAGIC: [u8; 7] = *b"fgb\x03fgb";
/// Bytes of an entry of the spatial index.
const INDEX_ENTRY: u64 = 40;

/// Reads a file. Features are numbered from 0 in the order of the file, as GIS programs show them.
pub(crate) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let mut reader = FileReader::open(path)?;
    let mut magic = [0; 8];
    if reader.remaining < 12 || reader.fill(&mut magic).is_err() || !magic.starts_with(&MAGIC) {
        return Err(Error::file(
            path,
            "the file is not a FlatGeobuf of version 3, or it is broken; copy or export it again",
        ));
    }
    let mut header = Vec::new();
    reader.chunk(&mut header, "the header")?;
    let header = size_prefixed_root_as_header(&header)
        .map_err(|e| Error::file_cause(path, "the header of the file is broken", e))?;
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    if let Some(layer) = request.layer.filter(|&layer| Some(layer) != header.name() && Some(layer) != stem) {
        let name = header.name().or(stem).unwrap_or_default();
        return Err(Error::file(path, format!("there is no layer {layer:?}; the only one is {name:?}")));
    }
    let mut table = Table::new(request);
    (table.crs, table.crs_problem) = crs_of(&header);
    let mut chosen = reader.pass_index(&header, request.within)?.map(Vec::into_iter);

    let fields = properties::columns(header.columns().into_iter().flat_map(|c| c.iter()), &mut table);
    let count = header.features_count();
    let mut buffer = Vec::new();
    let mut number = 0;
    // A file that was streamed does not state its feature count; it ends after its last feature.
    let is_end = |number: u64, remaining: u64| if count == 0 { remaining == 0 } else { number == count };
    loop {
        match &mut chosen {
            Some(places) => {
                let Some((next, remaining)) = places.next() else { return Ok(table) };
                number = next;
                reader.go_to(remaining)?;
            }
            None if is_end(number, reader.remaining) => break,
            None => {}
        }
        let broken = |what: String| Error::file(path, format!("feature {number}: {what}; the file is broken"));
        if reader.remaining == 0 {
            return Err(Error::file(
                path,
                format!("the file ends after {number} of {count} features; it is not complete"),
            ));
        }
        reader.chunk(&mut buffer, &format!("feature {number}"))?;
        let read = size_prefixed_root_as_feature(&buffer)
            .map_err(|e| Error::file_cause(path, format!("feature {number} is broken"), e))?;
        let mut feature = Feature { number, ..Feature::default() };
        if let Some(bytes) = read.properties() {
            // A feature may have its own columns.
            let own = read.columns().map(|columns| properties::columns(columns.iter(), &mut table));
            properties::read(bytes.bytes(), own.as_ref().unwrap_or(&fields), &mut feature, &mut table)
                .map_err(broken)?;
        }
        match read.geometry() {
            Some(shape) => geometry::read(&shape, header.geometry_type(), &mut feature, &mut table).map_err(broken)?,
            None => table.leave_out(NO_GEOMETRY),
        }
        table.push(feature);
        number += 1;
    }
    if reader.remaining > 0 {
        let message =
            format!("there are {} bytes after the last of {count} features; the file is broken", reader.remaining);
        return Err(Error::file(path, message));
    }
    Ok(table)
}

/// A file and the number of bytes that are not read yet.
struct FileReader<'a> {
    path: &'a Path,
    file: BufReader<File>,
    remaining: u64,
}

impl<'a> FileReader<'a> {
    fn open(path: &'a Path) -> Result<Self> {
        let file = open_to_read(path)?;
        let remaining = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
        Ok(Self { path, file: BufReader::with_capacity(1 << 16, file), remaining })
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<()> {
        self.file.read_exact(bytes).map_err(|e| Error::io("read", self.path, e))?;
        self.remaining = self.remaining.saturating_sub(bytes.len() as u64);
        Ok(())
    }

    /// Reads a table and the length before it.
    fn chunk(&mut self, buffer: &mut Vec<u8>, what: &str) -> Result<()> {
        let cut = || {
            Error::file(
                self.path,
                format!("the file ends within {what}; it is not complete, or it is broken; copy or export it again"),
            )
        };
        let mut length = [0; 4];
        if self.remaining < 4 {
            return Err(cut());
        }
        // The length must not exceed the rest of the file. Then a damaged length cannot allocate memory.
        let rest = self.remaining - 4;
        self.file.read_exact(&mut length).map_err(|e| Error::io("read", self.path, e))?;
        let size = u32::from_le_bytes(length) as usize;
        if size as u64 > rest {
            return Err(cut());
        }
        self.remaining = rest;
        buffer.clear();
        buffer.resize(size + 4, 0);
        buffer[..4].copy_from_slice(&length);
        self.fill(&mut buffer[4..])
    }

    /// Moves to where this many bytes are not read yet.
    fn go_to(&mut self, remaining: u64) -> Result<()> {
        let step = i64::try_from(i128::from(self.remaining) - i128::from(remaining)).expect("no file is longer");
        self.remaining = remaining;
        self.file.seek_relative(step).map_err(|e| Error::io("read", self.path, e))
    }

    /// Reads the spatial index and moves to the first feature. Gives the features that may meet a box: the number of each, and
    /// how many bytes are not read yet where it begins. None without a box, or if the index does not state them in the order of
    /// the file.
    fn pass_index(&mut self, header: &Header<'_>, within: Option<FileBox>) -> Result<Option<Vec<(u64, u64)>>> {
        let count = header.features_count();
        let Some(size) = index_size(count, header.index_node_size()).filter(|&s| s <= self.remaining) else {
            let message =
                "the file ends within its spatial index; it is not complete, or it is broken; copy or export it again";
            return Err(Error::file(self.path, message));
        };
        let features = self.remaining - size;
        let chosen = match within.filter(|_| size > 0) {
            Some(within) => self.meeting(count, features, within)?,
            None => None,
        };
        self.go_to(features)?;
        Ok(chosen)
    }

    /// The features that may meet a box, by the last entries of the index: those of the features, in their order. The entries
    /// before them, which are boxes around these, are not needed: one feature takes far more than its entry.
    fn meeting(&mut self, count: u64, features: u64, within: FileBox) -> Result<Option<Vec<(u64, u64)>>> {
        self.go_to(features + INDEX_ENTRY * count)?;
        let mut chosen = Vec::new();
        let mut least = 0;
        for number in 0..count {
            let mut entry = [0; INDEX_ENTRY as usize];
            self.fill(&mut entry)?;
            let (words, _) = entry.as_chunks();
            let [x0, y0, x1, y1, place] = std::array::from_fn(|k| u64::from_le_bytes(words[k]));
            if place < least || place >= features || (number == 0 && place > 0) {
                return Ok(None);
            }
            least = place + 1;
            if within.meets([x0, y0, x1, y1].map(f64::from_bits)) {
                chosen.push((number, features - place));
            }
        }
        Ok(Some(chosen))
    }
}

/// Size of the spatial index of `count` features, bytes. `None` if no file can be as large.
fn index_size(count: u64, node_size: u16) -> Option<u64> {
    if count == 0 || node_size == 0 {
        return Some(0);
    }
    let (mut level, mut all) = (count, count);
    while level > 1 {
        level = level.div_ceil(u64::from(node_size.max(2)));
        all = all.checked_add(level)?;
    }
    // The root of a single feature is an additional entry.
    if count == 1 {
        all += 1;
    }
    all.checked_mul(INDEX_ENTRY).filter(|&size| i64::try_from(size).is_ok())
}

/// The system in the header, or the reason why there is none.
fn crs_of(header: &Header<'_>) -> (Option<Crs>, Option<String>) {
    let Some(crs) = header.crs() else { return (None, None) };
    let wkt = crs.wkt().map(str::trim).filter(|wkt| !wkt.is_empty());
    // The organisation is EPSG unless the header names another one.
    let of_epsg = crs.org().is_none_or(|org| org.trim().is_empty() || org.trim().eq_ignore_ascii_case("EPSG"));
    let code = u32::try_from(crs.code()).ok().filter(|&code| code > 0);
    match (code, wkt) {
        (Some(code), Some(wkt)) if of_epsg => (Some(Crs { epsg: Some(code), wkt: Some(wkt.to_owned()) }), None),
        (Some(code), None) if of_epsg => (Some(Crs::from_epsg(code)), None),
        (_, Some(wkt)) => (Some(Crs::from_wkt(wkt)), None),
        (Some(code), None) => {
            let org = crs.org().unwrap_or_default();
            (None, Some(format!("the coordinate reference system {org}:{code} is not known")))
        }
        (None, None) => (None, None),
    }
}
