//! A model in layers: [`Terrain::plates`].

use super::facade::Terrain;
use tokosen_core::bands::bands_of_surface;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Report, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::contour::Target;
use tokosen_core::layers::LayerParams;
use tokosen_core::plates::{PlateParams, Plates, plates};

impl Terrain {
    /// Millimetres of the model for each metre.
    pub fn plate_scale(&self, params: &PlateParams) -> f64 {
        let (lo, hi) = self.surface.frame.extent();
        params.size / (hi - lo).max_element()
    }

    /// The plates of a model in layers, with findings about contours that divide no areas.
    ///
    /// # Errors
    /// As [`plates`], [`PlateParams::steps`] and [`Terrain::contours`].
    /// [`Error::PlaneUnitUnknown`](crate::Error::PlaneUnitUnknown) if heights are in feet and nothing states the unit of x and y.
    pub fn plates(&self, params: &PlateParams, progress: &dyn Progress) -> Result<Report<Plates>> {
        self.check_plane_unit()?;
        let scale = self.plate_scale(params);
        let (interval, _) = params.steps(scale)?;
        let (target, unit) = (Target::from(interval), ElevationUnit::Metre);
        let layers = LayerParams { targets: vec![target.clone()], unit, ..LayerParams::default() };
        let layers = self.contours_with(layers, progress)?;
        let mut findings = Vec::new();
        let found = step(progress, "plates", || {
            let areas = bands_of_surface(&self.surface, &layers[0], &target, unit).collect(&mut findings);
            plates(&areas, interval, scale, params.sheet)
        });
        Ok(Report { value: found?, findings })
    }
}
