//! The note about the limits of steep places, which depend on the source of the heights.

/// The source of heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeightsFrom {
    /// Contours, with their contour interval in metres if they have one.
    Contours(Option<f64>),
    /// A height map.
    HeightMap,
}

/// A note about steep places of at least `height` metres from such a source. It is stored with them.
pub fn steep_note(source: HeightsFrom, height: f64) -> String {
    // The height is rounded to millimetres, so that the note fits into every format.
    let height = (height * 1000.0).round() / 1000.0;
    let known = match source {
        HeightsFrom::Contours(Some(interval)) if interval > height => format!(
            "From contours {interval} m apart, which cannot show a slope of {height} m. Steep places lower than \
             {interval} m may be missing. Others may have a wrong position and size."
        ),
        HeightsFrom::Contours(Some(interval)) => {
            format!("From contours {interval} m apart. Heights between them are computed, not measured.")
        }
        HeightsFrom::Contours(None) => format!(
            "From contours of unknown interval. If it is larger than {height} m, they cannot show a slope of \
             {height} m, and steep places may be missing."
        ),
        HeightsFrom::HeightMap => format!(
            "From a height map. If it was made from contours more than {height} m apart, it cannot show a slope of \
             {height} m, and steep places may be missing."
        ),
    };
    format!("{known} Not a survey.")
}
