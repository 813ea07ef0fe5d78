//! Statistics.

use std::fs;

use serde_json::Value;

use super::{SMALL, assert_picture, assert_refused, render};
use crate::program::{done, folder, json, names_in, read, run, said, whitted};

/// The dotted names of all values that are not objects.
fn keys(value: &Value, prefix: &str, into: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| keys(value, &format!("{prefix}.{key}"), into));
        }
        _ => into.push(prefix.trim_start_matches('.').to_owned()),
    }
}

#[test]
fn an_error_that_nothing_tells_of_is_null() {
    let folder = folder();
    let rays = [("none", "1x1", false), ("none", "2x1", true), ("grid:2", "1x1", true)];
    for (aa, size, is_known) in rays {
        let output = run(folder.path(), &["render", "--aa", aa, "--size", size, "--stats", "-"]);
        done(&output);
        let estimate = &json(&output.stdout)["error"]["estimated_rmse"];
        assert!(
            estimate.is_number() == is_known && (is_known || estimate.is_null()),
            "{aa} {size}"
        );
        assert_eq!(said(&output).contains("off by about"), is_known, "{}", said(&output));
    }
}

#[test]
fn statistics_hold_every_key_and_what_was_asked_for() {
    let folder = folder();
    let output = render(folder.path(), &["--depth", "3", "--threads", "1", "--stats", "s.json"]);
    done(&output);
    assert_eq!(names_in(folder.path()), ["assignment.png", "s.json"]);
    let stats = fs::read_to_string(folder.path().join("s.json")).expect("readable");
    let stats: Value = serde_json::from_str(&stats).expect("JSON");
    let mut found = Vec::new();
    keys(&stats, "", &mut found);
    found.sort();
    let expected = "aa bvh.bytes bvh.nodes depth error.estimated_rmse error.goal_reached error.measured_rmse error.squared_per_ray height \
        lights peak_memory_bytes primitives rays.camera rays.camera_hit rays.reflected \
        rays.refracted rays.shadow rays.transmitted samples_per_pixel.max samples_per_pixel.mean \
        samples_per_pixel.min scene seconds.build seconds.load seconds.render seconds.total \
        seconds.write threads version width";
    assert_eq!(found.join(" "), expected);

    assert_eq!(stats["scene"], "assignment");
    assert_eq!(stats["aa"], "grid:2");
    assert_eq!(stats["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!((&stats["width"], &stats["height"]), (&8.into(), &6.into()));
    assert_eq!((&stats["depth"], &stats["threads"]), (&3.into(), &1.into()));
    assert_eq!(stats["rays"]["camera"], 4 * 8 * 6);
    assert_eq!(stats["samples_per_pixel"], serde_json::json!({ "min": 4, "mean": 4.0, "max": 4 }));
    assert!(stats["error"]["estimated_rmse"].as_f64().expect("a number") > 0.0);
    assert_eq!(stats["error"]["measured_rmse"], Value::Null);
    assert_eq!(stats["error"]["goal_reached"], Value::Null);
    for step in ["load", "build", "render", "write", "total"] {
        assert!(stats["seconds"][step].as_f64().expect("a number") >= 0.0, "{step}");
    }
    for count in ["reflected", "refracted", "transmitted", "shadow", "camera_hit"] {
        assert!(stats["rays"][count].is_u64(), "{count}");
    }
    if cfg!(target_os = "linux") {
        assert!(stats["peak_memory_bytes"].as_u64().expect("known") > 0);
    }
}

#[test]
fn statistics_go_to_standard_output_on_request() {
    let folder = folder();
    let output = render(folder.path(), &["--stats", "-", "--aa", "none"]);
    // The flag was given twice: SMALL has one.
    assert_refused(&output, 2, &["--aa"]);
    let output = run(folder.path(), &["render", "--size", "4x4", "--aa", "none", "--stats", "-"]);
    done(&output);
    let stats: Value = json(&output.stdout);
    assert_eq!(stats["rays"]["camera"], 16);
    assert_eq!(names_in(folder.path()), ["assignment.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_after_the_picture_is_safe() {
    let folder = folder();
    let output = render(folder.path(), &["--stats", "/dev/full"]);
    assert_refused(&output, 1, &["--stats", "/dev/full", "could not be written"]);
    assert_picture(&read(folder.path(), "assignment.png"), 8, 6);
    let full = fs::File::options().write(true).open("/dev/full").expect("it opens");
    let output = whitted(folder.path(), &[&SMALL[..], &["-o", "-"]].concat()).stdout(full).output();
    assert_refused(&output.expect("the program runs"), 1, &["standard output"]);
}
