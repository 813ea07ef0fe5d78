//! Goals, parts and references.

use serde_json::Value;

use super::{assert_picture, assert_refused};
use crate::program::{done, folder, json, read, run, said};

#[test]
fn a_part_is_cut_from_the_same_picture() {
    let folder = folder();
    let size = ["render", "--size", "40x30", "--quiet"];
    done(&run(folder.path(), &[&size[..], &["-o", "whole.png"]].concat()));
    done(&run(folder.path(), &[&size[..], &["-o", "part.png", "--crop", "7,9,33,30"]].concat()));
    let read = |name| image::open(folder.path().join(name)).expect("a PNG").into_rgb8();
    let cut = image::imageops::crop_imm(&read("whole.png"), 7, 9, 26, 21).to_image();
    assert_eq!(read("part.png"), cut);
}

#[test]
fn an_error_is_aimed_at_measured_and_missed_with_a_warning() {
    let folder = folder();
    let small = ["render", "--size", "40x30"];
    done(&run(folder.path(), &[&small[..], &["--aa", "sobol:64", "-o", "truth.png"]].concat()));
    let goal = ["--max-error", "5", "--reference", "truth.png", "--stats", "-"];
    let output = run(folder.path(), &[&small[..], &goal].concat());
    done(&output);
    assert!(!said(&output).contains("warning"), "{}", said(&output));
    let stats: Value = json(&output.stdout);
    let error = |key: &str| stats["error"][key].as_f64().expect("a number");
    assert!(error("estimated_rmse") <= 5.0 && error("squared_per_ray") > 0.0, "{stats}");
    assert!(error("measured_rmse") < 10.0 && error("measured_rmse") > 2.0, "{stats}");
    let output =
        run(folder.path(), &[&small[..], &["--max-error", "0.5", "--aa", "adaptive:0,8"]].concat());
    done(&output);
    assert!(said(&output).starts_with("warning: --max-error 0.5 is not reached"));
    let output = run(folder.path(), &["render", "--size", "41x30", "--reference", "truth.png"]);
    assert_refused(&output, 2, &["--reference", "41x30", "40x30"]);
    assert_refused(&run(folder.path(), &["render", "--reference", "no.png"]), 1, &["no.png"]);
}

/// Whatever the machine, there is a picture, and it is said if there was no time for more than a ray in each pixel.
#[test]
fn a_time_limit_ends_in_a_picture() {
    let folder = folder();
    let output = run(folder.path(), &["render", "--size", "64x48", "--time-limit", "0.000001"]);
    done(&output);
    assert!(said(&output).contains("warning: --time-limit 0.000001 is too short"));
    assert_picture(&read(folder.path(), "assignment.png"), 64, 48);
    let output = run(folder.path(), &["render", "--size", "64x48", "--time-limit", "0.3"]);
    done(&output);
    assert!(said(&output).contains("adaptive until the time was up"));
}
