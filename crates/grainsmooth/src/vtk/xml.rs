//! The XML formats .vtp and .vtu.
//!
//! We write the document and its numbers straight from our arrays. The conversion from [`vtkio::Vtk`] would
//! widen ids to 64 bits, drop field data, and take many times as long.

use std::io::{self, Write};

use super::raw::NumbersOfFile;
use super::{PolyData, VtkEncoding};

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
    if format == XmlFormat::PolyData && data.cells.are_elements() {
        return Err(io::Error::other("PolyData holds no finite elements; write an unstructured grid"));
    }
    let mut numbers = NumbersOfFile::new(encoding);
    let document = document::document(data, format, &mut numbers);
    numbers.write_file(document, out)
}
