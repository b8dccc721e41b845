//! Meshes in the unit of a drawing. The surface is made in metres; a model of a drawing in feet is in feet again, on all
//! three axes.

use glam::DVec3;

use super::Mesh;
use crate::crs::{LengthUnit, Reprojection};

impl Mesh {
    /// The mesh in the coordinates of the input, if the input is a drawing in another unit than metres: x, y, heights and the
    /// bottom. `None` for other inputs. Vertices of contours have the coordinates that they have in the drawing.
    pub fn in_drawing(&self, reprojection: &Reprojection) -> Option<Self> {
        let crs = reprojection.plane_of_drawing()?;
        let unit = crs.length_unit()?;
        let origin = (self.origin / unit.metres).round();
        let place = |v: &DVec3| {
            let p = v.truncate() + self.origin.truncate();
            let height = (v.z + self.origin.z) / unit.metres;
            reprojection.in_input(p).unwrap_or(p / unit.metres).extend(height) - origin
        };
        Some(Self {
            origin,
            vertices: self.vertices.iter().map(place).collect(),
            break_lines: self.break_lines.iter().map(|line| line.iter().map(place).collect()).collect(),
            base: self.base.map(|base| base / unit.metres),
            crs: Some(crs.clone()),
            unit: Some(unit),
            ..self.clone()
        })
    }

    /// The mesh in metres on all three axes, for formats that prescribe them. `None` if it is in metres.
    pub fn in_metres(&self) -> Option<Self> {
        let LengthUnit { metres, .. } = self.unit.clone()?;
        let origin = (self.origin * metres).round();
        let place = |v: &DVec3| (*v + self.origin) * metres - origin;
        Some(Self {
            origin,
            vertices: self.vertices.iter().map(place).collect(),
            break_lines: self.break_lines.iter().map(|line| line.iter().map(place).collect()).collect(),
            base: self.base.map(|base| base * metres),
            crs: self.crs.as_ref().map(|crs| crs.local_in_metres().unwrap_or_else(|| crs.clone())),
            unit: None,
            ..self.clone()
        })
    }

    /// The name of the unit of all three axes.
    pub fn unit_name(&self) -> &str {
        self.unit.as_ref().map_or("metre", |unit| &unit.name)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec3};

    use super::*;
    use crate::crs::Crs;

    #[test]
    fn a_drawing_in_feet_gives_a_model_in_feet() {
        let feet = Crs::of_plane(&LengthUnit { name: "US survey foot".into(), metres: 1200.0 / 3937.0 });
        let drawn = [
            DVec2::new(2_000_000.1, 600_000.7),
            DVec2::new(2_000_400.3, 600_000.7),
            DVec2::new(2_000_400.3, 600_300.9),
        ];
        let mut points = drawn;
        let metres = feet.local_in_metres().unwrap();
        let places = Reprojection::project(&mut [&mut points], &mut [], &feet, &metres).unwrap().value;
        let origin = DVec3::new(609_600.0, 182_900.0, 0.0);
        let vertex = |k: usize| points[k].extend(30.0) - origin;
        let mesh = Mesh {
            break_lines: Vec::new(),
            origin,
            vertices: (0..3).map(vertex).collect(),
            normals: vec![Vec3::Z; 3],
            triangles: vec![[0, 1, 2]],
            base: Some(0.3048),
            crs: Some(metres),
            unit: None,
        };
        let own = mesh.in_drawing(&places).unwrap();
        assert_eq!((own.unit_name(), mesh.unit_name()), ("US survey foot", "metre"));
        for (v, p) in own.vertices.iter().zip(drawn) {
            assert!((*v + own.origin).truncate().distance(p) < 1e-9);
            assert!((v.z - 30.0 * 3937.0 / 1200.0).abs() < 1e-9);
        }
        assert!(own.origin == own.origin.round() && own.vertices.iter().all(|v| v.length() < 1000.0), "{own:?}");
        let back = own.in_metres().unwrap();
        for (v, w) in back.vertices.iter().zip(&mesh.vertices) {
            assert!((*v + back.origin).distance(*w + mesh.origin) < 1e-6);
        }
        assert_eq!(back.crs.and_then(|crs| crs.length_unit()).map(|unit| unit.metres), Some(1.0));
        assert!(mesh.in_metres().is_none() && mesh.in_drawing(&Reprojection::default()).is_none());
    }
}
