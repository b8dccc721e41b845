//! Numbers and lines as bytes, little-endian, bit for bit.

use std::path::{Path, PathBuf};

use glam::DVec2;
use tokosen_core::base::FeatureId;
use tokosen_core::base::error::{Error, Result};

/// Bytes to write.
#[derive(Default)]
pub struct Out(pub Vec<u8>);

impl Out {
    pub fn count(&mut self, value: usize) {
        self.0.extend((value as u64).to_le_bytes());
    }

    pub fn number(&mut self, value: f64) {
        self.0.extend(value.to_bits().to_le_bytes());
    }

    pub fn feature(&mut self, feature: FeatureId) {
        self.count(feature.file().unwrap_or(0) as usize);
        self.count(feature.number() as usize);
    }

    /// Their number, and each of them as `add` writes it.
    pub fn each<T>(&mut self, all: &[T], mut add: impl FnMut(&mut Self, &T)) {
        self.count(all.len());
        all.iter().for_each(|one| add(self, one));
    }

    pub fn points(&mut self, points: &[DVec2]) {
        self.count(points.len());
        for p in points {
            self.number(p.x);
            self.number(p.y);
        }
    }
}

/// Bytes that were read. What ends too early is an error that names the file.
pub struct In<'a> {
    bytes: &'a [u8],
    file: PathBuf,
}

impl<'a> In<'a> {
    pub fn new(bytes: &'a [u8], file: &Path) -> Self {
        Self { bytes, file: file.to_owned() }
    }

    fn eight(&mut self) -> Result<[u8; 8]> {
        let (first, rest) = self.bytes.split_first_chunk::<8>().ok_or_else(|| self.broken())?;
        self.bytes = rest;
        Ok(*first)
    }

    fn broken(&self) -> Error {
        Error::file(&self.file, "is broken: numbers are missing; make the plan again")
    }

    /// A number of things, each of which has at least `bytes` bytes. So a broken file asks for no memory.
    pub fn count(&mut self, bytes: usize) -> Result<usize> {
        let count = u64::from_le_bytes(self.eight()?);
        let most = self.bytes.len() / bytes.max(1);
        usize::try_from(count).ok().filter(|count| *count <= most).ok_or_else(|| self.broken())
    }

    /// A whole number that counts nothing in the file.
    pub fn whole(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.eight()?))
    }

    pub fn number(&mut self) -> Result<f64> {
        Ok(f64::from_bits(u64::from_le_bytes(self.eight()?)))
    }

    pub fn point(&mut self) -> Result<DVec2> {
        Ok(DVec2::new(self.number()?, self.number()?))
    }

    pub fn points(&mut self) -> Result<Vec<DVec2>> {
        self.each(16, Self::point)
    }

    pub fn feature(&mut self) -> Result<FeatureId> {
        let (file, number) = (self.whole()? as u32, self.whole()?);
        Ok(FeatureId::from(number).in_file(file))
    }

    /// Things that [`Out::each`] wrote, each of at least so many bytes.
    pub fn each<T>(&mut self, bytes: usize, mut read: impl FnMut(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        let count = self.count(bytes)?;
        (0..count).map(|_| read(self)).collect()
    }

    /// All that is left.
    pub fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.bytes)
    }
}
