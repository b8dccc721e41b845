//! Lays plates side by side on sheets, in rows from the lower edge upwards.

use glam::DVec2;

use super::{Plate, Sheet};
use crate::base::error::{Error, Result};
use crate::geometry::Bounds;

/// Distance between plates, and from the edge of a sheet, millimetres.
const GAP: f64 = 5.0;
/// A sheet without a given size is about so much wider than high.
const WIDE: f64 = 1.5;

/// Places are whole thousandths of a millimetre. So rounding to these moves the lines of all plates alike.
const PLACE: f64 = 1e-3;

/// A row of plates on a sheet.
struct Row {
    sheet: usize,
    /// The lower left corner of the next plate.
    next: DVec2,
    height: f64,
}

/// Lays plates, the largest first, on sheets of a size, or on one that is large enough.
///
/// # Errors
/// [`Error::Parameter`] if a plate is larger than a sheet.
pub(super) fn lay(plates: Vec<Plate>, size: Option<DVec2>) -> Result<Vec<Sheet>> {
    let boxes: Vec<Bounds> = plates.iter().map(|plate| Bounds::around(&plate.cut.concat())).collect();
    let room = size.unwrap_or_else(|| {
        let sizes = || boxes.iter().map(|b| b.max - b.min);
        let area: f64 = sizes().map(|size| (size + GAP).element_product()).sum();
        let widest = sizes().map(|size| size.x).fold((WIDE * area).sqrt(), f64::max);
        DVec2::new(widest + 2.0 * GAP, f64::INFINITY)
    });
    let (mut sheets, mut rows): (Vec<Sheet>, Vec<Row>) = (Vec::new(), Vec::new());
    for (mut plate, Bounds { min, max }) in plates.into_iter().zip(boxes) {
        let own = max - min;
        if !(own + 2.0 * GAP).cmple(room).all() {
            return Err(Error::Parameter(format!(
                "plate {} has {:.1} x {:.1} mm, which do not fit on a sheet of {} x {} mm with {GAP} mm around: choose a smaller \
                 size or a larger sheet",
                plate.number, own.x, own.y, room.x, room.y
            )));
        }
        let has_room = |row: &Row| row.height >= own.y && row.next.x + own.x + GAP <= room.x;
        let k = rows.iter().position(has_room).unwrap_or_else(|| {
            let top = |sheet: usize| {
                let of_sheet = rows.iter().filter(|row| row.sheet == sheet);
                of_sheet.map(|row| row.next.y + row.height + GAP).fold(GAP, f64::max)
            };
            let sheet = (0..sheets.len()).find(|sheet| top(*sheet) + own.y + GAP <= room.y).unwrap_or(sheets.len());
            rows.push(Row { sheet, next: DVec2::new(GAP, top(sheet)), height: own.y });
            rows.len() - 1
        });
        let Row { sheet, next, .. } = &mut rows[k];
        let by = ((*next - min) / PLACE).round() * PLACE;
        next.x += own.x + GAP;
        for line in [&mut plate.cut, &mut plate.outline, &mut plate.numbers].into_iter().flatten() {
            line.iter_mut().for_each(|p| *p += by);
        }
        if *sheet == sheets.len() {
            sheets.push(Sheet { size: room, plates: Vec::new() });
        }
        let on_sheet = &mut sheets[*sheet];
        on_sheet.plates.push(plate);
        if size.is_none() {
            // As high as its plates.
            let highest = on_sheet.plates.iter().flat_map(|plate| plate.cut.iter().flatten()).map(|p| p.y);
            on_sheet.size.y = highest.fold(0.0, f64::max) + GAP;
        }
    }
    Ok(sheets)
}
