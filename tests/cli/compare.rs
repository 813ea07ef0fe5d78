//! Comparing and studying.

use std::fs;

use serde_json::Value;

use super::{assert_picture, assert_refused};
use crate::program::{done, folder, json, names_in, read, run, said, text};

#[test]
fn compare_measures_maps_and_judges() {
    let folder = folder();
    for (name, aa) in [("a.png", "none"), ("b.png", "grid:4")] {
        let small = ["render", "--size", "40x30", "--aa", aa, "-o", name];
        done(&run(folder.path(), &small));
    }
    let output = run(folder.path(), &["compare", "a.png", "a.png", "--fail-above", "0"]);
    done(&output);
    assert!(text(&output.stdout).contains("RMSE         0.0000"), "{}", text(&output.stdout));
    let output =
        run(folder.path(), &["compare", "a.png", "b.png", "--json", "--heatmap", "map.png"]);
    done(&output);
    let found: Value = json(&output.stdout);
    assert!(
        found["rmse"].as_f64().expect("a number") > 1.0 && found["ssim"].as_f64() < Some(0.999)
    );
    assert_picture(&read(folder.path(), "map.png"), 40, 30);
    let output = run(folder.path(), &["compare", "a.png", "b.png", "--fail-above", "1"]);
    assert_eq!(output.status.code(), Some(6));
    assert!(said(&output).contains("more than --fail-above 1"), "{}", said(&output));
    done(&run(folder.path(), &["render", "--size", "40x31", "-o", "c.png"]));
    assert_refused(&run(folder.path(), &["compare", "a.png", "c.png"]), 1, &["40x30", "40x31"]);
    assert_refused(&run(folder.path(), &["compare", "a.png", "no.png"]), 1, &["no.png"]);
    assert_refused(
        &run(folder.path(), &["compare", "a.png", "b.png", "--fail-above", "-1"]),
        2,
        &["--fail-above"],
    );
}

#[test]
fn a_study_that_cannot_be_written_is_refused_at_once() {
    let folder = folder();
    fs::write(folder.path().join("plain"), "kept").expect("written");
    assert_refused(&run(folder.path(), &["study", "--quick", "-o", "plain"]), 1, &["plain"]);
    assert_refused(&run(folder.path(), &["study", "nowhere"]), 2, &["nowhere", "assignment"]);
    assert_eq!(names_in(folder.path()), ["plain"]);
}
