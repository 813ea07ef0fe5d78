//! What is on disk before, after and in the midst.

use super::*;

/// What a folder holds, to see that nothing else was left there.
fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn write_text(text: &'static str) -> impl FnOnce(&mut dyn WriteSeek) -> io::Result<()> {
    move |writer| writer.write_all(text.as_bytes())
}

#[test]
fn a_new_file_appears_at_commit_and_not_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("new");
    let file = WholeFile::prepare(&path).expect("writable");
    assert_eq!(names_in(folder.path()), [""; 0]);
    file.commit(write_text("whole")).expect("written");
    assert_eq!(names_in(folder.path()), ["new"]);
    assert_eq!(fs::read_to_string(path).expect("readable"), "whole");
}

#[test]
fn a_failed_write_keeps_the_old_file_and_leaves_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("kept");
    fs::write(&path, "old").expect("written");
    let error = WholeFile::prepare(&path)
        .expect("writable")
        .commit(|writer| {
            writer.write_all(&vec![0; 100_000])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .expect_err("writing fails");
    assert!(matches!(error, FileError::Write { .. }), "{error}");
    assert_eq!(names_in(folder.path()), ["kept"]);
    assert_eq!(fs::read_to_string(path).expect("readable"), "old");
}

#[test]
fn a_folder_that_is_deleted_meanwhile_is_made_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let inner = folder.path().join("a/b");
    fs::create_dir_all(&inner).expect("created");
    let file = WholeFile::prepare(inner.join("file")).expect("writable");
    fs::remove_dir_all(folder.path().join("a")).expect("deleted");
    file.commit(write_text("whole")).expect("written");
    assert_eq!(names_in(&inner), ["file"]);
}

/// Locks stand in for the life of other programs; `tests/survive` kills real ones.
#[test]
fn only_what_no_living_program_writes_is_swept() {
    let folder = tempfile::tempdir().expect("a folder");
    let [dead, live, other] =
        [".whitted-a.part", ".whitted-b.part", ".whitted-c.png"].map(|n| folder.path().join(n));
    for path in [&dead, &other] {
        fs::write(path, "half").expect("written");
    }
    let writer = File::create(&live).expect("created");
    writer.lock().expect("locked");
    WholeFile::prepare(folder.path().join("new")).expect("writable");
    assert_eq!(names_in(folder.path()), [".whitted-b.part", ".whitted-c.png"]);
    drop(writer);
    WholeFile::prepare(folder.path().join("new")).expect("writable");
    assert_eq!(names_in(folder.path()), [".whitted-c.png"]);
}

#[test]
fn places_that_take_no_file_are_refused_with_their_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let plain = folder.path().join("plain");
    fs::write(&plain, "").expect("written");
    let refuse = |path: PathBuf| WholeFile::prepare(path).expect_err("refused");
    assert!(matches!(refuse(folder.path().to_owned()), FileError::IsFolder { .. }));
    assert!(matches!(refuse(folder.path().join("new/")), FileError::IsFolder { .. }));
    assert!(matches!(refuse(folder.path().join("no/file")), FileError::NoFolder { .. }));
    assert!(matches!(refuse(plain.join("file")), FileError::NotAFolder { .. }));
    assert!(matches!(refuse(folder.path().join("n".repeat(300))), FileError::Create { .. }));
    let mut permissions = fs::metadata(&plain).expect("there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&plain, permissions).expect("changed");
    assert!(matches!(refuse(plain), FileError::Protected { .. }));
    assert_eq!(names_in(folder.path()), ["plain"]);
}

#[test]
fn a_name_as_long_as_names_can_be_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = "n".repeat(255);
    let file = WholeFile::prepare(folder.path().join(&name)).expect("writable");
    file.commit(write_text("")).expect("written");
    assert_eq!(names_in(folder.path()), [name]);
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::fs::Permissions;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).expect("there").permissions().mode() & 0o7777
    }

    /// Oracle: the file `File::create` makes beside it, under whatever umask the test runs.
    #[test]
    fn a_new_file_gets_the_usual_permissions_and_an_old_one_keeps_its_own() {
        let folder = tempfile::tempdir().expect("a folder");
        let [usual, ours] = ["usual", "ours"].map(|name| folder.path().join(name));
        File::create(&usual).expect("created");
        WholeFile::prepare(&ours).expect("writable").commit(write_text("1")).expect("written");
        assert_eq!(mode(&ours), mode(&usual));
        for odd in [0o640, 0o666, 0o755] {
            fs::set_permissions(&ours, Permissions::from_mode(odd)).expect("changed");
            let file = WholeFile::prepare(&ours).expect("writable");
            file.commit(write_text("2")).expect("written");
            assert_eq!(mode(&ours), odd);
        }
    }

    #[test]
    fn a_link_stays_and_the_file_it_leads_to_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let [real, near, far] = ["real", "near", "far"].map(|name| folder.path().join(name));
        symlink("real", &near).expect("linked");
        symlink(&near, &far).expect("linked");
        for text in ["dangling", "existing"] {
            let file = WholeFile::prepare(&far).expect("writable");
            assert!(file.is_same_file(&WholeFile::prepare(&real).expect("writable")));
            file.commit(write_text(text)).expect("written");
            assert_eq!(fs::read_to_string(&real).expect("readable"), text);
            assert_eq!(names_in(folder.path()), ["far", "near", "real"]);
            assert!(fs::symlink_metadata(&far).expect("there").is_symlink());
        }
    }

    #[test]
    fn links_in_a_circle_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
        symlink(&one, &two).expect("linked");
        symlink(&two, &one).expect("linked");
        let error = WholeFile::prepare(&one).expect_err("a circle");
        assert!(matches!(error, FileError::Create { .. }), "{error}");
    }

    #[test]
    fn devices_are_written_directly() {
        let null = WholeFile::prepare("/dev/null").expect("writable");
        null.commit(write_text("gone")).expect("written");
        assert!(!fs::metadata("/dev/null").expect("there").is_file());
    }

    /// A swallowed error is not lost.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error_even_if_the_encoder_hides_it() {
        let full = WholeFile::prepare("/dev/full").expect("it opens");
        let error = full.commit(|writer| {
            let _ = writer.write_all(&vec![0; 100_000]);
            Ok(())
        });
        assert!(matches!(error, Err(FileError::Write { .. })), "{error:?}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error() {
        let full = WholeFile::prepare("/dev/full").expect("it opens");
        let error = full.commit(write_text("text")).expect_err("full");
        let FileError::Write { source, .. } = error else { panic!("{error}") };
        assert_eq!(source.kind(), io::ErrorKind::StorageFull);
    }
}
