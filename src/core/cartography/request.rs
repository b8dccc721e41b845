//! What is asked of a map, before its ground is known.

use super::for_map::{MapParams, Steep};
use super::kinds::Kinds;
use super::rules::MapScale;
use crate::base::ElevationUnit;
use crate::base::error::{Error, Result};
use crate::contour::{Interval, Target};

/// What is asked of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapRequest {
    /// The levels of its layers: one interval, or none if the scale is to choose one.
    pub targets: Vec<Target>,
    /// The unit of the interval and of the steps.
    pub unit: ElevationUnit,
    /// One contour of the interval in so many is an index contour; 0 for none.
    pub index_every: u32,
    /// The steps of supplementary contours: none, half of the interval, or half and a quarter of it.
    pub supplementary: Vec<f64>,
    /// Supplementary contours are drawn where the others are at least so far apart, metres.
    pub spacing: Option<f64>,
    /// The number of the scale.
    pub scale: Option<f64>,
    /// What becomes of intermediate contours on steep slopes.
    pub steep: Steep,
}

/// A request that makes sense.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPlan {
    params: MapParams,
    /// Whether the interval is still to be chosen.
    is_open: bool,
}

impl MapRequest {
    /// The plan, if anything is asked for.
    ///
    /// # Errors
    /// [`Error::Parameter`] with a sentence about what does not go together.
    pub fn plan(&self) -> Result<Option<MapPlan>> {
        let wrong = |message: String| Err(Error::Parameter(message));
        let scale = match self.scale.map(|number| (number, MapScale::new(number))) {
            Some((number, None)) => return wrong(format!("the scale is {number}, it must be 1 or more")),
            scale => scale.and_then(|(_, scale)| scale),
        };
        match (&self.supplementary[..], scale) {
            ([], None) if self.spacing.is_none() && self.steep == Steep::Keep => return Ok(None),
            (_, None) if self.steep == Steep::Thin => {
                return wrong("leaving out lines on steep slopes needs a scale".into());
            }
            ([], _) if self.spacing.is_some() => {
                return wrong("a spacing applies to supplementary contours only".into());
            }
            _ => {}
        }
        if let Some(bad) = self.spacing.filter(|d| !(d.is_finite() && *d > 0.0)) {
            return wrong(format!("the spacing of supplementary contours is {bad}, it must be more than 0"));
        }
        let open = Interval { step: f64::NAN, base: 0.0, rounding: 0.0 };
        let (interval, is_open) = match self.targets[..] {
            [Target::Interval { step, base }] => (Interval { step, base, rounding: 0.0 }, false),
            [] if self.supplementary.is_empty() => (open, true),
            [] => return wrong("supplementary contours need an interval, of which they are half and a quarter".into()),
            _ => return wrong("supplementary contours and contours for a scale have one interval".into()),
        };
        if let Some(scale) = scale.filter(|scale| is_open && scale.interval(0.0).is_none()) {
            return wrong(format!(
                "there is no usual interval for 1:{}, only for scales from 1:7000 to 1:160000: give an interval",
                scale.number()
            ));
        }
        let kinds = Kinds { interval, unit: self.unit, index_every: self.index_every, parts: 1 };
        let kinds = if self.supplementary.is_empty() { kinds } else { kinds.with_steps(&self.supplementary)? };
        Ok(Some(MapPlan { params: MapParams { kinds, apart: self.spacing, scale, steep: self.steep }, is_open }))
    }
}

impl MapPlan {
    /// The parameters for ground of a mean slope (rise by run), by which the interval is chosen if none is given. In feet it is
    /// four times the number: 20 feet instead of 5 m.
    pub fn settle(self, slope: impl FnOnce() -> f64) -> MapParams {
        let mut params = self.params;
        if let Some(step) = params.scale.filter(|_| self.is_open).and_then(|scale| scale.interval(slope())) {
            params.kinds.interval.step = if params.kinds.unit.is_foot() { 4.0 * step } else { step };
        }
        params
    }

    /// Whether the interval is chosen by the slope.
    pub fn is_open(&self) -> bool {
        self.is_open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request() -> MapRequest {
        MapRequest {
            targets: vec![Target::Interval { step: 10.0, base: 0.0 }],
            unit: ElevationUnit::Metre,
            index_every: 5,
            supplementary: vec![],
            spacing: None,
            scale: None,
            steep: Steep::Keep,
        }
    }

    #[test]
    fn what_does_not_go_together_is_said() {
        assert_eq!(request().plan().unwrap(), None);
        let said = |request: MapRequest| request.plan().unwrap_err().to_string();
        let half = MapRequest { supplementary: vec![5.0], ..request() };
        assert!(half.plan().unwrap().is_some());
        assert!(said(MapRequest { targets: vec![], ..half.clone() }).contains("need an interval"));
        let two = vec![Target::Interval { step: 10.0, base: 0.0 }; 2];
        assert!(said(MapRequest { targets: two, ..half.clone() }).contains("one interval"));
        assert!(said(MapRequest { targets: vec![Target::Levels(vec![1.0])], ..half.clone() }).contains("one interval"));
        assert!(said(MapRequest { spacing: Some(0.0), ..half }).contains("more than 0"));
        assert!(said(MapRequest { spacing: Some(10.0), ..request() }).contains("supplementary"));
        assert!(said(MapRequest { steep: Steep::Thin, ..request() }).contains("needs a scale"));
        assert!(said(MapRequest { scale: Some(0.0), ..request() }).contains("1 or more"));
        assert!(said(MapRequest { targets: vec![], scale: Some(500.0), ..request() }).contains("1:500"));
    }

    #[test]
    fn the_slope_chooses_an_interval() {
        let open =
            |unit| MapRequest { targets: vec![], scale: Some(25_000.0), unit, ..request() }.plan().unwrap().unwrap();
        assert_eq!(
            open(ElevationUnit::Metre).settle(|| 0.2).kinds.interval,
            Interval { step: 5.0, base: 0.0, rounding: 0.0 }
        );
        assert_eq!(open(ElevationUnit::Metre).settle(|| 0.3).kinds.interval.step, 10.0);
        assert_eq!(open(ElevationUnit::Foot).settle(|| 0.1).kinds.interval.step, 20.0);
        let given = MapRequest { scale: Some(25_000.0), ..request() }.plan().unwrap().unwrap();
        assert_eq!(given.settle(|| unreachable!("an interval is given")).kinds.interval.step, 10.0);
    }
}
