//! Places on the command line: coordinates, or a file of points.

use std::path::Path;

use clap::builder::TypedValueParser;
use glam::DVec2;
use tokosen::base::error::Finding;
use tokosen::crs::Crs;
use tokosen::io::VectorSource;
use tokosen::terrain::{Place, read_places_in};

use super::failure::Failure;
use super::memory;
use super::source::source;

/// Where places are.
#[derive(Debug, Clone, PartialEq)]
pub enum PlaceArg {
    /// At these coordinates.
    At(DVec2),
    /// At the points of a file.
    File(VectorSource),
}

impl PlaceArg {
    /// Reads two coordinates, otherwise the name of a file.
    pub fn parser() -> impl TypedValueParser<Value = Self> {
        source().map(|source| match source.path.to_str().and_then(coordinates) {
            Some(at) if source.layer.is_none() => Self::At(at),
            _ => Self::File(source),
        })
    }
}

/// Two numbers: `x,y` or `x y`.
fn coordinates(text: &str) -> Option<DVec2> {
    let mut numbers = text.split([',', ' ']).filter(|part| !part.is_empty()).map(|part| part.parse().ok());
    match [numbers.next(), numbers.next(), numbers.next()] {
        [Some(Some(x)), Some(Some(y)), None] => Some(DVec2::new(x, y)).filter(|at| at.is_finite()),
        _ => None,
    }
}

/// The files among places.
pub fn files(places: &[PlaceArg]) -> impl Iterator<Item = &Path> {
    places.iter().filter_map(|place| match place {
        PlaceArg::File(source) => Some(source.path.as_path()),
        PlaceArg::At(_) => None,
    })
}

/// The places in a coordinate reference system; reads their files. Coordinates on the command line are in it already.
pub fn read(places: &[PlaceArg], crs: Option<&Crs>, findings: &mut Vec<Finding>) -> Result<Vec<Place>, Failure> {
    let mut found = Vec::new();
    for place in places {
        match place {
            PlaceArg::At(at) => found.push(Place::at(*at, crs)),
            PlaceArg::File(source) => {
                found.extend(read_places_in(crs, source, memory::available())?.collect(findings));
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_numbers_are_a_place_and_everything_else_a_file() {
        for (text, at) in [("1,2", (1.0, 2.0)), ("-138.5 36", (-138.5, 36.0)), ("1e3, -7", (1000.0, -7.0))] {
            assert_eq!(coordinates(text), Some(at.into()), "{text}");
        }
        for text in ["", "1", "1,2,3", "a,b", "points.gpkg", "1,nan", "1,inf", "1;2"] {
            assert_eq!(coordinates(text), None, "{text}");
        }
    }
}
