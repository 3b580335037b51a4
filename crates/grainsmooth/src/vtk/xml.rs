//! The XML formats .vtp and .vtu.
//!
//! `vtkio` writes the document; its numbers follow as raw bytes straight from our arrays. The conversion from
//! [`vtkio::Vtk`] would hold every number inline as base64, widen ids to 64 bits, drop field data, and take many times as
//! long.

use std::io::{self, Write};

use super::PolyData;
use super::raw::AppendedNumbers;
use document::Document;

mod document;

/// Which of the XML formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum XmlFormat {
    /// .vtp
    PolyData,
    /// .vtu
    UnstructuredGrid,
}

/// Writes the file.
pub(super) fn write(data: &PolyData<'_>, format: XmlFormat, out: &mut dyn Write) -> io::Result<()> {
    let mut numbers = AppendedNumbers::default();
    let document = Document::new(data, format, &mut numbers);
    let document = vtkio::xml::se::to_string(&document).map_err(io::Error::other)?;
    let (head, closing_tag) = document.split_at(document.len() - "</VTKFile>".len());
    writeln!(out, "{head}")?;
    numbers.write(out)?;
    writeln!(out, "{closing_tag}")
}
