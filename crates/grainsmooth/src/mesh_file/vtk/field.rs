//! Field data at the head of a legacy file, which VTK and this program write and `vtkio` does not know.

use std::borrow::Cow;

/// The file without the field data that follow its `DATASET` line; unchanged where there are none or they make no sense.
pub(super) fn without_field_data(bytes: &[u8]) -> Cow<'_, [u8]> {
    match field_data(bytes) {
        Some((start, end)) => Cow::Owned([&bytes[..start], &bytes[end..]].concat()),
        None => Cow::Borrowed(bytes),
    }
}

/// Where the field data begin and end.
fn field_data(bytes: &[u8]) -> Option<(usize, usize)> {
    let mut reader = Reader { bytes, at: 0 };
    reader.line()?;
    reader.line()?;
    let is_binary = reader.line()?.trim() == "BINARY";
    while !reader.line()?.trim().starts_with("DATASET") {}
    let start = reader.at;
    let head = reader.line()?;
    let mut words = head.split_whitespace();
    if words.next()? != "FIELD" {
        return None;
    }
    let array_count: usize = words.nth(1)?.parse().ok()?;
    for _ in 0..array_count {
        let mut head = reader.line()?;
        while head.trim().is_empty() {
            head = reader.line()?;
        }
        let words: Vec<&str> = head.split_whitespace().collect();
        let [_, components, tuples, kind] = words[..] else { return None };
        let count = components.parse::<usize>().ok()?.checked_mul(tuples.parse().ok()?)?;
        for _ in 0..if kind == "string" { count } else { 0 } {
            if is_binary {
                let length = reader.string_length()?;
                reader.skip(length)?;
            } else {
                reader.line()?;
            }
        }
        if kind == "string" {
            continue;
        }
        if is_binary {
            reader.skip(count.checked_mul(width(kind)?)?)?;
        } else {
            reader.skip_words(count)?;
        }
    }
    Some((start, reader.at))
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
}

impl Reader<'_> {
    fn line(&mut self) -> Option<String> {
        let rest = self.bytes.get(self.at..)?;
        let length = rest.iter().position(|&byte| byte == b'\n')?;
        self.at += length + 1;
        Some(String::from_utf8_lossy(&rest[..length]).into_owned())
    }

    fn skip(&mut self, count: usize) -> Option<()> {
        self.at = self.at.checked_add(count).filter(|&at| at <= self.bytes.len())?;
        Some(())
    }

    fn skip_words(&mut self, count: usize) -> Option<()> {
        for _ in 0..count {
            let is_blank = |byte: &&u8| byte.is_ascii_whitespace();
            self.at += self.bytes.get(self.at..)?.iter().take_while(is_blank).count();
            let length = self.bytes[self.at..].iter().take_while(|byte| !is_blank(byte)).count();
            (length > 0).then_some(())?;
            self.at += length;
        }
        Some(())
    }

    /// The length of a binary string: its two highest bits say in how many bytes it is stored.
    fn string_length(&mut self) -> Option<usize> {
        let (width, length_bits) = match self.bytes.get(self.at)? >> 6 {
            3 => (1, 6),
            2 => (2, 14),
            1 => (4, 30),
            _ => (8, 62),
        };
        let stored = self.bytes.get(self.at..self.at + width)?;
        self.at += width;
        let number = stored.iter().fold(0_u64, |number, &byte| number << 8 | u64::from(byte));
        usize::try_from(number & (u64::MAX >> (64 - length_bits))).ok()
    }
}
