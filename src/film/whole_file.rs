//! Files that appear whole or not at all.

mod part;

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

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
    #[error("{}: could not be written ({source}); a file that was there before is kept", path.display())]
    Write {
        /// The file as given.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// What a file is written to. Devices and pipes do not seek.
pub trait WriteSeek: Write + Seek {}

impl<W: Write + Seek> WriteSeek for W {}

/// A file that will be written later, at once and completely.
///
/// [`prepare`](Self::prepare) finds out whether it can be written before the work for its contents
/// starts; [`commit`](Self::commit) writes a temporary file beside it and renames that into place.
/// Between the two nothing of it exists, so an interrupted program leaves nothing behind. What one that was killed
/// while it wrote left is deleted by the next `prepare` in the folder.
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
        part::sweep(&folder);
        // Created and dropped, that is removed, at once.
        if let Err(source) = part::create(&folder) {
            return Err(FileError::Create { path, source });
        }
        Ok(Self { path, place: Place::Disk { target, folder } })
    }

    /// The file as it was given to [`prepare`](Self::prepare).
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is a file on disk, not a device or a pipe.
    pub fn is_on_disk(&self) -> bool {
        matches!(self.place, Place::Disk { .. })
    }

    /// Whether it would take the place of a file that is there, reached through whatever links and relative paths.
    pub fn replaces(&self, file: &Path) -> bool {
        match &self.place {
            Place::Disk { target, .. } => {
                matches!((target.canonicalize(), file.canonicalize()), (Ok(a), Ok(b)) if a == b)
            }
            Place::Stream => false,
        }
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
        &self,
        write: impl FnOnce(&mut dyn WriteSeek) -> io::Result<()>,
    ) -> Result<(), FileError> {
        let done = match &self.place {
            Place::Disk { target, folder } => replace(target, folder, write),
            Place::Stream => {
                File::options().write(true).open(&self.path).and_then(|file| fill(&file, write))
            }
        };
        done.map_err(|source| FileError::Write { path: self.path.clone(), source })
    }
}

fn replace(
    target: &Path,
    folder: &Path,
    write: impl FnOnce(&mut dyn WriteSeek) -> io::Result<()>,
) -> io::Result<()> {
    let file = match part::create(folder) {
        // Deleted since it was looked at: what was worked for is not to be lost for that.
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            fs::create_dir_all(folder)?;
            part::create(folder)?
        }
        created => created?,
    };
    fill(file.as_file(), write)?;
    if let Ok(existing) = fs::metadata(target) {
        file.as_file().set_permissions(existing.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(target)?;
    Ok(())
}

fn fill(file: &File, write: impl FnOnce(&mut dyn WriteSeek) -> io::Result<()>) -> io::Result<()> {
    let mut buffer = BufWriter::new(Watched { file, failed: None });
    write(&mut buffer)?;
    buffer.flush()?;
    // An encoder may have swallowed it.
    buffer.get_ref().failed.map_or(Ok(()), |kind| Err(kind.into()))
}

/// A file that remembers that a write failed.
struct Watched<'a> {
    file: &'a File,
    failed: Option<io::ErrorKind>,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(kind) = self.failed {
            return Err(kind.into());
        }
        let written = self.file.write(bytes);
        if let Err(error) = &written
            && error.kind() != io::ErrorKind::Interrupted
        {
            self.failed = Some(error.kind());
        }
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
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
mod tests;
