//! Field data at the head of a legacy file, which VTK and this program write and `vtkio` does not know.

use std::borrow::Cow;
use std::ops::Range;
use std::str::FromStr;

use super::labelled::Notes;
use crate::names::FIELD_NAMES;
use crate::vtk::{DataArray, DataNumbers, FieldValue};

/// Where the field data stand that follow the `DATASET` line, and what they say; nothing where there are none or they make no sense.
pub(super) fn field_data(bytes: &[u8]) -> Option<(Range<usize>, Notes)> {
    let mut reader = Reader { bytes, at: 0, is_binary: false };
    reader.line()?;
    reader.line()?;
    reader.is_binary = reader.line()?.trim() == "BINARY";
    while !reader.line()?.trim().starts_with("DATASET") {}
    let start = reader.at;
    let head = reader.line()?;
    let mut words = head.split_whitespace();
    if words.next()? != "FIELD" {
        return None;
    }
    let array_count: usize = words.nth(1)?.parse().ok()?;
    let mut notes = Notes::default();
    for _ in 0..array_count {
        let head = reader.array_head()?;
        let words: Vec<&str> = head.split_whitespace().collect();
        let [name, components, tuples, kind] = words[..] else { return None };
        let count = components.parse::<usize>().ok()?.checked_mul(tuples.parse().ok()?)?;
        let components = components.parse().ok().filter(|count| *count > 0)?;
        let data = |numbers| FieldValue::Data(DataArray { name: name.to_owned(), components, numbers });
        match kind {
            "string" => {
                for _ in 0..count {
                    notes.note(name, FieldValue::Text(reader.text()?));
                }
            }
            // A .vtu of this program has its texts as bytes, and what VTK makes of it too.
            "unsigned_char" => {
                let bytes = if reader.is_binary {
                    reader.bytes(count)?.to_vec()
                } else {
                    (0..count).map(|_| reader.number()).collect::<Option<_>>()?
                };
                let is_text = FIELD_NAMES.iter().any(|(known, is_text)| known == &name && *is_text);
                notes.note(
                    name,
                    match is_text {
                        true => FieldValue::Text(String::from_utf8_lossy(&bytes).into_owned()),
                        false => data(DataNumbers::UInt8(bytes)),
                    },
                );
            }
            "double" => {
                notes.note(name, data(DataNumbers::Float64(reader.numbers(count)?)));
            }
            "int" | "vtktypeint32" => {
                let numbers: Option<Vec<i32>> = match reader.is_binary {
                    true => {
                        let bytes = reader.bytes(count.checked_mul(size_of::<i32>())?)?;
                        Some(bytes.as_chunks().0.iter().map(|number| i32::from_be_bytes(*number)).collect())
                    }
                    false => (0..count).map(|_| reader.number()).collect(),
                };
                notes.note(name, data(DataNumbers::Int32(numbers?)));
            }
            "vtktypeuint64" if count == 1 => {
                let number = match reader.is_binary {
                    true => u64::from_be_bytes(reader.bytes(size_of::<u64>())?.try_into().ok()?),
                    false => reader.number()?,
                };
                notes.note(name, FieldValue::Integer(number));
            }
            _ if reader.is_binary => reader.skip(count.checked_mul(width(kind)?)?)?,
            _ => (0..count).try_for_each(|_| reader.word().map(|_| ()))?,
        }
    }
    reader.skip_metadata()?;
    Some((start..reader.at, notes))
}

fn width(kind: &str) -> Option<usize> {
    Some(match kind {
        "char" | "signed_char" | "unsigned_char" | "vtktypeint8" | "vtktypeuint8" => 1,
        "short" | "unsigned_short" => 2,
        "int" | "unsigned_int" | "float" | "vtktypeint32" | "vtktypeuint32" => 4,
        "long" | "unsigned_long" | "double" | "vtktypeint64" | "vtktypeuint64" | "vtkIdType" => 8,
        _ => return None,
    })
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    is_binary: bool,
}

impl<'a> Reader<'a> {
    fn line(&mut self) -> Option<Cow<'a, str>> {
        let rest = self.bytes.get(self.at..)?;
        let length = rest.iter().position(|&byte| byte == b'\n')?;
        self.at += length + 1;
        Some(String::from_utf8_lossy(&rest[..length]))
    }

    /// The line at the head of the next array.
    fn array_head(&mut self) -> Option<Cow<'a, str>> {
        self.skip_metadata()?;
        loop {
            let line = self.line()?;
            if !line.trim().is_empty() {
                return Some(line);
            }
        }
    }

    /// Passes over what VTK notes on the array before: `METADATA`, up to an empty line.
    fn skip_metadata(&mut self) -> Option<()> {
        let start = self.at;
        while let Some(line) = self.line() {
            match line.trim() {
                "" => {}
                "METADATA" => {
                    while !self.line()?.trim().is_empty() {}
                    return Some(());
                }
                _ => break,
            }
        }
        self.at = start;
        Some(())
    }

    fn skip(&mut self, count: usize) -> Option<()> {
        self.bytes(count).map(|_| ())
    }

    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let bytes = self.bytes.get(self.at..self.at.checked_add(count)?)?;
        self.at += count;
        Some(bytes)
    }

    /// What stands up to the next blank.
    fn word(&mut self) -> Option<&'a [u8]> {
        let is_blank = |byte: &&u8| byte.is_ascii_whitespace();
        self.at += self.bytes.get(self.at..)?.iter().take_while(is_blank).count();
        let length = self.bytes[self.at..].iter().take_while(|byte| !is_blank(byte)).count();
        self.bytes(length).filter(|word| !word.is_empty())
    }

    fn numbers(&mut self, count: usize) -> Option<Vec<f64>> {
        if self.is_binary {
            let bytes = self.bytes(count.checked_mul(size_of::<f64>())?)?;
            return Some(bytes.as_chunks().0.iter().map(|number| f64::from_be_bytes(*number)).collect());
        }
        (0..count).map(|_| self.number()).collect()
    }

    /// The next number of a text.
    fn number<T: FromStr>(&mut self) -> Option<T> {
        str::from_utf8(self.word()?).ok()?.parse().ok()
    }

    fn text(&mut self) -> Option<String> {
        if self.is_binary {
            let length = self.text_length()?;
            return Some(String::from_utf8_lossy(self.bytes(length)?).into_owned());
        }
        self.line().map(|line| percent_decoded(&line))
    }

    /// The length of a binary text: its two highest bits say in how many bytes it is stored.
    fn text_length(&mut self) -> Option<usize> {
        let (width, length_bits) = match self.bytes.get(self.at)? >> 6 {
            3 => (1, 6),
            2 => (2, 14),
            1 => (4, 30),
            _ => (8, 62),
        };
        let number = self.bytes(width)?.iter().fold(0_u64, |number, &byte| number << 8 | u64::from(byte));
        usize::try_from(number & (u64::MAX >> (64 - length_bits))).ok()
    }
}

/// A text as it was before VTK put `%20` for each blank, and so on.
fn percent_decoded(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| byte == b'%').and_then(|code| str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(decoded) => {
                bytes.push(decoded);
                rest = &after[2..];
            }
            None => {
                bytes.push(byte);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
