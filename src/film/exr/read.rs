//! Reading back, row by row, what the program wrote.

use std::{
    io::{self, BufReader, Read, Seek},
    ops::Range,
};

use exr::{
    block::reader::{AllChunksReader, ChunksReader, SequentialBlockDecompressor},
    meta::header::Header,
};

use super::{Row, headers, io_error};
use crate::{Rgb, film::Label};

/// A file of [`write_exr`](super::write_exr) that is read row by row.
pub(in crate::film) struct ExrReader<R: Read + Seek> {
    blocks: SequentialBlockDecompressor<AllChunksReader<BufReader<R>>>,
    width: usize,
    /// The current block's layers, and the rows of it that are still to come.
    layers: [Vec<u8>; 2],
    rows: Range<usize>,
}

impl<R: Read + Seek> ExrReader<R> {
    /// Reads all that comes before the pixels; the label is none if the file has no complete one.
    pub(in crate::film) fn open(file: R) -> io::Result<(Self, [u32; 2], Option<Label>)> {
        let reader = exr::block::read(BufReader::new(file), false).map_err(io_error)?;
        let header = &reader.headers()[0];
        let size = [header.layer_size.x() as u32, header.layer_size.y() as u32];
        let text = header.own_attributes.comments.as_ref().map(ToString::to_string);
        let text = text.unwrap_or_default();
        let lines = text.lines().filter_map(|line| line.split_once(": "));
        let label = Label::from_entries(lines);
        let is_ours = label.as_ref().is_some_and(|label| {
            let ours = headers(size, Some(label));
            let shape = |h: &Header| {
                (h.channels.list.clone(), h.compression, h.blocks, h.layer_size, h.line_order)
            };
            reader.headers().iter().map(shape).eq(ours.iter().map(shape))
        });
        let blocks = reader.all_chunks(false).map_err(io_error)?.sequential_decompressor(false);
        let (width, layers, rows) = (size[0] as usize, [Vec::new(), Vec::new()], 0..0);
        Ok((Self { blocks, width, layers, rows }, size, label.filter(|_| is_ours)))
    }

    /// The next row of a file without missing pixels.
    pub(in crate::film) fn read_row(&mut self, row: &mut Row) -> io::Result<()> {
        if self.rows.is_empty() {
            for layer in 0..2 {
                let block = self.blocks.next();
                let block = block.ok_or_else(|| io::Error::from(io::ErrorKind::UnexpectedEof))?;
                let block = block.map_err(io_error)?;
                if block.index.layer != layer {
                    return Err(io::Error::new(
                        io::ErrorKind::InvalidData,
                        "the layers are not in turn",
                    ));
                }
                self.rows = 0..block.index.pixel_size.y();
                self.layers[layer] = block.data;
            }
        }
        let k = self.rows.next().unwrap_or(0);
        let line = |bytes: &'_ [u8], number: usize| -> Vec<[u8; 4]> {
            let line = &bytes[number * self.width * 4..][..self.width * 4];
            line.chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]).collect()
        };
        let [b, g, r] = [0, 1, 2].map(|channel| line(&self.layers[0], 3 * k + channel));
        row.colors.clear();
        row.colors.extend(
            (0..self.width).map(|x| Rgb::from_array([r[x], g[x], b[x]].map(f32::from_ne_bytes))),
        );
        row.samples.clear();
        row.samples.extend(line(&self.layers[1], k).into_iter().map(u32::from_ne_bytes));
        Ok(())
    }
}
