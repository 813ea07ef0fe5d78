//! Finished blocks, and pictures on their way to a goal, as bytes.

use std::io::{self, Read, Write};

use super::{
    read_all,
    summed::{SUM_BYTES, Summed, checksum},
};
use crate::{
    color::Rgb,
    film::Tile,
    render::{Account, RayCounts, Unfinished},
};

/// What stands in a checkpoint.
pub enum Entry {
    /// A finished block.
    Block(Record),
    /// The whole picture on its way to a goal.
    Unfinished(Box<Unfinished>),
}

/// In the place of a block's number, before an unfinished picture.
const UNFINISHED: u32 = u32::MAX;

impl Entry {
    /// The next entry of the checkpoint of a picture in blocks at `places`, and the bytes that it takes; none where the
    /// file ends, or from where on it is damaged.
    pub(super) fn read(reader: &mut impl Read, places: &[Tile]) -> io::Result<Option<(Self, u64)>> {
        let mut number = [0; 4];
        if !read_all(reader, &mut number)? {
            return Ok(None);
        }
        if u32::from_le_bytes(number) == UNFINISHED {
            let read = read_unfinished(reader);
            return Ok(read.map(|(it, bytes)| (Self::Unfinished(Box::new(it)), bytes)));
        }
        let record = Record::read(reader, number, places)?;
        Ok(record.map(|record| {
            let bytes = record.bytes();
            (Self::Block(record), bytes)
        }))
    }
}

/// Writes an unfinished picture, its checksum behind it.
pub(super) fn write_unfinished(unfinished: &Unfinished, writer: &mut dyn Write) -> io::Result<()> {
    let mut summed = Summed::new(&mut *writer);
    summed.write_all(&UNFINISHED.to_le_bytes())?;
    if let Err(error) = postcard::to_io(unfinished, &mut summed) {
        return Err(summed.take_failure().unwrap_or_else(|| io::Error::other(error)));
    }
    let (sum, _) = summed.sum();
    writer.write_all(&sum)
}

/// The picture behind the mark, and the bytes of the entry; none if it is damaged.
fn read_unfinished(reader: &mut impl Read) -> Option<(Unfinished, u64)> {
    let mut summed = Summed::new(&mut *reader);
    summed.add(&UNFINISHED.to_le_bytes());
    let (unfinished, _) = postcard::from_io((&mut summed, &mut [0; 8])).ok()?;
    let (sum, bytes) = summed.sum();
    let mut there = [0; SUM_BYTES];
    let is_whole = read_all(reader, &mut there).ok()? && there == sum;
    is_whole.then_some((unfinished, bytes + SUM_BYTES as u64))
}

/// What a checkpoint keeps of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The block's number.
    pub number: usize,
    /// The colours, row by row, linear.
    pub colors: Vec<Rgb>,
    /// The rays through each pixel.
    pub samples: Vec<u32>,
    /// What it took and what it is worth.
    pub account: Account,
}

/// Number and account.
const HEAD_BYTES: usize = 4 + 8 * 8;
/// Colour and samples of a pixel.
const PIXEL_BYTES: usize = 16;

impl Record {
    /// The bytes that it takes.
    pub(super) fn bytes(&self) -> u64 {
        (HEAD_BYTES + PIXEL_BYTES * self.colors.len() + SUM_BYTES) as u64
    }

    /// As it stands in a file.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.bytes() as usize);
        bytes.extend((self.number as u32).to_le_bytes());
        let Account { rays, squared_error, unsettled } = self.account;
        let RayCounts { camera, reflected, refracted, transmitted, shadow, camera_hit } = rays;
        for count in [camera, reflected, refracted, transmitted, shadow, camera_hit, unsettled] {
            bytes.extend(count.to_le_bytes());
        }
        bytes.extend(squared_error.to_le_bytes());
        for color in &self.colors {
            color.to_array().into_iter().for_each(|channel| bytes.extend(channel.to_le_bytes()));
        }
        self.samples.iter().for_each(|count| bytes.extend(count.to_le_bytes()));
        let sum = checksum(&bytes);
        bytes.extend(sum);
        bytes
    }

    /// The record behind its number; none if it is damaged.
    fn read(reader: &mut impl Read, number: [u8; 4], places: &[Tile]) -> io::Result<Option<Self>> {
        let mut bytes = number.to_vec();
        let number = u32::from_le_bytes(number) as usize;
        let Some(place) = places.get(number) else { return Ok(None) };
        let pixels = place.width() as usize * place.height() as usize;
        bytes.resize(HEAD_BYTES + PIXEL_BYTES * pixels, 0);
        let mut sum = [0; SUM_BYTES];
        let is_whole = read_all(reader, &mut bytes[4..])? && read_all(reader, &mut sum)?;
        if !is_whole || sum != checksum(&bytes) {
            return Ok(None);
        }
        let word = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        let long = |k: usize| {
            let at = 4 + 8 * k;
            let [a, b] = [word(at), word(at + 4)].map(u32::from_le_bytes).map(u64::from);
            a | b << 32
        };
        let rays = RayCounts {
            camera: long(0),
            reflected: long(1),
            refracted: long(2),
            transmitted: long(3),
            shadow: long(4),
            camera_hit: long(5),
        };
        let account = Account { rays, unsettled: long(6), squared_error: f64::from_bits(long(7)) };
        let channel = |k: usize| f32::from_le_bytes(word(HEAD_BYTES + 4 * k));
        let color = |k: usize| Rgb::new(channel(3 * k), channel(3 * k + 1), channel(3 * k + 2));
        let samples = |k: usize| u32::from_le_bytes(word(HEAD_BYTES + 12 * pixels + 4 * k));
        Ok(Some(Self {
            number,
            colors: (0..pixels).map(color).collect(),
            samples: (0..pixels).map(samples).collect(),
            account,
        }))
    }
}
