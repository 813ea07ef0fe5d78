//! Joining parts of a picture that were rendered apart.
//!
//! Parts are read row by row while the whole is written, so pictures larger than the memory can be joined.

mod sweep;

use std::{
    fs::File,
    io,
    path::{Path, PathBuf},
};

use thiserror::Error;

use super::{Format, ImageError, Label, OutputFile, Share, Tile};
use sweep::{Reader, write};

/// Why parts do not make a picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There is nothing to join.
    #[error("no part is given; name the files that `render --tile` or `--crop` wrote")]
    NoParts,
    /// A part cannot be read.
    #[error("{}: the part cannot be read ({source})", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system or the decoder says.
        source: io::Error,
    },
    /// A part does not say what it is.
    #[error(
        "{}: the file does not say which picture it is a part of; only .png and .exr files that `whitted` wrote can be joined",
        path.display()
    )]
    NoLabel {
        /// The file.
        path: PathBuf,
    },
    /// A part is not done.
    #[error(
        "{}: {missing} of its pixels are not rendered yet; finish it with `whitted render --resume` first",
        path.display()
    )]
    Unfinished {
        /// The file.
        path: PathBuf,
        /// How many pixels.
        missing: u64,
    },
    /// Two parts are of different pictures.
    #[error("{}: not of the same picture as {} ({what})", second.display(), first.display())]
    Differs {
        /// The first part.
        first: PathBuf,
        /// The one that differs from it.
        second: PathBuf,
        /// In what they differ: here is the first, there the second.
        what: String,
    },
    /// Two parts hold the same pixels.
    #[error("{} and {} overlap at column {x}, row {y}; leave one out", first.display(), second.display())]
    Overlap {
        /// A part.
        first: PathBuf,
        /// Another.
        second: PathBuf,
        /// A column that both hold.
        x: u32,
        /// And its row.
        y: u32,
    },
    /// Pixels are in no part.
    #[error("not all of the picture is there: {what}")]
    Gap {
        /// What is missing.
        what: String,
    },
    /// Eight bits do not become floats again.
    #[error("{}: an 8-bit part cannot become part of an .exr file; render the parts as .exr", path.display())]
    TooFewBits {
        /// The part.
        path: PathBuf,
    },
    /// The whole cannot be written.
    #[error(transparent)]
    Output(#[from] ImageError),
}

/// A part before its pixels are read.
#[derive(Debug)]
struct Part {
    path: PathBuf,
    label: Label,
    place: Tile,
    is_exr: bool,
}

impl Part {
    fn is_in_row(&self, y: u32) -> bool {
        (self.place.y0..self.place.y1).contains(&y)
    }
}

/// What a PNG or OpenEXR file says of itself; none if it has no complete label.
///
/// # Errors
/// The file cannot be read, or is of another kind.
pub fn read_label(file: File) -> io::Result<Option<Label>> {
    Reader::open(file).map(|(_, _, label)| label)
}

/// Joins `parts` to the picture `output`, byte for byte the one that an undivided render writes; returns its size in
/// pixels.
///
/// # Errors
/// The parts are not all of one picture, overlap, or leave a gap, or a file cannot be read or written.
pub fn merge(parts: &[PathBuf], output: &OutputFile) -> Result<[u32; 2], MergeError> {
    let mut parts = parts.iter().map(|path| look_at(path)).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = parts.first() else { return Err(MergeError::NoParts) };
    let mut label = first.label.whole();
    for part in &parts {
        let what = first.label.differences(&part.label);
        if !what.is_empty() {
            let (first, second) = (first.path.clone(), part.path.clone());
            return Err(MergeError::Differs { first, second, what: what.join("; ") });
        }
    }
    if output.format() == Format::Exr
        && let Some(part) = parts.iter().find(|part| !part.is_exr)
    {
        return Err(MergeError::TooFewBits { path: part.path.clone() });
    }
    parts.sort_by_key(|part| (part.place.y0, part.place.x0));
    check_cover(&parts, label.size)?;
    label.warning = parts.iter().find_map(|part| part.label.warning.clone());
    write(&parts, &label, output)?;
    Ok(label.size)
}

fn look_at(path: &Path) -> Result<Part, MergeError> {
    let path = path.to_owned();
    let (reader, size, label) = match File::open(&path).and_then(Reader::open) {
        Ok(found) => found,
        Err(source) => return Err(MergeError::Read { path, source }),
    };
    let Some(label) = label else { return Err(MergeError::NoLabel { path }) };
    if label.missing > 0 {
        return Err(MergeError::Unfinished { path, missing: label.missing });
    }
    let place = label.place();
    if size != [place.width(), place.height()] {
        return Err(MergeError::NoLabel { path });
    }
    Ok(Part { path, label, place, is_exr: matches!(reader, Reader::Exr(_)) })
}

/// Whether the parts, from top to bottom, hold each pixel once.
fn check_cover(parts: &[Part], [width, height]: [u32; 2]) -> Result<(), MergeError> {
    // Between these rows the same parts are side by side.
    let mut cuts: Vec<u32> = parts.iter().flat_map(|p| [p.place.y0, p.place.y1]).collect();
    cuts.extend([0, height]);
    cuts.sort_unstable();
    cuts.dedup();
    let mut gap = None;
    for rows in cuts.windows(2) {
        let (y, below) = (rows[0], rows[1]);
        let mut beside: Vec<&Part> = parts.iter().filter(|part| part.is_in_row(y)).collect();
        beside.sort_by_key(|part| part.place.x0);
        for pair in beside.windows(2) {
            if pair[1].place.x0 < pair[0].place.x1 {
                let [first, second] = [pair[0].path.clone(), pair[1].path.clone()];
                return Err(MergeError::Overlap { first, second, x: pair[1].place.x0, y });
            }
        }
        let mut x = 0;
        for part in beside {
            if part.place.x0 > x {
                gap = gap.or(Some(Tile { x0: x, y0: y, x1: part.place.x0, y1: below }));
            }
            x = part.place.x1;
        }
        if x < width {
            gap = gap.or(Some(Tile { x0: x, y0: y, x1: width, y1: below }));
        }
    }
    match gap {
        None => Ok(()),
        Some(gap) => Err(MergeError::Gap { what: missing(parts, gap) }),
    }
}

/// What is missing: the shares, if the parts are shares of the same number; else a rectangle.
fn missing(parts: &[Part], gap: Tile) -> String {
    let shares: Option<Vec<Share>> = parts.iter().map(|part| part.label.share).collect();
    if let Some(mut shares) = shares
        && let Some(of) = shares.first().map(|share| share.of)
        && shares.iter().all(|share| share.of == of)
    {
        shares.sort_unstable();
        let there = |index: &u32| shares.binary_search(&Share { of, index: *index }).is_ok();
        let absent: Vec<u32> = (1..=of).filter(|index| !there(index)).collect();
        let named: Vec<String> = absent.iter().take(20).map(|k| format!("{k}/{of}")).collect();
        let more = match absent.len().saturating_sub(20) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let (noun, verb) = if absent.len() == 1 { ("tile", "is") } else { ("tiles", "are") };
        return format!(
            "{noun} {}{more} {verb} missing; render with --tile {}",
            named.join(", "),
            named.join(",")
        );
    }
    let Tile { x0, y0, x1, y1 } = gap;
    format!(
        "the pixels from ({x0}, {y0}) to ({x1}, {y1}) are in no part; render with --crop {x0},{y0},{x1},{y1}"
    )
}
