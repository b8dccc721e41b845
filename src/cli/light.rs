//! The light of a hillshade on the command line.

use clap::Args;
use tokosen::dem::shade::{Light, ShadeParams};

use super::failure::Failure;

/// The light of a hillshade.
#[derive(Debug, Clone, Args)]
pub struct LightArgs {
    /// Azimuth of the light of the hillshade [degrees clockwise from north]
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 315.0,
        requires = "hillshade",
        conflicts_with = "multidirectional"
    )]
    pub azimuth: f64,
    /// Altitude of the light of the hillshade above the horizon [degrees]
    #[arg(long, value_name = "DEGREES", default_value_t = 45.0, requires = "hillshade")]
    pub altitude: f64,
    /// Factor on heights for the hillshade (vertical exaggeration)
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, requires = "hillshade")]
    pub z_factor: f64,
    /// Light the hillshade from 225, 270, 315 and 360 degrees; each slope mostly from the side, as 'gdaldem
    /// -multidirectional' does
    #[arg(long, requires = "hillshade")]
    pub multidirectional: bool,
}

impl LightArgs {
    /// The parameters of the hillshade.
    pub fn params(&self) -> Result<ShadeParams, Failure> {
        let Self { azimuth, altitude, z_factor, multidirectional } = *self;
        if !(0.0..=360.0).contains(&azimuth) {
            return Err(Failure::Usage(format!("--azimuth is {azimuth}, it must be from 0 to 360")));
        }
        if !(0.0..=90.0).contains(&altitude) {
            return Err(Failure::Usage(format!("--altitude is {altitude}, it must be from 0 to 90")));
        }
        if !(z_factor.is_finite() && z_factor > 0.0) {
            return Err(Failure::Usage(format!("--z-factor is {z_factor}, it must be more than 0")));
        }
        let params = match multidirectional {
            true => ShadeParams::multidirectional(altitude),
            false => ShadeParams { lights: vec![Light { azimuth, altitude, weight: 1.0 }], ..ShadeParams::default() },
        };
        Ok(ShadeParams { exaggeration: z_factor, ..params })
    }
}
