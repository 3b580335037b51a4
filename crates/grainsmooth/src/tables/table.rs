use std::fmt::{self, Write as _};
use std::io::{self, Write};

use polycrystal::GrainId;
use rayon::prelude::*;
use serde::ser::{Serialize, Serializer};

/// Rows of values under named columns: written as CSV, or as a list of JSON objects.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Table {
    pub(crate) columns: Vec<&'static str>,
    pub(crate) rows: Vec<Vec<Value>>,
}

/// One value of a table.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub(crate) enum Value {
    Integer(i64),
    /// Not finite: null in JSON, empty in CSV.
    Number(f64),
    /// Blanks between them in CSV.
    Integers(Vec<i64>),
    Numbers(Vec<f64>),
    /// A column for each coordinate in CSV.
    Point(Vec<f64>),
    Flag(bool),
}

/// A column's name, and its value for each row's item.
type Column<'a, T> = (&'static str, &'a dyn Fn(&T) -> Value);

impl Table {
    /// A row for each item.
    pub(crate) fn new<T>(items: &[T], columns: &[Column<'_, T>]) -> Self {
        let row = |item: &T| columns.iter().map(|(_, value)| value(item)).collect();
        let names = columns.iter().map(|(name, _)| *name).collect();
        Self { columns: names, rows: items.iter().map(row).collect() }
    }

    /// Adds a column behind the others, with a value for each row.
    pub(crate) fn add_column(&mut self, name: &'static str, value: impl Fn(&[Value]) -> Value) {
        self.columns.push(name);
        self.rows.iter_mut().for_each(|row| row.push(value(row)));
    }

    /// Writes a header line, then one line a row.
    pub(crate) fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        let first: &[Value] = self.rows.first().map_or(&[], |row| row);
        let header = (0..).zip(&self.columns).flat_map(|(k, name): (usize, _)| match first.get(k) {
            Some(value) => value.names_in_csv(name),
            None => vec![(*name).to_owned()],
        });
        let line = |index: usize, text: &mut String| push_csv_line(&self.rows[index], text);
        write_csv(&header.collect::<Vec<_>>(), self.rows.len(), line, out)
    }
}

/// Lines that a thread puts into words at once: some hundred kilobytes of text.
const LINES_AT_ONCE: usize = 1024;

/// Writes a header and so many lines, which threads put into words side by side.
pub(crate) fn write_csv(
    header: &[String],
    count: usize,
    push_line: impl Fn(usize, &mut String) + Sync,
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "{}", header.join(","))?;
    let at_once = LINES_AT_ONCE * rayon::current_num_threads();
    for first in (0..count).step_by(at_once) {
        let last = count.min(first + at_once);
        let parts = (first..last).into_par_iter().step_by(LINES_AT_ONCE);
        let in_words = |start: usize| {
            let mut text = String::new();
            (start..last.min(start + LINES_AT_ONCE)).for_each(|index| push_line(index, &mut text));
            text
        };
        let texts: Vec<String> = parts.map(in_words).collect();
        texts.iter().try_for_each(|text| out.write_all(text.as_bytes()))?;
    }
    Ok(())
}

/// Adds values as a line of CSV: none has a comma or a quote of its own.
pub(crate) fn push_csv_line<'a>(values: impl IntoIterator<Item = &'a Value>, text: &mut String) {
    for value in values {
        value.push_csv(text);
        text.push(',');
    }
    text.pop();
    text.push('\n');
}

/// Adds numbers in words, with something between them.
fn push_joined<T>(numbers: &[T], between: char, push: impl Fn(&T, &mut String), text: &mut String) {
    for (place, number) in numbers.iter().enumerate() {
        if place > 0 {
            text.push(between);
        }
        push(number, text);
    }
}

fn axis_names(count: usize, before: &str) -> Vec<String> {
    ["x", "y", "z"][..count].iter().map(|axis| format!("{before}{axis}")).collect()
}

impl Value {
    /// The number as that of a grain; nothing for that of the exterior.
    pub(crate) fn grain(&self) -> Option<GrainId> {
        match self {
            Self::Integer(number) => u32::try_from(*number).ok().map(GrainId),
            _ => None,
        }
    }

    /// The names of its columns in CSV, in a column of some name.
    pub(crate) fn names_in_csv(&self, name: &str) -> Vec<String> {
        match self {
            // A seed has the names that `--seeds-file` reads.
            Self::Point(point) if name == "seed" => axis_names(point.len(), ""),
            Self::Point(point) => axis_names(point.len(), &format!("{name}_")),
            _ => vec![name.to_owned()],
        }
    }

    fn push_csv(&self, text: &mut String) {
        fn push(value: impl fmt::Display, text: &mut String) {
            write!(text, "{value}").expect("text grows");
        }
        fn push_number(value: &f64, text: &mut String) {
            if value.is_finite() {
                push(format_args!("{value:?}"), text);
            }
        }
        match self {
            Self::Integer(value) => push(value, text),
            Self::Number(value) => push_number(value, text),
            Self::Integers(values) => push_joined(values, ' ', |value, text| push(value, text), text),
            Self::Numbers(values) => push_joined(values, ' ', push_number, text),
            Self::Point(values) => push_joined(values, ',', push_number, text),
            Self::Flag(value) => push(value, text),
        }
    }
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let row = |row: &Vec<Value>| Row(self.columns.iter().copied().zip(row.iter().cloned()).collect());
        serializer.collect_seq(self.rows.iter().map(row))
    }
}

/// A row as an object of JSON.
pub(crate) struct Row(pub(crate) Vec<(&'static str, Value)>);

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}
