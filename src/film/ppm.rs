//! PPM files: 8-bit sRGB without compression, and without a place for a label.

use std::io::{self, Write};

use super::{Film, encode};

/// Writes the film as a binary PPM (`P6`, 255 levels), whose values are sRGB. What is not rendered is black.
///
/// # Errors
/// Those of the writer.
pub fn write_ppm(film: &Film, mut writer: impl Write) -> io::Result<()> {
    write_header(film.width(), film.height(), &mut writer)?;
    let mut bytes = Vec::new();
    for y in 0..film.height() {
        encode::encode_row(film.row(y), &mut bytes);
        writer.write_all(&bytes)?;
    }
    Ok(())
}

/// Writes all that comes before the pixels.
pub(super) fn write_header(width: u32, height: u32, mut writer: impl Write) -> io::Result<()> {
    write!(writer, "P6\n{width} {height}\n255\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rgb, film::Tile};

    /// Oracle: the format's description, <https://netpbm.sourceforge.net/doc/ppm.html>.
    #[test]
    fn a_ppm_is_a_header_and_bytes() {
        let mut film = Film::new(2, 1);
        let tile = Tile { x0: 0, y0: 0, x1: 2, y1: 1 };
        film.blit(&tile, &[Rgb::new(1.0, 0.0, 0.5), Rgb::ONE], &[1, 1]);
        let mut file = Vec::new();
        write_ppm(&film, &mut file).expect("written to memory");
        assert_eq!(file, b"P6\n2 1\n255\n\xff\x00\xbc\xff\xff\xff");
    }
}
