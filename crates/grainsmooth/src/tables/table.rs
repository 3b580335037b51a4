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

impl Table {
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
        let line = |index: usize| self.rows[index].iter().flat_map(Value::in_csv).collect();
        write_csv(header.collect(), self.rows.len(), line, out)
    }
}

/// Lines that a thread puts into words at once: some hundred kilobytes of text.
const LINES_AT_ONCE: usize = 1024;

/// Writes a header and so many lines, which threads put into words side by side.
pub(crate) fn write_csv(
    header: Vec<String>,
    count: usize,
    line: impl Fn(usize) -> Vec<String> + Sync,
    out: &mut dyn Write,
) -> io::Result<()> {
    let in_words = |lines: Vec<Vec<String>>| {
        let mut writer = csv::Writer::from_writer(Vec::new());
        lines.iter().try_for_each(|line| writer.write_record(line))?;
        writer.into_inner().map_err(csv::IntoInnerError::into_error)
    };
    out.write_all(&in_words(vec![header])?)?;
    let at_once = LINES_AT_ONCE * rayon::current_num_threads();
    for first in (0..count).step_by(at_once) {
        let last = count.min(first + at_once);
        let parts = (first..last).into_par_iter().step_by(LINES_AT_ONCE);
        let parts =
            parts.map(|start| in_words((start..last.min(start + LINES_AT_ONCE)).map(&line).collect()));
        let texts: Vec<Vec<u8>> = parts.collect::<io::Result<_>>()?;
        texts.iter().try_for_each(|text| out.write_all(text))?;
    }
    Ok(())
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

    pub(crate) fn in_csv(&self) -> Vec<String> {
        let number = |value: &f64| if value.is_finite() { format!("{value:?}") } else { String::new() };
        match self {
            Self::Integer(value) => vec![value.to_string()],
            Self::Number(value) => vec![number(value)],
            Self::Integers(values) => vec![values.iter().map(i64::to_string).collect::<Vec<_>>().join(" ")],
            Self::Numbers(values) => vec![values.iter().map(number).collect::<Vec<_>>().join(" ")],
            Self::Point(values) => values.iter().map(number).collect(),
            Self::Flag(value) => vec![value.to_string()],
        }
    }
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.rows.iter().map(|row| RowAsMap(&self.columns, row)))
    }
}

/// A row as an object of JSON.
pub(crate) struct RowAsMap<'a>(pub(crate) &'a [&'static str], pub(crate) &'a [Value]);

impl Serialize for RowAsMap<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().zip(self.1))
    }
}
