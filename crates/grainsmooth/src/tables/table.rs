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
        writeln!(out, "{}", self.columns.join(","))?;
        for row in &self.rows {
            assert_eq!(row.len(), self.columns.len(), "a value for each column");
            let values: Vec<String> = row.iter().map(Value::in_csv).collect();
            writeln!(out, "{}", values.join(","))?;
        }
        Ok(())
    }
}

impl Value {
    /// The number as that of a grain; nothing for that of the exterior.
    pub(crate) fn grain(&self) -> Option<GrainId> {
        match self {
            Self::Integer(number) => u32::try_from(*number).ok().map(GrainId),
            _ => None,
        }
    }

    fn in_csv(&self) -> String {
        let number = |value: &f64| if value.is_finite() { format!("{value:?}") } else { String::new() };
        match self {
            Self::Integer(value) => value.to_string(),
            Self::Number(value) => number(value),
            Self::Integers(values) => values.iter().map(i64::to_string).collect::<Vec<_>>().join(" "),
            Self::Numbers(values) => values.iter().map(number).collect::<Vec<_>>().join(" "),
            Self::Flag(value) => value.to_string(),
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
