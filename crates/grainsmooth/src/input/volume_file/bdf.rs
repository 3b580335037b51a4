//! Bulk data of Nastran: GRID, CTETRA, CTRIA3 and CTRIA6 in small, wide and free fields.
//!
//! MSC Nastran Quick Reference Guide, "Bulk data entries".

use glam::DVec3;
use polycrystal::GrainId;

use super::VolumeFile;
use super::numbered::{Places, number, wrong_node_count};
use crate::mesh::file::MeshFileProblem;
use crate::volume_mesh::element_shape::ElementShape;

/// An entry: the line that it begins in, counted from 0, and its fields from the name on.
type Entry = (usize, Vec<String>);

/// Widths of fields.
const SMALL: usize = 8;
const WIDE: usize = 16;

/// The entries, each with the lines that continue it.
fn entries(text: &str) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for (line, content) in text.lines().enumerate() {
        if content.starts_with('$') || content.trim().is_empty() {
            continue;
        }
        let fields = fields(content);
        let head = fields.first().map_or("", String::as_str);
        let continues = head.is_empty() || head.starts_with(['+', '*']);
        match entries.last_mut() {
            Some((_, entry)) if continues => entry.extend_from_slice(&fields[1..]),
            _ => entries.push((line, fields)),
        }
    }
    entries
}

/// The fields of a line; of fixed width, the last one, which marks that the entry goes on, is left out.
fn fields(content: &str) -> Vec<String> {
    if content.contains(',') {
        return content.split(',').map(|field| field.trim().to_owned()).collect();
    }
    let characters: Vec<char> = content.chars().collect();
    let (head, rest) = characters.split_at(SMALL.min(characters.len()));
    let head: String = head.iter().collect();
    let (width, count) = if head.contains('*') { (WIDE, 4) } else { (SMALL, 8) };
    let fields =
        rest.chunks(width).take(count).map(|field| field.iter().collect::<String>().trim().to_owned());
    std::iter::once(head.trim().to_owned()).chain(fields).collect()
}

pub(super) fn read(text: &str) -> Result<VolumeFile, MeshFileProblem> {
    let entries = entries(text);
    let mut file = VolumeFile::default();
    let mut nodes = Places::new("node");
    let named = |name: &'static str| {
        entries.iter().filter(move |(_, fields)| fields[0].trim_end_matches('*').eq_ignore_ascii_case(name))
    };
    for (line, fields) in named("GRID") {
        let [_, node, _, x, y, z, ..] = &fields[..] else {
            return Err(MeshFileProblem::line(*line, "a GRID has a number and three coordinates"));
        };
        let node = number(*line, node)?;
        nodes.push(*line, node)?;
        file.node_numbers.push(node);
        file.points.push(DVec3::new(number(*line, x)?, number(*line, y)?, number(*line, z)?));
    }
    // Beside tetrahedra, triangles are shells on their faces.
    let is_solid = named("CTETRA").next().is_some();
    file.shape = if is_solid { ElementShape::Tetrahedron } else { ElementShape::Triangle };
    let (kinds, count): (&[&str], usize) =
        if is_solid { (&["CTETRA"], 10) } else { (&["CTRIA3", "CTRIA6"], 6) };
    for (line, fields) in kinds.iter().flat_map(|kind| named(kind)) {
        let [kind, element, property, of_element @ ..] = &fields[..] else {
            return Err(MeshFileProblem::line(*line, "an element has a number, a property and nodes"));
        };
        // Behind the nodes of triangles stand an angle and thicknesses.
        let count = if kind.starts_with("CTRIA3") { 3 } else { count };
        let of_element =
            of_element.iter().take(count).filter(|field| !field.is_empty() && !field.starts_with('+'));
        let of_element: Vec<u32> =
            of_element.map(|field| nodes.of(*line, field)).collect::<Result<_, _>>()?;
        file.push_element(number(*line, element)?, &of_element)
            .map_err(|wanted| wrong_node_count(*line, of_element.len(), wanted))?;
        let property: u32 = number(*line, property)?;
        file.grains.push(property.checked_sub(1).map(GrainId).into_iter().collect());
    }
    Ok(file)
}
