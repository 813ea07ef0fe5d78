//! The pictures of the README's gallery are those of the commands under them.

use std::path::Path;

use image::RgbImage;
use whitted::film::{Difference, metrics::read_png_rgb8};

use super::program::{done, folder, run};

/// The cells of a line of a table.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.trim().trim_matches('|').split(" | ").map(str::trim)
}

/// The pictures of the gallery, and the command under each.
fn gallery(readme: &str) -> Vec<(&str, &str)> {
    let (_, gallery) = readme.split_once("\n## Gallery\n").expect("the gallery");
    let (gallery, _) = gallery.split_once("\n## ").expect("what comes after it");
    let is_row = |line: &&str| line.starts_with('|') && !line.starts_with("| ---");
    let rows: Vec<&str> = gallery.lines().filter(is_row).collect();
    let pairs = rows.chunks(2).flat_map(|rows| cells(rows[0]).zip(cells(rows[1])));
    let picture_and_command = |(picture, command): (_, _)| {
        let picture: &str = picture;
        let (_, picture) = picture.split_once("](").expect(picture);
        let command: &str = command;
        let command = command.strip_prefix("`whitted ").and_then(|rest| rest.strip_suffix('`'));
        (picture.strip_suffix(')').expect(picture), command.expect("a command"))
    };
    pairs.map(picture_and_command).collect()
}

/// Oracle: the pictures as they are shown; other machines may round a few samples differently.
#[test]
fn pictures_are_those_of_their_commands() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = std::fs::read_to_string(root.join("README.md")).expect("README.md");
    let gallery = gallery(&readme);
    assert!(gallery.len() >= 12, "{gallery:?}");
    let folder = folder();
    let made = folder.path().join("made.png");
    for (picture, command) in gallery {
        let target = ["-o", made.to_str().expect("UTF-8"), "--quiet"];
        let words: Vec<&str> = command.split(' ').chain(target).collect();
        done(&run(root, &words));
        let [made, shown]: [RgbImage; 2] =
            [made.clone(), root.join(picture)].map(|path| read_png_rgb8(path).expect("a picture"));
        let difference = Difference::between(&made, &shown).expect("equal sizes");
        assert!(difference.rmse <= 0.2 && difference.mean <= 0.05, "{picture}: {difference:?}");
    }
}
