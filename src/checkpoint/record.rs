//! A finished block as bytes.

use std::io::{self, Read};

use super::read_all;
use crate::{
    color::Rgb,
    film::Tile,
    render::{Account, RayCounts},
};

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

/// Eight bytes by which damage is found.
pub(super) fn checksum(bytes: &[u8]) -> [u8; 8] {
    let hash = blake3::hash(bytes);
    std::array::from_fn(|k| hash.as_bytes()[k])
}

impl Record {
    /// The bytes that it takes.
    pub(super) fn bytes(&self) -> u64 {
        (HEAD_BYTES + PIXEL_BYTES * self.colors.len() + 8) as u64
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

    /// The next record of a picture in blocks at `places`; none where the file ends, or from where on it is damaged.
    pub(super) fn read(reader: &mut impl Read, places: &[Tile]) -> io::Result<Option<Self>> {
        let mut bytes = vec![0; HEAD_BYTES];
        if !read_all(reader, &mut bytes)? {
            return Ok(None);
        }
        let number = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize;
        let Some(place) = places.get(number) else { return Ok(None) };
        let pixels = place.width() as usize * place.height() as usize;
        bytes.resize(HEAD_BYTES + PIXEL_BYTES * pixels, 0);
        let mut sum = [0; 8];
        let is_whole = read_all(reader, &mut bytes[HEAD_BYTES..])? && read_all(reader, &mut sum)?;
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
