//! What every DXF has around its entities, and the entity of level lines.

use std::collections::BTreeMap;
use std::io::Result as Written;
use std::path::Path;

use glam::DVec2;

use super::output::GroupWriter;
use super::tables::{self, Look, MODEL_SPACE};
use super::unit;
use crate::layer::Bounds;
use crate::maker::MADE_BY;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::LengthUnit;

/// Handles up to this one belong to the tables, larger ones to layers and entities.
const FIRST_HANDLE: u64 = 0x100;
/// The code of a comment.
const COMMENT: i32 = 999;

/// A drawing, but for its entities.
pub(crate) struct Drawing<'a> {
    /// How its layers look.
    pub looks: &'a BTreeMap<&'a str, Look>,
    /// How many handles its entities need.
    pub handles: u64,
    pub bounds: Bounds,
    /// The unit that its header states.
    pub unit: Option<LengthUnit>,
}

impl Drawing<'_> {
    /// Writes the file with the entities of `entities`.
    pub fn write(&self, path: &Path, entities: impl FnOnce(&mut GroupWriter) -> Written<()>) -> Result<()> {
        let run = || -> Written<()> {
            let mut out = GroupWriter::create(path, FIRST_HANDLE)?;
            out.put(COMMENT, MADE_BY)?;
            let handles = FIRST_HANDLE + self.looks.len() as u64 + self.handles;
            write_header(&mut out, handles + 1, unit::code_of(self.unit.as_ref()), self.bounds)?;
            tables::write(&mut out, self.looks, self.bounds)?;
            out.pairs(&[(0, "SECTION"), (2, "ENTITIES")])?;
            entities(&mut out)?;
            out.pairs(&[(0, "ENDSEC")])?;
            tables::write_objects(&mut out)?;
            out.pairs(&[(0, "EOF")])?;
            out.flush()
        };
        run().map_err(|e| Error::io("write", path, e))
    }
}

fn write_header(
    out: &mut GroupWriter,
    next_handle: u64,
    (unit, is_metric): (i64, bool),
    [min_x, max_x, min_y, max_y]: Bounds,
) -> Written<()> {
    out.pairs(&[(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1015")])?;
    out.pairs(&[(9, "$DWGCODEPAGE"), (3, "ANSI_1252"), (9, "$HANDSEED")])?;
    out.put(5, format_args!("{next_handle:X}"))?;
    out.pairs(&[(9, "$INSUNITS")])?;
    out.put(70, unit)?;
    out.pairs(&[(9, "$MEASUREMENT")])?;
    out.put(70, u8::from(is_metric))?;
    out.pairs(&[(9, "$EXTMIN")])?;
    out.numbers(10, &[min_x, min_y, 0.0])?;
    out.pairs(&[(9, "$EXTMAX")])?;
    out.numbers(10, &[max_x, max_y, 0.0])?;
    out.pairs(&[(0, "ENDSEC")])
}

/// Writes a line at a height; a closed one if its first point is repeated.
pub(crate) fn write_level(out: &mut GroupWriter, layer: &str, points: &[DVec2], elevation: f64) -> Written<()> {
    // A closed line does not repeat its first vertex. A line that only goes there and back is not closed.
    let bits = |p: &DVec2| p.to_array().map(f64::to_bits);
    let is_closed = points.len() > 3 && points.first().map(bits) == points.last().map(bits);
    let points = if is_closed { &points[..points.len() - 1] } else { points };
    out.begin_entity("LWPOLYLINE", MODEL_SPACE, layer)?;
    out.pairs(&[(100, "AcDbPolyline")])?;
    out.put(90, points.len())?;
    out.put(70, u8::from(is_closed))?;
    out.numbers(43, &[0.0])?;
    out.numbers(38, &[elevation])?;
    points.iter().try_for_each(|p| out.numbers(10, &p.to_array()))
}
