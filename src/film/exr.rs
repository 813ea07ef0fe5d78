//! OpenEXR files: 32-bit linear light in one layer, the rays of each pixel in another.

mod read;

use std::io::{self, Seek, Write};

use exr::{
    block::{
        BlockIndex, UncompressedBlock,
        writer::{ChunkWriter, ChunksWriter},
    },
    compression::Compression,
    error::Error,
    math::Vec2,
    meta::{
        BlockDescription,
        attribute::{ChannelDescription, IntegerBounds, LineOrder, SampleType, Text},
        header::{Header, ImageAttributes, LayerAttributes},
    },
};
use rayon::prelude::*;

use super::{Film, Label, Tile};
use crate::Rgb;
pub(super) use read::ExrReader;

/// Rows that are compressed together.
const BLOCK_ROWS: u32 = 16;
/// Blocks that are compressed at the same time.
const BLOCKS_AT_ONCE: u32 = 8;

/// Colours and rays of the pixels of one row.
#[derive(Debug, Default)]
pub(super) struct Row {
    pub(super) colors: Vec<Rgb>,
    pub(super) samples: Vec<u32>,
}

/// Writes the film as an OpenEXR file with two layers: `color`, linear `R`, `G` and `B` as 32-bit floats, and
/// `samples`, the rays through each pixel as 32-bit integers; both compressed by blocks of 16 rows (`ZIP`).
///
/// The file's data window is the part that the label names. Without a label the film is the whole picture. The same
/// film and label always give the same bytes. If the label says that pixels are missing, there is a channel `A`, zero
/// where there are no samples.
///
/// # Errors
/// Those of the writer; a film without pixels is [`io::ErrorKind::InvalidInput`].
pub fn write_exr(film: &Film, label: Option<&Label>, writer: impl Write + Seek) -> io::Result<()> {
    if film.pixels().is_empty() {
        let error = "a picture without pixels is no OpenEXR file";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, error));
    }
    let mut y = 0;
    write_rows([film.width(), film.height()], label, writer, &mut |row| {
        row.colors.clear();
        row.colors.extend_from_slice(film.row(y));
        row.samples.clear();
        row.samples.extend_from_slice(film.row_samples(y));
        y += 1;
        Ok(())
    })
}

/// Writes a file whose rows come one after another from `next`.
pub(super) fn write_rows(
    size: [u32; 2],
    label: Option<&Label>,
    writer: impl Write + Seek,
    next: &mut dyn FnMut(&mut Row) -> io::Result<()>,
) -> io::Result<()> {
    let headers = headers(size, label);
    let mut write = |writer: &mut ChunkWriter<_>| -> exr::error::UnitResult {
        let blocks = size[1].div_ceil(BLOCK_ROWS);
        for first in (0..blocks).step_by(BLOCKS_AT_ONCE as usize) {
            let last = (first + BLOCKS_AT_ONCE).min(blocks);
            let mut raw = Vec::new();
            for block in first..last {
                raw.extend(read_block(size, block, has_alpha(label), next)?);
            }
            let chunks: Vec<_> =
                raw.into_par_iter().map(|block| block.compress_to_chunk(&headers)).collect();
            for (k, chunk) in chunks.into_iter().enumerate() {
                writer.write_chunk(first as usize + k / 2, chunk?)?;
            }
        }
        Ok(())
    };
    exr::block::write(writer, headers.iter().cloned().collect(), true, |_, w| write(w))
        .map_err(io_error)
}

fn has_alpha(label: Option<&Label>) -> bool {
    label.is_some_and(|label| label.missing > 0)
}

fn headers([width, height]: [u32; 2], label: Option<&Label>) -> [Header; 2] {
    let place = label.map_or(Tile { x0: 0, y0: 0, x1: width, y1: height }, Label::place);
    let [whole_width, whole_height] = label.map_or([width, height], |label| label.size);
    let whole = Vec2(whole_width as usize, whole_height as usize);
    let header = |name: &str, channels: Vec<ChannelDescription>| {
        let size = Vec2(width as usize, height as usize);
        let mut own = LayerAttributes::named(Text::from(name));
        own.layer_position = Vec2(place.x0 as i32, place.y0 as i32);
        own.software_name = label.map(|label| latin(&label.software));
        own.comments = label.map(|label| {
            let lines =
                label.entries().into_iter().map(|(name, value)| format!("{name}: {value}\n"));
            latin(&lines.collect::<String>())
        });
        let shared = ImageAttributes::new(IntegerBounds::from_dimensions(whole));
        Header::new(Text::from(name), size, channels.into())
            .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
            .with_attributes(own)
            .with_shared_attributes(shared)
    };
    let channel = |name: &str, kind, linear| ChannelDescription::new(name, kind, linear);
    let names: &[&str] = if has_alpha(label) { &["A", "B", "G", "R"] } else { &["B", "G", "R"] };
    let colors = names.iter().map(|name| channel(name, SampleType::F32, true)).collect();
    [header("color", colors), header("samples", vec![channel("samples", SampleType::U32, true)])]
}

/// Letters beyond Latin-1, which no label has, become question marks.
fn latin(text: &str) -> Text {
    let letters = text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap_or(b'?'));
    Text::from_bytes_unchecked(letters.collect())
}

/// The two layers of the next block.
fn read_block(
    [width, height]: [u32; 2],
    block: u32,
    has_alpha: bool,
    next: &mut dyn FnMut(&mut Row) -> io::Result<()>,
) -> io::Result<[UncompressedBlock; 2]> {
    let top = block * BLOCK_ROWS;
    let rows = BLOCK_ROWS.min(height - top);
    let (mut colors, mut samples) = (Vec::new(), Vec::new());
    let mut row = Row::default();
    for _ in 0..rows {
        next(&mut row)?;
        if has_alpha {
            let alpha = |count: &u32| f32::from(u8::from(*count > 0)).to_ne_bytes();
            colors.extend(row.samples.iter().flat_map(alpha));
        }
        for channel in [2, 1, 0] {
            colors.extend(row.colors.iter().flat_map(|color| color[channel].to_ne_bytes()));
        }
        samples.extend(row.samples.iter().flat_map(|count| count.to_ne_bytes()));
    }
    let index = |layer| BlockIndex {
        layer,
        pixel_position: Vec2(0, top as usize),
        pixel_size: Vec2(width as usize, rows as usize),
        level: Vec2(0, 0),
    };
    Ok([
        UncompressedBlock { index: index(0), data: colors },
        UncompressedBlock { index: index(1), data: samples },
    ])
}

fn io_error(error: Error) -> io::Error {
    match error {
        Error::Io(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidData, other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels, ReadLayers};
    use std::io::Cursor;

    fn film() -> Film {
        let (width, height) = (37_u32, 41_u32);
        let count = width * height;
        let colors =
            (0..count).map(|k| Rgb::new(k as f32 / count as f32, 0.25, 1.0 / (k + 1) as f32));
        Film::from_parts(width, height, colors.collect(), (0..count).map(|k| k % 7 + 1).collect())
    }

    fn label(missing: u64) -> Label {
        Label {
            software: "whitted 9.9".to_owned(),
            scene: "abc".to_owned(),
            size: [100, 90],
            options: "aa=none".to_owned(),
            part: Some(Tile { x0: 3, y0: 5, x1: 40, y1: 46 }),
            share: None,
            missing,
            warning: None,
        }
    }

    /// Oracle: the `exr` crate's own reader of whole pictures.
    #[test]
    fn an_exr_reads_back_as_it_was_in_both_layers() {
        let film = film();
        let mut file = Cursor::new(Vec::new());
        write_exr(&film, None, &mut file).expect("written to memory");
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(Cursor::new(file.into_inner()))
            .expect("an OpenEXR file");
        let [color, samples] = &image.layer_data[..] else { panic!("two layers") };
        let values = |layer: &exr::image::Layer<_>, name: &str| -> Vec<f32> {
            let channels: &exr::image::AnyChannels<exr::image::FlatSamples> = &layer.channel_data;
            let channel = channels.list.iter().find(|channel| channel.name.eq(name));
            channel.expect(name).sample_data.values_as_f32().collect()
        };
        for (k, name) in ["R", "G", "B"].into_iter().enumerate() {
            let expected: Vec<f32> = film.pixels().iter().map(|pixel| pixel[k]).collect();
            assert_eq!(values(color, name), expected, "{name}");
        }
        let expected: Vec<f32> = film.samples().iter().map(|count| *count as f32).collect();
        assert_eq!(values(samples, "samples"), expected);
    }

    #[test]
    fn rows_and_label_read_back() {
        let (film, label) = (film(), label(0));
        let mut file = Cursor::new(Vec::new());
        write_exr(&film, Some(&label), &mut file).expect("written to memory");
        let file = Cursor::new(file.into_inner());
        let (mut reader, size, found) = ExrReader::open(file).expect("an OpenEXR file");
        assert_eq!((size, found), ([37, 41], Some(label)));
        let mut row = Row::default();
        for y in 0..41 {
            reader.read_row(&mut row).expect("a row");
            assert_eq!((&row.colors[..], &row.samples[..]), (film.row(y), film.row_samples(y)));
        }
        assert!(reader.read_row(&mut row).is_err());
    }

    #[test]
    fn the_same_film_is_the_same_bytes() {
        let bytes = || {
            let mut file = Cursor::new(Vec::new());
            write_exr(&film(), Some(&label(5)), &mut file).expect("written to memory");
            file.into_inner()
        };
        assert!(bytes() == bytes());
        let error = write_exr(&Film::new(0, 3), None, Cursor::new(Vec::new()));
        assert_eq!(error.expect_err("no pixels").kind(), io::ErrorKind::InvalidInput);
    }
}
