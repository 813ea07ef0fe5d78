//! Tiles, crops, and what joins them.

use std::fs::File;
use std::io::Cursor;
use std::path::Path;

use whitted::film::{Film, Label, Tile, write_png};

use super::{done, folder, names_in, read, refused, run};

const SIZE: [&str; 4] = ["render", "--quiet", "--size", "97x71"];

/// Oracle: the undivided render. Every mode, whatever the tiles share at their borders; both formats, and 8 bits of floats.
#[test]
fn joined_tiles_are_the_undivided_picture_byte_for_byte() {
    for aa in ["none", "grid:3", "sobol:5", "adaptive:2", "adaptive:1,2", "adaptive:0,4096"] {
        let folder = folder();
        let at = folder.path();
        let small = if aa.ends_with("4096") { "23x17" } else { "97x71" };
        let mode = ["render", "--quiet", "--size", small, "--aa", aa];
        for name in ["whole.png", "whole.exr", "whole.ppm"] {
            done(&run(at, &[&mode[..], &["-o", name]].concat()));
        }
        for kind in ["png", "exr"] {
            let name = format!("part.{kind}");
            for tiles in ["5/6,1/6,2/6", "6/6,3/6,4/6"] {
                done(&run(at, &[&mode[..], &["-o", &name, "--tile", tiles]].concat()));
            }
        }
        let parts = |kind: &str| (1..=6).map(|k| format!("part-{k}of6.{kind}")).collect::<Vec<_>>();
        for (kind, output) in
            [("png", "a.png"), ("exr", "a.exr"), ("exr", "b.png"), ("png", "a.ppm")]
        {
            let parts = parts(kind);
            let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
            done(&run(at, &[&["merge", "-o", output][..], &parts].concat()));
            let whole = format!("whole.{}", &output[2..]);
            assert!(read(at, output) == read(at, &whole), "{aa}: {output} of {kind}");
        }
    }
}

#[test]
fn crops_that_cover_the_picture_are_joined_as_well() {
    let folder = folder();
    let at = folder.path();
    done(&run(at, &[&SIZE[..], &["-o", "whole.exr"]].concat()));
    let crops = ["0,0,97,10", "0,10,40,71", "40,10,97,33", "40,33,97,71"];
    for (k, crop) in crops.iter().enumerate() {
        let name = format!("{k}.exr");
        done(&run(at, &[&SIZE[..], &["-o", &name, "--crop", crop]].concat()));
    }
    done(&run(at, &["merge", "3.exr", "0.exr", "2.exr", "1.exr", "-o", "joined.exr", "-q"]));
    assert!(read(at, "joined.exr") == read(at, "whole.exr"));
    let output = run(at, &["merge", "0.exr", "1.exr", "3.exr", "-o", "no.exr"]);
    refused(&output, 5, &["(40, 10) to (97, 33)", "--crop 40,10,97,33"]);
    done(&run(at, &["merge", "whole.exr", "-o", "again.exr"]));
    assert!(read(at, "again.exr") == read(at, "whole.exr"));
}

#[test]
fn tiles_have_names_of_their_own_unless_told() {
    let folder = folder();
    let at = folder.path();
    done(&run(at, &[&SIZE[..], &["--aa", "none", "--tile", "2/3"]].concat()));
    done(&run(at, &[&SIZE[..], &["--aa", "none", "--tile", "3/3", "-o", "mine.exr"]].concat()));
    let stats = ["--tile", "1/3,2/3", "-o", "some.exr", "--stats", "s.json"];
    done(&run(at, &[&SIZE[..], &["--aa", "none"], &stats].concat()));
    let expected = [
        "assignment-2of3.png",
        "mine.exr",
        "s-1of3.json",
        "s-2of3.json",
        "some-1of3.exr",
        "some-2of3.exr",
    ];
    assert_eq!(names_in(at), expected);
    let tile = image::open(at.join("assignment-2of3.png")).expect("a PNG");
    assert!(tile.width() * tile.height() < 97 * 71 / 2, "only its own pixels");
}

/// A part of the other program `software`, as it would be written.
fn part_of(at: &Path, name: &str, software: &str, missing: u64) {
    let label = Label {
        software: software.to_owned(),
        scene: "00".repeat(32),
        size: [8, 4],
        options: "aa=none depth=6".to_owned(),
        part: Some(Tile { x0: 0, y0: 0, x1: 8, y1: 2 }),
        share: None,
        missing,
        warning: None,
    };
    let mut file = Cursor::new(Vec::new());
    write_png(&Film::new(8, 2), Some(&label), &mut file).expect("memory");
    std::fs::write(at.join(name), file.into_inner()).expect("written");
}

#[test]
fn parts_that_do_not_belong_together_are_refused_with_the_reason() {
    let folder = folder();
    let at = folder.path();
    let small = ["render", "--quiet", "--size", "16x12", "--aa", "none"];
    let tile = |tile: &str, more: &[&str]| {
        done(&run(at, &[&small[..], &["--tile", tile], more].concat()));
    };
    tile("1/4,2/4,4/4", &[]);
    tile("3/4", &["-o", "depth.png", "--depth", "2"]);
    tile("3/4", &["-o", "scene.png", "--fov", "30"]);
    tile("2/2", &["-o", "half.png"]);
    tile("1/2", &["-o", "half.exr"]);
    done(&run(
        at,
        &["render", "-q", "--size", "20x12", "--aa", "none", "--tile", "3/4", "-o", "size.png"],
    ));
    done(&run(
        at,
        &["render", "-q", "--size", "16x12", "--aa", "grid:2", "--tile", "3/4", "-o", "aa.png"],
    ));
    image::RgbImage::new(8, 6).save(at.join("foreign.png")).expect("written");
    part_of(at, "old.png", "whitted 0.0.1", 0);
    part_of(at, "new.png", &Label::this_software(), 0);
    part_of(at, "open.png", &Label::this_software(), 5);
    std::fs::write(at.join("broken.png"), &read(at, "assignment-1of4.png")[..300])
        .expect("written");
    std::fs::write(at.join("text.png"), "no picture").expect("written");
    let [one, two, four] = [1, 2, 4].map(|k| format!("assignment-{k}of4.png"));
    let cases: &[(&[&str], i32, &[&str])] = &[
        (&[&one, &two, &four], 5, &["tile 3/4 is missing", "--tile 3/4"]),
        (&[&one], 5, &["tiles 2/4, 3/4, 4/4 are missing", "--tile 2/4,3/4,4/4"]),
        (&[&one, &two, "depth.png", &four], 5, &["depth.png", "depth: 6 here, 2 there"]),
        (&[&one, &two, "scene.png", &four], 5, &["scene.png", "scene: "]),
        (&[&one, &two, "size.png", &four], 5, &["size.png", "size: 16x12 here, 20x12 there"]),
        (&[&one, &two, "aa.png", &four], 5, &["aa.png", "aa: none here, grid:2 there"]),
        (&[&one, &two, &two, &four], 5, &["overlap", &two]),
        (&[&one, &two, &four, "half.png"], 5, &["overlap", "half.png"]),
        (&["foreign.png", &two], 5, &["foreign.png", "does not say"]),
        (&["old.png", "new.png"], 5, &["new.png", "version: whitted 0.0.1 here"]),
        (&["open.png", "new.png"], 5, &["open.png", "5 of its pixels", "--resume"]),
        (&["broken.png"], 5, &["missing"]),
        (&["text.png"], 1, &["text.png", "cannot be read"]),
        (&["nowhere.png"], 1, &["nowhere.png"]),
        (&[], 2, &["PART"]),
    ];
    let before = names_in(at);
    for (parts, code, words) in cases {
        refused(&run(at, &[&["merge", "-o", "out.png"], *parts].concat()), *code, words);
        assert_eq!(names_in(at), before, "{parts:?}");
    }
    refused(&run(at, &["merge", "-o", "o.exr", &one]), 2, &["8-bit part", &one]);
    refused(&run(at, &["merge", "-o", "o.tif", &one]), 2, &["o.tif", ".png, .exr, .ppm"]);
}

/// A part that is cut off in the midst of its pixels is found when it comes to them; nothing is written.
#[test]
fn a_part_that_ends_early_leaves_the_old_picture() {
    let folder = folder();
    let at = folder.path();
    for kind in ["png", "exr"] {
        let name = format!("p.{kind}");
        done(&run(at, &[&SIZE[..], &["--tile", "1/2,2/2", "-o", &name]].concat()));
        let second = format!("p-2of2.{kind}");
        let length = read(at, &second).len() as u64;
        let file = File::options().write(true).open(at.join(&second)).expect("there");
        file.set_len(length * 2 / 3).expect("cut");
        std::fs::write(at.join(&name), "old").expect("written");
        let output = run(at, &["merge", &format!("p-1of2.{kind}"), &second, "-o", &name]);
        refused(&output, 1, &[&second, "cannot be read"]);
        assert_eq!(read(at, &name), b"old");
    }
}

#[test]
fn tiles_are_refused_where_pixels_depend_on_each_other_or_on_nothing() {
    let folder = folder();
    let at = folder.path();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--tile", "0/4"], &["--tile", "such as 3/64"]),
        (&["--tile", "5/4"], &["--tile", "such as 3/64"]),
        (&["--tile", "1/4,1/4"], &["--tile", "twice"]),
        (&["--tile", "1/64", "--size", "6x5"], &["--tile", "6x5", "64"]),
        (&["--tile", "1/4", "--max-error", "2"], &["--tile", "--max-error"]),
        (&["--tile", "1/4", "--time-limit", "2"], &["--tile", "--time-limit"]),
        (&["--tile", "1/4", "--crop", "0,0,5,5"], &["--tile", "--crop"]),
        (&["--tile", "1/4", "--rules", "classic"], &["--rules classic", "--tile"]),
        (&["--tile", "1/4,2/4", "-o", "-"], &["several tiles"]),
        (&["--tile", "1/4,2/4", "--stats", "-"], &["several tiles"]),
        (&["--tile", "1/4", "-o", "a.ppm"], &["a.ppm", "which tile"]),
        (&["--resume", "-o", "-"], &["--resume"]),
        (&["--checkpoint", "0"], &["--checkpoint", "above 0"]),
        (&["--size", "32768x32768"], &["22.0 GiB", "--tile"]),
    ];
    for (arguments, words) in cases {
        refused(&run(at, &[&["render", "--quiet"], *arguments].concat()), 2, words);
    }
    assert_eq!(names_in(at), [""; 0]);
}
