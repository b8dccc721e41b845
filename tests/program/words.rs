//! The words of the command line: help, flags of other programs, units, systems, levels.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use tokosen::contour::ContourMap;
use tokosen::io::{ReadOptions, read_contours};

use crate::common::Folder;
use crate::running::{Running, folder_with, said};

fn lines(folder: &Folder, name: &str) -> ContourMap {
    read_contours(&folder.path(name), &ReadOptions::default()).unwrap().value
}

fn levels(map: &ContourMap) -> Vec<f64> {
    let mut levels: Vec<f64> = map.contours.iter().map(|line| line.elevation).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels
}

#[test]
fn short_help_has_the_usual_options() {
    let folder: Folder = Folder::new();
    let [short, long] = ["dem -h", "dem --help"].map(|line| folder.succeeds(line));
    for usual in ["--cell", "--output", "--extent", "--water", "--preview"] {
        assert!(short.contains(usual) && long.contains(usual), "{usual}");
    }
    for rare in ["--tension", "--snap", "--fit", "--threads"] {
        assert!(!short.contains(rare) && long.contains(rare), "{rare}");
    }
    assert!(short.lines().count() * 2 < long.lines().count());
}

#[test]
fn flags_of_other_programs_get_the_right_one() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    for (line, right) in [
        ("dem in.geojson --cell 5 -o a.tif --bbox 0,0,1,1", "--extent"),
        ("dem in.geojson --cell 5 -o a.tif --cutline a.gpkg", "--clip"),
        ("dem in.geojson --res 5 -o a.tif", "--cell"),
        ("densify in.geojson -i 2 -o a.gpkg --t_srs=EPSG:4326", "--to-crs"),
        ("densify in.geojson -i 2 -o a.gpkg --field elev", "--elevation-field"),
        ("derive in.geojson --cell 5 --shade a.tif", "--hillshade"),
        ("densify in.geojson -i 2 -o a.gpkg --force", "--overwrite"),
    ] {
        let message = folder.ends(line, 2);
        assert!(message.contains(&format!("'{right}'")), "{line}: {message}");
    }
    // A verb that lacks the flag does not propose it.
    assert!(!folder.ends("compare in.geojson b.tif --bbox 0,0,1,1", 2).contains("--extent"));
}

#[test]
fn units_have_their_usual_names() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    folder.succeeds("densify in.geojson -i 5 -o ft.geojson --to-unit ft");
    folder.succeeds("densify in.geojson -i 5 -o feet.geojson --to-unit feet");
    assert_eq!(levels(&lines(&folder, "ft.geojson")), levels(&lines(&folder, "feet.geojson")));
}

#[test]
fn systems_can_be_proj_strings() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    let args =
        ["densify", "in.geojson", "-i", "2", "-o", "out.gpkg", "--crs", "+proj=utm +zone=54 +datum=WGS84 +no_defs"];
    let output = crate::running::tokosen().current_dir(folder.0.path()).args(args).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(lines(&folder, "out.gpkg").crs.and_then(|crs| crs.epsg), Some(32654));
}

#[test]
fn a_coarser_interval_gives_its_own_lines() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    let input = lines(&folder, "in.geojson");
    let all = levels(&input);
    let step = all[1] - all[0];
    let text = folder.succeeds(&format!("densify in.geojson -i {} -o coarse.geojson", 2.0 * step));
    assert!(text.contains("--keep-input"), "{text}");
    let coarse = lines(&folder, "coarse.geojson");
    let wanted: Vec<f64> = all.iter().copied().filter(|level| level % (2.0 * step) == 0.0).collect();
    assert!(!wanted.is_empty() && wanted.len() < all.len());
    assert_eq!(levels(&coarse), wanted);
    // They are the lines of the input, vertex for vertex.
    let count = |map: &ContourMap| -> usize {
        map.contours.iter().filter(|line| wanted.contains(&line.elevation)).map(|line| line.points.len()).sum()
    };
    assert_eq!(count(&coarse), count(&input));
    folder.succeeds(&format!("densify in.geojson -i {} -o kept.geojson --keep-input", 2.0 * step));
    assert_eq!(levels(&lines(&folder, "kept.geojson")), all);
    let text = folder.succeeds(&format!("densify in.geojson -i {step} -o same.geojson"));
    assert!(!text.contains("coarser") && levels(&lines(&folder, "same.geojson")) == all, "{text}");
}
