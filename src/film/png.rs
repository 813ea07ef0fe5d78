//! PNG files: 8-bit sRGB, written row by row, with a label in their text chunks.

use std::io::{self, BufRead, BufReader, Read, Seek, Write};

use super::{Film, Label, encode};

/// The bytes of compressed data in each chunk.
const CHUNK_BYTES: usize = 1 << 16;

/// Writes the film as an 8-bit sRGB PNG with an `sRGB` chunk (perceptual rendering intent) and the label, if there is
/// one.
///
/// The same film and label always give the same bytes. If the label says that pixels are missing, those without samples
/// are transparent.
///
/// # Errors
///
/// Those of the writer; a film without pixels is [`io::ErrorKind::InvalidInput`], since PNG has no
/// such picture.
pub fn write_png(film: &Film, label: Option<&Label>, writer: impl Write) -> io::Result<()> {
    let has_alpha = is_unfinished(label);
    let mut y = 0;
    write_rows([film.width(), film.height()], label, writer, &mut |bytes| {
        encode::encode_row(film.row(y), bytes);
        if has_alpha {
            *bytes = with_alpha(bytes, film.row_samples(y));
        }
        y += 1;
        Ok(())
    })
}

/// Writes 8-bit sRGB bytes, row by row, as a PNG.
///
/// # Errors
/// Those of the writer, and a number of bytes that does not fit the size.
pub fn write_rgb8(bytes: &[u8], width: u32, height: u32, writer: impl Write) -> io::Result<()> {
    let row = 3 * width as usize;
    if bytes.len() as u64 != row as u64 * u64::from(height) {
        let error = format!("{} bytes are not {width} x {height} pixels", bytes.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, error));
    }
    let mut rows = bytes.chunks_exact(row.max(1));
    write_rows([width, height], None, writer, &mut |row| {
        row.clear();
        row.extend_from_slice(rows.next().unwrap_or_default());
        Ok(())
    })
}

/// Writes a file whose rows, three bytes a pixel, come one after another from `next`; four bytes if the label says that pixels
/// are missing.
pub(super) fn write_rows(
    [width, height]: [u32; 2],
    label: Option<&Label>,
    writer: impl Write,
    next: &mut dyn FnMut(&mut Vec<u8>) -> io::Result<()>,
) -> io::Result<()> {
    let write = || -> Result<(), png::EncodingError> {
        let mut encoder = png::Encoder::new(writer, width, height);
        let has_alpha = is_unfinished(label);
        encoder.set_color(if has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::Fast);
        for (name, value) in label.map(Label::entries).unwrap_or_default() {
            encoder.add_text_chunk(name.to_owned(), value)?;
        }
        let mut writer = encoder.write_header()?;
        let mut stream = writer.stream_writer_with_size(CHUNK_BYTES)?;
        let mut bytes = Vec::new();
        for _ in 0..height {
            next(&mut bytes)?;
            stream.write_all(&bytes)?;
        }
        stream.finish()?;
        writer.finish()
    };
    write().map_err(io_error)
}

fn is_unfinished(label: Option<&Label>) -> bool {
    label.is_some_and(|label| label.missing > 0)
}

fn with_alpha(bytes: &[u8], samples: &[u32]) -> Vec<u8> {
    let alpha = |count: &u32| if *count > 0 { 255 } else { 0 };
    let pixels = bytes.chunks_exact(3).zip(samples);
    pixels.flat_map(|(rgb, count)| [rgb[0], rgb[1], rgb[2], alpha(count)]).collect()
}

fn io_error(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidInput, other.to_string()),
    }
}

/// A PNG file that is read row by row.
pub(super) struct PngReader<R: BufRead + Seek> {
    reader: png::Reader<R>,
    row: Vec<u8>,
}

impl<R: Read + Seek> PngReader<BufReader<R>> {
    /// Reads all that comes before the pixels; the label is none if the file has no complete one.
    pub(super) fn open(file: R) -> io::Result<(Self, [u32; 2], Option<Label>)> {
        let reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(decode_error)?;
        let info = reader.info();
        let text = &info.uncompressed_latin1_text;
        let entries = text.iter().map(|chunk| (chunk.keyword.as_str(), chunk.text.as_str()));
        let (label, size) = (Label::from_entries(entries), [info.width, info.height]);
        let (color, depth) = reader.output_color_type();
        let is_ours = matches!(color, png::ColorType::Rgb | png::ColorType::Rgba);
        let label = label.filter(|_| is_ours && depth == png::BitDepth::Eight);
        Ok((Self { reader, row: Vec::new() }, size, label))
    }

    /// The next row, three bytes a pixel.
    pub(super) fn read_row(&mut self) -> io::Result<&[u8]> {
        let row = self.reader.next_row().map_err(decode_error)?;
        let row = row.ok_or_else(|| io::Error::from(io::ErrorKind::UnexpectedEof))?;
        self.row.clear();
        self.row.extend_from_slice(row.data());
        Ok(&self.row)
    }
}

fn decode_error(error: png::DecodingError) -> io::Error {
    match error {
        png::DecodingError::IoError(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidData, other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rgb, color::srgb_to_linear, film::Tile};

    /// A film whose 8-bit form is known by construction: pixel `i` is level `i % 256` of sRGB.
    fn ramp(width: u32, height: u32) -> (Film, Vec<u8>) {
        let levels: Vec<u8> = (0..width * height).map(|i| (i % 256) as u8).collect();
        let pixels: Vec<Rgb> = levels
            .iter()
            .map(|&level| Rgb::splat(srgb_to_linear(f64::from(level) / 255.0) as f32))
            .collect();
        let mut film = Film::new(width, height);
        let tile = Tile { x0: 0, y0: 0, x1: width, y1: height };
        film.blit(&tile, &pixels, &vec![1; levels.len()]);
        (film, levels.into_iter().flat_map(|level| [level; 3]).collect())
    }

    /// Oracle: levels chosen first, decoded by the `image` crate.
    #[test]
    fn png_decodes_to_the_levels_it_was_made_of() {
        for (width, height) in [(1, 1), (1, 300), (300, 1), (64, 33)] {
            let (film, levels) = ramp(width, height);
            assert_eq!(encode::to_srgb8(&film), levels);
            let mut file = Vec::new();
            write_png(&film, None, &mut file).expect("written to memory");
            let decoded = image::load_from_memory(&file).expect("a PNG");
            assert_eq!(decoded.color(), image::ColorType::Rgb8);
            assert_eq!((decoded.width(), decoded.height()), (width, height));
            assert_eq!(decoded.into_rgb8().into_raw(), levels, "{width} x {height}");
        }
    }

    /// Oracle: the PNG specification, section 11.3.2.5 (one byte, 0 is perceptual, before the data).
    #[test]
    fn png_says_that_it_is_srgb() {
        let mut file = Vec::new();
        write_png(&ramp(4, 4).0, None, &mut file).expect("written to memory");
        let place = |name: &[u8]| file.windows(name.len()).position(|bytes| bytes == name);
        let srgb = place(b"\0\0\0\x01sRGB\0").expect("an sRGB chunk of one byte, 0");
        assert!(srgb < place(b"IDAT").expect("picture data"));
    }

    #[test]
    fn a_film_without_pixels_is_no_png() {
        let error = write_png(&Film::new(0, 5), None, &mut Vec::new()).expect_err("no pixels");
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
    }

    /// The writer's own error arrives, not the encoder's view of it.
    #[test]
    fn a_full_disk_is_reported_as_such() {
        let (film, _) = ramp(64, 64);
        let error = write_png(&film, None, &mut [0_u8; 100][..]).expect_err("too little room");
        assert_eq!(error.kind(), io::ErrorKind::WriteZero);
    }
}
