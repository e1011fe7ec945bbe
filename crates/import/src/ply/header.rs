//! The header of a PLY file: what the rows of its body are made of.

use crate::text::{Lines, Word, Words};
use crate::{Diagnostics, SourceId, Span};

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A number of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) const fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// The type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A column of an element.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// A table of the body.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// The line that declares it.
    pub span: Span,
}

impl Element {
    /// The column of this name.
    pub(super) fn column(&self, names: &[&str]) -> Option<usize> {
        names
            .iter()
            .find_map(|name| self.properties.iter().position(|p| p.name == *name))
    }

    /// No row of the body is shorter than this many bytes.
    pub(super) fn least_row_length(&self, format: Format) -> u64 {
        self.properties
            .iter()
            .map(|property| match (format, property.kind) {
                // A digit and a blank.
                (Format::Ascii, _) => 2,
                (_, Kind::One(scalar)) => scalar.size() as u64,
                (_, Kind::List { count, .. }) => count.size() as u64,
            })
            .sum()
    }
}

/// Everything before the body.
#[derive(Debug)]
pub(super) struct Header {
    pub format: Format,
    pub elements: Vec<Element>,
    /// The first byte of the body.
    pub body: usize,
}

/// Reads the header, or reports why there is none.
pub(super) fn read(
    bytes: &[u8],
    source: SourceId,
    diagnostics: &mut Diagnostics,
) -> Option<Header> {
    let mut lines = Lines::new(bytes, 0);
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    let whole = |(start, end): (usize, usize)| Span::new(source, start..end);
    let first = lines.next()?;
    if bytes[first.0..first.1].trim_ascii() != b"ply" {
        diagnostics.error(whole(first), "a PLY file begins with the line `ply`");
        return None;
    }
    while let Some(line) = lines.next() {
        let mut words = Words::new(bytes, line.0, line.1);
        let Some(keyword) = words.next() else {
            continue;
        };
        match keyword.bytes {
            b"comment" | b"obj_info" => {}
            b"format" => format = read_format(keyword, words, source, diagnostics),
            b"element" => {
                let element = read_element(whole(line), words, source, diagnostics)?;
                if elements.iter().any(|e| e.name == element.name) {
                    let message = format!("there are two elements `{}`", element.name);
                    diagnostics.error(whole(line), message);
                    return None;
                }
                elements.push(element);
            }
            b"property" => {
                let property = read_property(whole(line), words, source, diagnostics)?;
                match elements.last_mut() {
                    Some(element) => element.properties.push(property),
                    None => {
                        diagnostics.error(whole(line), "a property before the first element");
                        return None;
                    }
                }
            }
            b"end_header" => {
                let body = lines.offset();
                if format.is_none() && !diagnostics.has_errors() {
                    diagnostics.error(whole(first), "the header has no `format` line");
                }
                return Some(Header {
                    format: format?,
                    elements,
                    body,
                });
            }
            _ => {
                let message = format!("`{}` is no keyword of a PLY header", keyword.shown());
                diagnostics.error(keyword.span(source), message);
                // What follows may be no header at all.
                return None;
            }
        }
    }
    let end = Span::new(source, bytes.len()..bytes.len());
    diagnostics.error(end, "the file ends inside the header, before `end_header`");
    None
}

fn read_format(
    keyword: Word<'_>,
    mut words: Words<'_>,
    source: SourceId,
    diagnostics: &mut Diagnostics,
) -> Option<Format> {
    let Some(name) = words.next() else {
        diagnostics.error(keyword.span(source), "`format` must name a format");
        return None;
    };
    let format = match name.bytes {
        b"ascii" => Format::Ascii,
        b"binary_little_endian" => Format::LittleEndian,
        b"binary_big_endian" => Format::BigEndian,
        _ => {
            let message = format!(
                "`{}` is no format of PLY: ascii, binary_little_endian or binary_big_endian",
                name.shown()
            );
            diagnostics.error(name.span(source), message);
            return None;
        }
    };
    if let Some(version) = words.next()
        && version.bytes != b"1.0"
    {
        let message = format!("version {} is read as 1.0", version.shown());
        diagnostics.warning(version.span(source), message);
    }
    Some(format)
}

fn read_element(
    line: Span,
    mut words: Words<'_>,
    source: SourceId,
    diagnostics: &mut Diagnostics,
) -> Option<Element> {
    let (Some(name), Some(count)) = (words.next(), words.next()) else {
        diagnostics.error(line, "an element has a name and a number of rows");
        return None;
    };
    let Some(rows) = count.integer().and_then(|n| u64::try_from(n).ok()) else {
        let message = format!("`{}` is no number of rows", count.shown());
        diagnostics.error(count.span(source), message);
        return None;
    };
    Some(Element {
        name: name.text().into_owned(),
        count: rows,
        properties: Vec::new(),
        span: line,
    })
}

fn read_property(
    line: Span,
    mut words: Words<'_>,
    source: SourceId,
    diagnostics: &mut Diagnostics,
) -> Option<Property> {
    let mut scalar = |word: Option<Word<'_>>| {
        let Some(word) = word else {
            diagnostics.error(line, "a property has a type and a name");
            return None;
        };
        let scalar = Scalar::named(word.bytes);
        if scalar.is_none() {
            let message = format!("`{}` is no type of PLY", word.shown());
            diagnostics.error(word.span(source), message);
        }
        scalar
    };
    let first = words.next();
    let kind = if first.is_some_and(|w| w.bytes == b"list") {
        let (count, item) = (scalar(words.next())?, scalar(words.next())?);
        Kind::List { count, item }
    } else {
        Kind::One(scalar(first)?)
    };
    if let Kind::List { count, .. } = kind
        && !count.is_integer()
    {
        diagnostics.error(line, "the length of a list must have an integer type");
        return None;
    }
    let Some(name) = words.next() else {
        diagnostics.error(line, "a property has a type and a name");
        return None;
    };
    Some(Property {
        name: name.text().into_owned(),
        kind,
    })
}
