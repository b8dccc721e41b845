//! Mesh codes of Japan's standard grid squares (JIS X 0410), and the exact edges of the squares.

/// A grid square. Its edges are whole seconds of arc.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Mesh {
    /// Southern edge.
    pub south: i64,
    /// Western edge.
    pub west: i64,
    /// Extent from south to north.
    pub height: i64,
    /// Extent from west to east.
    pub width: i64,
}

impl Mesh {
    /// The square of a code of 4, 6 or 8 digits. `None` if the code is not valid.
    pub fn of_code(code: &str) -> Option<Self> {
        let digits: Vec<i64> = code.chars().map(|c| c.to_digit(10).map(i64::from)).collect::<Option<_>>()?;
        let &[p0, p1, u0, u1, ref rest @ ..] = digits.as_slice() else { return None };
        let (mut south, mut west) = ((p0 * 10 + p1) * 2400, (100 + u0 * 10 + u1) * 3600);
        let (mut height, mut width) = (2400, 3600);
        // Each level of the code has two digits: the step to the north, then the step to the east. `parts` is the
        // number of squares per side.
        let (pairs, []) = rest.as_chunks::<2>() else { return None };
        if pairs.len() > 2 {
            return None;
        }
        for (&[north, east], parts) in pairs.iter().zip([8, 10]) {
            if north >= parts || east >= parts {
                return None;
            }
            (height, width) = (height / parts, width / parts);
            south += north * height;
            west += east * width;
        }
        // Japan lies inside this range. A square outside it comes from an invalid code.
        let in_range = (15 * 3600..50 * 3600).contains(&south) && (118 * 3600..160 * 3600).contains(&west);
        in_range.then_some(Self { south, west, height, width })
    }

    /// Latitude and longitude of the south-west and the north-east corner, degrees.
    pub fn corners(&self) -> [[f64; 2]; 2] {
        let degrees = |seconds: i64| seconds as f64 / 3600.0;
        [
            [degrees(self.south), degrees(self.west)],
            [degrees(self.south + self.height), degrees(self.west + self.width)],
        ]
    }
}

/// Cells per degree of a height map, equal in both directions. `None` if the cells do not divide the square evenly, or
/// if the edges of squares of this size do not all fall on edges of cells.
pub(super) fn cells_per_degree(mesh: &Mesh, cols: u64, rows: u64) -> Option<i64> {
    let along = |cells: u64, extent: i64| {
        let cells = i64::try_from(cells).ok()?.checked_mul(3600)?;
        (cells > 0 && cells % extent == 0).then_some(cells / extent)
    };
    let density = along(cols, mesh.width)?;
    (along(rows, mesh.height)? == density && (density * mesh.width) % 3600 == 0).then_some(density)
}

/// A position in cells from the equator or the zero meridian. `None` if it is not a whole number.
pub(super) fn in_cells(seconds: i64, cells_per_degree: i64) -> Option<i64> {
    let cells = seconds * cells_per_degree;
    (cells % 3600 == 0).then_some(cells / 3600)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_where_the_published_files_have_them() {
        // Codes with the corners that files of these squares state.
        for (code, [south, west], [north, east]) in [
            ("543745", [36.333333333, 137.625], [36.416666667, 137.75]),
            ("36243098", [24.325, 124.1], [24.333333333, 124.1125]),
            ("36243076", [24.308333333, 124.075], [24.316666667, 124.0875]),
            ("5339", [35.333333333, 139.0], [36.0, 140.0]),
        ] {
            let [sw, ne] = Mesh::of_code(code).unwrap().corners();
            for (a, b) in [(sw[0], south), (sw[1], west), (ne[0], north), (ne[1], east)] {
                assert!((a - b).abs() < 1e-9, "{code}: {a} {b}");
            }
        }
    }

    #[test]
    fn codes_that_are_none() {
        for code in [
            "",
            "54",
            "54374",
            "543785",
            "543758",
            "5437450",
            "54374500 ",
            "543745000",
            "5437a5",
            "９９",
            "0000",
            "9999",
        ] {
            assert_eq!(Mesh::of_code(code), None, "{code}");
        }
    }

    #[test]
    fn cells_of_the_products() {
        let (second, third) = (Mesh::of_code("543745").unwrap(), Mesh::of_code("36243098").unwrap());
        assert_eq!(cells_per_degree(&second, 1125, 750), Some(9000));
        assert_eq!(cells_per_degree(&third, 225, 150), Some(18_000));
        assert_eq!(cells_per_degree(&third, 1125, 750), Some(90_000));
        for (cols, rows) in [(1125, 751), (1124, 750), (0, 0), (u64::MAX, 1), (225, 0)] {
            assert_eq!(cells_per_degree(&second, cols, rows), None);
        }
        assert_eq!(in_cells(second.west, 9000), Some(1_238_625));
    }
}
