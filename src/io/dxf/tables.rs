//! The parts around the entities that CAD programs require: tables, blocks and objects. All of them are fixed except
//! the layers.

use std::collections::BTreeMap;
use std::io::Result as Written;

use super::output::GroupWriter;
use crate::layer::Bounds;

/// Handle of the block that the entities belong to.
pub(super) const MODEL_SPACE: u64 = 0x20;
const PAPER_SPACE: u64 = 0x24;
/// Handles of the tables. The handles of their entries are in the constants below; those of the layers are assigned
/// later.
const LAYERS: u64 = 0x2;

/// How the lines of a layer look.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    /// Index into the AutoCAD palette.
    color: &'static str,
    /// Width of drawn lines in hundredths of a millimetre; 0 is the thinnest that a device has.
    width: &'static str,
}

impl Look {
    /// Contours: a brown.
    pub const CONTOUR: Self = Self { color: "34", width: "13" };
    /// Index contours: a darker brown.
    pub const INDEX: Self = Self { color: "36", width: "30" };
    /// Red hairlines.
    pub const CUT: Self = Self { color: "1", width: "0" };
    /// Blue hairlines.
    pub const ENGRAVE: Self = Self { color: "5", width: "0" };
    /// The layer `0`, which every drawing has.
    const ZERO: Self = Self { color: "7", width: "-3" };
}

/// Tables before and after that of the layers: groups of a table and its entries, written unchanged.
#[rustfmt::skip] // One line per entry.
const BEFORE: &[(i32, &str)] = &[
    (0, "TABLE"), (2, "LTYPE"), (5, "5"), (330, "0"), (100, "AcDbSymbolTable"), (70, "3"),
    (0, "LTYPE"), (5, "14"), (330, "5"), (100, "AcDbSymbolTableRecord"), (100, "AcDbLinetypeTableRecord"),
    (2, "ByBlock"), (70, "0"), (3, ""), (72, "65"), (73, "0"), (40, "0.0"),
    (0, "LTYPE"), (5, "15"), (330, "5"), (100, "AcDbSymbolTableRecord"), (100, "AcDbLinetypeTableRecord"),
    (2, "ByLayer"), (70, "0"), (3, ""), (72, "65"), (73, "0"), (40, "0.0"),
    (0, "LTYPE"), (5, "16"), (330, "5"), (100, "AcDbSymbolTableRecord"), (100, "AcDbLinetypeTableRecord"),
    (2, "Continuous"), (70, "0"), (3, "Solid line"), (72, "65"), (73, "0"), (40, "0.0"),
    (0, "ENDTAB"),
];

#[rustfmt::skip] // One line per entry.
const AFTER: &[(i32, &str)] = &[
    (0, "TABLE"), (2, "STYLE"), (5, "3"), (330, "0"), (100, "AcDbSymbolTable"), (70, "1"),
    (0, "STYLE"), (5, "11"), (330, "3"), (100, "AcDbSymbolTableRecord"), (100, "AcDbTextStyleTableRecord"),
    (2, "Standard"), (70, "0"), (40, "0.0"), (41, "1.0"), (50, "0.0"), (71, "0"), (42, "2.5"), (3, "txt"), (4, ""),
    (0, "ENDTAB"),
    (0, "TABLE"), (2, "VIEW"), (5, "6"), (330, "0"), (100, "AcDbSymbolTable"), (70, "0"), (0, "ENDTAB"),
    (0, "TABLE"), (2, "UCS"), (5, "7"), (330, "0"), (100, "AcDbSymbolTable"), (70, "0"), (0, "ENDTAB"),
    (0, "TABLE"), (2, "APPID"), (5, "9"), (330, "0"), (100, "AcDbSymbolTable"), (70, "1"),
    (0, "APPID"), (5, "12"), (330, "9"), (100, "AcDbSymbolTableRecord"), (100, "AcDbRegAppTableRecord"),
    (2, "ACAD"), (70, "0"),
    (0, "ENDTAB"),
    (0, "TABLE"), (2, "DIMSTYLE"), (5, "A"), (330, "0"), (100, "AcDbSymbolTable"), (70, "1"),
    (100, "AcDbDimStyleTable"), (71, "0"),
    (0, "DIMSTYLE"), (105, "27"), (330, "A"), (100, "AcDbSymbolTableRecord"), (100, "AcDbDimStyleTableRecord"),
    (2, "Standard"), (70, "0"),
    (0, "ENDTAB"),
    (0, "TABLE"), (2, "BLOCK_RECORD"), (5, "1"), (330, "0"), (100, "AcDbSymbolTable"), (70, "2"),
    (0, "BLOCK_RECORD"), (5, "20"), (330, "1"), (100, "AcDbSymbolTableRecord"), (100, "AcDbBlockTableRecord"),
    (2, "*Model_Space"), (340, "0"),
    (0, "BLOCK_RECORD"), (5, "24"), (330, "1"), (100, "AcDbSymbolTableRecord"), (100, "AcDbBlockTableRecord"),
    (2, "*Paper_Space"), (340, "0"),
    (0, "ENDTAB"),
    (0, "ENDSEC"),
];

/// The root dictionary and the list of groups, which are required.
#[rustfmt::skip] // One line per entry.
const OBJECTS: &[(i32, &str)] = &[
    (0, "SECTION"), (2, "OBJECTS"),
    (0, "DICTIONARY"), (5, "C"), (330, "0"), (100, "AcDbDictionary"), (281, "1"), (3, "ACAD_GROUP"), (350, "D"),
    (0, "DICTIONARY"), (5, "D"), (330, "C"), (100, "AcDbDictionary"), (281, "1"),
    (0, "ENDSEC"),
];

/// Writes the sections before the entities.
pub(super) fn write(out: &mut GroupWriter, layers: &BTreeMap<&str, Look>, bounds: Bounds) -> Written<()> {
    out.pairs(&[(0, "SECTION"), (2, "CLASSES"), (0, "ENDSEC"), (0, "SECTION"), (2, "TABLES")])?;
    write_view(out, bounds)?;
    out.pairs(BEFORE)?;
    out.pairs(&[(0, "TABLE"), (2, "LAYER"), (5, "2"), (330, "0"), (100, "AcDbSymbolTable")])?;
    out.put(70, layers.len() + 1)?;
    let others = layers.iter().map(|(name, look)| (*name, *look)).filter(|(name, _)| *name != "0");
    for (name, Look { color, width }) in std::iter::once(("0", Look::ZERO)).chain(others) {
        out.begin("LAYER", LAYERS)?;
        out.pairs(&[(100, "AcDbSymbolTableRecord"), (100, "AcDbLayerTableRecord"), (2, name), (70, "0")])?;
        out.pairs(&[(62, color), (6, "Continuous"), (370, width)])?;
    }
    out.pairs(&[(0, "ENDTAB")])?;
    out.pairs(AFTER)?;
    out.pairs(&[(0, "SECTION"), (2, "BLOCKS")])?;
    for (name, owner) in [("*Model_Space", MODEL_SPACE), ("*Paper_Space", PAPER_SPACE)] {
        let ends = [("BLOCK", 1, "AcDbBlockBegin"), ("ENDBLK", 2, "AcDbBlockEnd")];
        for (kind, offset, class) in ends {
            out.put(0, kind)?;
            out.put(5, format_args!("{:X}", owner + offset))?;
            out.put(330, format_args!("{owner:X}"))?;
            out.pairs(&[(100, "AcDbEntity"), (8, "0"), (100, class)])?;
            if kind == "BLOCK" {
                out.pairs(&[(2, name), (70, "0")])?;
                out.numbers(10, &[0.0; 3])?;
                out.pairs(&[(3, name), (1, "")])?;
            }
        }
    }
    out.pairs(&[(0, "ENDSEC")])
}

/// Writes the section after the entities.
pub(super) fn write_objects(out: &mut GroupWriter) -> Written<()> {
    out.pairs(OBJECTS)
}

/// The view with which the drawing opens: its full extent.
fn write_view(out: &mut GroupWriter, [min_x, max_x, min_y, max_y]: Bounds) -> Written<()> {
    // Halves are added, because the sum of two finite numbers may be infinite.
    let half = |a: f64, b: f64| b / 2.0 - a / 2.0;
    let height = (2.0 * half(min_y, max_y).max(half(min_x, max_x) / 1.5)).clamp(1.0, f64::MAX);
    out.pairs(&[(0, "TABLE"), (2, "VPORT"), (5, "8"), (330, "0"), (100, "AcDbSymbolTable"), (70, "1")])?;
    out.pairs(&[(0, "VPORT"), (5, "2E"), (330, "8"), (100, "AcDbSymbolTableRecord")])?;
    out.pairs(&[(100, "AcDbViewportTableRecord"), (2, "*Active"), (70, "0")])?;
    out.numbers(10, &[0.0; 2])?;
    out.numbers(11, &[1.0; 2])?;
    out.numbers(12, &[min_x / 2.0 + max_x / 2.0, min_y / 2.0 + max_y / 2.0])?;
    out.numbers(13, &[0.0; 2])?;
    out.numbers(14, &[10.0; 2])?;
    out.numbers(15, &[10.0; 2])?;
    out.numbers(16, &[0.0, 0.0, 1.0])?;
    out.numbers(17, &[0.0; 3])?;
    out.numbers(40, &[height])?;
    out.numbers(41, &[1.5])?;
    out.numbers(42, &[50.0])?;
    for code in [43, 44, 50, 51] {
        out.numbers(code, &[0.0])?;
    }
    out.pairs(&[(71, "0"), (72, "1000"), (73, "1"), (74, "3"), (75, "0"), (76, "0"), (77, "0"), (78, "0")])?;
    out.pairs(&[(0, "ENDTAB")])
}
