//! The parts of a picture read row by row, while the whole is written.

use std::{
    fs::File,
    io::{self, BufReader, Read, Seek},
    path::PathBuf,
};

use super::{MergeError, Part};
use crate::film::{
    FileError, Format, Label, OutputFile, encode,
    exr::{self, ExrReader, Row},
    png::{self, PngReader},
    ppm,
};

/// What reads a part's pixels.
pub(super) enum Reader {
    Png(Box<PngReader<BufReader<File>>>),
    Exr(Box<ExrReader<File>>),
}

impl Reader {
    /// What reads a file, the size of its picture, and its label.
    pub(super) fn open(mut file: File) -> io::Result<(Self, [u32; 2], Option<Label>)> {
        let mut magic = [0; 4];
        file.read_exact(&mut magic)?;
        file.rewind()?;
        if magic == [0x76, 0x2f, 0x31, 0x01] {
            let (reader, size, label) = ExrReader::open(file)?;
            return Ok((Self::Exr(Box::new(reader)), size, label));
        }
        let (reader, size, label) = PngReader::open(file)?;
        Ok((Self::Png(Box::new(reader)), size, label))
    }
}

/// The parts that a row goes through, opened when the first of their rows comes.
struct Sweep<'a> {
    parts: &'a [Part],
    next: usize,
    active: Vec<(&'a Part, Reader)>,
    y: u32,
    /// Which part could not be read.
    failed: Option<PathBuf>,
}

impl Sweep<'_> {
    /// Hands the readers of the next row to `read`, from left to right.
    fn advance(&mut self, mut read: impl FnMut(&mut Reader) -> io::Result<()>) -> io::Result<()> {
        let y = self.y;
        self.active.retain(|(part, _)| part.is_in_row(y));
        while let Some(part) = self.parts.get(self.next).filter(|part| part.place.y0 == y) {
            self.next += 1;
            match File::open(&part.path).and_then(Reader::open) {
                Ok((reader, ..)) => self.active.push((part, reader)),
                Err(error) => {
                    self.failed = Some(part.path.clone());
                    return Err(error);
                }
            }
        }
        self.active.sort_by_key(|(part, _)| part.place.x0);
        for (part, reader) in &mut self.active {
            read(reader).inspect_err(|_| self.failed = Some(part.path.clone()))?;
        }
        self.y += 1;
        Ok(())
    }

    /// The next row as 8-bit sRGB.
    fn bytes(&mut self, bytes: &mut Vec<u8>) -> io::Result<()> {
        bytes.clear();
        let (mut row, mut encoded) = (Row::default(), Vec::new());
        self.advance(|reader| {
            match reader {
                Reader::Png(reader) => bytes.extend_from_slice(reader.read_row()?),
                Reader::Exr(reader) => {
                    reader.read_row(&mut row)?;
                    encode::encode_row(&row.colors, &mut encoded);
                    bytes.extend_from_slice(&encoded);
                }
            }
            Ok(())
        })
    }

    /// The next row as floats.
    fn floats(&mut self, whole: &mut Row) -> io::Result<()> {
        whole.colors.clear();
        whole.samples.clear();
        let mut row = Row::default();
        self.advance(|reader| {
            let Reader::Exr(reader) = reader else {
                return Err(io::ErrorKind::InvalidData.into()); // it was another file a moment ago
            };
            reader.read_row(&mut row)?;
            whole.colors.append(&mut row.colors);
            whole.samples.append(&mut row.samples);
            Ok(())
        })
    }
}

/// Writes the whole, of which the parts, sorted from top to bottom, hold each pixel once.
pub(super) fn write(parts: &[Part], label: &Label, output: &OutputFile) -> Result<(), MergeError> {
    let [width, height] = label.size;
    let mut sweep = Sweep { parts, next: 0, active: Vec::new(), y: 0, failed: None };
    let written = output.file().commit(|mut writer| match output.format() {
        Format::Png => {
            png::write_rows(label.size, Some(label), writer, &mut |bytes| sweep.bytes(bytes))
        }
        Format::Exr => {
            exr::write_rows(label.size, Some(label), writer, &mut |row| sweep.floats(row))
        }
        Format::Ppm => {
            ppm::write_header(width, height, &mut writer)?;
            let mut bytes = Vec::new();
            (0..height).try_for_each(|_| {
                sweep.bytes(&mut bytes)?;
                writer.write_all(&bytes)
            })
        }
    });
    match (written, sweep.failed) {
        (Ok(()), _) => Ok(()),
        (Err(FileError::Write { source, .. }), Some(path)) => {
            Err(MergeError::Read { path, source })
        }
        (Err(error), _) => Err(MergeError::Output(error.into())),
    }
}
