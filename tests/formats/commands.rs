//! The program itself, on files.

use std::path::Path;
use std::process::Output;

use super::file;
use super::program::{done, folder, json, read, run, said, text};

fn whitted(arguments: &[&str]) -> Output {
    run(Path::new("."), arguments)
}

/// Oracle: the built-in scene itself.
#[test]
fn the_printed_assignment_renders_alike() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let text = whitted(&["scenes", "--show", "assignment"]).stdout;
    std::fs::write(path("copy.toml"), text).expect("written");
    let flags = ["--size", "90x90", "--quiet", "-o"];
    let picture = |scene: &str, name: &str| {
        let output = whitted(&[&["render", scene], &flags[..], &[&path(name)]].concat());
        done(&output);
        read(folder.path(), name)
    };
    assert!(picture("assignment", "a.png") == picture(&path("copy.toml"), "b.png"));
}

#[test]
fn a_model_renders_by_itself_and_in_a_scene() {
    let folder = folder();
    let out = folder.path().join("out.png").display().to_string();
    let model = file("models/bread/bread.obj").display().to_string();
    for args in [
        vec!["render", &model, "--size", "20x20", "-o", &out, "--strict"],
        vec!["render", &model, "--size", "20x20", "-o", &out, "--up", "z", "--fov", "20"],
        vec!["render", "--obj", &model, "--size", "20x20", "-o", &out],
        vec!["render", "--obj", &format!("{model}@1,-15,-80*5"), "--size", "20x20", "-o", &out],
    ] {
        done(&whitted(&args));
    }
}

#[test]
fn codes_tell_what_was_wrong() {
    let folder = folder();
    let out = folder.path().join("out.png").display().to_string();
    let broken = |name: &str| file("tests/broken").join(name).display().to_string();
    for (scene, strict, code) in [
        ("obj/duplicate_face.obj", false, 0),
        ("obj/duplicate_face.obj", true, 4),
        ("obj/index_zero.obj", false, 3),
        ("toml/unknown_key.toml", false, 3),
        ("nff/cut_sphere.nff", false, 3),
        ("nff/zero_radius.nff", true, 4),
        ("nothing.scene", false, 2),
    ] {
        let path = broken(scene);
        let mut args = vec!["render", &path, "--size", "8x8", "--aa", "none", "-o", &out];
        args.extend(strict.then_some("--strict"));
        assert_eq!(whitted(&args).status.code(), Some(code), "{scene}");
    }
    let output = whitted(&["render", &broken("toml/unknown_nested_key.toml"), "-o", &out]);
    let said = said(&output);
    assert!(said.contains(":14:38: unknown key `raduis`; did you mean `radius`?\n"), "{said}");
    assert!(said.contains(&format!("\n     | {:37}^^^^^^", "")), "{said}");
}

/// They estimate no error, so they claim none.
#[test]
fn the_classic_rules_tell_their_rays_and_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = file("tests/formats/spd/tetra.nff").display().to_string();
    let out = folder.path().join("out.png").display().to_string();
    let output = whitted(&["render", &scene, "--rules", "classic", "-o", &out, "--stats", "-"]);
    assert!(output.status.success(), "{}", said(&output));
    let text = said(&output);
    assert!(
        text.contains("512x512 pixels, classic, depth 5, ") && !text.contains("off by"),
        "{text}"
    );
    let stats: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(stats["error"]["estimated_rmse"].is_null() && stats["aa"] == "classic", "{stats}");
    assert_eq!(stats["samples_per_pixel"]["mean"], 4.0);
}

#[test]
fn the_classic_rules_leave_no_choice() {
    let scene = file("tests/formats/spd/tetra.nff").display().to_string();
    let output = whitted(&["render", &scene, "--rules", "classic", "--size", "8x8"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn inspection_is_json() {
    let model = file("models/chicken/chicken.obj").display().to_string();
    let output = whitted(&["inspect", &model, "--json"]);
    done(&output);
    let json = json(&output.stdout);
    assert_eq!((json["triangles"].as_u64(), json["closed"].as_bool()), (Some(2724), Some(false)));
    assert_eq!(json["textures"][0]["found"], true);
    assert_eq!(json["bounds"][1].as_array().map(Vec::len), Some(3));
}

/// Oracle: the table of the standard scenes, and the text of the assignment.
#[test]
fn scenes_are_inspected() {
    let inspect = |scene: &str| {
        let output = whitted(&["inspect", scene, "--json"]);
        done(&output);
        json(&output.stdout)
    };
    let rings = inspect(&file("tests/formats/spd/rings.nff").display().to_string());
    let entities = &rings["entities"];
    let counts = ["cylinders", "spheres", "polygons", "surfaces", "lights"];
    assert_eq!(counts.map(|key| entities[key].as_u64()), [900, 900, 1, 181, 3].map(Some));
    assert_eq!((&rings["primitives"], &rings["lights"]), (&1801.into(), &3.into()));
    let scene = std::fs::read_to_string(file("tests/formats/spd/rings.nff")).expect("a scene");
    let from = scene.lines().find_map(|line| line.strip_prefix("from ")).expect("a view");
    let from: Vec<f64> = from.split_whitespace().map(|x| x.parse().expect("a number")).collect();
    assert_eq!(rings["camera"]["eye"], serde_json::json!(from));
    let assignment = inspect("assignment");
    let output = whitted(&["scenes", "--show", "assignment"]);
    let shown = text(&output.stdout);
    assert_eq!(assignment["shapes"]["spheres"], shown.matches("shape.sphere =").count());
    assert_eq!(
        assignment["material_names"].as_array().map(Vec::len),
        Some(shown.matches("[material.").count())
    );
    assert_eq!(assignment["textures"][0]["found"], true);
    let output = whitted(&["inspect", "assignment"]);
    let text = text(&output.stdout);
    assert!(text.contains("primitives   17\n"), "{text}");
}
