use tokosen_core::base::Grid;
use tokosen_core::base::error::FindingKind;

use super::*;

fn page_of(title: &str, findings: &[Finding]) -> String {
    let grid = Grid { corner: DVec2::new(100.0, 200.0), cell: DVec2::splat(10.0), cols: 2, rows: 2 };
    let heights = Dem { grid, values: vec![1.0, 2.0, 3.0, 4.0], crs: None };
    let mesh = Mesh {
        origin: DVec3::new(100.0, 200.0, 0.0),
        vertices: vec![DVec3::ZERO, DVec3::new(20.0, -20.0, 4.0), DVec3::new(20.0, 0.0, 2.0)],
        normals: Vec::new(),
        triangles: vec![[0, 1, 2]],
        break_lines: Vec::new(),
        base: None,
        crs: None,
        unit: None,
    };
    terrain_page(&TerrainPage { title, tolerance: 0.5, findings, ..TerrainPage::of_heights(&heights, &mesh) })
}

fn data_of(page: &str) -> Value {
    let begin = "<script type=\"application/json\" id=\"data\">";
    let data = page.split(begin).nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
    serde_json::from_str(data).unwrap()
}

#[test]
fn names_and_messages_cannot_end_their_place() {
    let evil = "</script><script>alert(1)</script><!--";
    let plain = page_of("", &[]);
    let page = page_of(evil, &[Finding::at(FindingKind::Gap, DVec2::new(110.0, 190.0), evil)]);
    for end in ["</script", "<script", "<!--"] {
        assert_eq!(page.matches(end).count(), plain.matches(end).count(), "{end}");
    }
    // What the page reads is what was meant.
    let data = data_of(&page);
    assert_eq!((&data["title"], &data["findings"][0]["message"]), (&evil.into(), &evil.into()));
    assert_eq!(data["findings"][0]["place"], json!([10.0, -10.0]));
}

#[test]
fn findings_that_are_left_out_are_counted() {
    let mut findings = vec![Finding::new(FindingKind::UnknownCrs, None, "note"); MOST_FINDINGS + 2];
    findings.push(Finding::new(FindingKind::Gap, None, "error"));
    let data = data_of(&page_of("", &findings));
    assert_eq!((&data["findings"][0]["message"], &data["leftOut"]), (&"error".into(), &3.into()));
}

#[test]
fn parts_of_the_page_stay_whole() {
    for part in SCRIPTS.iter().chain([&LIBRARY, &STYLE, &LICENCES]) {
        for end in ["</script", "</style", "<!--", "sourceMappingURL", "innerHTML ="] {
            assert!(!part.contains(end) || (*part == LIBRARY && end == "innerHTML ="), "{end}");
        }
    }
}

#[test]
fn both_languages_say_the_same_things() {
    let words = SCRIPTS[0];
    let keys = |name: &str| -> Vec<String> {
        let object = words.split(&format!("const {name} = {{\n")).nth(1).and_then(|rest| rest.split("\n};").next());
        let lines = object.unwrap().lines().filter(|line| line.starts_with("  ") && !line.starts_with("    "));
        lines.filter_map(|line| Some(line.trim().split_once(':')?.0.to_owned())).collect()
    };
    assert!(keys("ENGLISH").len() > 40);
    assert_eq!(keys("ENGLISH"), keys("JAPANESE"));
}
