//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file cannot be written; what stood in its place before is untouched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// A folder stands where the file should go.
    #[error("{}: is a folder; name a file in it", path.display())]
    IsFolder {
        /// The file as given.
        path: PathBuf,
    },
    /// The folder the file should go to does not exist.
    #[error("{}: there is no folder {}; create it or name another", path.display(), folder.display())]
    NoFolder {
        /// The file as given.
        path: PathBuf,
        /// The folder that is missing.
        folder: PathBuf,
    },
    /// The file should go into something that is not a folder.
    #[error("{}: {} is not a folder; name a file in a folder", path.display(), folder.display())]
    NotAFolder {
        /// The file as given.
        path: PathBuf,
        /// What is not a folder.
        folder: PathBuf,
    },
    /// The existing file is write-protected.
    #[error("{}: the existing file is write-protected; name another or lift its protection", path.display())]
    Protected {
        /// The file as given.
        path: PathBuf,
    },
    /// The name is impossible or the folder takes no new files.
    #[error("{}: cannot be created ({source}); name a file in a writable folder", path.display())]
    Create {
        /// The file as given.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Writing failed halfway.
    #[error("{}: could not be written ({source}); what was there before is kept", path.display())]
    Write {
        /// The file as given.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// A file that will be written later, at once and completely.
///
/// [`prepare`](Self::prepare) finds out whether it can be written before the work for its contents
/// starts; [`commit`](Self::commit) writes a temporary file beside it and renames that into place.
/// Between the two nothing of it exists, so an interrupted program leaves nothing behind.
///
/// A symbolic link stays, and the file it leads to is replaced. Devices and pipes are written
/// directly, since there is nothing to keep whole.
#[derive(Debug)]
pub struct WholeFile {
    /// As given, for messages.
    path: PathBuf,
    place: Place,
}

#[derive(Debug)]
enum Place {
    /// A file, reached through no link, and the folder it is in.
    Disk { target: PathBuf, folder: PathBuf },
    /// A device or a pipe.
    Stream,
}

impl WholeFile {
    /// Checks that `path` can be written, by really creating (and removing) a file in its folder.
    ///
    /// # Errors
    ///
    /// When there is no such folder, nothing can be created in it, or a folder or a write-protected
    /// file is in the place.
    pub fn prepare(path: impl Into<PathBuf>) -> Result<Self, FileError> {
        let path = path.into();
        let existing = match fs::metadata(&path) {
            Ok(metadata) => Some(metadata),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
                let folder = folder_of(&path);
                return Err(FileError::NotAFolder { path, folder });
            }
            Err(source) => return Err(FileError::Create { path, source }),
        };
        let names_folder = path
            .as_os_str()
            .as_encoded_bytes()
            .last()
            .is_none_or(|&byte| std::path::is_separator(char::from(byte)));
        match existing {
            Some(metadata) if metadata.is_dir() => return Err(FileError::IsFolder { path }),
            None if names_folder => return Err(FileError::IsFolder { path }),
            Some(metadata) if !metadata.is_file() => {
                return Ok(Self { path, place: Place::Stream });
            }
            Some(metadata) if metadata.permissions().readonly() => {
                return Err(FileError::Protected { path });
            }
            _ => {}
        }
        let target = match follow_links(&path) {
            Ok(target) => target,
            Err(source) => return Err(FileError::Create { path, source }),
        };
        let folder = folder_of(&target);
        match fs::metadata(&folder) {
            Ok(metadata) if metadata.is_dir() => {}
            Ok(_) => return Err(FileError::NotAFolder { path, folder }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(FileError::NoFolder { path, folder });
            }
            Err(source) => return Err(FileError::Create { path, source }),
        }
        // Created and dropped, that is removed, at once.
        if let Err(source) = create_beside(&folder) {
            return Err(FileError::Create { path, source });
        }
        Ok(Self { path, place: Place::Disk { target, folder } })
    }

    /// The file as it was given to [`prepare`](Self::prepare).
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether both lead to the same file on disk, through whatever links and relative paths.
    pub fn is_same_file(&self, other: &Self) -> bool {
        match (&self.place, &other.place) {
            (
                Place::Disk { target: a, folder: folder_a },
                Place::Disk { target: b, folder: folder_b },
            ) => {
                a.file_name() == b.file_name()
                    && matches!((folder_a.canonicalize(), folder_b.canonicalize()), (Ok(a), Ok(b)) if a == b)
            }
            _ => false,
        }
    }

    /// Writes the contents with `write` and puts the file into place once they are safely on disk.
    ///
    /// A new file gets the permissions new files get (the umask); an existing one keeps its own.
    ///
    /// # Errors
    ///
    /// [`FileError::Write`]; the old file, or none, is then still there, and no temporary one.
    pub fn commit(
        self,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), FileError> {
        let done = match &self.place {
            Place::Disk { target, folder } => replace(target, folder, write),
            Place::Stream => {
                File::options().write(true).open(&self.path).and_then(|file| fill(&file, write))
            }
        };
        done.map_err(|source| FileError::Write { path: self.path, source })
    }
}

fn replace(
    target: &Path,
    folder: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let file = create_beside(folder)?;
    fill(file.as_file(), write)?;
    if let Ok(existing) = fs::metadata(target) {
        file.as_file().set_permissions(existing.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(target)?;
    Ok(())
}

fn fill(file: &File, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut buffer = BufWriter::new(file);
    write(&mut buffer)?;
    buffer.flush()
}

/// A temporary file in `folder`, gone when dropped. Its name is short whatever the target's, so
/// that a name that just fits does not fail here.
fn create_beside(folder: &Path) -> io::Result<NamedTempFile> {
    tempfile::Builder::new()
        .prefix(".whitted-")
        .suffix(".part")
        // Opened here, because tempfile would shut out everyone else, whatever the umask.
        .make_in(folder, |path| File::create_new(path))
}

/// The folder a file lies in, `.` for a bare name.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// Where a chain of links leads; its end need not exist.
fn follow_links(path: &Path) -> io::Result<PathBuf> {
    const MOST_LINKS: usize = 40; // as Linux does
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&place) {
            Ok(next) => place = folder_of(&place).join(next),
            Err(_) => return Ok(place), // not a link, or nothing there
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

#[cfg(test)]
mod tests {
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

    fn write_text(text: &'static str) -> impl FnOnce(&mut dyn Write) -> io::Result<()> {
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

        #[cfg(target_os = "linux")]
        #[test]
        fn a_full_device_is_an_error() {
            let full = WholeFile::prepare("/dev/full").expect("it opens");
            let error = full.commit(write_text("text")).expect_err("full");
            let FileError::Write { source, .. } = error else { panic!("{error}") };
            assert_eq!(source.kind(), io::ErrorKind::StorageFull);
        }
    }
}
