//! Is the estimate of the error true? For each scene and mode: the error against 1024 rays per pixel, and the estimate as a multiple of it.
//!
//! `cargo run --release --example honesty [-- SCENE...]`; without scenes the built-in ones and all models and scenes that come with
//! the program. Pictures of 128 × 80 pixels.
#![allow(clippy::print_stdout, reason = "its output is a table")]

use std::{error::Error, path::Path};

use whitted::{
    aa::AntiAliasing,
    render::{Goal, RenderOptions, Rendering, render},
    scene::{LoadOptions, Scene, load},
    study::reference::Reference,
};

const MODES: [(&str, Option<f64>); 13] = [
    ("none", None),
    ("grid:2", None),
    ("grid:3", None),
    ("grid:4", None),
    ("grid:6", None),
    ("adaptive:16", None),
    ("adaptive:8", None),
    ("adaptive:4", None),
    ("adaptive:2", None),
    ("adaptive:1", None),
    ("adaptive", Some(4.0)),
    ("adaptive", Some(2.0)),
    ("adaptive", Some(1.0)),
];

/// Errors below this are not told from that of the reference.
const LEAST: f64 = 0.02;

fn main() -> Result<(), Box<dyn Error>> {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let scenes = if named.is_empty() { all_scenes()? } else { named };
    let (mut all, mut close, mut low) = (0, 0, Vec::new());
    for name in scenes {
        let scene = scene(&name)?;
        let truth = picture(&scene, AntiAliasing::Sequence { count: 1024 }, Goal::Mode)?;
        let truth = Reference::of_film(&truth.film);
        print!("{:24}", Path::new(&name).file_name().unwrap_or_default().to_string_lossy());
        for (mode, goal) in MODES {
            let goal_of_picture = goal.map_or(Goal::Mode, Goal::Error);
            let found = picture(&scene, mode.parse()?, goal_of_picture)?;
            let (error, _) = truth.error_of(&found.film);
            let ratio = found.estimated_rmse.ok_or("no estimate")? / error;
            print!(" {error:6.2} x{ratio:.2}");
            if error >= LEAST {
                all += 1;
                close += usize::from((1.0 / 1.5..=1.5).contains(&ratio));
                if ratio < 0.5 {
                    low.push(format!(
                        "{name} {mode} {}",
                        goal.map_or(String::new(), |e| e.to_string())
                    ));
                }
            }
        }
        println!();
    }
    println!("within 1.5: {close} of {all}; below half: {low:?}");
    Ok(())
}

fn all_scenes() -> Result<Vec<String>, Box<dyn Error>> {
    let mut scenes = vec!["assignment".to_owned()];
    scenes.extend([1, 3, 10, 30, 100, 300, 1000, 10_000].map(|count| format!("spheres:{count}")));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in ["models", "tests/formats/models", "tests/formats/spd"] {
        for entry in std::fs::read_dir(root.join(folder))? {
            let path = entry?.path();
            let inner = path.file_name().map(|name| path.join(name).with_extension("obj"));
            for path in inner.into_iter().chain([path]) {
                if path.extension().is_some_and(|kind| kind == "obj" || kind == "nff")
                    && path.is_file()
                {
                    scenes.push(path.to_string_lossy().into_owned());
                }
            }
        }
    }
    scenes.sort();
    Ok(scenes)
}

fn scene(name: &str) -> Result<Scene, Box<dyn Error>> {
    let mut options = LoadOptions::default();
    let mut name = name;
    if let Some(("spheres", count)) = name.split_once(':') {
        (name, options.objects) = ("spheres", Some(count.parse()?));
    }
    Ok(load(name, &options)?.scene)
}

fn picture(scene: &Scene, aa: AntiAliasing, goal: Goal) -> Result<Rendering, Box<dyn Error>> {
    let options = RenderOptions { size: Some([128, 80]), aa, goal, ..Default::default() };
    Ok(render(scene, &options, &|_| ())?)
}
