//! Places that cannot be written: one line, code 1, nothing written.

use std::fs;
use std::path::Path;

use super::{assert_refused, render};
use crate::program::{folder, names_in, run};

#[test]
fn unwritable_places_are_refused_for_picture_and_statistics() {
    let folder = folder();
    fs::write(folder.path().join("plain"), "kept").expect("written");
    fs::create_dir(folder.path().join("dir.png")).expect("created");
    let before = names_in(folder.path());
    let long = format!("{}.png", "n".repeat(300));
    for (place, part) in [
        ("missing/a.png", "there is no folder missing"),
        ("plain/a.png", "plain is not a folder"),
        ("dir.png", "is a folder"),
        ("dir.png/", "is a folder"),
        ("new.png/", "is a folder"),
        (&long, "cannot be created"),
    ] {
        assert_refused(&render(folder.path(), &["-o", place]), 1, &[place, part]);
        let stats = render(folder.path(), &["--stats", place]);
        assert_refused(&stats, 1, &["--stats", place, part]);
    }
    assert_eq!(names_in(folder.path()), before);
    assert_eq!(fs::read(folder.path().join("plain")).expect("readable"), b"kept");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_refused() {
    let folder = folder(); // even root creates nothing in /proc
    let output = render(folder.path(), &["-o", "/proc/whitted.png"]);
    assert_refused(&output, 1, &["/proc/whitted.png", "cannot be created", "writable folder"]);
}

#[test]
fn a_write_protected_picture_stays() {
    let folder = folder();
    let path = folder.path().join("picture.png");
    fs::write(&path, "kept").expect("written");
    let mut permissions = fs::metadata(&path).expect("there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).expect("changed");
    let output = render(folder.path(), &["-o", "picture.png"]);
    assert_refused(&output, 1, &["picture.png", "write-protected"]);
    assert_eq!(fs::read(&path).expect("readable"), b"kept");
}

/// The statistics are refused before the render, so the picture they belong to is not touched.
#[test]
fn a_refused_render_keeps_the_picture_of_the_last_one() {
    let folder = folder();
    let path = folder.path().join("assignment.png");
    fs::write(&path, "kept").expect("written");
    for arguments in [["--stats", "no/s.json"], ["--aa", "grid:0"], ["--size", "0x1"]] {
        let output = run(folder.path(), &[&["render"][..], &arguments].concat());
        assert_ne!(output.status.code(), Some(0));
        assert_eq!(fs::read(&path).expect("readable"), b"kept");
    }
    assert_eq!(names_in(folder.path()), ["assignment.png"]);
}

/// Oracle: the bytes of every file before. The default name is one that the model's picture may well have.
#[test]
fn what_a_picture_is_made_from_is_not_replaced() {
    let folder = folder();
    let write =
        |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    let texture = Path::new(env!("CARGO_MANIFEST_DIR")).join("textures/flower.png");
    fs::copy(texture, folder.path().join("crate.png")).expect("copied");
    write("crate.mtl", "newmtl m\nmap_Kd crate.png\n");
    write(
        "crate.obj",
        "mtllib crate.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n",
    );
    write(
        "a.toml",
        "resolution = [9, 9]\ndepth = 1\nbackground = [0, 0, 0]\n\
         camera = { eye = [0, 0, 5], look_at = [0, 0, 0], up = [0, 1, 0], vertical_fov = 40 }\n\
         [[model]]\nfile = \"crate.obj\"\n",
    );
    let parts =
        run(folder.path(), &["render", "--size", "9x9", "--tile", "1/2,2/2", "-o", "p.png"]);
    assert_eq!(parts.status.code(), Some(0));
    let all = ["crate.obj", "crate.mtl", "crate.png", "a.toml", "p-1of2.png", "p-2of2.png"];
    let bytes = || all.map(|name| fs::read(folder.path().join(name)).expect("there"));
    let before = bytes();
    for (arguments, part) in [
        (&["render", "crate.obj"][..], "--output crate.png: would replace crate.png"),
        (&["render", "crate.obj", "--stats", "crate.obj", "-o", "x.png"], "--stats crate.obj"),
        (&["render", "--obj", "crate.obj", "-o", "crate.png"], "--output crate.png"),
        (&["render", "a.toml", "--stats", "a.toml"], "--stats a.toml"),
        (&["render", "a.toml", "--stats", "crate.mtl"], "--stats crate.mtl"),
        (&["render", "-o", "p-1of2.png", "--reference", "p-1of2.png"], "the reference"),
        (&["merge", "p-1of2.png", "p-2of2.png", "-o", "p-2of2.png"], "one of the parts"),
    ] {
        assert_refused(&run(folder.path(), arguments), 2, &[part, "name another file"]);
    }
    assert_eq!(bytes(), before);
}
