//! Gmsh's mesh format 4.1, as text.
//!
//! <https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format>

use std::collections::BTreeMap;

use glam::DVec3;
use polycrystal::GrainId;

use super::numbered::{Places, number, wrong_node_count};
use super::{Tie, VolumeFile};
use crate::mesh::file::MeshFileProblem;
use crate::volume_mesh::element_shape::{ElementShape, face_key};

/// Lines of a section, with their numbers in the file.
struct Section<'a> {
    lines: std::vec::IntoIter<(usize, &'a str)>,
    last: usize,
}

impl<'a> Section<'a> {
    /// The section of a name; empty where there is none.
    fn new(text: &'a str, name: &str) -> Self {
        let lines = text.lines().enumerate().skip_while(|(_, line)| line.trim() != name).skip(1);
        let lines: Vec<_> = lines.take_while(|(_, line)| !line.starts_with("$End")).collect();
        Self { last: lines.last().map_or(0, |(line, _)| *line), lines: lines.into_iter() }
    }

    /// The words of the next line.
    fn words(&mut self) -> Result<(usize, Vec<&'a str>), MeshFileProblem> {
        let (line, content) = self
            .lines
            .next()
            .ok_or_else(|| MeshFileProblem::line(self.last, "the section ends too early"))?;
        Ok((line, content.split_whitespace().collect()))
    }

    /// The numbers in the next line, of which there must be so many or more.
    fn numbers(&mut self, count: usize) -> Result<(usize, Vec<u64>), MeshFileProblem> {
        let (line, words) = self.words()?;
        if words.len() < count {
            return Err(MeshFileProblem::line(line, format!("{count} numbers must stand here")));
        }
        let numbers = words.iter().map(|word| number(line, word)).collect::<Result<_, _>>()?;
        Ok((line, numbers))
    }
}

pub(super) fn read(text: &str) -> Result<VolumeFile, MeshFileProblem> {
    let (line, format) = Section::new(text, "$MeshFormat").words()?;
    if format.first() != Some(&"4.1") || format.get(1) != Some(&"0") {
        let what = "only the format 4.1 as text is read; write it with `gmsh -format msh41`";
        return Err(MeshFileProblem::line(line, what));
    }
    let names = physical_names(text)?;
    let groups = groups(text)?;
    let is_solid = groups.keys().any(|(dimension, _)| *dimension == 3);
    let shape = if is_solid { ElementShape::Tetrahedron } else { ElementShape::Triangle };
    let mut file = VolumeFile { shape, ..VolumeFile::default() };
    let nodes = read_nodes(text, &mut file)?;
    read_elements(text, &nodes, &groups, &names, &mut file)?;
    read_periodic(text, &nodes, &mut file)?;
    Ok(file)
}

/// Names of physical groups, by dimension and number.
fn physical_names(text: &str) -> Result<BTreeMap<(u64, u64), String>, MeshFileProblem> {
    let mut names = BTreeMap::new();
    for (line, content) in Section::new(text, "$PhysicalNames").lines.skip(1) {
        let mut words = content.splitn(3, ' ');
        let mut next = || words.next().unwrap_or_default();
        let (dimension, group) = (number(line, next())?, number(line, next())?);
        names.insert((dimension, group), next().trim().trim_matches('"').to_owned());
    }
    Ok(names)
}

/// The physical groups of each entity, by dimension and tag.
fn groups(text: &str) -> Result<BTreeMap<(u64, u64), Vec<u64>>, MeshFileProblem> {
    let mut section = Section::new(text, "$Entities");
    let (_, counts) = section.numbers(4)?;
    let mut groups = BTreeMap::new();
    for (dimension, count) in (0..).zip(counts) {
        // A point has three coordinates, all others a box of six.
        let first = if dimension == 0 { 4 } else { 7 };
        for _ in 0..count {
            let (line, words) = section.words()?;
            let word = |place: usize| words.get(place).copied().unwrap_or_default();
            let count: usize = number(line, word(first))?;
            let own = (first + 1..=first + count).map(|place| {
                let group: i64 = number(line, word(place))?;
                Ok::<_, MeshFileProblem>(group.unsigned_abs())
            });
            groups.insert((dimension, number(line, word(0))?), own.collect::<Result<_, _>>()?);
        }
    }
    Ok(groups)
}

fn read_nodes(text: &str, file: &mut VolumeFile) -> Result<Places, MeshFileProblem> {
    let mut nodes = Places::new("node");
    let mut section = Section::new(text, "$Nodes");
    let (_, head) = section.numbers(4)?;
    for _ in 0..head[0] {
        let (_, block) = section.numbers(4)?;
        for _ in 0..block[3] {
            let (line, tag) = section.numbers(1)?;
            nodes.push(line, tag[0])?;
            file.node_numbers.push(tag[0]);
        }
        for _ in 0..block[3] {
            let (line, words) = section.words()?;
            let [x, y, z] = words[..] else {
                return Err(MeshFileProblem::line(line, "a node has three coordinates"));
            };
            file.points.push(DVec3::new(number(line, x)?, number(line, y)?, number(line, z)?));
        }
    }
    Ok(nodes)
}

fn read_elements(
    text: &str,
    nodes: &Places,
    groups: &BTreeMap<(u64, u64), Vec<u64>>,
    names: &BTreeMap<(u64, u64), String>,
    file: &mut VolumeFile,
) -> Result<(), MeshFileProblem> {
    let mut section = Section::new(text, "$Elements");
    let (_, head) = section.numbers(4)?;
    for _ in 0..head[0] {
        let (line, block) = section.numbers(4)?;
        let &[dimension, entity, kind, count] = &block[..] else {
            return Err(MeshFileProblem::line(line, "four numbers begin a block of elements"));
        };
        let of_entity = groups.get(&(dimension, entity)).map_or(&[][..], Vec::as_slice);
        let of_entity: Vec<&str> =
            of_entity.iter().filter_map(|group| Some(names.get(&(dimension, *group))?.as_str())).collect();
        for _ in 0..count {
            let (line, words) = section.words()?;
            let Some((element, corners)) = words.split_first() else { continue };
            let corners: Vec<u32> =
                corners.iter().map(|word| nodes.of(line, word)).collect::<Result<_, _>>()?;
            let (shape_axes, wanted) = match kind {
                1 => (1, 2),
                2 => (2, 3),
                4 => (3, 4),
                8 => (1, 3),
                9 => (2, 6),
                11 => (3, 10),
                _ => continue,
            };
            let wrong = |wanted| wrong_node_count(line, corners.len(), wanted);
            if corners.len() != wanted {
                return Err(wrong(wanted));
            }
            let axes = file.shape.axes();
            if shape_axes + 1 == axes {
                for name in &of_entity {
                    let faces = file.surfaces.entry(inp_name(name)).or_default();
                    faces.push(face_key(&corners[..axes]));
                }
            } else if shape_axes == axes {
                let mut nodes = corners.clone();
                if let [.., fifth, sixth] = &mut nodes[..]
                    && kind == 11
                {
                    // Gmsh has the last two edges in the other order.
                    std::mem::swap(fifth, sixth);
                }
                file.push_element(number(line, element)?, &nodes).map_err(wrong)?;
                let grains = of_entity.iter().filter_map(|name| name.strip_prefix("grain"));
                file.grains.push(grains.filter_map(|grain| Some(GrainId(grain.parse().ok()?))).collect());
            }
        }
    }
    Ok(())
}

/// What .inp calls a physical surface: `BOUNDARY_3` for `boundary3`, and `X0` for `x0`.
fn inp_name(name: &str) -> String {
    name.replacen("boundary", "boundary_", 1).to_uppercase()
}

fn read_periodic(text: &str, nodes: &Places, file: &mut VolumeFile) -> Result<(), MeshFileProblem> {
    let mut section = Section::new(text, "$Periodic");
    if section.lines.len() == 0 {
        return Ok(());
    }
    let (_, head) = section.numbers(1)?;
    for _ in 0..head[0] {
        section.numbers(3)?;
        // An affine transformation, or none.
        section.words()?;
        let (_, count) = section.numbers(1)?;
        for _ in 0..count[0] {
            let (line, words) = section.words()?;
            let [copy, original] = words[..] else {
                return Err(MeshFileProblem::line(line, "a pair of nodes is two numbers"));
            };
            let (copy, original) = (nodes.of(line, copy)?, nodes.of(line, original)?);
            file.ties.push(Tie { copy, original, periods: None });
        }
    }
    Ok(())
}
