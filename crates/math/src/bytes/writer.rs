use crate::{DAffine3, DVec2, DVec3};

use super::ALIGNMENT;

/// Bytes that grow.
#[derive(Clone, Debug, Default)]
pub struct ByteWriter {
    bytes: Vec<u8>,
}

impl ByteWriter {
    /// No bytes yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// All of them.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// All of them so far.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Writes these as they are.
    pub fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Writes zeros up to where an array may begin.
    pub fn align(&mut self) {
        let length = self.bytes.len().next_multiple_of(ALIGNMENT);
        self.bytes.resize(length, 0);
    }

    /// Writes one byte.
    pub fn u8(&mut self, value: u8) {
        self.bytes.push(value);
    }

    /// Writes 0 or 1.
    pub fn bool(&mut self, value: bool) {
        self.u8(u8::from(value));
    }

    /// Writes four bytes.
    pub fn u32(&mut self, value: u32) {
        self.raw(&value.to_le_bytes());
    }

    /// Writes four bytes.
    pub fn i32(&mut self, value: i32) {
        self.raw(&value.to_le_bytes());
    }

    /// Writes eight bytes.
    pub fn u64(&mut self, value: u64) {
        self.raw(&value.to_le_bytes());
    }

    /// Writes the bits of a number.
    pub fn f64(&mut self, value: f64) {
        self.u64(value.to_bits());
    }

    /// Writes two numbers.
    pub fn vec2(&mut self, v: DVec2) {
        v.to_array().into_iter().for_each(|x| self.f64(x));
    }

    /// Writes three numbers.
    pub fn vec3(&mut self, v: DVec3) {
        v.to_array().into_iter().for_each(|x| self.f64(x));
    }

    /// Writes twelve numbers, column by column.
    pub fn affine(&mut self, map: &DAffine3) {
        map.to_cols_array().into_iter().for_each(|x| self.f64(x));
    }

    /// Writes the length of a text and the text.
    pub fn str(&mut self, text: &str) {
        self.u64(text.len() as u64);
        self.raw(text.as_bytes());
    }

    /// Writes how many numbers there are and, aligned, the numbers.
    pub fn f64s(&mut self, values: &[f64]) {
        self.array(values, |x| x.to_bits().to_le_bytes());
    }

    /// Writes how many numbers there are and, aligned, the numbers.
    pub fn u32s(&mut self, values: &[u32]) {
        self.array(values, |x| x.to_le_bytes());
    }

    /// Writes how many numbers there are and, aligned, the numbers.
    pub fn i64s(&mut self, values: &[i64]) {
        self.array(values, |x| x.to_le_bytes());
    }

    fn array<T: Copy, const N: usize>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; N]) {
        self.u64(values.len() as u64);
        self.align();
        self.bytes.reserve(values.len() * N);
        for &value in values {
            self.bytes.extend_from_slice(&bytes(value));
        }
    }
}
