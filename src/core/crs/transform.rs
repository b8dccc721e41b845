//! Transforms coordinates of one system to those of another.
//!
//! The projections are those of `proj4rs`, a translation of PROJ. It agrees with PROJ to a micrometre, and with
//! coordinates published by the Geospatial Information Authority of Japan to their last digit. x is always east or
//! longitude, and y north or latitude, whatever order a system's definition has.
//!
//! Datums on the ellipsoids of WGS 84 and GRS 1980 (WGS 84, ETRS89, JGD2000, JGD2011, NAD83 and similar ones) count as
//! equal: they differ by about a metre at most. Older datums are shifted with the seven parameters of the built-in
//! table, which are accurate to some metres. Shifts that need a grid file are refused.

use std::sync::Arc;

use glam::DVec2;
use proj4rs::Proj;

use super::definition::{Definition, Shift, label};
use super::system::{Crs, DEGREE};
use crate::base::error::{Error, Result};

/// Corrections of the way back between shifted datums. Each takes off all but some millionths of what is left.
const CORRECTIONS: usize = 3;

/// A transformation from one system to another and back.
#[derive(Clone)]
pub struct Transform {
    way: Way,
    /// Whether datums are shifted by known parameters.
    is_shifted: bool,
}

/// What happens to coordinates.
#[derive(Clone)]
enum Way {
    /// Nothing: both are the same system.
    Same,
    /// They are multiplied: both are the same plane in different units.
    Scaled(f64),
    /// They are projected.
    Projected(Arc<[System; 2]>),
}

/// One of the two systems.
#[derive(Clone)]
struct System {
    proj: Proj,
    /// Radians per unit of the coordinates, for geographic systems.
    angle: Option<f64>,
}

impl std::fmt::Debug for Transform {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = f.debug_struct("Transform");
        match &self.way {
            Way::Same => &mut shown,
            Way::Scaled(factor) => shown.field("factor", factor),
            Way::Projected(sides) => shown.field("projections", &[sides[0].proj.projname(), sides[1].proj.projname()]),
        }
        .finish()
    }
}

/// A place after a transformation; unchanged if there is none.
pub fn converted(transform: Option<&Transform>, p: DVec2) -> Option<DVec2> {
    transform.map_or(Some(p), |transform| transform.forward(p))
}

impl Transform {
    /// The transformation between two systems; `None` if coordinates are the same in both, or if one is not known.
    ///
    /// # Errors
    /// As [`Transform::between`].
    pub fn between_known(from: Option<&Crs>, to: Option<&Crs>) -> Result<Option<Self>> {
        let Some((from, to)) = from.zip(to) else { return Ok(None) };
        Ok(Some(Self::between(from, to)?).filter(|transform| !transform.is_identity()))
    }

    /// The transformation from `from` to `to`. Between systems of the same name, coordinates stay as they are, bit for
    /// bit.
    ///
    /// # Errors
    /// [`Error::Data`] if a system is not known, if its projection is not supported, or if the shift between the datums
    /// is not known.
    pub fn between(from: &Crs, to: &Crs) -> Result<Self> {
        let (from, to) = (from.horizontal(), to.horizontal());
        if from.matches(&to) && (from.epsg.is_some() || from.wkt().is_some()) {
            return Ok(Self { way: Way::Same, is_shifted: false });
        }
        if let Some(factor) = from.units_of(&to) {
            let way = if factor == 1.0 { Way::Same } else { Way::Scaled(factor) };
            return Ok(Self { way, is_shifted: false });
        }
        let definitions = [Definition::of(&from)?, Definition::of(&to)?];
        let same_datum = definitions[0].datum.is_some() && definitions[0].datum == definitions[1].datum;
        if !same_datum {
            for (definition, crs) in definitions.iter().zip([&from, &to]) {
                let why = match definition.shift() {
                    Shift::None | Shift::Known => continue,
                    Shift::Grid => "needs a grid file of shifts",
                    Shift::Unknown => "is not known",
                };
                return Err(Error::Data(format!(
                    "{} cannot be transformed to {}: the shift from the datum of {} {why}; reproject the file first, \
                     for instance with ogr2ogr",
                    label(&from),
                    label(&to),
                    label(crs)
                )));
            }
        }
        let side = |definition: &Definition, crs: &Crs| -> Result<System> {
            let text = if same_datum { definition.on_own_datum() } else { definition.with_shift() };
            let proj = Proj::from_proj_string(&text).map_err(|e| {
                Error::Data(format!("{}: coordinates of this system cannot be transformed: {e}", label(crs)))
            })?;
            if !(proj.has_forward() && proj.has_inverse()) {
                let message = "its projection is known in one direction only, so coordinates cannot be transformed";
                return Err(Error::Data(format!("{}: {message}", label(crs))));
            }
            Ok(System { proj, angle: definition.angle })
        };
        let is_shifted = !same_datum && definitions.iter().any(|definition| definition.shift() == Shift::Known);
        let sides = Arc::new([side(&definitions[0], &from)?, side(&definitions[1], &to)?]);
        Ok(Self { way: Way::Projected(sides), is_shifted })
    }

    /// Whether coordinates stay as they are.
    pub fn is_identity(&self) -> bool {
        matches!(self.way, Way::Same)
    }

    /// The number by which coordinates are multiplied, if nothing else happens to them.
    pub fn factor(&self) -> Option<f64> {
        match self.way {
            Way::Same => Some(1.0),
            Way::Scaled(factor) => Some(factor),
            Way::Projected(_) => None,
        }
    }

    /// From the first system to the second, in their own units. `None` if the second has no such position.
    pub fn forward(&self, p: DVec2) -> Option<DVec2> {
        match &self.way {
            Way::Same => Some(p),
            Way::Scaled(factor) => finite(p * *factor),
            Way::Projected(sides) => convert(&sides[0], &sides[1], p),
        }
    }

    /// From the second system to the first, in their own units. `None` if the first has no such position.
    ///
    /// It is the inverse of [`forward`](Self::forward), also between datums that are shifted. A shift is made at height 0
    /// above the ellipsoid of the datum that it starts from. Height 0 of one datum is some metres above or below that
    /// of the other, so the shift back alone does not return to the same position: it misses by millimetres. The miss
    /// is taken off until nothing is left of it.
    pub fn inverse(&self, p: DVec2) -> Option<DVec2> {
        let [from, to] = match &self.way {
            Way::Same => return Some(p),
            Way::Scaled(factor) => return finite(p / *factor),
            Way::Projected(sides) => sides.as_ref(),
        };
        let mut found = convert(to, from, p)?;
        if !self.is_shifted {
            return Some(found);
        }
        let mut aim = p;
        for _ in 0..CORRECTIONS {
            aim += p - convert(from, to, found)?;
            let better = convert(to, from, aim)?;
            if better == std::mem::replace(&mut found, better) {
                break;
            }
        }
        Some(found)
    }
}

fn finite(p: DVec2) -> Option<DVec2> {
    p.is_finite().then_some(p)
}

fn convert(from: &System, to: &System, p: DVec2) -> Option<DVec2> {
    if !p.is_finite() {
        return None;
    }
    let p = from.angle.map_or(p, |unit| radians(p, unit));
    if from.angle.is_some() && p.y.abs() > std::f64::consts::FRAC_PI_2 + 1e-12 {
        return None;
    }
    let mut place = (p.x, p.y, 0.0);
    proj4rs::transform::transform(&from.proj, &to.proj, &mut place).ok()?;
    let q = DVec2::new(place.0, place.1);
    let q = to.angle.map_or(q, |unit| angles(q, unit));
    finite(q)
}

fn radians(p: DVec2, unit: f64) -> DVec2 {
    if unit == DEGREE { DVec2::new(p.x.to_radians(), p.y.to_radians()) } else { p * unit }
}

fn angles(p: DVec2, unit: f64) -> DVec2 {
    if unit == DEGREE { DVec2::new(p.x.to_degrees(), p.y.to_degrees()) } else { p / unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(from: u32, to: u32) -> Transform {
        Transform::between(&Crs::from_epsg(from), &Crs::from_epsg(to)).unwrap()
    }

    fn dms(degrees: f64, minutes: f64, seconds: f64) -> f64 {
        degrees + minutes / 60.0 + seconds / 3600.0
    }

    #[test]
    fn published_coordinates_of_the_plane_rectangular_zones() {
        // An example of the Geospatial Information Authority of Japan, on its page for latitude and longitude to plane
        // coordinates (after Kawase 2011). The second pair is from its page for the opposite direction. Their X is
        // north.
        for (zone, lat, lon, x, y) in [
            (9, dms(36., 6., 13.58925), dms(140., 5., 16.27815), 11_543.688_3, 22_916.243_6),
            (15, dms(26., 6., 23.34513), dms(127., 41., 28.71893), 11_810.197, 19_134.409),
        ] {
            let way = between(6668, 6668 + zone);
            let found = way.forward(DVec2::new(lon, lat)).unwrap();
            assert!(found.distance(DVec2::new(y, x)) < 1e-3, "zone {zone}: {found}");
            let back = way.inverse(found).unwrap();
            assert!(back.distance(DVec2::new(lon, lat)) < 1e-12, "zone {zone}: {back}");
        }
    }

    #[test]
    fn origins_of_the_zones_are_zero() {
        let origins = [
            (33., 129.5),
            (33., 131.),
            (36., 132. + 10. / 60.),
            (33., 133.5),
            (36., 134. + 20. / 60.),
            (36., 136.),
            (36., 137. + 10. / 60.),
            (36., 138.5),
            (36., 139. + 50. / 60.),
            (40., 140. + 50. / 60.),
            (44., 140.25),
            (44., 142.25),
            (44., 144.25),
            (26., 142.),
            (26., 127.5),
            (26., 124.),
            (26., 131.),
            (20., 136.),
            (26., 154.),
        ];
        for (i, (lat, lon)) in origins.into_iter().enumerate() {
            let found = between(6668, 6669 + i as u32).forward(DVec2::new(lon, lat)).unwrap();
            assert!(found.length() < 1e-6, "zone {}: {found}", i + 1);
        }
    }

    #[test]
    fn the_meridian_is_as_long_as_its_arc() {
        // The arc of the meridian is the integral of a (1 − e²) / (1 − e² sin²φ)^(3/2), here by Simpson's rule.
        let (a, f): (f64, f64) = (6_378_137.0, 1.0 / 298.257_222_101);
        let e2 = f * (2.0 - f);
        let curve = |lat: f64| a * (1.0 - e2) / (1.0 - e2 * lat.sin().powi(2)).powf(1.5);
        let (lo, hi, n) = (36f64.to_radians(), 44.5f64.to_radians(), 2000);
        let step = (hi - lo) / f64::from(n);
        let weight = |i: i32| if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        let arc = (0..=n).map(|i| weight(i) * curve(lo + f64::from(i) * step)).sum::<f64>() * step / 3.0;
        let found = between(6668, 6677).forward(DVec2::new(dms(139., 50., 0.), 44.5)).unwrap();
        assert!((found.y - 0.9999 * arc).abs() < 1e-3, "{} {}", found.y, 0.9999 * arc);
        assert!(found.x.abs() < 1e-6);
    }

    #[test]
    fn places_agree_with_proj() {
        // The ellipsoid of ETRS89 gives other coordinates than that of WGS 84, by a tenth of a millimetre.
        for (from, to, p, q, near) in [
            (4326, 32632, [8.0, 58.15], CHECK[0], 1e-6),
            (4258, 25832, [8.0, 58.15], CHECK[0], 5e-4),
            (4326, 3857, [138.7, 35.4], CHECK[1], 1e-6),
            (4326, 32756, [151.2, -33.9], CHECK[2], 1e-6),
            (4269, 2229, [-118.2, 34.1], CHECK[3], 1e-5),
            (4258, 3035, [8.0, 58.15], CHECK[4], 1e-6),
            (4171, 2154, [6.9, 45.8], CHECK[5], 1e-6),
            (4267, 26718, [-74.0, 41.0], CHECK[6], 1e-6),
        ] {
            let found = between(from, to).forward(p.into()).unwrap();
            assert!(found.distance(q.into()) < near, "{from} to {to}: {found} is not {q:?}");
            let back = between(from, to).inverse(found).unwrap();
            assert!(back.distance(p.into()) < 1e-10, "{from} to {to}: {back}");
        }
    }

    /// East and north from PROJ 9.5.1 for the systems above.
    const CHECK: [[f64; 2]; 7] = [
        [441_139.498_623_526, 6_445_846.654_014_416],
        [15_440_013.373_027_043, 4_218_373.287_173_4],
        [333_568.941_011_552, 6_247_473.336_844_02],
        [6_501_118.851_496_282, 1_858_834.334_990_413],
        [4_203_063.681_411_339, 3_895_929.487_952_826],
        [1_002_806.320_773_398, 6_529_743.184_548_502],
        [584_104.397_973_192, 4_539_026.702_246_191],
    ];

    #[test]
    fn old_datums_are_shifted_and_equal_ones_are_not() {
        // Some 450 m lie between coordinates of the Tokyo datum and of JGD2011, whichever way the table words them.
        let tokyo = between(4301, 6668).forward(DVec2::new(139.75, 35.65)).unwrap() - DVec2::new(139.75, 35.65);
        assert!((tokyo - DVec2::new(-0.0032, 0.0032)).length() < 3e-4, "{tokyo}");
        assert_eq!(
            between(4301, 6677).forward(DVec2::new(139.75, 35.65)).unwrap().x.round(),
            between(6668, 6677).forward(DVec2::new(139.75, 35.65) + tokyo).unwrap().x.round()
        );
        for (a, b) in [(4326, 6668), (4612, 4326), (4258, 4326), (4269, 4326)] {
            let p = DVec2::new(139.75, 35.65);
            assert!(between(a, b).forward(p).unwrap().distance(p) < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn the_way_back_between_shifted_datums_leads_back() {
        // Swiss, Austrian and British grids, ED50 and the Tokyo datum, each with a place in it and a modern plane.
        for (from, to, p) in [
            (21781, 32632, [600_000.0, 200_000.0]),
            (21781, 25832, [780_000.0, 160_000.0]),
            (2056, 32632, [2_700_000.0, 1_180_000.0]),
            (31254, 32632, [80_000.0, 235_000.0]),
            (31256, 25833, [2_000.0, 340_000.0]),
            (31287, 32633, [400_000.0, 400_000.0]),
            (27700, 32630, [320_000.0, 510_000.0]),
            (27700, 3857, [216_000.0, 771_000.0]),
            (23030, 25830, [450_000.0, 4_480_000.0]),
            (4230, 25832, [9.0, 54.0]),
            (30169, 6677, [-12_000.0, -35_000.0]),
            (4301, 6677, [139.75, 35.65]),
        ] {
            let (way, p) = (between(from, to), DVec2::from(p));
            let there = way.forward(p).unwrap();
            let back = way.forward(way.inverse(there).unwrap()).unwrap();
            assert!(back.distance(there) < 1e-6, "{from} to {to}: {} m off", back.distance(there));
            let lengths = if Crs::from_epsg(from).is_geographic() { 1e-11 } else { 1e-6 };
            assert!(way.inverse(there).unwrap().distance(p) < lengths, "{from} to {to}");
        }
    }

    #[test]
    fn a_shift_that_is_not_known_is_refused() {
        for (from, to) in [(4267, 4326), (4326, 26718), (4004, 6668), (4267, 6677)] {
            let error = Transform::between(&Crs::from_epsg(from), &Crs::from_epsg(to)).unwrap_err().to_string();
            assert!(error.contains("the shift from the datum of"), "{error}");
        }
        let unknown = Crs { epsg: None, wkt: Some("ENGCRS[\"site\"]".into()) };
        assert!(Transform::between(&unknown, &Crs::wgs84()).is_err());
        assert!(Transform::between(&Crs { epsg: None, wkt: None }, &Crs { epsg: None, wkt: None }).is_err());
    }

    #[test]
    fn the_same_system_leaves_every_bit() {
        let way = between(6677, 6677);
        let p = DVec2::new(0.1 + 0.2, -0.0);
        assert!(way.is_identity());
        assert_eq!(way.forward(p).map(|q| q.x.to_bits()), Some(p.x.to_bits()));
        assert_eq!(way.inverse(p).map(|q| q.y.to_bits()), Some(p.y.to_bits()));
    }

    #[test]
    fn texts_mean_what_their_codes_mean() {
        let p = DVec2::new(6.9, 45.8);
        for (code, base) in [(2154, 4171), (32632, 4326), (3035, 4258), (27563, 4275), (2229, 4269)] {
            let known = Crs::from_epsg(code);
            let text = known.wkt.clone().unwrap();
            let unnamed = text[..text.rfind(",AUTHORITY").unwrap()].to_owned() + "]";
            let unnamed = Crs { epsg: None, wkt: Some(unnamed) };
            let p = if code == 2229 { DVec2::new(-118.2, 34.1) } else { p };
            let base = Crs::from_epsg(base);
            let [a, b] = [&known, &unnamed].map(|crs| Transform::between(&base, crs).unwrap().forward(p).unwrap());
            assert!(a.distance(b) < 1e-3, "{code}: {a} {b}");
        }
    }

    #[test]
    fn no_place_and_no_system_panics() {
        let places = [0.0, -1.0, 90.0, 91.0, 180.0, 1e6, -1e300, f64::NAN, f64::INFINITY];
        let (mut known, mut ways, mut found) = (0, 0, 0);
        for code in (1024..=u16::MAX).map(u32::from).filter(|code| code % 7 == 0 || *code == 3857) {
            let crs = Crs::from_epsg(code);
            if crs.wkt.is_none() {
                continue;
            }
            known += 1;
            let Ok(way) = Transform::between(&crs, &Crs::from_epsg(4258)) else { continue };
            ways += 1;
            if way.is_identity() {
                continue;
            }
            for x in places {
                for y in places {
                    let p = DVec2::new(x, y);
                    for q in [way.forward(p), way.inverse(p)].into_iter().flatten() {
                        assert!(q.is_finite(), "{code} {p}");
                        found += 1;
                    }
                }
            }
        }
        // Measured: 760 of 875 systems, 42183 places.
        assert!(known >= 800 && ways * 10 >= known * 8, "{ways} transformations of {known} systems");
        assert!(found >= 30_000, "{found} places have coordinates");
    }
}
