//! Comparing and studying.

use std::fs;

use serde_json::Value;

use super::{assert_picture, assert_refused};
use crate::program::{done, folder, json, names_in, read, run, said, text, whitted};

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

/// A dash is standard input or output, what is compared is not replaced, and what is no PNG is not written as one.
#[test]
fn pictures_come_and_go_through_pipes_and_replace_nothing() {
    let folder = folder();
    for (name, aa) in [("a.png", "none"), ("b.png", "grid:2"), ("c.exr", "none"), ("c.ppm", "none")]
    {
        done(&run(folder.path(), &["render", "--size", "20x15", "--aa", aa, "-o", name]));
    }
    let piped = |name: &str, arguments: &[&str]| {
        let file = fs::File::open(folder.path().join(name)).expect("there");
        whitted(folder.path(), arguments).stdin(file).output().expect("the program runs")
    };
    let plain = run(folder.path(), &["compare", "a.png", "b.png"]);
    done(&plain);
    assert_eq!(piped("b.png", &["compare", "a.png", "-"]).stdout, plain.stdout);
    assert_eq!(piped("a.png", &["compare", "-", "b.png"]).stdout, plain.stdout);
    let output = piped("a.png", &["compare", "-", "b.png", "--heatmap", "-"]);
    done(&output);
    assert_picture(&output.stdout, 20, 15);
    assert_eq!(said(&output), text(&plain.stdout));
    let output = piped("a.png", &["render", "--size", "20x15", "--aa", "none", "--reference", "-"]);
    done(&output);
    assert!(said(&output).contains(", 0.00 measured"), "{}", said(&output));

    let kept = names_in(folder.path());
    let before = read(folder.path(), "a.png");
    let both = ["a.png", "b.png"];
    for (pictures, more, code, parts) in [
        (["-", "-"], &[][..], 2, &["standard input", "one"][..]),
        (both, &["--heatmap", "-", "--json"], 2, &["--heatmap -", "--json"]),
        (both, &["--heatmap", "a.png"], 2, &["--heatmap a.png", "compared"]),
        (both, &["--heatmap", "./b.png"], 2, &["--heatmap ./b.png", "replace b.png"]),
        (both, &["--heatmap", "map.jpg"], 2, &["map.jpg", ".png"]),
        (["a.png", "c.exr"], &[], 1, &["c.exr", "not a PNG file", "no other pictures"]),
        (["c.ppm", "a.png"], &[], 1, &["c.ppm", "not a PNG file", "no other pictures"]),
    ] {
        let arguments = [&["compare"], &pictures[..], more].concat();
        assert_refused(&run(folder.path(), &arguments), code, parts);
    }
    assert_refused(&piped("c.ppm", &["compare", "a.png", "-"]), 1, &["standard input", "PNG"]);
    assert!(names_in(folder.path()) == kept && read(folder.path(), "a.png") == before);
}

#[test]
fn a_study_that_cannot_be_written_is_refused_at_once() {
    let folder = folder();
    fs::write(folder.path().join("plain"), "kept").expect("written");
    assert_refused(&run(folder.path(), &["study", "--quick", "-o", "plain"]), 1, &["plain"]);
    assert_refused(&run(folder.path(), &["study", "nowhere"]), 2, &["nowhere", "assignment"]);
    for name in ["spheres:1e3", "spheres:99999999999", "spheres:0", "spheres:"] {
        let advice = "a whole number from 1 to 50000000 after `spheres:`";
        assert_refused(&run(folder.path(), &["study", name]), 2, &[name, advice]);
    }
    assert_eq!(names_in(folder.path()), ["plain"]);
    for name in
        ["study.csv", "index.html", "depth.svg", "assignment-rays.png", "error-assignment.png"]
    {
        let place = folder.path().join(name);
        fs::create_dir(&place).expect("made");
        let output = run(folder.path(), &["study", "--quick", "-o", ".", "assignment"]);
        assert_refused(&output, 1, &[name, "is a folder"]);
        fs::remove_dir(&place).expect("removed");
    }
    assert_eq!(names_in(folder.path()), ["plain", "references"]);
    assert_eq!(names_in(&folder.path().join("references")), [""; 0]);
}
