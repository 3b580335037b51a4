//! Input files of Abaqus and CalculiX, without parts and assemblies.
//!
//! Abaqus Analysis User's Guide, "Input syntax rules"; CalculiX CrunchiX User's Manual.

use std::collections::BTreeMap;

use glam::DVec3;
use polycrystal::GrainId;

use super::numbered::{Places, number, wrong_node_count};
use super::{Tie, VolumeFile};
use crate::mesh::file::MeshFileProblem;
use crate::volume_mesh::element_shape::{ElementShape, face_key};

/// Prefix of the element sets of grains, and of the node sets of the axes of a periodic box.
const GRAIN: &str = "GRAIN_";
const PERIOD: [&str; 3] = ["PERIOD_X", "PERIOD_Y", "PERIOD_Z"];

/// A keyword line with its parameters, upper case, and the data lines behind it.
struct Card<'a> {
    keyword: String,
    parameters: BTreeMap<String, String>,
    data: Vec<(usize, &'a str)>,
}

fn cards(text: &str) -> Vec<Card<'_>> {
    let mut cards: Vec<Card<'_>> = Vec::new();
    for (line, content) in text.lines().enumerate() {
        if content.starts_with("**") || content.trim().is_empty() {
            continue;
        }
        if let Some(head) = content.strip_prefix('*') {
            let mut words = head.split(',').map(|word| word.trim().to_uppercase());
            let keyword = words.next().unwrap_or_default();
            let parameters = words.map(|word| match word.split_once('=') {
                Some((name, value)) => (name.trim().to_owned(), value.trim().to_owned()),
                None => (word, String::new()),
            });
            cards.push(Card { keyword, parameters: parameters.collect(), data: Vec::new() });
        } else if let Some(card) = cards.last_mut() {
            card.data.push((line, content));
        }
    }
    cards
}

/// The shape of elements of a type, the number of their nodes, and whether they are cohesive elements between such.
fn element_type(name: &str) -> Option<(ElementShape, usize, bool)> {
    match name {
        "C3D4" => Some((ElementShape::Tetrahedron, 4, false)),
        "C3D10" => Some((ElementShape::Tetrahedron, 10, false)),
        "COH3D6" => Some((ElementShape::Tetrahedron, 6, true)),
        "CPS3" | "CPE3" => Some((ElementShape::Triangle, 3, false)),
        "CPS6" | "CPE6" => Some((ElementShape::Triangle, 6, false)),
        "COH2D4" => Some((ElementShape::Triangle, 4, true)),
        _ => None,
    }
}

/// The words of a data line; a comma at its end means nothing.
fn words(content: &str) -> impl Iterator<Item = &str> {
    content.trim().trim_end_matches(',').split(',').map(str::trim)
}

pub(super) fn read(text: &str) -> Result<VolumeFile, MeshFileProblem> {
    let cards = cards(text);
    let mut file = VolumeFile::default();
    let mut nodes = Places::new("node");
    let mut elements = Places::new("element");
    for card in cards.iter().filter(|card| card.keyword == "NODE") {
        for (line, content) in &card.data {
            let words: Vec<&str> = words(content).collect();
            let (node, x, y, z) = match words[..] {
                [node, x, y] => (node, x, y, "0"),
                [node, x, y, z] => (node, x, y, z),
                _ => {
                    let what = "a node is its number and two or three coordinates";
                    return Err(MeshFileProblem::line(*line, what));
                }
            };
            let node = number(*line, node)?;
            nodes.push(*line, node)?;
            file.node_numbers.push(node);
            file.points.push(DVec3::new(number(*line, x)?, number(*line, y)?, number(*line, z)?));
        }
    }
    let of_elements = || cards.iter().filter(|card| card.keyword == "ELEMENT");
    let name_of = |card: &Card<'_>| card.parameters.get("TYPE").cloned().unwrap_or_default();
    let mut types = of_elements().filter_map(|card| element_type(&name_of(card)));
    file.shape = types.next().map_or(file.shape, |(shape, ..)| shape);
    for card in of_elements() {
        let name = name_of(card);
        let of_shape = element_type(&name).filter(|(shape, ..)| *shape == file.shape);
        let Some((_, wanted, is_cohesive)) = of_shape else {
            let line = card.data.first().map_or(0, |(line, _)| *line);
            let what = format!(
                "elements of the type {name} are not checked; give C3D4, C3D10 and COH3D6, or in the plane CPS3, CPE3, CPS6, CPE6 and COH2D4"
            );
            return Err(MeshFileProblem::line(line, what));
        };
        for (line, content) in &card.data {
            let all: Vec<&str> = words(content).collect();
            let Some((element, corners)) = all.split_first() else { continue };
            let corners: Vec<u32> =
                corners.iter().map(|word| nodes.of(*line, word)).collect::<Result<_, _>>()?;
            let wrong = |wanted| wrong_node_count(*line, corners.len(), wanted);
            if corners.len() != wanted {
                return Err(wrong(wanted));
            }
            let element = number(*line, element)?;
            if is_cohesive {
                file.joints.push(corners);
                continue;
            }
            elements.push(*line, element)?;
            file.push_element(element, &corners).map_err(wrong)?;
        }
    }
    file.grains = vec![Vec::new(); file.element_numbers.len()];
    read_sets(&cards, &nodes, &elements, &mut file)?;
    for card in cards.iter().filter(|card| card.keyword == "EQUATION") {
        file.ties = ties(card, &nodes, &file)?;
    }
    Ok(file)
}

/// Sets of nodes and of elements, and surfaces.
fn read_sets(
    cards: &[Card<'_>],
    nodes: &Places,
    elements: &Places,
    file: &mut VolumeFile,
) -> Result<(), MeshFileProblem> {
    for card in cards {
        let name = |key: &str| card.parameters.get(key).cloned().unwrap_or_default();
        match card.keyword.as_str() {
            "NODE" if PERIOD.contains(&&*name("NSET")) => {
                for (line, content) in &card.data {
                    let node = words(content).next().unwrap_or_default();
                    let node = nodes.of(*line, node)?;
                    file.control_nodes.push(node);
                    file.node_sets.entry(name("NSET")).or_default().push(node);
                }
            }
            "NSET" => {
                let set = file.node_sets.entry(name("NSET")).or_default();
                for (line, content) in &card.data {
                    for word in words(content) {
                        set.push(nodes.of(*line, word)?);
                    }
                }
            }
            "ELSET" if name("ELSET").starts_with(GRAIN) => {
                let name = name("ELSET");
                for (line, content) in &card.data {
                    let grain = GrainId(number(*line, &name[GRAIN.len()..])?);
                    let members: Vec<u64> =
                        words(content).map(|word| number(*line, word)).collect::<Result<_, _>>()?;
                    let members = match (&members[..], card.parameters.contains_key("GENERATE")) {
                        ([first, last, step], true) if *step > 0 => {
                            (*first..=*last).step_by(usize::try_from(*step).unwrap_or(1)).collect()
                        }
                        (_, true) => {
                            return Err(MeshFileProblem::line(*line, "GENERATE takes first, last and step"));
                        }
                        _ => members,
                    };
                    for member in members {
                        file.grains[elements.of(*line, &member.to_string())? as usize].push(grain);
                    }
                }
            }
            "SURFACE" => {
                let mut set = Vec::new();
                for (line, content) in &card.data {
                    let words: Vec<&str> = words(content).collect();
                    let [element, face] = words[..] else {
                        return Err(MeshFileProblem::line(
                            *line,
                            "a face is an element and S1, S2 or another",
                        ));
                    };
                    let corners = file.element(elements.of(*line, element)? as usize);
                    let face: usize = number(*line, face.trim_start_matches(['S', 's']))?;
                    let [shape, _, _] = file.shape.words();
                    let of_face = face.checked_sub(1).and_then(|face| file.faces(corners).nth(face));
                    let of_face = of_face.ok_or_else(|| {
                        MeshFileProblem::line(*line, format!("a {shape} has no face S{face}"))
                    })?;
                    set.push(face_key(&of_face));
                }
                file.surfaces.entry(name("NAME")).or_default().extend(set);
            }
            _ => {}
        }
    }
    Ok(())
}

/// The nodes that equations tie to others: u - u' - sum s_a u_a = 0 in each direction.
fn ties(card: &Card<'_>, nodes: &Places, file: &VolumeFile) -> Result<Vec<Tie>, MeshFileProblem> {
    let axis_of: BTreeMap<u32, usize> =
        (0..3).filter_map(|axis| Some((*file.node_sets.get(PERIOD[axis])?.first()?, axis))).collect();
    let mut ties: Vec<Tie> = Vec::new();
    let mut components: BTreeMap<(u32, u64), Tie> = BTreeMap::new();
    let mut lines = card.data.iter();
    while let Some((line, content)) = lines.next() {
        let count: usize = number(*line, content.trim_end_matches([',', ' ']))?;
        let mut terms = Vec::new();
        while terms.len() < 3 * count {
            let (line, content) =
                lines.next().ok_or_else(|| MeshFileProblem::line(*line, "the equation is cut off"))?;
            terms.extend(words(content).map(|word| (*line, word)));
        }
        let wrong = || MeshFileProblem::line(*line, "the equation ties no two nodes whole periods apart");
        let (mut ends, mut periods, mut directions) = ([None; 2], [0i8; 3], Vec::new());
        for term in terms.chunks(3) {
            let [(line, node), (_, direction), (_, factor)] = term else { return Err(wrong()) };
            let (node, factor): (u32, f64) = (nodes.of(*line, node)?, number(*line, factor)?);
            directions.push(number::<u64>(*line, direction)?);
            match axis_of.get(&node) {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "a small whole number, or it is found not to fit"
                )]
                Some(axis) => periods[*axis] = -factor as i8,
                None if factor == 1.0 => ends[0] = Some(node),
                None if factor == -1.0 => ends[1] = Some(node),
                None => return Err(wrong()),
            }
        }
        let ([Some(copy), Some(original)], Some(direction)) = (ends, directions.first()) else {
            return Err(wrong());
        };
        if directions.iter().any(|other| other != direction) {
            return Err(wrong());
        }
        let tie = Tie { copy, original, periods: Some(periods) };
        if components.insert((copy, *direction), tie).is_some() {
            let node = file.node_numbers[copy as usize];
            let what = format!("node {node} is tied in direction {direction} a second time");
            return Err(MeshFileProblem::line(*line, what));
        }
        if *direction == 1 {
            ties.push(tie);
        }
    }
    let directions = u64::try_from(file.shape.axes()).unwrap_or(u64::MAX);
    for tie in &ties {
        if (2..=directions).any(|direction| components.get(&(tie.copy, direction)) != Some(tie)) {
            let (line, _) = card.data[0];
            let node = file.node_numbers[tie.copy as usize];
            let what = format!("equations do not tie node {node} in the same way in all directions");
            return Err(MeshFileProblem::line(line, what));
        }
    }
    Ok(ties)
}
