//! Charts of lines, such as profiles and storage curves, as PNG or SVG.
//!
//! A chart is laid out once, as shapes that both formats draw. Letters of an SVG are text.

mod layout;
mod png;
mod shapes;
mod svg;

use image::RgbImage;

use tokosen_core::base::error::{Error, Result};

/// A line of a chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Its points; it is interrupted where a coordinate is not a number.
    pub points: Vec<[f64; 2]>,
    /// Half the height of a band around each point, in the unit of y; empty if there is none.
    pub band: Vec<f64>,
}

/// One pair of axes with lines.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// What stands above it.
    pub title: String,
    /// What the axes show, with the unit.
    pub labels: [String; 2],
    /// The lines.
    pub series: Vec<Series>,
    /// How much larger a unit of y is drawn than one of x. If `None`, the panel has a usual shape.
    pub exaggeration: Option<f64>,
}

/// A picture of panels below and beside each other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// What stands above all.
    pub title: String,
    /// The panels.
    pub panels: Vec<Panel>,
}

/// A chart has so many panels at most.
pub const MOST_PANELS: usize = 60;

impl Chart {
    /// The chart as a picture.
    ///
    /// # Errors
    /// A chart without a point, or with more panels than [`MOST_PANELS`].
    pub fn png(&self) -> Result<RgbImage> {
        png::draw(&layout::layout(self.checked()?))
    }

    /// The chart as the text of an SVG.
    ///
    /// # Errors
    /// As [`Chart::png`].
    pub fn svg(&self) -> Result<String> {
        Ok(svg::draw(&layout::layout(self.checked()?)))
    }

    fn checked(&self) -> Result<&Self> {
        let points = self.panels.iter().flat_map(|panel| &panel.series).flat_map(|series| &series.points);
        if points.filter(|point| point.iter().all(|number| number.is_finite())).count() == 0 {
            return Err(Error::Parameter("a chart needs points".into()));
        }
        match self.panels.len() {
            0..=MOST_PANELS => Ok(self),
            n => Err(Error::Parameter(format!("a chart of {n} panels is too large; there may be {MOST_PANELS}"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(exaggeration: Option<f64>) -> Chart {
        let points = (0..=100).map(|k| [f64::from(k) * 10.0, 700.0 + f64::from(k % 20)]).collect();
        let a = Series { name: "ground & water".into(), points, band: vec![0.5; 101] };
        let b = Series {
            name: "design".into(),
            points: vec![[0.0, 700.0], [f64::NAN; 2], [500.0, 710.0], [900.0, 720.0]],
            band: vec![],
        };
        let labels = ["distance, m".into(), "height, m".into()];
        let panel = Panel { title: "Line 1".into(), labels, series: vec![a, b], exaggeration };
        Chart { title: "Profile".into(), panels: vec![panel] }
    }

    #[test]
    fn both_formats_show_the_same() {
        let picture = chart(None).png().unwrap();
        let svg = chart(None).svg().unwrap();
        assert!(svg.starts_with("<svg") && svg.contains(&format!("width=\"{}\"", picture.width())));
        for text in ["ground &amp; water", "design", "distance, m", "height, m", "Line 1", "Profile", ">1000<", ">710<"]
        {
            assert!(svg.contains(text), "{text}: {svg}");
        }
        // The band, and its sample in the legend.
        assert_eq!(svg.matches("<polygon").count(), 2);
        let blue = picture.pixels().filter(|p| p.0[2] > p.0[0].saturating_add(80)).count();
        assert!(blue > 100, "{blue}");
    }

    #[test]
    fn heights_are_exaggerated_as_asked() {
        let height = |exaggeration| chart(Some(exaggeration)).png().unwrap().height();
        assert!(height(40.0) > height(10.0) + 100);
        assert!(chart(Some(10.0)).svg().unwrap().contains("heights x 10"));
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        assert!(Chart::default().png().is_err());
        let many = Chart { panels: vec![chart(None).panels[0].clone(); MOST_PANELS + 1], ..chart(None) };
        assert!(many.svg().unwrap_err().to_string().contains("61 panels"));
    }
}
