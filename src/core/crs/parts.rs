//! Parts of systems by their own EPSG codes, such as ellipsoids, datums and units, taken from the texts of the built-in table.

use super::system::definition;
use super::wkt;

/// The text of a part that has this keyword and this EPSG code: `SPHEROID` and 7019 give `SPHEROID["GRS 1980",…]`. `None` if
/// no entry of the table has it.
pub fn part_of_table(keyword: &str, code: u32) -> Option<&'static str> {
    let wanted = format!("AUTHORITY[\"EPSG\",\"{code}\"]");
    (1024..=u32::from(u16::MAX)).filter_map(definition).filter(|entry| entry.wkt.contains(&wanted)).find_map(|entry| {
        let root = wkt::parse(entry.wkt)?;
        let part = root.all().into_iter().find(|node| {
            node.keyword == keyword && node.authority().is_some_and(|(name, number)| name == "EPSG" && number == code)
        })?;
        Some(&entry.wkt[part.span.clone()])
    })
}

/// The first number of such a part: metres or radians of a unit, degrees of a meridian.
pub fn number_of_part(text: &str) -> Option<f64> {
    wkt::parse(text)?.numbers().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_codes_of_their_own() {
        let starts = |keyword, code, start: &str| part_of_table(keyword, code).is_some_and(|t| t.starts_with(start));
        assert!(starts("SPHEROID", 7019, "SPHEROID[\"GRS 1980\",6378137,298.257222101"));
        assert!(starts("DATUM", 6326, "DATUM[\"WGS_1984\",SPHEROID["));
        assert!(starts("UNIT", 9003, "UNIT[\"US survey foot\",0.304800609601219"));
        assert!(starts("PRIMEM", 8903, "PRIMEM[\"Paris\",2.33722917"));
        assert_eq!(part_of_table("UNIT", 7019), None);
        assert_eq!(part_of_table("UNIT", 9107), None);
        assert_eq!(part_of_table("SPHEROID", 7022).and_then(number_of_part), Some(6_378_388.0));
    }
}
