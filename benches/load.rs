//! How fast models load: a chessboard from file to first ray, and a generated file of 100 MB, against `tobj` alone.
//!
//! `cargo bench --bench load` runs everything, each in a process of its own, so that the peaks of memory are its own.

#![allow(clippy::print_stdout, reason = "a bench tells what it measured")]

use std::{
    env, fs,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

use glam::DVec3;
use whitted::{
    geometry::Ray,
    scene::{LoadOptions, load, obj::load_model},
};

const SIDE: u32 = 1120;

fn main() {
    let kind = env::var("WHITTED_LOAD").unwrap_or_default();
    let big = env::temp_dir().join("whitted-load.obj");
    let chess = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/formats/models/chessboard/chessboard.obj");
    match kind.as_str() {
        "" => {
            write_grid(&big);
            for kind in ["chess", "chess-tobj", "grid", "grid-tobj"] {
                let program = env::current_exe().expect("this program");
                let done = Command::new(program).env("WHITTED_LOAD", kind).status();
                assert!(done.expect("runs").success(), "{kind}");
            }
            fs::remove_file(&big).expect("removed");
        }
        "chess" => best(&kind, &chess, 9, first_ray),
        "chess-tobj" => best(&kind, &chess, 9, tobj_alone),
        "grid" => {
            best(&kind, &big, 3, |path| load_model(path).expect("a model").mesh.triangles().len());
        }
        _ => best(&kind, &big, 3, tobj_alone),
    }
}

/// From the file to the answer of the first ray.
fn first_ray(path: &Path) -> usize {
    let name = path.display().to_string();
    let scene = load(&name, &LoadOptions::default()).expect("a scene").scene;
    let down = Ray::new(DVec3::new(0.0, 100.0, 0.0), DVec3::NEG_Y);
    assert!(scene.nearest(&down).is_some());
    scene.primitive_count()
}

fn tobj_alone(path: &Path) -> usize {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let (models, _) = tobj::load_obj(path, &options).expect("a clean file");
    models.iter().map(|m| m.mesh.indices.len() / 3).sum()
}

fn best(kind: &str, path: &Path, runs: u32, work: impl Fn(&Path) -> usize) {
    let bytes = fs::metadata(path).expect("the file").len() as f64;
    let (mut shortest, mut triangles) = (f64::INFINITY, 0);
    for _ in 0..runs {
        let started = Instant::now();
        triangles = work(path);
        shortest = shortest.min(started.elapsed().as_secs_f64());
    }
    let peak = fs::read_to_string("/proc/self/status").ok().and_then(|status| {
        let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
        line.split_whitespace().nth(1)?.parse::<f64>().ok()
    });
    let peak = peak.map_or(f64::NAN, |kib| kib * 1024.0 / bytes);
    println!(
        "{kind:>11}: {shortest:.3} s, {:.0} MB/s, {triangles} triangles, peak memory {peak:.1} times the file",
        bytes / 1e6 / shortest
    );
}

/// A height field of about 100 MB, with texture coordinates.
fn write_grid(path: &PathBuf) {
    let mut out = BufWriter::new(fs::File::create(path).expect("a file"));
    for z in 0..SIDE {
        for x in 0..SIDE {
            let (x, z) = (f64::from(x), f64::from(z));
            let y = (x * 0.02).sin() * (z * 0.03).cos();
            writeln!(out, "v {:.6} {y:.6} {:.6}", x / 100.0, z / 100.0).expect("written");
        }
    }
    for z in 0..SIDE - 1 {
        for x in 0..SIDE - 1 {
            let a = z * SIDE + x + 1;
            let (b, c, d) = (a + 1, a + SIDE, a + SIDE + 1);
            writeln!(out, "f {a} {c} {b}\nf {b} {c} {d}").expect("written");
        }
    }
}
