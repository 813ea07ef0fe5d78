//! Renders that survive: finished blocks on disk, from which an interrupted render goes on.
//!
//! A checkpoint is a file that only grows: a head that says of which picture it is, then a record for each finished
//! [block](crate::render::Block). Each has a checksum, so whatever ends the program in the midst of writing costs at
//! most the last record. The head is written to another file that is then renamed, so that a checkpoint always has a
//! whole one.
//!
//! A picture towards an error or until a time has no block that is finished before the others; all that is known of it
//! is written behind the head instead, to another file that then takes the place of the last one.

mod job;
mod record;
mod summed;

use std::{
    fs::{self, File},
    io::{self, BufReader, Read, Seek, Write},
    path::{Path, PathBuf},
};

use thiserror::Error;

pub use job::Job;
use record::write_unfinished;
pub use record::{Entry, Record};
use summed::{SUM_BYTES, checksum};

use crate::{
    film::{FileError, Label, Tile, WholeFile},
    render::Unfinished,
};

/// The first line of every checkpoint.
const MAGIC: &[u8] = b"whitted checkpoint 6\n";
/// The longest head that is read, in bytes.
const LONGEST_HEAD: u32 = 1 << 16;

/// Why a render does not go on from a checkpoint.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("{}: the checkpoint cannot be read ({source})", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is no checkpoint, or its head is damaged.
    #[error("{}: not a checkpoint, or damaged; delete it, or render without --resume", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// The checkpoint is of another picture.
    #[error(
        "{}: the checkpoint is of another picture ({what}); render with the same scene and options, or without --resume",
        path.display()
    )]
    Differs {
        /// The file.
        path: PathBuf,
        /// In what they differ: here is what is asked for, there the checkpoint.
        what: String,
    },
}

/// A checkpoint that more is written to.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    file: File,
    /// The bytes up to the end of the last whole record.
    length: u64,
}

impl Checkpoint {
    /// Where the checkpoint of a picture file is: beside it.
    pub fn path_for(picture: &Path) -> PathBuf {
        let mut name = picture.as_os_str().to_owned();
        name.push(".checkpoint");
        PathBuf::from(name)
    }

    /// A checkpoint of one block. One that is there already is kept under its name with `.old` behind it.
    ///
    /// # Errors
    /// The file cannot be written; then there is none.
    pub fn create(path: &Path, label: &Label, first: &Record) -> Result<Self, FileError> {
        Self::set_aside(path)?;
        Self::write(path, label, |writer| writer.write_all(&first.to_bytes()))
    }

    /// A checkpoint of a picture that is not finished anywhere, in the place of `last`, the one before.
    ///
    /// # Errors
    /// The file cannot be written; the one before, or none, is then still there.
    pub fn create_unfinished(
        path: &Path,
        label: &Label,
        unfinished: &Unfinished,
        last: Option<&Self>,
    ) -> Result<Self, FileError> {
        if last.is_none() {
            Self::set_aside(path)?;
        }
        Self::write(path, label, |writer| write_unfinished(unfinished, writer))
    }

    /// Gives a file that is in the way another name.
    fn set_aside(path: &Path) -> Result<(), FileError> {
        if path.exists() {
            let mut old = path.as_os_str().to_owned();
            old.push(".old");
            fs::rename(path, old)
                .map_err(|source| FileError::Write { path: path.to_owned(), source })?;
        }
        Ok(())
    }

    /// A file with a head and what `write` puts behind it, to which more can be appended.
    fn write(
        path: &Path,
        label: &Label,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, FileError> {
        let error = |source| FileError::Write { path: path.to_owned(), source };
        let head = head(label);
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).map_err(error)?;
        }
        WholeFile::prepare(path)?.commit(|mut writer| {
            writer.write_all(&head)?;
            write(&mut writer)
        })?;
        let file = File::options().append(true).open(path).map_err(error)?;
        let length = file.metadata().map_err(error)?.len();
        Ok(Self { path: path.to_owned(), file, length })
    }

    /// Opens the checkpoint of the picture that `label` describes, in blocks at `places`, and hands each entry to
    /// `put`. What is behind the last whole one is cut off.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or is of another picture.
    pub fn open(
        path: &Path,
        label: &Label,
        places: &[Tile],
        mut put: impl FnMut(Entry),
    ) -> Result<Self, CheckpointError> {
        let unread = |source| CheckpointError::Read { path: path.to_owned(), source };
        let file = File::options().read(true).append(true).open(path).map_err(unread)?;
        let mut reader = BufReader::with_capacity(1 << 20, &file);
        let mut length = check_head(&mut reader, path, label)?;
        while let Some((entry, bytes)) = Entry::read(&mut reader, places).map_err(unread)? {
            length += bytes;
            put(entry);
        }
        drop(reader);
        file.set_len(length).map_err(unread)?;
        Ok(Self { path: path.to_owned(), file, length })
    }

    /// Whether the file is a checkpoint of the picture that `label` describes.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or is of another picture.
    pub fn check(path: &Path, label: &Label) -> Result<(), CheckpointError> {
        let unread = |source| CheckpointError::Read { path: path.to_owned(), source };
        let mut reader = BufReader::new(File::open(path).map_err(unread)?);
        check_head(&mut reader, path, label).map(drop)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the file is still in its place, and as long as it was made.
    pub fn is_there(&self) -> bool {
        fs::metadata(&self.path).is_ok_and(|metadata| metadata.len() >= self.length)
    }

    /// Writes one more block. After an error the checkpoint is what it was.
    ///
    /// # Errors
    /// Those of the file.
    pub fn append(&mut self, record: &Record) -> io::Result<()> {
        match self.file.write_all(&record.to_bytes()) {
            Ok(()) => self.length += record.bytes(),
            Err(error) => {
                // What was written of it is cut off; were it not, it would be when it is opened.
                self.file.set_len(self.length)?;
                return Err(error);
            }
        }
        Ok(())
    }

    /// Waits until what was written survives even a loss of power.
    ///
    /// # Errors
    /// Those of the file.
    pub fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// Deletes the file, because the picture is finished.
    ///
    /// # Errors
    /// Those of the system.
    pub fn remove(self) -> io::Result<()> {
        fs::remove_file(self.path)
    }
}

fn head(label: &Label) -> Vec<u8> {
    let lines = label.entries().into_iter().map(|(name, value)| format!("{name}: {value}\n"));
    let text: String = lines.collect();
    let mut head = MAGIC.to_vec();
    head.extend((text.len() as u32).to_le_bytes());
    head.extend(text.as_bytes());
    let sum = checksum(&head);
    head.extend(sum);
    head
}

/// The length of a head that is of the picture that `label` describes.
fn check_head(
    reader: &mut (impl Read + Seek),
    path: &Path,
    label: &Label,
) -> Result<u64, CheckpointError> {
    let path = || path.to_owned();
    let found =
        read_head(reader).map_err(|source| CheckpointError::Read { path: path(), source })?;
    let Some((found, length)) = found else {
        return Err(CheckpointError::Damaged { path: path() });
    };
    let mut differences = label.differences(&found);
    if label.place() != found.place() {
        let show = |Tile { x0, y0, x1, y1 }: Tile| format!("{x0},{y0},{x1},{y1}");
        let (ours, theirs) = (show(label.place()), show(found.place()));
        differences.push(format!("part: {ours} here, {theirs} there"));
    }
    if !differences.is_empty() {
        return Err(CheckpointError::Differs { path: path(), what: differences.join("; ") });
    }
    Ok(length)
}

/// The label in the head, and the head's length; none if it is damaged.
fn read_head(reader: &mut (impl Read + Seek)) -> io::Result<Option<(Label, u64)>> {
    let start = MAGIC.len() + 4;
    let mut head = vec![0; start];
    if !read_all(reader, &mut head)? || !head.starts_with(MAGIC) {
        return Ok(None);
    }
    let length =
        u32::from_le_bytes([head[start - 4], head[start - 3], head[start - 2], head[start - 1]]);
    if length > LONGEST_HEAD {
        return Ok(None);
    }
    head.resize(start + length as usize, 0);
    let mut sum = [0; SUM_BYTES];
    if !read_all(reader, &mut head[start..])?
        || !read_all(reader, &mut sum)?
        || sum != checksum(&head)
    {
        return Ok(None);
    }
    let text = String::from_utf8_lossy(&head[start..]);
    let label = Label::from_entries(text.lines().filter_map(|line| line.split_once(": ")));
    let length = reader.stream_position()?;
    Ok(label.map(|label| (label, length)))
}

/// Fills `bytes`; false if the file ends before.
fn read_all(reader: &mut impl Read, bytes: &mut [u8]) -> io::Result<bool> {
    match reader.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}
