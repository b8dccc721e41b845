//! The quantities that a raster can hold, and their names in files.

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
}

impl Quantity {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Height => "height",
            Self::Difference => "difference in height",
            Self::Slope => "slope",
            Self::Aspect => "aspect",
            Self::Shade => "brightness",
        }
    }

    /// Its unit: the name that programs use, and words.
    pub(super) fn unit(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Height | Self::Difference => Some(("m", "metres")),
            Self::Slope | Self::Aspect => Some(("degree", "degrees")),
            Self::Shade => None,
        }
    }

    /// What the values are, such as `height in metres`.
    pub(super) fn words(self) -> String {
        self.unit().map_or(self.name().to_owned(), |(_, unit)| format!("{} in {unit}", self.name()))
    }
}

/// The name in files of the second value per cell.
pub const STANDARD_ERROR: &str = "standard error";
