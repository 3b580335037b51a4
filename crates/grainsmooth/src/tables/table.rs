use std::io::{self, Write};

use polycrystal::GrainId;
use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};

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

    /// The table of rows that have the same columns.
    pub(crate) fn of_records(records: impl Iterator<Item = Vec<(&'static str, Value)>>) -> Self {
        let mut columns = Vec::new();
        let rows = records.map(|record| {
            let (names, values): (Vec<_>, Vec<_>) = record.into_iter().unzip();
            columns = names;
            values
        });
        let rows = rows.collect();
        Self { columns, rows }
    }

    /// Writes a header line, then one line a row.
    pub(crate) fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(out);
        let first: &[Value] = self.rows.first().map_or(&[], |row| row);
        let header = (0..).zip(&self.columns).flat_map(|(k, name): (usize, _)| match first.get(k) {
            // A seed has the names that `--seeds-file` reads.
            Some(Value::Point(point)) if *name == "seed" => axis_names(point.len(), ""),
            Some(Value::Point(point)) => axis_names(point.len(), &format!("{name}_")),
            _ => vec![(*name).to_owned()],
        });
        writer.write_record(header)?;
        for row in &self.rows {
            writer.write_record(row.iter().flat_map(Value::in_csv))?;
        }
        writer.flush()
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

    fn in_csv(&self) -> Vec<String> {
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
        struct Row<'a>(&'a [&'static str], &'a [Value]);
        impl Serialize for Row<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let mut row = serializer.serialize_map(Some(self.0.len()))?;
                for (column, value) in self.0.iter().zip(self.1) {
                    row.serialize_entry(column, value)?;
                }
                row.end()
            }
        }
        let mut rows = serializer.serialize_seq(Some(self.rows.len()))?;
        for row in &self.rows {
            rows.serialize_element(&Row(&self.columns, row))?;
        }
        rows.end()
    }
}
