//! The rows of a PLY body, one after the other, as numbers.

use std::ops::Range;

use super::header::{Element, Format, Kind, Scalar};
use crate::text::{Lines, Words};
use crate::{Diagnostics, SourceId, Span};

/// The body from the place that has been read up to.
#[derive(Debug)]
pub(super) struct Body<'a> {
    bytes: &'a [u8],
    at: usize,
    format: Format,
    source: SourceId,
}

/// The numbers of one row. Every type of PLY fits into an `f64` exactly.
#[derive(Debug, Default)]
pub(super) struct Row {
    values: Vec<f64>,
    columns: Vec<Range<usize>>,
    /// Its bytes in the file.
    pub place: Range<usize>,
}

impl Row {
    /// The number in a column; of a list, its first (0 of an empty one).
    pub(super) fn number(&self, column: usize) -> f64 {
        self.list(column).first().copied().unwrap_or(0.0)
    }

    /// The numbers in a column.
    pub(super) fn list(&self, column: usize) -> &[f64] {
        let range = self.columns.get(column).cloned().unwrap_or_default();
        &self.values[range]
    }
}

/// What is wrong in a row, and where.
#[derive(Debug)]
pub(super) struct BadRow {
    place: Range<usize>,
    message: String,
    /// Whether it is known where the next row starts.
    pub next_is_known: bool,
}

impl<'a> Body<'a> {
    pub(super) const fn new(
        bytes: &'a [u8],
        start: usize,
        format: Format,
        source: SourceId,
    ) -> Self {
        Self {
            bytes,
            at: start,
            format,
            source,
        }
    }

    /// Bytes not yet read.
    pub(super) const fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Adds an error at a place of the body: a line where it is text, a byte where it is not.
    pub(super) fn error(&self, place: Range<usize>, message: &str, diagnostics: &mut Diagnostics) {
        if self.format == Format::Ascii {
            diagnostics.error(Span::new(self.source, place), message);
        } else {
            diagnostics.error(None, format!("at byte {}: {message}", place.start));
        }
    }

    /// Adds the error of a row.
    pub(super) fn report(&self, bad: &BadRow, diagnostics: &mut Diagnostics) {
        self.error(bad.place.clone(), &bad.message, diagnostics);
    }

    /// Reads the next row of `element` into `row`.
    pub(super) fn read_row(&mut self, element: &Element, row: &mut Row) -> Result<(), BadRow> {
        row.values.clear();
        row.columns.clear();
        if self.format == Format::Ascii {
            self.read_line(element, row)
        } else {
            self.read_binary(element, row)
        }
    }

    fn read_line(&mut self, element: &Element, row: &mut Row) -> Result<(), BadRow> {
        let mut lines = Lines::new(self.bytes, self.at);
        let is_blank = |line: &(usize, usize)| self.bytes[line.0..line.1].trim_ascii().is_empty();
        let line = lines.by_ref().find(|line| !is_blank(line));
        self.at = lines.offset();
        let Some((start, end)) = line else {
            return Err(BadRow {
                place: self.bytes.len()..self.bytes.len(),
                message: format!("the file ends before all rows of `{}`", element.name),
                next_is_known: false,
            });
        };
        row.place = start..end;
        let bad = |place: Range<usize>, message: String| BadRow {
            place,
            message,
            next_is_known: true,
        };
        let mut words = Words::new(self.bytes, start, end);
        let mut next = |what: &str| {
            let Some(word) = words.next() else {
                return Err(bad(start..end, format!("this row has no {what}")));
            };
            let place = word.start..word.start + word.bytes.len();
            let value = word.number();
            value.ok_or_else(|| bad(place, format!("`{}` is not a number", word.shown())))
        };
        for property in &element.properties {
            let first = row.values.len();
            match property.kind {
                Kind::One(_) => row.values.push(next(&property.name)?),
                Kind::List { .. } => {
                    let length = next(&property.name)?;
                    let most = (end - start) as f64;
                    if !(length >= 0.0 && length <= most && libm::trunc(length) == length) {
                        let message =
                            format!("`{}` cannot have {length} items here", property.name);
                        return Err(bad(start..end, message));
                    }
                    for _ in 0..length as usize {
                        row.values.push(next(&property.name)?);
                    }
                }
            }
            row.columns.push(first..row.values.len());
        }
        if words.next().is_some() {
            let message = format!("this row has more values than `{}` has", element.name);
            return Err(bad(start..end, message));
        }
        Ok(())
    }

    fn read_binary(&mut self, element: &Element, row: &mut Row) -> Result<(), BadRow> {
        let start = self.at;
        for property in &element.properties {
            let first = row.values.len();
            let (count, item) = match property.kind {
                Kind::One(scalar) => (1, scalar),
                Kind::List { count, item } => {
                    let length = self.scalar(count, element)?;
                    if length < 0.0 {
                        return Err(BadRow {
                            place: start..self.at,
                            message: format!("`{}` cannot have {length} items", property.name),
                            next_is_known: false,
                        });
                    }
                    (length as usize, item)
                }
            };
            if count > self.left() / item.size() {
                return Err(self.truncated(element, start));
            }
            for _ in 0..count {
                let value = self.scalar(item, element)?;
                row.values.push(value);
            }
            row.columns.push(first..row.values.len());
        }
        row.place = start..self.at;
        Ok(())
    }

    fn truncated(&self, element: &Element, start: usize) -> BadRow {
        BadRow {
            place: start..self.bytes.len(),
            message: format!(
                "the file ends (at byte {}) before all rows of `{}`",
                self.bytes.len(),
                element.name
            ),
            next_is_known: false,
        }
    }

    fn scalar(&mut self, scalar: Scalar, element: &Element) -> Result<f64, BadRow> {
        let size = scalar.size();
        let Some(bytes) = self.bytes.get(self.at..self.at + size) else {
            return Err(self.truncated(element, self.at));
        };
        // Little-endian, padded with zeros.
        let mut b = [0_u8; 8];
        b[..size].copy_from_slice(bytes);
        if self.format == Format::BigEndian {
            b[..size].reverse();
        }
        self.at += size;
        Ok(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes([b[0]])),
            Scalar::U8 => f64::from(b[0]),
            Scalar::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
            Scalar::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
            Scalar::I32 => f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            Scalar::U32 => f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            Scalar::F32 => f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            Scalar::F64 => f64::from_le_bytes(b),
        })
    }
}
