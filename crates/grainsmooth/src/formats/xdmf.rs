//! XDMF: elements that fill grains, with their numbers as raw bytes in a folder beside the file.
//!
//! <https://www.xdmf.org/index.php/XDMF_Model_and_Format>

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use quick_xml::escape::escape;

use super::format::{Beside, Content, Extra, Format, HEAD, Writer};
use crate::files::output::OutputPath;
use crate::volume_mesh::element_nodes::ElementNodes;
use crate::volume_mesh::element_shape::ElementShape;
use crate::{Error, Polycrystal, StagedFiles};

/// Some three tetrahedra for each triangle, with four nodes and a grain; and half a node each.
pub(super) const FORMAT: Format = Format {
    extension: "xdmf",
    content: Content::Elements,
    bytes: |size| HEAD + (3 * 20 + 12) * size.mesh.triangles,
    write: Writer::Files(stage),
    extra: Extra { programs: "ParaView, meshio", beside: Some(Beside::Folder), ..Extra::NONE },
};

/// The files of the folder.
const POINTS: &str = "points.bin";
const ELEMENTS: &str = "elements.bin";
const GRAINS: &str = "GrainId.bin";

fn stage(polycrystal: &Polycrystal, output: &OutputPath<()>, files: &mut StagedFiles) -> Result<(), Error> {
    let failed = |cause| Error::WriteOutput { path: output.path().to_owned(), cause };
    let (elements, _) = polycrystal.elements().map_err(failed)?;
    let folder = output.target().with_extension("");
    files.files_in(&folder, output.path(), |directory| write_numbers(polycrystal, &elements, directory))?;
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    output.stage(files, |out| write(polycrystal, &elements, &name, out))
}

/// Writes little-endian numbers: coordinates, the nodes of elements, and the grain of each.
fn write_numbers(polycrystal: &Polycrystal, elements: &ElementNodes<'_>, folder: &Path) -> io::Result<()> {
    let file = |name: &str| Ok::<_, io::Error>(BufWriter::new(File::create(folder.join(name))?));
    let mut points = file(POINTS)?;
    let mut coordinates = elements.points.iter().flat_map(|point| point.to_array());
    coordinates.try_for_each(|coordinate| points.write_all(&coordinate.to_le_bytes()))?;
    points.flush()?;
    let mut nodes = file(ELEMENTS)?;
    elements.nodes().iter().try_for_each(|node| nodes.write_all(&node.to_le_bytes()))?;
    nodes.flush()?;
    let mut grains = file(GRAINS)?;
    let names = polycrystal.file().names;
    elements.grains.iter().try_for_each(|grain| grains.write_all(&names.number(*grain).to_le_bytes()))?;
    grains.flush()
}

fn write(
    polycrystal: &Polycrystal,
    elements: &ElementNodes<'_>,
    folder: &str,
    out: &mut dyn Write,
) -> io::Result<()> {
    let topology = match (elements.shape, elements.are_quadratic()) {
        (ElementShape::Triangle, false) => "Triangle",
        (ElementShape::Triangle, true) => "Triangle_6",
        (ElementShape::Tetrahedron, false) => "Tetrahedron",
        (ElementShape::Tetrahedron, true) => "Tetrahedron_10",
    };
    let (count, points) = (elements.grains.len(), elements.points.len());
    let item = |size: String, kind: &str, bytes: u32, file: &str| {
        let path = format!("{folder}/{file}");
        format!(
            "<DataItem Dimensions=\"{size}\" NumberType=\"{kind}\" Precision=\"{bytes}\" Format=\"Binary\" Endian=\"Little\">{}</DataItem>",
            escape(&path)
        )
    };
    let corners = item(format!("{count} {}", elements.node_count), "UInt", 4, ELEMENTS);
    let places = item(format!("{points} 3"), "Float", 8, POINTS);
    let grains = item(count.to_string(), "Int", 4, GRAINS);
    let name = polycrystal.file().names.grain();
    writeln!(out, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>")?;
    writeln!(out, "<Grid Name=\"grains\" GridType=\"Uniform\">")?;
    writeln!(
        out,
        "<Topology TopologyType=\"{topology}\" NumberOfElements=\"{count}\">\n{corners}\n</Topology>"
    )?;
    writeln!(out, "<Geometry GeometryType=\"XYZ\">\n{places}\n</Geometry>")?;
    writeln!(
        out,
        "<Attribute Name=\"{name}\" AttributeType=\"Scalar\" Center=\"Cell\">\n{grains}\n</Attribute>"
    )?;
    writeln!(out, "</Grid>\n</Domain>\n</Xdmf>")?;
    // Readers skip processing instructions, and comments cannot hold the names of options.
    writeln!(out, "<?grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    write!(out, "{}", polycrystal.provenance().text())?;
    writeln!(out, "?>")
}
