//! Tables in text files: lines of columns, whose names the first line may give.

use std::io::Cursor;

/// What is wrong with the text of a table, and what to do about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum TextProblem {
    /// The line is not text.
    #[error("not UTF-8 text; save the file as UTF-8")]
    NotUtf8,
    /// A quoted column goes on in the next line, as where its second quote is missing.
    #[error("a quote is not closed on its line; close or remove it")]
    OpenQuote,
}

/// The line of a fault, counted from 1, and what it is.
type Fault = (usize, TextProblem);

/// A line of a table.
pub(crate) struct Row {
    /// Its place in the file, counted from 1.
    pub line: usize,
    record: csv::StringRecord,
    /// Whether columns stand between blanks in the whole file.
    is_blank_separated: bool,
}

impl Row {
    /// The columns without the blanks around them and without quotes.
    pub(crate) fn columns(&self) -> Vec<&str> {
        match (self.is_blank_separated, self.record.len()) {
            (true, _) => self.record.iter().filter(|text| !text.is_empty()).collect(),
            (false, 1) => self.record[0].split_whitespace().collect(),
            (false, _) => self.record.iter().collect(),
        }
    }
}

/// Whether columns are names: none of them is a number.
pub(crate) fn are_names(columns: &[&str]) -> bool {
    columns.iter().all(|column| column.parse::<f64>().is_err())
}

/// The lines of a file without blanks around them, and their places, counted from 1.
pub(crate) fn lines(content: &[u8]) -> impl Iterator<Item = Result<(usize, &str), Fault>> {
    let lines = (1..).zip(content.split(|&byte| byte == b'\n'));
    lines.map(|(place, bytes)| line(bytes).map(|text| (place, text)).map_err(|problem| (place, problem)))
}

fn line(bytes: &[u8]) -> Result<&str, TextProblem> {
    let text = std::str::from_utf8(bytes).map_err(|_| TextProblem::NotUtf8)?;
    // Some editors begin a file with this invisible mark.
    Ok(text.trim_start_matches('\u{feff}').trim())
}

/// The lines of a table. Empty lines, and comments, which begin with `#` and may have any coding, are left out.
///
/// Columns stand between semicolons where the first line has them, else between commas; in lines without, between blanks or tabs. They may
/// be quoted.
///
/// # Errors
/// The line and what is wrong with its text.
pub(crate) fn rows(content: &[u8]) -> Result<impl Iterator<Item = Result<Row, Fault>>, Fault> {
    // The `csv` crate says of a record after comments the line where the comments began.
    let (mut text, mut places) = (String::new(), Vec::new());
    for (place, bytes) in (1..).zip(content.split(|&byte| byte == b'\n')) {
        let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
        if bytes.trim_ascii_start().starts_with(b"#") {
            continue;
        }
        let line = line(bytes).map_err(|problem| (place, problem))?;
        if !line.is_empty() {
            text.extend([line, "\n"]);
            places.push(place);
        }
    }
    // Where the last line leaves a quote open, this line ends up inside.
    text.push('\n');
    let delimiter = match text.lines().next() {
        Some(first) if first.contains(';') => b';',
        _ if text.contains(',') => b',',
        _ => b' ',
    };
    let is_blank_separated = delimiter == b' ';
    if is_blank_separated {
        text = text.replace('\t', " ");
    }
    let mut reader = csv::ReaderBuilder::new();
    reader.has_headers(false).flexible(true).delimiter(delimiter).trim(csv::Trim::All);
    let mut reader = reader.from_reader(Cursor::new(text));
    Ok(std::iter::from_fn(move || {
        let mut record = csv::StringRecord::new();
        if !reader.read_record(&mut record).expect("text in memory, with any number of columns") {
            return None;
        }
        let first = record.position().map_or(1, csv::Position::line);
        let line = places[usize::try_from(first).unwrap_or(1).saturating_sub(1)];
        if reader.position().line() > first + 1 {
            return Some(Err((line, TextProblem::OpenQuote)));
        }
        Some(Ok(Row { line, record, is_blank_separated }))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(content: &[u8]) -> Result<Vec<(usize, Vec<String>)>, Fault> {
        let owned = |row: Row| (row.line, row.columns().into_iter().map(str::to_owned).collect());
        rows(content)?.map(|row| row.map(owned)).collect()
    }

    #[test]
    fn separators_in_quotes_separate_nothing() {
        let rows = table(b"\xef\xbb\xbf# made by hand\n\"mean, in um\"; diameter\n\n 1;\"2\" \n").unwrap();
        let row = |line, columns: [&str; 2]| (line, columns.map(str::to_owned).to_vec());
        assert_eq!(rows, [row(2, ["mean, in um", "diameter"]), row(4, ["1", "2"])]);
    }

    #[test]
    fn only_comments_may_have_any_coding() {
        assert_eq!(table(b"# \xb5m\n1 \t 2\n").unwrap().len(), 1);
        assert_eq!(table(b"# \xb5m\n1\n\xb5m\n").unwrap_err(), (3, TextProblem::NotUtf8));
        assert_eq!(table(b"1\n\"2\n3\n").unwrap_err(), (2, TextProblem::OpenQuote));
    }
}
