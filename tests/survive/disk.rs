//! Full disks and deleted folders at any moment.

use std::fs;
use std::process::{Child, Command};

use super::stop::{PICTURE, end, reference, signal, until, wait_until_it_sleeps};
use super::{done, folder, names_in, read, refused, run, said};

/// A limit on the size of files stands in for a disk without room: writing fails halfway in the same way.
#[test]
fn a_full_disk_costs_neither_the_checkpoint_nor_the_old_picture() {
    let folder = folder();
    let at = folder.path();
    let expected = reference(at, &PICTURE, "exr");
    fs::write(at.join("a.exr"), "old").expect("written");
    let program = env!("CARGO_BIN_EXE_whitted");
    // In units of 512 or 1024 bytes: room for part of the checkpoint, which takes 16 bytes a pixel, but not for the picture.
    let line = format!(
        "trap '' XFSZ; ulimit -f 600; exec {program} {} -o a.exr --checkpoint 0.02 --resume",
        PICTURE.join(" ")
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(at).output().expect("a shell");
    refused(
        &output,
        1,
        &["a.exr: could not be written", "is kept in a.exr.checkpoint", "--resume"],
    );
    assert_eq!(read(at, "a.exr"), b"old");
    let output = run(at, &[&PICTURE[..], &["-o", "a.exr", "--resume"]].concat());
    done(&output);
    assert!(said(&output).contains("going on from a.exr.checkpoint"), "{}", said(&output));
    assert!(read(at, "a.exr") == expected);
}

#[test]
fn a_disk_without_any_room_keeps_nothing_and_does_not_say_so() {
    let folder = folder();
    let program = env!("CARGO_BIN_EXE_whitted");
    let line = format!(
        "trap '' XFSZ; ulimit -f 1; exec {program} {} -o a.png --checkpoint 0.02",
        PICTURE.join(" ")
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output();
    let output = output.expect("a shell");
    refused(&output, 1, &["a.png: could not be written"]);
    assert!(!said(&output).contains("--resume"), "{}", said(&output));
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn a_folder_deleted_on_the_way_is_made_again() {
    let folder = folder();
    let at = folder.path();
    let expected = reference(at, &PICTURE, "png");
    for stopped in [false, true] {
        fs::create_dir(at.join("sub")).expect("created");
        let child = until(at, 0.3, &["-o", "sub/a.png", "--checkpoint", "0.02"]);
        while_asleep(&child, || fs::remove_dir_all(at.join("sub")).expect("deleted"));
        if stopped {
            signal(&child, "-INT");
        }
        let output = end(child);
        if stopped {
            refused(&output, 130, &["sub/a.png.checkpoint"]);
            done(&run(at, &[&PICTURE[..], &["-o", "sub/a.png", "--resume"]].concat()));
        } else {
            done(&output);
        }
        assert!(read(at, "sub/a.png") == expected, "stopped: {stopped}");
        assert_eq!(names_in(&at.join("sub")), ["a.png"]);
        fs::remove_dir_all(at.join("sub")).expect("deleted");
    }
}

/// A file where the folder was: nothing can be written there any more.
#[test]
fn a_place_that_cannot_be_written_any_more_is_an_error_that_says_so() {
    let folder = folder();
    let at = folder.path();
    fs::create_dir(at.join("sub")).expect("created");
    let child = until(at, 0.3, &["-o", "sub/a.png"]);
    while_asleep(&child, || {
        fs::remove_dir_all(at.join("sub")).expect("deleted");
        fs::write(at.join("sub"), "in the way").expect("written");
    });
    let output = end(child);
    refused(&output, 1, &["sub/a.png", "could not be written"]);
    assert_eq!(read(at, "sub"), b"in the way");
}

/// Changes files while the render that writes there stands still, so that it makes none between two steps of the change.
fn while_asleep(child: &Child, change: impl FnOnce()) {
    signal(child, "-STOP");
    wait_until_it_sleeps(child);
    change();
    signal(child, "-CONT");
}
