//! Bodies on a torus, each laid out whole in space.

use std::collections::{BTreeMap, VecDeque};

use glam::DVec3;

use super::datafile::Datafile;
use super::{Corner, Element, id, triangles};
use crate::mesh::file::vtk::labelled::{LabelledCells, Notes};
use crate::mesh::file::{MeshFile, MeshFileProblem};
use crate::names::PERIODS;
use crate::vtk::{DataArray, FieldValue};

type Periods = [i32; 3];

fn sum(a: Periods, b: Periods) -> Periods {
    [0, 1, 2].map(|axis| a[axis] + b[axis])
}

fn difference(a: Periods, b: Periods) -> Periods {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

/// The boundaries of whole bodies. Where the two sides of an element are whole periods apart, it stands there twice.
pub(super) fn cells(
    file: &Datafile,
    periods: DVec3,
    elements: &[Element],
) -> Result<LabelledCells, MeshFileProblem> {
    let at = laid_out(file, periods, elements)?;
    let mut points = Points { periods, points: Vec::new(), ids: BTreeMap::new(), originals: Vec::new() };
    let (mut faces, mut labels) = (Vec::new(), Vec::new());
    let mut copied: BTreeMap<(usize, usize, Periods), i64> = BTreeMap::new();
    for (index, (element, at)) in elements.iter().zip(&at).enumerate() {
        let label = |body: usize| i64::from(file.bodies[body].0);
        let mut add = |place: Periods, is_reversed: bool, sides: [i64; 2]| -> Result<(), MeshFileProblem> {
            for piece in points.pieces(file, index, &element.corners, place)? {
                faces.push(if is_reversed { piece.into_iter().rev().collect() } else { piece });
                labels.push(sides);
            }
            Ok(())
        };
        match (element.sides, *at) {
            ([Some(front), Some(back)], [from, to]) if from != to => {
                let apart = difference(to, from);
                // One number for both ways in which elements of a boundary may wind.
                let key = (front, back, apart).min((back, front, apart.map(|count| -count)));
                let next = -2 - i64::try_from(copied.len()).expect("no more boundaries than elements");
                let beyond = *copied.entry(key).or_insert(next);
                let is_first = key == (front, back, apart);
                let other = i64::try_from(elements.len()).expect("a length");
                // The copies of a boundary of a body with itself need numbers of their own.
                let [one, two] = if is_first { [beyond, beyond - other] } else { [beyond - other, beyond] };
                add(from, false, [label(front), one])?;
                add(to, true, [label(back), two])?;
            }
            ([Some(front), Some(back)], [from, _]) => {
                let is_reversed = label(back) < label(front);
                let sides = [label(front).min(label(back)), label(front).max(label(back))];
                add(from, is_reversed, sides)?;
            }
            ([Some(front), None], [from, _]) => add(from, false, [label(front), -1])?,
            ([None, Some(back)], [_, to]) => add(to, true, [label(back), -1])?,
            ([None, None], _) => {}
        }
    }
    let repeats = |axis: usize| file.edges.iter().any(|edge| edge.wraps[axis] != 0);
    let periods = [0, 1, 2].map(|axis| if repeats(axis) { periods[axis] } else { 0.0 });
    let mut notes = Notes::default();
    notes.note(PERIODS, FieldValue::Data(DataArray::float64(PERIODS, 1, periods.to_vec())));
    Ok(LabelledCells {
        mesh: MeshFile { points: points.points, faces, ..MeshFile::default() },
        is_plane: file.is_plane,
        labels,
        label_array: "FaceLabels",
        originals: Some(points.originals),
        notes,
        ..LabelledCells::default()
    })
}

/// One of the two sides of an element: by position.
type SideOf = (usize, usize);

/// How many periods each body has each element from where its first corner is: from one element of a body, its others follow over what they share.
fn laid_out(
    file: &Datafile,
    periods: DVec3,
    elements: &[Element],
) -> Result<Vec<[Periods; 2]>, MeshFileProblem> {
    let links = links(file, periods, elements);
    let mut at: Vec<[Option<Periods>; 2]> = vec![[None; 2]; elements.len()];
    let mut has_begun = vec![false; file.bodies.len()];
    for (index, element) in elements.iter().enumerate() {
        for (side, body) in element.sides.iter().enumerate() {
            let Some(body) = *body else { continue };
            if at[index][side].is_some() {
                continue;
            }
            if std::mem::replace(&mut has_begun[body], true) {
                let what = format!("body {} is in several parts", file.bodies[body].0);
                return Err(MeshFileProblem::corrupt("Surface Evolver", what));
            }
            at[index][side] = Some([0; 3]);
            let mut queue = VecDeque::from([(index, side, [0; 3])]);
            while let Some((index, side, here)) = queue.pop_front() {
                for ((index, side), away) in links.get(&(index, side)).into_iter().flatten() {
                    if at[*index][*side].is_none() {
                        let there = sum(here, *away);
                        at[*index][*side] = Some(there);
                        queue.push_back((*index, *side, there));
                    }
                }
            }
        }
    }
    Ok(at.into_iter().map(|at| at.map(Option::unwrap_or_default)).collect())
}

/// An element beside an edge (in the plane: a vertex).
struct Around {
    element: usize,
    /// Where the edge begins, from the element's first corner.
    place: Periods,
    /// The direction in which the element lies.
    angle: f64,
    /// The side to which angles grow.
    ahead: usize,
}

/// The sides of elements between which nothing but a body lies, and how far the second element's first corner is from that of the first.
fn links(file: &Datafile, periods: DVec3, elements: &[Element]) -> BTreeMap<SideOf, Vec<(SideOf, Periods)>> {
    let mut around: BTreeMap<usize, Vec<Around>> = BTreeMap::new();
    for (index, element) in elements.iter().enumerate() {
        let position = |corner: &Corner| {
            file.vertices[corner.vertex] + DVec3::from_array(corner.periods.map(f64::from)) * periods
        };
        let mut add = |shared: usize, place: Periods, angle: f64, ahead: usize| {
            around.entry(shared).or_default().push(Around { element: index, place, angle, ahead });
        };
        if file.is_plane {
            let [from, to] = [0, 1].map(|end| element.corners[end]);
            let along = position(&to) - position(&from);
            // A body lies to the left of its edges.
            add(from.vertex, from.periods, along.y.atan2(along.x), 0);
            add(to.vertex, to.periods, (-along.y).atan2(-along.x), 1);
            continue;
        }
        let middle = element.corners.iter().map(position).sum::<DVec3>() / element.corners.len() as f64;
        let next = element.corners.iter().cycle().skip(1);
        for (edge, (mut from, mut to)) in element.edges.iter().zip(element.corners.iter().zip(next)) {
            if edge.is_reversed {
                (from, to) = (to, from);
            }
            let axis = (position(to) - position(from)).normalize_or(DVec3::X);
            let u = axis.any_orthonormal_vector();
            let radius = middle - position(from);
            // A body lies behind its facets, whose normals point away from it.
            let ahead = usize::from(!edge.is_reversed);
            add(edge.index, from.periods, radius.dot(axis.cross(u)).atan2(radius.dot(u)), ahead);
        }
    }
    let mut links: BTreeMap<SideOf, Vec<(SideOf, Periods)>> = BTreeMap::new();
    for mut around in around.into_values() {
        around.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.element.cmp(&b.element)));
        let next = around.iter().cycle().skip(1);
        for (one, two) in around.iter().zip(next) {
            let (from, to) = ((one.element, one.ahead), (two.element, 1 - two.ahead));
            if elements[from.0].sides[from.1] == elements[to.0].sides[to.1] {
                let away = difference(one.place, two.place);
                links.entry(from).or_default().push((to, away));
                links.entry(to).or_default().push((from, away.map(|count| -count)));
            }
        }
    }
    links
}

/// Whether a point is a vertex of the file, or the middle of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Original {
    Vertex(usize),
    Middle(usize),
}

/// The points of bodies that are laid out, with all that are a copy of another.
struct Points {
    periods: DVec3,
    points: Vec<DVec3>,
    /// The points at whole periods from each original.
    ids: BTreeMap<Original, BTreeMap<Periods, u32>>,
    originals: Vec<u32>,
}

impl Points {
    fn point(
        &mut self,
        original: Original,
        periods: Periods,
        position: DVec3,
    ) -> Result<u32, MeshFileProblem> {
        let next = id(self.points.len())?;
        let copies = self.ids.entry(original).or_default();
        let first = self.originals.get(copies.values().min().map_or(usize::MAX, |first| *first as usize));
        let first = first.copied().unwrap_or(next);
        let point = *copies.entry(periods).or_insert(next);
        if point == next {
            let [x, y, z] = periods.map(f64::from);
            self.points.push(position + DVec3::new(x, y, z) * self.periods);
            self.originals.push(first);
        }
        Ok(point)
    }

    /// An element some periods from where its first corner is: a segment, a triangle, or triangles around its middle.
    fn pieces(
        &mut self,
        file: &Datafile,
        index: usize,
        corners: &[Corner],
        place: Periods,
    ) -> Result<Vec<Vec<u32>>, MeshFileProblem> {
        let ids = corners
            .iter()
            .map(|Corner { vertex, periods }| {
                self.point(Original::Vertex(*vertex), sum(place, *periods), file.vertices[*vertex])
            })
            .collect::<Result<Vec<u32>, _>>()?;
        if file.is_plane || ids.len() == 3 {
            return Ok(vec![ids]);
        }
        let mut local: Vec<DVec3> = corners
            .iter()
            .map(|Corner { vertex, periods }| {
                file.vertices[*vertex] + DVec3::from_array(periods.map(f64::from)) * self.periods
            })
            .collect();
        let around = (0..).take(local.len()).collect();
        let pieces = triangles(around, &mut local)?;
        let middle = self.point(Original::Middle(index), place, local[corners.len()])?;
        let known = |corner: &u32| ids.get(*corner as usize).copied().unwrap_or(middle);
        Ok(pieces.iter().map(|piece| piece.iter().map(known).collect()).collect())
    }
}
