//! Lines shorter than the elements, which become points where that is asked for.
//!
//! The two ends of such a line become one. Every grain stays a closed ball if the grains that meet at both ends are those along the line (the link condition of Dey, Edelsbrunner, Guha and
//! Nekhayev 1999, for cells instead of simplices). The same is demanded of boundaries, so that none touches itself.

use std::collections::{BTreeMap, BTreeSet};

use subzero::FaceId;
use voronoi::Translation;

use crate::mesh::id::id;
use crate::network::merged::MergedSides;
use crate::remesh::short_lines::{MergedLine, ShortLines};
use crate::remesh::size_field::{Halved, Surroundings};
use crate::remesh::skeleton::Occurrence;
use crate::remesh::torus::Moved;
use crate::{BoundaryId, GrainId, Level, Network, Side};

/// Fewest lines that are left around a boundary (in the plane: around a grain).
const FEWEST_LINES: usize = 3;

/// What is found at a node or along a line, and how far from its own place.
type Around<Id> = BTreeSet<(Id, Translation)>;

/// What lies around nodes, or along lines, by number of originals.
#[derive(Default)]
struct Incidence {
    grains: BTreeMap<u32, Around<GrainId>>,
    parts: BTreeMap<u32, Around<u32>>,
}

impl Incidence {
    fn note(&mut self, at: Moved<u32>, part: u32, grains: &[GrainId]) {
        let moved = Translation::ZERO - at.translation;
        self.parts.entry(at.original).or_default().insert((part, moved));
        self.grains.entry(at.original).or_default().extend(grains.iter().map(|grain| (*grain, moved)));
    }
}

/// The same, as a copy has it around.
fn moved<Id: Ord + Copy>(around: &Around<Id>, by: Translation) -> Around<Id> {
    around.iter().map(|(what, own)| (*what, *own + by)).collect()
}

impl ShortLines {
    /// The lines shorter than `length` that may become points, the shortest first; none where elements became smaller because something was wrong, and then no others than
    /// those of `around`, from the round before. `sides` are those of the boundary of a triangle (in the plane: the grain that it is in, twice).
    pub(crate) fn new(
        network: &Network,
        around: &Surroundings<'_>,
        sides: impl Fn(BoundaryId) -> [Side; 2],
        length: f64,
        halved: &[Halved],
    ) -> Self {
        let Surroundings { level, mesh, points, torus, skeleton, parts, .. } = *around;
        let mut found = Self::default();
        let lengths = skeleton.lines.iter().map(|line| line.length(points));
        let mut short: Vec<(f64, u32)> = lengths.zip(0u32..).filter(|(own, _)| *own < length).collect();
        short.retain(|(_, line)| halved.is_empty() || around.short.has(*line));
        short.retain(|(_, line)| {
            let line = &skeleton.lines[*line as usize];
            let middle = line.middle(points);
            !line.is_closed() && !halved.iter().any(|near| near.place.distance(middle) < near.within)
        });
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if short.is_empty() {
            return found;
        }
        let (mut at_nodes, mut along) = (Incidence::default(), Incidence::default());
        let mut line_counts = vec![0; parts.boundaries.len()];
        for (part, boundary) in parts.boundaries.iter().enumerate() {
            let grains: Vec<GrainId> = sides(*boundary).into_iter().filter_map(Side::grain).collect();
            let mut occurrences = BTreeSet::new();
            for triangle in parts.triangles.of(part) {
                for corner in mesh.triangles()[*triangle as usize] {
                    if skeleton.is_node[corner as usize] {
                        at_nodes.note(torus.vertices[corner as usize], id(part), &grains);
                    }
                }
                for edge in mesh.triangle_edges(FaceId(*triangle)) {
                    let Some(edge) = skeleton.of_edge[edge.index()] else { continue };
                    let Occurrence { line, translation, .. } = skeleton.occurrences[edge.occurrence as usize];
                    along.note(Moved { original: line, translation }, id(part), &grains);
                    occurrences.insert(edge.occurrence);
                }
            }
            line_counts[part] = occurrences.len();
        }
        let mut between: BTreeMap<[Moved<u32>; 2], usize> = BTreeMap::new();
        for line in &skeleton.lines {
            *between.entry(found.ends(line.ends(), torus)).or_default() += 1;
        }
        for (length, line) in short {
            let ends = skeleton.lines[line as usize].ends();
            let places = skeleton.occurrences.iter().filter(|occurrence| occurrence.line == line);
            let Some(along_line) = sides_along(level, places) else { continue };
            let [stays, goes] = ends;
            let [kept, gone] = [stays, goes].map(|vertex| torus.vertices[vertex as usize]);
            let has_merged = |end: Moved<u32>| {
                found.gone.contains_key(&end.original) || found.places.contains_key(&end.original)
            };
            if has_merged(kept) || has_merged(gone) {
                continue;
            }
            let of_both = [kept, gone].map(|end| {
                let Incidence { grains, parts } = &at_nodes;
                (
                    moved(&grains[&end.original], end.translation),
                    moved(&parts[&end.original], end.translation),
                )
            });
            let [(kept_grains, kept_parts), (gone_grains, gone_parts)] = of_both;
            let is_ball = kept_grains.intersection(&gone_grains).eq(&along.grains[&line])
                && kept_parts.intersection(&gone_parts).eq(&along.parts[&line]);
            let parts = &along.parts[&line];
            let is_wide = parts.iter().all(|(part, _)| line_counts[*part as usize] > FEWEST_LINES);
            let is_alone = kept.original != gone.original && between[&found.ends(ends, torus)] == 1;
            if !(is_ball && is_wide && is_alone) {
                continue;
            }
            parts.iter().for_each(|(part, _)| line_counts[*part as usize] -= 1);
            let place = skeleton.lines[line as usize].middle(points);
            let back = kept.translation.vector(network.domain());
            found.lines.insert(line);
            found.places.insert(kept.original, place - back);
            let translation = kept.translation - gone.translation;
            found.gone.insert(gone.original, Moved { original: kept.original, translation });
            let grains: BTreeSet<GrainId> =
                kept_grains.union(&gone_grains).map(|(grain, _)| *grain).collect();
            let [kept_sides, gone_sides] = [stays, goes].map(|vertex| sides_at(network, level, vertex));
            let point = kept_sides.saturating_add(gone_sides).saturating_sub(along_line);
            found.sides.push(MergedSides { line: along_line, ends: [kept_sides, gone_sides], point });
            found.merged.push(MergedLine { place, length, grains: grains.into_iter().collect() });
        }
        found
    }
}

/// How many sides meet along a line, where that may become a point: it and its ends lie on the same walls, and at pores all or none. Were an end drawn to a wall, what is near could come to
/// lie flat on that.
fn sides_along<'a>(level: &Level, places: impl Iterator<Item = &'a Occurrence>) -> Option<u8> {
    let mut sides = 0;
    for Occurrence { vertices, walls, meeting, .. } in places {
        let ends = [vertices[0], vertices[vertices.len() - 1]].map(|end| end as usize);
        let is_along_walls = ends.iter().all(|end| level.walls[*end] == *walls);
        let is_outer = ends.map(|end| level.node_types[end].is_outer());
        if !is_along_walls || meeting.node_type.is_outer() != (is_outer == [true; 2]) {
            return None;
        }
        sides = sides.max(meeting.sides);
    }
    Some(sides)
}

/// How many sides meet at a node.
fn sides_at(network: &Network, level: &Level, vertex: u32) -> u8 {
    let vertex = vertex as usize;
    let is_at_exterior = match network.domain().is_periodic() {
        true => !level.walls[vertex].is_empty(),
        false => level.node_types[vertex].is_outer(),
    };
    level.grain_counts[vertex].saturating_add(u8::from(is_at_exterior))
}
