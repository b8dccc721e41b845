//! Names a feature of the input: its number in its file and, if there are several files, which of them.

use std::fmt;

use serde::{Serialize, Serializer};

/// A feature of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct FeatureId {
    /// The number of the file, from 1; 0 if the input is one file or none.
    file: u32,
    /// The number that GIS programs show as the feature's id.
    number: u64,
}

impl FeatureId {
    /// The same feature in a file of several. Files are numbered from 1, in the order in which they were given.
    pub fn in_file(self, file: u32) -> Self {
        Self { file, ..self }
    }

    /// The number of the file, from 1; `None` if the input is one file or none.
    pub fn file(self) -> Option<u32> {
        (self.file > 0).then_some(self.file)
    }

    /// The number in the file.
    pub fn number(self) -> u64 {
        self.number
    }
}

impl From<u64> for FeatureId {
    fn from(number: u64) -> Self {
        Self { file: 0, number }
    }
}

/// Equal if the feature has this number and the input is one file.
impl PartialEq<u64> for FeatureId {
    fn eq(&self, number: &u64) -> bool {
        *self == Self::from(*number)
    }
}

impl fmt::Display for FeatureId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.file {
            0 => write!(f, "{}", self.number),
            file => write!(f, "{} of file {file}", self.number),
        }
    }
}

/// A number where there is one file, otherwise the words of messages.
impl Serialize for FeatureId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.file {
            0 => serializer.serialize_u64(self.number),
            _ => serializer.collect_str(self),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_named_where_there_are_several() {
        let alone = FeatureId::from(12);
        let third = alone.in_file(3);
        assert_eq!((alone.to_string(), third.to_string()), ("12".into(), "12 of file 3".into()));
        assert_eq!((alone.file(), third.file(), third.number()), (None, Some(3), 12));
        assert_eq!(serde_json::json!([alone, third]), serde_json::json!([12, "12 of file 3"]));
    }
}
