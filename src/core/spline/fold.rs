//! Where the surface may bend sharply, and which way.

/// How the surface may bend across a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Fold {
    /// As everywhere.
    #[default]
    None,
    /// Sharply, where contours are near. The line was found, for example as a ridge line.
    Found,
    /// Sharply, in either way. The map gives the line.
    Given,
    /// Sharply, if the line is then higher than a straight line from side to side.
    Ridge,
    /// Sharply, if the line is then lower than a straight line from side to side.
    Valley,
}

/// The folds that second differences lie across, one array for each kind of difference.
pub type Folds = [Vec<Fold>; 3];

impl Fold {
    /// Whether a second difference may be large across it. Positive differences belong to hollow ground.
    pub fn may_bend(self, difference: f64) -> bool {
        match self {
            Self::None => false,
            Self::Found | Self::Given => true,
            Self::Ridge => difference <= 0.0,
            Self::Valley => difference >= 0.0,
        }
    }
}
