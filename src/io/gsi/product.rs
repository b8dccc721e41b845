//! The height maps of 基盤地図情報 and their accuracy.

/// A kind of height map, by its source and the size of its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Product {
    /// 1 m cells (0.04 seconds of arc) from airborne lidar.
    Dem1A,
    /// 5 m cells (0.2 seconds) from airborne lidar.
    Dem5A,
    /// 5 m cells from aerial photographs of 20 cm ground resolution.
    Dem5B,
    /// 5 m cells from aerial photographs of 40 cm ground resolution, on some islands.
    Dem5C,
    /// 10 m cells (0.4 seconds) from the contours of volcano maps.
    Dem10A,
    /// 10 m cells from the contours of the topographic map.
    Dem10B,
}

impl Product {
    /// The product's name, such as `DEM10B`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dem1A => "DEM1A",
            Self::Dem5A => "DEM5A",
            Self::Dem5B => "DEM5B",
            Self::Dem5C => "DEM5C",
            Self::Dem10A => "DEM10A",
            Self::Dem10B => "DEM10B",
        }
    }

    /// The stated accuracy of a height, as a standard deviation in metres.
    ///
    /// The values come from the table of products on GSI's page about its height maps
    /// (fgd.gsi.go.jp/download/ref_dem.html), which states each as a bound. DEM1A uses the value of DEM5A, which is
    /// measured the same way. Lidar cells without a measured point in them may be off by up to 2 m.
    pub fn sigma(self) -> f64 {
        match self {
            Self::Dem1A | Self::Dem5A => 0.3,
            Self::Dem5B => 0.7,
            Self::Dem5C => 1.4,
            Self::Dem10A => 2.5,
            Self::Dem10B => 5.0,
        }
    }

    /// Cells per degree, in both directions.
    pub(super) fn cells_per_degree(self) -> i64 {
        match self {
            Self::Dem1A => 90_000,
            Self::Dem5A | Self::Dem5B | Self::Dem5C => 18_000,
            Self::Dem10A | Self::Dem10B => 9000,
        }
    }

    /// The product of a document. The item in its name decides if it fits the cells. Otherwise the type of the height
    /// map and its cells decide.
    ///
    /// The name comes first because two products have the same type.
    pub(super) fn of(item: Option<&str>, kind: &str, cells_per_degree: i64) -> Option<Self> {
        let all = [Self::Dem1A, Self::Dem5A, Self::Dem5B, Self::Dem5C, Self::Dem10A, Self::Dem10B];
        let fits = |product: &Self| product.cells_per_degree() == cells_per_degree;
        let named = all.into_iter().find(|product| item.is_some_and(|item| item.eq_ignore_ascii_case(product.name())));
        let by_kind = match cells_per_degree {
            90_000 => Self::Dem1A,
            18_000 if kind.contains("数値地形") => Self::Dem5B,
            18_000 => Self::Dem5A,
            9000 if kind.contains("火山") => Self::Dem10A,
            9000 => Self::Dem10B,
            _ => return None,
        };
        Some(named.filter(fits).unwrap_or(by_kind))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_by_name_and_by_type() {
        let of = Product::of;
        assert_eq!(of(Some("dem5c"), "5mメッシュ（数値地形）", 18_000), Some(Product::Dem5C));
        assert_eq!(of(None, "5mメッシュ（数値地形）", 18_000), Some(Product::Dem5B));
        assert_eq!(of(None, "5mメッシュ（標高）", 18_000), Some(Product::Dem5A));
        assert_eq!(of(Some("DEM5A"), "10mメッシュ（火山標高）", 9000), Some(Product::Dem10A));
        assert_eq!(of(None, "10mメッシュ（標高）", 9000), Some(Product::Dem10B));
        assert_eq!(of(None, "1mメッシュ（標高）", 90_000), Some(Product::Dem1A));
        assert_eq!(of(Some("DEM5A"), "", 7200), None);
    }
}
