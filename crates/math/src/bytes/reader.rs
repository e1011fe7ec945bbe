use std::error::Error;
use std::fmt;

use crate::{DAffine3, DVec2, DVec3};

use super::ALIGNMENT;

/// Bytes that are not what they should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BytesError {
    /// Which byte, from 0.
    pub at: usize,
    /// What is wrong there.
    pub what: String,
}

impl fmt::Display for BytesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "byte {}: {}", self.at, self.what)
    }
}

impl Error for BytesError {}

/// Goes through bytes that a [`ByteWriter`](super::ByteWriter) made, or somebody else.
#[derive(Clone, Debug)]
pub struct ByteReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> ByteReader<'a> {
    /// At the first byte.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// At byte `at`; behind the end nothing can be read.
    #[must_use]
    pub const fn starting_at(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// How many bytes lie behind.
    #[must_use]
    pub const fn position(&self) -> usize {
        self.at
    }

    /// How many bytes lie ahead.
    #[must_use]
    pub const fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }

    /// An error at this place.
    #[must_use]
    pub fn error(&self, what: impl fmt::Display) -> BytesError {
        BytesError {
            at: self.at,
            what: what.to_string(),
        }
    }

    /// Takes `count` bytes.
    ///
    /// # Errors
    /// There are fewer.
    pub fn raw(&mut self, count: usize) -> Result<&'a [u8], BytesError> {
        let end = self.at.checked_add(count);
        let Some(part) = end.and_then(|end| self.bytes.get(self.at..end)) else {
            return Err(self.error("the data end too early"));
        };
        self.at += count;
        Ok(part)
    }

    fn array_of<const N: usize>(&mut self) -> Result<[u8; N], BytesError> {
        let part = self.raw(N)?;
        let mut array = [0; N];
        array.copy_from_slice(part);
        Ok(array)
    }

    /// Passes the zeros up to where an array may begin.
    ///
    /// # Errors
    /// They are not zeros, or not there.
    pub fn align(&mut self) -> Result<(), BytesError> {
        let gap = self.at.next_multiple_of(ALIGNMENT) - self.at;
        if self.raw(gap)?.iter().any(|&b| b != 0) {
            return Err(self.error("a gap that is not empty"));
        }
        Ok(())
    }

    /// One byte.
    ///
    /// # Errors
    /// There is none.
    pub fn u8(&mut self) -> Result<u8, BytesError> {
        Ok(self.array_of::<1>()?[0])
    }

    /// A truth value.
    ///
    /// # Errors
    /// It is neither 0 nor 1, or not there.
    pub fn bool(&mut self) -> Result<bool, BytesError> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self.error(format_args!("a truth value of {other}"))),
        }
    }

    /// Four bytes.
    ///
    /// # Errors
    /// There are fewer.
    pub fn u32(&mut self) -> Result<u32, BytesError> {
        Ok(u32::from_le_bytes(self.array_of()?))
    }

    /// Four bytes.
    ///
    /// # Errors
    /// There are fewer.
    pub fn i32(&mut self) -> Result<i32, BytesError> {
        Ok(i32::from_le_bytes(self.array_of()?))
    }

    /// Eight bytes.
    ///
    /// # Errors
    /// There are fewer.
    pub fn u64(&mut self) -> Result<u64, BytesError> {
        Ok(u64::from_le_bytes(self.array_of()?))
    }

    /// Any number, also one that is not finite.
    ///
    /// # Errors
    /// There are fewer than eight bytes.
    pub fn f64(&mut self) -> Result<f64, BytesError> {
        Ok(f64::from_bits(self.u64()?))
    }

    /// Two numbers.
    ///
    /// # Errors
    /// There are fewer bytes.
    pub fn vec2(&mut self) -> Result<DVec2, BytesError> {
        Ok(DVec2::new(self.f64()?, self.f64()?))
    }

    /// Three numbers.
    ///
    /// # Errors
    /// There are fewer bytes.
    pub fn vec3(&mut self) -> Result<DVec3, BytesError> {
        Ok(DVec3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    /// Twelve numbers.
    ///
    /// # Errors
    /// There are fewer bytes.
    pub fn affine(&mut self) -> Result<DAffine3, BytesError> {
        let mut columns = [0.0; 12];
        for x in &mut columns {
            *x = self.f64()?;
        }
        Ok(DAffine3::from_cols_array(&columns))
    }

    /// How many things follow, each of at least `bytes_each` bytes: never more than there is room for.
    ///
    /// # Errors
    /// There is no number, or less room.
    pub fn count(&mut self, bytes_each: usize) -> Result<usize, BytesError> {
        let count = self.u64()?;
        let room = self.left() / bytes_each.max(1);
        match usize::try_from(count) {
            Ok(count) if count <= room => Ok(count),
            _ => Err(self.error("more of something than there are bytes")),
        }
    }

    /// A text.
    ///
    /// # Errors
    /// It is longer than what is left, or not UTF-8.
    pub fn str(&mut self) -> Result<&'a str, BytesError> {
        let length = self.count(1)?;
        let bytes = self.raw(length)?;
        std::str::from_utf8(bytes).map_err(|_| self.error("a text that is not UTF-8"))
    }

    /// An array of numbers, also such that are not finite.
    ///
    /// # Errors
    /// There are fewer bytes.
    pub fn f64s(&mut self) -> Result<Vec<f64>, BytesError> {
        self.array(f64::from_le_bytes)
    }

    /// An array of numbers.
    ///
    /// # Errors
    /// There are fewer bytes.
    pub fn u32s(&mut self) -> Result<Vec<u32>, BytesError> {
        self.array(u32::from_le_bytes)
    }

    /// An array of numbers.
    ///
    /// # Errors
    /// There are fewer bytes.
    pub fn i64s(&mut self) -> Result<Vec<i64>, BytesError> {
        self.array(i64::from_le_bytes)
    }

    fn array<T, const N: usize>(&mut self, number: fn([u8; N]) -> T) -> Result<Vec<T>, BytesError> {
        let count = self.u64()?;
        self.align()?;
        let fits = usize::try_from(count).is_ok_and(|count| count <= self.left() / N);
        if !fits {
            return Err(self.error("more numbers than there are bytes"));
        }
        let bytes = self.raw(count as usize * N)?;
        let (chunks, _) = bytes.as_chunks::<N>();
        Ok(chunks.iter().map(|chunk| number(*chunk)).collect())
    }

    /// Ends the reading.
    ///
    /// # Errors
    /// There are bytes left.
    pub fn finish(&self) -> Result<(), BytesError> {
        if self.left() == 0 {
            Ok(())
        } else {
            Err(self.error("data behind the end"))
        }
    }
}
