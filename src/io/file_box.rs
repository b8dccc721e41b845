//! A box in a file, outside of which features are not read.

/// A box in the coordinates of a file: least x, least y, greatest x, greatest y. They are finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileBox([f64; 4]);

impl Eq for FileBox {}

impl FileBox {
    /// Reads `XMIN,YMIN,XMAX,YMAX`.
    pub(crate) fn from_text(text: &str) -> Option<Self> {
        let numbers = text.split(',').map(|part| part.trim().parse().ok().filter(|n: &f64| n.is_finite()));
        let sides: [f64; 4] = numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()?;
        (sides[0] <= sides[2] && sides[1] <= sides[3]).then_some(Self(sides))
    }

    /// Least x, least y, greatest x, greatest y.
    pub(crate) fn sides(&self) -> [f64; 4] {
        self.0
    }

    /// Whether it meets another box: least x, least y, greatest x, greatest y. One with sides that are no numbers may.
    pub(crate) fn meets(&self, [x0, y0, x1, y1]: [f64; 4]) -> bool {
        let [low_x, low_y, high_x, high_y] = self.0;
        !(x0 > high_x || x1 < low_x || y0 > high_y || y1 < low_y)
    }
}
