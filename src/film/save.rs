//! A picture file: checked before the render, written whole after it.

use std::path::{Path, PathBuf};

use super::{Film, ImageError, Label, WholeFile, write_exr, write_png, write_ppm};

/// The picture formats there are, by the extension that picks them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB.
    Png,
    /// 32-bit linear floats.
    Exr,
    /// 8-bit sRGB without compression or label.
    Ppm,
}

/// For messages.
const KNOWN_EXTENSIONS: &str = ".png, .exr, .ppm";

impl Format {
    /// The format the extension of `path` names, in upper or lower case.
    fn of(path: &Path) -> Result<Self, ImageError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        for (known, format) in [("png", Self::Png), ("exr", Self::Exr), ("ppm", Self::Ppm)] {
            if extension.eq_ignore_ascii_case(known) {
                return Ok(format);
            }
        }
        Err(ImageError::UnknownExtension {
            path: path.to_owned(),
            extension: extension.into_owned(),
            known: KNOWN_EXTENSIONS,
        })
    }
}

/// A picture file to come.
///
/// [`prepare`](Self::prepare) before rendering, so that a mistyped folder costs no render;
/// [`commit`](Self::commit) afterwards. See [`WholeFile`] for what happens on disk.
#[derive(Debug)]
pub struct OutputFile {
    file: WholeFile,
    format: Format,
}

impl OutputFile {
    /// Checks that the extension of `path` names a [known format](Format) and that the file can be written.
    ///
    /// # Errors
    ///
    /// [`ImageError::UnknownExtension`], or [`ImageError::File`] with the reason.
    pub fn prepare(path: impl Into<PathBuf>) -> Result<Self, ImageError> {
        let path = path.into();
        let format = Format::of(&path)?;
        Ok(Self { file: WholeFile::prepare(path)?, format })
    }

    /// The file on disk.
    pub fn file(&self) -> &WholeFile {
        &self.file
    }

    /// The format that the extension picks.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Writes the film, and the label where the format has a place for it, and puts the file into place; an existing
    /// picture is replaced at that moment.
    ///
    /// # Errors
    ///
    /// [`ImageError::File`]; an existing picture is then still what it was.
    pub fn commit(&self, film: &Film, label: Option<&Label>) -> Result<(), ImageError> {
        match self.format {
            Format::Png => self.file.commit(|writer| write_png(film, label, writer))?,
            Format::Exr => self.file.commit(|writer| write_exr(film, label, writer))?,
            Format::Ppm => self.file.commit(|writer| write_ppm(film, writer))?,
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FileError, encode, metrics};
    use std::fs;

    #[test]
    fn a_saved_film_reads_back_and_replaces_the_old_picture() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("picture.PNG");
        for size in [3, 5] {
            let film = Film::new(size, 2);
            OutputFile::prepare(&path).expect("writable").commit(&film, None).expect("written");
            let read = metrics::read_png_rgb8(&path).expect("readable");
            assert_eq!(read.dimensions(), (size, 2));
            assert_eq!(read.into_raw(), encode::to_srgb8(&film));
        }
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[test]
    fn a_picture_that_cannot_be_encoded_leaves_the_old_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("picture.png");
        fs::write(&path, "old").expect("written");
        let error = OutputFile::prepare(&path).expect("writable").commit(&Film::new(0, 0), None);
        assert!(matches!(error, Err(ImageError::File(FileError::Write { .. }))), "{error:?}");
        assert_eq!(fs::read(&path).expect("readable"), b"old");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[test]
    fn unknown_extensions_are_refused_with_the_known_ones() {
        for name in ["picture", "picture.", "picture.tif", "png", ".png", "a.png.gz"] {
            let error = OutputFile::prepare(name).expect_err("unknown").to_string();
            assert!(error.starts_with(name) && error.ends_with(": .png, .exr, .ppm"), "{error}");
            assert!(!Path::new(name).exists());
        }
    }
}
