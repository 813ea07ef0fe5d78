//! From the bytes of a file to text: byte-order marks, UTF-16, names in old encodings, and files that are no text.

use std::{
    borrow::Cow,
    fs::File,
    io::{self, Read},
    path::Path,
};

use thiserror::Error;

/// The largest text file that is read, in bytes: what indices of 32 bits are sure to count.
pub const LARGEST_FILE: u64 = (1 << 32) - 1;

/// Why a file is not read as text.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TextError {
    /// The system refuses.
    #[error("cannot be read ({0})")]
    Read(#[from] io::Error),
    /// More bytes than are accepted.
    #[error("is larger than {most} bytes, the most that is read")]
    TooLarge {
        /// The limit.
        most: u64,
    },
    /// Something else than text.
    #[error("is {kind}, not a text file")]
    Binary {
        /// What it looks like.
        kind: &'static str,
    },
}

/// The bytes of a file of at most `most` bytes; no more are ever read.
///
/// # Errors
/// The file cannot be read, or is larger.
pub fn read_limited(path: &Path, most: u64) -> Result<Vec<u8>, TextError> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(TextError::TooLarge { most });
    }
    let mut bytes = Vec::new();
    // One more than it says, so that the end is found without growing.
    bytes.try_reserve_exact(length as usize + 1).map_err(io::Error::from)?;
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(TextError::TooLarge { most }) } else { Ok(bytes) }
}

/// The bytes that come from standard input, at most `most`.
///
/// # Errors
/// They cannot be read, or are more.
pub fn read_stdin(most: u64) -> Result<Vec<u8>, TextError> {
    let mut bytes = Vec::new();
    io::stdin().take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(TextError::TooLarge { most }) } else { Ok(bytes) }
}

/// The text in `bytes`, as bytes in which ASCII means itself: without byte-order mark, UTF-16 turned into UTF-8.
///
/// # Errors
/// The bytes are no text: they hold a zero, or begin like a known binary format.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, [u8]>, TextError> {
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => checked(rest).map(Cow::Borrowed),
        [0xff, 0xfe, rest @ ..] => Ok(Cow::Owned(from_utf16(rest, u16::from_le_bytes)?)),
        [0xfe, 0xff, rest @ ..] => Ok(Cow::Owned(from_utf16(rest, u16::from_be_bytes)?)),
        // UTF-16 without a mark: the first two letters are ASCII.
        [a, 0, b, 0, ..] if *a != 0 && *b != 0 => {
            Ok(Cow::Owned(from_utf16(bytes, u16::from_le_bytes)?))
        }
        [0, a, 0, b, ..] if *a != 0 && *b != 0 => {
            Ok(Cow::Owned(from_utf16(bytes, u16::from_be_bytes)?))
        }
        _ => checked(bytes).map(Cow::Borrowed),
    }
}

/// Magic numbers of what is taken for a model or scene by mistake.
const MAGIC: &[(&[u8], &str)] = &[
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"glTF", "a binary glTF model"),
    (b"Kaydara FBX", "an FBX model"),
    (b"BLENDER", "a Blender file"),
    (b"PK\x03\x04", "a zip archive"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x7fELF", "a program"),
];

fn checked(bytes: &[u8]) -> Result<&[u8], TextError> {
    if let Some((_, kind)) = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Err(TextError::Binary { kind });
    }
    if memchr::memchr(0, bytes).is_some() {
        return Err(TextError::Binary { kind: "binary data" });
    }
    Ok(bytes)
}

fn from_utf16(bytes: &[u8], unit: impl Fn([u8; 2]) -> u16) -> Result<Vec<u8>, TextError> {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let mut text = Vec::with_capacity(bytes.len() / 2);
    let mut utf8 = [0; 4];
    for letter in char::decode_utf16(units) {
        let letter = letter.unwrap_or(char::REPLACEMENT_CHARACTER);
        text.extend_from_slice(letter.encode_utf8(&mut utf8).as_bytes());
    }
    checked(&text)?;
    Ok(text)
}

/// A name as readable text: UTF-8 if it is that, else taken as Latin-1, which gives every name one reading.
pub fn name_of(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(name) => name.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_of_a_text_reads_alike() {
        let text = "v 1 2 3\nusemtl Größe";
        let le: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let be: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let marked = |mark: &[u8], bytes: &[u8]| [mark, bytes].concat();
        for bytes in [
            text.as_bytes().to_vec(),
            marked(b"\xef\xbb\xbf", text.as_bytes()),
            marked(b"\xff\xfe", &le),
            marked(b"\xfe\xff", &be),
            le.clone(),
            be.clone(),
        ] {
            assert_eq!(decode(&bytes).expect("text"), text.as_bytes());
        }
    }

    #[test]
    fn what_is_no_text_is_refused() {
        for (bytes, kind) in [
            (&b"\x89PNG\r\n"[..], "a PNG picture"),
            (b"v 1 2 3\n\0", "binary data"),
            (b"\xff\xfe\0\0\0\0", "binary data"),
            (b"\xff\xd8\xff\xe0", "a JPEG picture"),
        ] {
            let error = decode(bytes).expect_err("no text").to_string();
            assert_eq!(error, format!("is {kind}, not a text file"));
        }
        assert_eq!(decode(b"").expect("empty"), b"".as_slice());
    }

    #[test]
    fn names_have_one_reading() {
        assert_eq!(name_of("Größe".as_bytes()), "Größe");
        assert_eq!(name_of(b"Gr\xf6\xdfe"), "Größe");
    }
}
