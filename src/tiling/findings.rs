//! Findings in the files of a plan.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use tokosen_core::base::FeatureId;
use tokosen_core::base::error::{Finding, FindingKind};

/// A finding as it is stored. Proposals are left out: nothing corrects the lines any more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    code: String,
    place: Option<DVec2>,
    message: String,
    features: Vec<(u32, u64)>,
    elevations: Vec<f64>,
}

impl From<&Finding> for Stored {
    fn from(finding: &Finding) -> Self {
        Self {
            code: finding.kind.code().to_owned(),
            place: finding.place,
            message: finding.message.clone(),
            features: finding.features.iter().map(|f| (f.file().unwrap_or(0), f.number())).collect(),
            elevations: finding.elevations.clone(),
        }
    }
}

impl Stored {
    /// The finding; `None` if this version of the program has no such kind.
    pub fn finding(self) -> Option<Finding> {
        let kind = FindingKind::ALL.iter().copied().find(|kind| kind.code() == self.code)?;
        let features = self.features.into_iter().map(|(file, number)| FeatureId::from(number).in_file(file)).collect();
        let mut finding = Finding::new(kind, self.place, self.message).of_elevations(self.elevations);
        finding.features = features;
        Some(finding)
    }
}

/// Findings in their order, those about the whole map once.
pub fn once(findings: impl IntoIterator<Item = Finding>) -> Vec<Finding> {
    let mut all: Vec<Finding> = Vec::new();
    let mut general = std::collections::HashSet::new();
    for finding in findings {
        if finding.place.is_some() || general.insert((finding.kind, finding.message.clone())) {
            all.push(finding);
        }
    }
    all
}
