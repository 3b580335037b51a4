//! The XML formats .vtp and .vtu.
//!
//! `vtkio` writes the document, and we its numbers, straight from our arrays. The conversion from [`vtkio::Vtk`] would
//! widen ids to 64 bits, drop field data, and take many times as long.

use std::io::{self, Write};

use super::raw::NumbersOfFile;
use super::{PolyData, VtkEncoding};
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
pub(super) fn write(
    data: &PolyData<'_>,
    format: XmlFormat,
    encoding: VtkEncoding,
    out: &mut dyn Write,
) -> io::Result<()> {
    if format == XmlFormat::PolyData && data.cells.are_solids() {
        return Err(io::Error::other("PolyData holds no tetrahedra; write an unstructured grid"));
    }
    let mut numbers = NumbersOfFile::new(encoding);
    let document = Document::new(data, format, &mut numbers);
    let document = vtkio::xml::se::to_string(&document).map_err(io::Error::other)?;
    numbers.write_file(document.trim_end_matches("</VTKFile>"), out)
}
