//! The layer of sub-domains.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::subdomains::{Landform, Regions};
use tokosen_core::tin::Tin;

/// Name of the layer.
pub(crate) const NAME: &str = "regions";

/// The name of the layer.
pub const REGIONS_LAYER: &str = "regions";

const COLUMNS: &[Column] = &[
    Column { name: "id", kind: Kind::Int },
    Column { name: "class", kind: Kind::Text(20) },
    Column { name: "is_open", kind: Kind::Bool },
    Column { name: "band_lo", kind: Kind::Height },
    Column { name: "band_hi", kind: Kind::Height },
    Column { name: "n_ib", kind: Kind::Int },
    // Four counts of up to ten digits, with their words.
    Column { name: "mixture", kind: Kind::Text(96) },
    Column { name: "parent", kind: Kind::Int },
    Column { name: "depth", kind: Kind::Int },
    Column { name: "area", kind: Kind::Real },
];

/// The landforms, one area per sub-domain. See [`write_landforms`](crate::write_landforms) for their attributes.
pub fn of_landforms(forms: &[Landform], tin: &Tin, regions: &Regions) -> Layer<'static> {
    let real = |number: f64| if number.is_finite() { Cell::Real(number) } else { Cell::Null };
    let row = |(id, form): (usize, &Landform)| {
        let band = regions.regions[id].band;
        let mixture = form.mixture.to_string();
        let cells = vec![
            Cell::Int(id as i64),
            Cell::Text(form.class.name().into()),
            Cell::Bool(form.is_open),
            real(band.lo),
            real(band.hi),
            Cell::Int(form.interior_count() as i64),
            if mixture.is_empty() { Cell::Null } else { Cell::Text(mixture.into()) },
            form.parent.map_or(Cell::Null, |parent| Cell::Int(parent.into())),
            Cell::Int(form.depth.into()),
            Cell::Real(form.area),
        ];
        Row { shape: Shape::Area(form.rings.iter().map(|ring| ring.points(tin)).collect()), cells }
    };
    let rows = forms.iter().enumerate().map(row).collect();
    Layer { name: NAME, geometry: Geometry::Areas, columns: COLUMNS, rows }
}
