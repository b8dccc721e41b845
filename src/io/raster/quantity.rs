//! The quantities that a raster can hold, and their names in files.

use tokosen_core::base::ElevationUnit;

/// What the values of a raster are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quantity {
    /// Height in metres.
    #[default]
    Height,
    /// Height above another surface, metres.
    Difference,
    /// Steepness in degrees.
    Slope,
    /// The direction that a slope faces, degrees clockwise from north.
    Aspect,
    /// Brightness from 1 to 255.
    Shade,
    /// The neighbour that a cell drains to, as a code.
    FlowDirection,
    /// The number of cells that drain through a cell.
    FlowAccumulation,
    /// The area that drains through a cell, square metres.
    UpstreamArea,
    /// The number of a catchment.
    Catchment,
    /// The depth of water, metres.
    Depth,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 10] = [
        Self::Height,
        Self::Difference,
        Self::Slope,
        Self::Aspect,
        Self::Shade,
        Self::FlowDirection,
        Self::FlowAccumulation,
        Self::UpstreamArea,
        Self::Catchment,
        Self::Depth,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Height => "height",
            Self::Difference => "difference in height",
            Self::Slope => "slope",
            Self::Aspect => "aspect",
            Self::Shade => "brightness",
            Self::FlowDirection => "flow direction",
            Self::FlowAccumulation => "flow accumulation",
            Self::UpstreamArea => "upstream area",
            Self::Catchment => "catchment",
            Self::Depth => "depth",
        }
    }

    /// Whether it is measured in a unit of height.
    fn is_vertical(self) -> bool {
        matches!(self, Self::Height | Self::Difference | Self::Depth)
    }
}

/// The values in a file: a quantity in its unit there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Values {
    pub quantity: Quantity,
    /// The unit of heights.
    pub heights: ElevationUnit,
}

impl From<Quantity> for Values {
    /// The quantity, with heights in metres.
    fn from(quantity: Quantity) -> Self {
        Self { quantity, heights: ElevationUnit::Metre }
    }
}

impl Values {
    /// The name of the quantity.
    pub fn name(self) -> &'static str {
        self.quantity.name()
    }

    /// The unit: the name that programs use, and words.
    pub fn unit(self) -> Option<(&'static str, &'static str)> {
        match self.quantity {
            quantity if quantity.is_vertical() => Some((programs_name(self.heights), self.heights.name())),
            Quantity::Slope | Quantity::Aspect => Some(("degree", "degrees")),
            Quantity::FlowAccumulation => Some(("cells", "cells")),
            Quantity::UpstreamArea => Some(("m2", "square metres")),
            _ => None,
        }
    }

    /// What the values are, such as `height in metres`.
    pub fn words(self) -> String {
        self.unit().map_or(self.name().to_owned(), |(_, unit)| format!("{} in {unit}", self.name()))
    }

    /// The factor from values in memory to those in the file. `None` if they are the same.
    pub fn factor(self) -> Option<f64> {
        (self.quantity.is_vertical() && self.heights.is_foot()).then(|| self.heights.about(1.0))
    }
}

/// The name of a unit of heights that GDAL and programs on top of it use.
fn programs_name(unit: ElevationUnit) -> &'static str {
    match unit {
        ElevationUnit::Metre => "m",
        ElevationUnit::Foot => "ft",
        ElevationUnit::UsSurveyFoot => "US survey foot",
    }
}

/// The name in files of the second value per cell.
pub const STANDARD_ERROR: &str = "standard error";
