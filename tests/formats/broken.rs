//! Broken and odd files, each with what is said about it.
//!
//! `tests/broken/*/expected.txt` holds a block for every file: what it holds and the warnings, or the error. With
//! `WHITTED_BLESS` set the blocks are written anew, to be read before they are committed.

use std::fmt::Write;

use whitted::film::{ImageError, metrics::read_png_rgb8};
use whitted::scene::{LoadOptions, Warning, load, obj::inspect_model};
use whitted::texture::Image;

use super::file;

fn check(kind: &str, least: usize, describe: impl Fn(&str) -> String) {
    let folder = file("tests/broken").join(kind);
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
        .filter(|name| name.ends_with(&format!(".{kind}")))
        .collect();
    names.sort();
    assert!(names.len() >= least, "{} files of {kind}", names.len());
    let base = format!("{}/", file("tests/broken").display());
    let mut found = String::new();
    for name in names {
        let text = describe(&folder.join(&name).display().to_string()).replace(&base, "");
        writeln!(found, "== {name}\n{}\n", text.trim_end()).expect("in memory");
    }
    let path = folder.join("expected.txt");
    if std::env::var_os("WHITTED_BLESS").is_some() {
        std::fs::write(&path, &found).expect("written");
    }
    let expected = std::fs::read_to_string(&path).expect("expected.txt");
    for (found, expected) in found.split("== ").zip(expected.split("== ")) {
        assert_eq!(found, expected);
    }
    assert_eq!(found, expected);
}

fn with_warnings(mut text: String, warnings: &[Warning]) -> String {
    for warning in warnings {
        write!(text, "\nwarning: {warning}").expect("in memory");
    }
    text
}

/// Loads a scene and traces a ray through each corner of a small picture.
fn rendered(path: &str) -> String {
    match load(path, &LoadOptions::default()) {
        Ok(loaded) => {
            let options = whitted::render::RenderOptions {
                size: Some([6, 6]),
                aa: whitted::aa::AntiAliasing::None,
                ..Default::default()
            };
            let picture = whitted::render::render(&loaded.scene, &options, &|_| {});
            let film = picture.expect("threads").film;
            assert!(film.pixels().iter().all(|p| p.is_finite()), "{path}: a pixel is no number");
            let (count, lights) = (loaded.scene.primitive_count(), loaded.scene.light_count());
            with_warnings(format!("{count} primitives, {lights} lights"), &loaded.warnings)
        }
        Err(error) => format!("error: {error}"),
    }
}

#[test]
fn models() {
    check("obj", 60, |path| match inspect_model(path.as_ref()) {
        Ok(report) => {
            let text = format!(
                "{} positions, {} faces, {} triangles, {} kept, area {:.4e}, closed {}",
                report.positions,
                report.faces,
                report.triangles,
                report.kept_triangles,
                report.area,
                report.closed
            );
            rendered(path);
            with_warnings(text, &report.warnings)
        }
        Err(error) => format!("error: {error}"),
    });
}

#[test]
fn neutral_files() {
    check("nff", 30, rendered);
}

#[test]
fn scene_files() {
    check("toml", 40, rendered);
}

/// Oracle: png 0.18.1 panics at a palette of 49 bytes, zune-jpeg 0.5.15 at a first component that is sampled less densely than the
/// second.
#[test]
fn pictures_at_which_decoders_panic_are_errors() {
    for name in ["palette_49.png", "sampling.jpg"] {
        let path = file("tests/broken/image").join(name);
        let bytes = std::fs::read(&path).expect(name);
        let error = Image::decode(name, &bytes).expect_err(name).to_string();
        assert!(error.contains(name), "{error}");
        let as_picture = read_png_rgb8(&path);
        let is_refused =
            matches!(as_picture, Err(ImageError::Decode { .. } | ImageError::NotPng { .. }));
        assert!(is_refused, "{name}: {as_picture:?}");
    }
}
