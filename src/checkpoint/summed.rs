//! Bytes that are summed up on their way, so that damage is found.

use std::io::{self, Error, Read, Write};

/// The bytes of a checksum.
pub(super) const SUM_BYTES: usize = 8;

/// How many bytes are summed up at a time; one by one takes longer.
const AT_ONCE: usize = 1 << 16;

/// The checksum of bytes that are at hand.
pub(super) fn checksum(bytes: &[u8]) -> [u8; SUM_BYTES] {
    start_of(&blake3::hash(bytes))
}

fn start_of(hash: &blake3::Hash) -> [u8; SUM_BYTES] {
    std::array::from_fn(|k| hash.as_bytes()[k])
}

/// A reader or writer all of whose bytes are in the checksum.
pub(super) struct Summed<T> {
    inner: T,
    hasher: blake3::Hasher,
    pending: Vec<u8>,
    failure: Option<Error>,
}

impl<T> Summed<T> {
    pub(super) fn new(inner: T) -> Self {
        let pending = Vec::with_capacity(AT_ONCE);
        Self { inner, hasher: blake3::Hasher::new(), pending, failure: None }
    }

    /// Takes in bytes, which may have gone another way.
    pub(super) fn add(&mut self, bytes: &[u8]) {
        if self.pending.len() + bytes.len() > AT_ONCE {
            self.hasher.update(&self.pending);
            self.pending.clear();
        }
        self.pending.extend_from_slice(bytes);
    }

    /// The checksum of all bytes, and how many they are.
    pub(super) fn sum(mut self) -> ([u8; SUM_BYTES], u64) {
        self.hasher.update(&self.pending);
        (start_of(&self.hasher.finalize()), self.hasher.count())
    }

    /// Why the inner one failed, if it did.
    pub(super) fn take_failure(&mut self) -> Option<Error> {
        self.failure.take()
    }
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.add(&buffer[..count]);
        Ok(count)
    }
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(buffer);
        match written {
            Ok(count) => self.add(&buffer[..count]),
            Err(error) => {
                let kind = error.kind();
                self.failure = Some(error);
                return Err(kind.into());
            }
        }
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
