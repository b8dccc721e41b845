//! Tuned numbers by name: `spline.crease_weight`, and for an element of an array `spline.steps.1`.

use serde_json::Value;

use super::Tuning;

/// The reason why a tuned number cannot be set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TuneError {
    /// There is no number with this name.
    #[error("no tuned number is called {name:?}; the tuned numbers are:\n{known}")]
    Unknown {
        /// The name.
        name: String,
        /// The existing names with their values, one per line.
        known: String,
    },
    /// The number cannot have this value.
    #[error("the tuned number {name} cannot be {value}: {reason}")]
    Unsuitable {
        /// The name.
        name: String,
        /// The value.
        value: String,
        /// The condition that the value does not meet.
        reason: &'static str,
    },
}

/// Numbers that must be above zero: divisors, and lengths of arrays.
const ABOVE_ZERO: [&str; 4] =
    ["spline.grid.", "spline.wide.jump_limits", "spline.wide.slope_reach", "errors.width_classes"];

/// The end of the name of a pair of limits, least and largest.
const LIMITS: &str = "_limits";

impl Tuning {
    /// All numbers, as text, by name in alphabetical order.
    pub fn numbers(&self) -> Vec<(String, String)> {
        let mut found = Vec::new();
        leaves("", &self.tree(), &mut found);
        found
    }

    /// Sets a number by its name. Whole numbers suit every number. Fractions do not suit counts.
    ///
    /// # Errors
    /// When no number has this name, or cannot have this value. All numbers then stay as they are.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), TuneError> {
        let mut tree = self.tree();
        let mut place = Some(&mut tree);
        for key in name.split('.') {
            place = place.and_then(|value| match value {
                Value::Array(all) => key.parse().ok().and_then(|k: usize| all.get_mut(k)),
                value => value.get_mut(key),
            });
        }
        let Some(place) = place.filter(|place| place.is_number()) else {
            let known: Vec<String> = self.numbers().iter().map(|(name, value)| format!("{name} = {value}")).collect();
            return Err(TuneError::Unknown { name: name.into(), known: known.join("\n") });
        };
        let unsuitable = |reason| TuneError::Unsuitable { name: name.into(), value: value.into(), reason };
        let number: serde_json::Number = value.parse().map_err(|_| unsuitable("it must be a number"))?;
        *place = Value::Number(number);
        let set: Self = serde_json::from_value(tree).map_err(|_| unsuitable("it must be a count, 0 or more"))?;
        set.validate()?;
        *self = set;
        Ok(())
    }

    /// Whether the surface can be calculated with these numbers.
    ///
    /// # Errors
    /// When one is not finite, is negative, is 0 where it must not be, or when limits are not in order.
    pub fn validate(&self) -> Result<(), TuneError> {
        let numbers = self.numbers();
        let mut least = 0.0;
        for (name, text) in &numbers {
            let unsuitable = |reason| TuneError::Unsuitable { name: name.clone(), value: text.clone(), reason };
            // A value that is not finite is not a number in the text.
            let value: f64 = text.parse().map_err(|_| unsuitable("it must be finite"))?;
            if value < 0.0 {
                return Err(unsuitable("it must be 0 or more"));
            }
            if value == 0.0 && ABOVE_ZERO.iter().any(|start| name.starts_with(start)) {
                return Err(unsuitable("it must be more than 0"));
            }
            if name.trim_end_matches(".1").ends_with(LIMITS) && value < least {
                return Err(unsuitable("it must not be below the first limit"));
            }
            least = value;
        }
        Ok(())
    }

    /// The numbers as a tree. They go through text, because it has the fewest digits for numbers in single precision.
    fn tree(&self) -> Value {
        let text = serde_json::to_string(self).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    }
}

/// Adds the names and values of the numbers in a tree.
fn leaves(name: &str, tree: &Value, found: &mut Vec<(String, String)>) {
    let below = |key: &str| if name.is_empty() { key.to_string() } else { format!("{name}.{key}") };
    match tree {
        Value::Object(all) => all.iter().for_each(|(key, value)| leaves(&below(key), value, found)),
        Value::Array(all) => all.iter().enumerate().for_each(|(k, value)| leaves(&below(&k.to_string()), value, found)),
        value => found.push((name.to_string(), value.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_survive_the_way_through_text() {
        let tuning = Tuning::default();
        let mut same = tuning;
        for (name, value) in tuning.numbers() {
            same.set(&name, &value).unwrap();
        }
        assert_eq!(same, tuning);
        assert_eq!(tuning.validate(), Ok(()));
    }

    #[test]
    fn numbers_are_set_by_name() {
        let mut tuning = Tuning::default();
        tuning.set("spline.crease_weight", "0.6").unwrap();
        tuning.set("spline.steps.1", "7").unwrap();
        tuning.set("spline.grid.nodes_per_spacing", "5").unwrap();
        tuning.set("errors.climb_share_limits.0", "1e-2").unwrap();
        let mut wanted = Tuning::default();
        wanted.spline.crease_weight = 0.6;
        wanted.spline.steps = [40, 7, 200];
        wanted.spline.grid.nodes_per_spacing = 5.0;
        wanted.errors.climb_share_limits = [0.01, 0.8];
        assert_eq!(tuning, wanted);
    }

    #[test]
    fn what_cannot_be_set_leaves_the_numbers_as_they_are() {
        let mut tuning = Tuning::default();
        for name in ["crease_weight", "spline", "spline.steps", "spline.steps.3", "spline.steps.x", ""] {
            let error = tuning.set(name, "1").unwrap_err();
            assert!(matches!(&error, TuneError::Unknown { known, .. } if known.contains("\nspline.steps.2 = 200\n")));
        }
        for (name, value) in [
            ("spline.crease_weight", "much"),
            ("spline.crease_weight", "-0.1"),
            ("spline.crease_weight", "NaN"),
            ("spline.steps.0", "1.5"),
            ("spline.steps.0", "-1"),
            ("spline.grid.nodes_per_spacing", "0"),
            ("errors.width_classes", "0"),
            ("trials.spacing_limits.1", "0.01"),
            ("trials.spacing_limits.0", "11"),
        ] {
            let error = tuning.set(name, value).unwrap_err();
            assert!(matches!(error, TuneError::Unsuitable { .. }), "{error}");
        }
        assert_eq!(tuning, Tuning::default());
        tuning.spline.gain.reach = f64::NAN;
        assert!(tuning.validate().is_err());
    }
}
