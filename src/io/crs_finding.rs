//! The finding about a coordinate reference system that is missing or that nobody describes.

use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::crs::Crs;

/// The finding about the system that a file names; none if it is known. `missing` says why there is none.
pub(super) fn crs_finding(crs: Option<&Crs>, missing: impl FnOnce() -> String) -> Option<Finding> {
    let message = match crs {
        None => missing(),
        Some(Crs { epsg: Some(code), .. }) if crs.and_then(Crs::wkt).is_none() => format!(
            "the file names EPSG:{code}, which is not in the built-in table of coordinate reference systems; coordinates \
             count as metres on a plane"
        ),
        Some(_) => return None,
    };
    Some(Finding::general(FindingKind::UnknownCrs, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_that_nobody_describes_is_told() {
        let told = |crs: Option<&Crs>| crs_finding(crs, || "no name".to_owned()).map(|finding| finding.message);
        assert_eq!(told(Some(&Crs::from_epsg(6677))), None);
        assert_eq!(told(Some(&Crs::from_wkt("LOCAL_CS[\"site\"]"))), None);
        assert_eq!(told(None).as_deref(), Some("no name"));
        assert!(told(Some(&Crs::from_epsg(999_999))).is_some_and(|message| message.contains("EPSG:999999")));
    }
}
