//! Progress for other programs, as lines of JSON.

use serde_json::Value;

use crate::running::{folder_with_part, run, said};

#[test]
fn progress_as_json_grows_to_one_and_names_the_steps() {
    let folder = folder_with_part("c.gpkg");
    let output = run(folder.0.path(), "dem c.gpkg --cell 60 -o d.tif -q --progress json");
    assert!(output.status.success() && output.stdout.is_empty(), "{}", said(&output));
    let lines: Vec<Value> = said(&output).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let shares: Vec<f64> = lines.iter().map(|line| line["progress"].as_f64().expect("a number")).collect();
    assert!(shares.is_sorted() && shares.first() == Some(&0.0) && shares.last() == Some(&1.0), "{shares:?}");
    for step in ["reading", "triangulating", "smooth surface", "writing"] {
        assert!(lines.iter().any(|line| line["step"] == step), "{step}: {lines:?}");
    }
    // A run that fails is not told as done.
    let failed = said(&run(folder.0.path(), "dem missing.gpkg --cell 60 -o d.tif --progress json"));
    assert!(failed.contains("error: ") && !failed.contains("1.0"), "{failed}");
}
