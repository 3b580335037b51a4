//! Whether the elements around each edge (in the plane: each point) close the surfaces of all grains.

use std::collections::BTreeMap;

use crate::check::fault::{Fault, Place};
use crate::mesh::adjacency::{Adjacency, Incidence};
use crate::{GrainId, Side, Surface};

/// What is wrong at the edges that are not inside a boundary.
///
/// An element whose change of sides would close all its edges is blamed for them; other edges are reported one by one.
pub(crate) fn closedness_faults(surface: &Surface<'_>, adjacency: &Adjacency<'_>) -> Vec<Fault> {
    let edges: Vec<&[Incidence]> = adjacency.non_manifold_edges().collect();
    let mut faults: Vec<Fault> = edges.iter().flat_map(|at| repeated_elements(surface, at)).collect();
    let mut open: BTreeMap<u32, &[Incidence]> =
        edges.iter().filter(|at| !is_closed(surface, at, None)).map(|at| (at[0].edge, *at)).collect();
    for (element, edges) in suspects(surface, &open) {
        let edges: Vec<&[Incidence]> = edges.iter().filter_map(|edge| open.get(edge).copied()).collect();
        // Another suspect may have explained some of its edges.
        if edges.len() < surface.elements.corners(element).len() {
            continue;
        }
        if let Some(sides) = sides_that_close(surface, element, &edges) {
            let stated = surface.sides_of(element);
            let is_turned = sides == [stated[1], stated[0]];
            faults.push(if is_turned {
                Fault::Turned { element }
            } else {
                Fault::WrongSides { element, stated, fitting: sides }
            });
            for at in edges {
                open.remove(&at[0].edge);
            }
        }
    }
    faults.extend(open.values().map(|at| fault_at(surface, at)));
    faults.extend(edges.iter().flat_map(|at| pinches(surface, at)));
    faults
}

/// Number of edges where some grain, or the exterior, is not closed.
pub(crate) fn open_edge_count(surface: &Surface<'_>, adjacency: &Adjacency<'_>) -> usize {
    adjacency.non_manifold_edges().filter(|at| !is_closed(surface, at, None)).count()
}

/// Sides at an edge, each with 1 for each element that walks it one way around and -1 for the other; sorted.
fn walks(surface: &Surface<'_>, at: &[Incidence], changed: Option<(u32, [Side; 2])>) -> Vec<(Side, i32)> {
    let mut walks = Vec::with_capacity(2 * at.len());
    for at in at {
        let sides = match changed {
            Some((element, sides)) if element == at.element => sides,
            _ => surface.sides_of(at.element),
        };
        // An element walks its edge one way for its first side and the other way for its second.
        let direction = at.direction(surface.elements);
        walks.extend(sides.into_iter().zip([direction, -direction]));
    }
    walks.sort_unstable();
    walks
}

fn is_closed(surface: &Surface<'_>, at: &[Incidence], changed: Option<(u32, [Side; 2])>) -> bool {
    if changed.is_none()
        && let [a, b, c] = at
    {
        // Nearly all edges are like this, and this is quick.
        let walk = |at: &Incidence| {
            let ([first, second], way) = (surface.sides_of(at.element), at.direction(surface.elements));
            if way > 0 { [first, second] } else { [second, first] }
        };
        let [[a, after_a], [b, after_b], [c, after_c]] = [walk(a), walk(b), walk(c)];
        let is_round = |sides: [Side; 3]| sides == [a, b, c];
        if is_round([after_b, after_c, after_a]) || is_round([after_c, after_a, after_b]) {
            return true;
        }
    }
    let walks = walks(surface, at, changed);
    walks.chunk_by(|a, b| a.0 == b.0).all(|walks| walks.iter().map(|(_, way)| way).sum::<i32>() == 0)
}

/// Elements with nothing but open edges, and these.
fn suspects(surface: &Surface<'_>, open: &BTreeMap<u32, &[Incidence]>) -> BTreeMap<u32, Vec<u32>> {
    let mut edges: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for at in open.values().copied().flatten() {
        edges.entry(at.element).or_default().push(at.edge);
    }
    edges.retain(|element, edges| edges.len() == surface.elements.corners(*element).len());
    edges
}

/// The sides with which an element would close all its edges: its own the other way around, or those of a neighbour.
fn sides_that_close(surface: &Surface<'_>, element: u32, edges: &[&[Incidence]]) -> Option<[Side; 2]> {
    let own = surface.sides_of(element);
    let mut candidates = vec![[own[1], own[0]]];
    for at in edges.iter().copied().flatten().filter(|at| at.element != element) {
        let sides = surface.sides_of(at.element);
        candidates.extend([sides, [sides[1], sides[0]]]);
    }
    let closes = |sides: &[Side; 2]| edges.iter().all(|at| is_closed(surface, at, Some((element, *sides))));
    candidates.into_iter().find(closes)
}

fn fault_at(surface: &Surface<'_>, at: &[Incidence]) -> Fault {
    let place = place_of(surface, at);
    let walks = walks(surface, at, None);
    let sides = walks.chunk_by(|a, b| a.0 == b.0);
    let uneven: Vec<GrainId> =
        sides.filter(|walks| walks.len() % 2 == 1).filter_map(|walks| walks[0].0.grain()).collect();
    if uneven.is_empty() {
        Fault::Winding { place, elements: at.iter().map(|at| at.element).collect() }
    } else {
        Fault::Open { place, grains: uneven }
    }
}

/// Grains whose surface passes an edge more than once. In the plane a grain may touch itself in no point either.
fn pinches(surface: &Surface<'_>, at: &[Incidence]) -> Vec<Fault> {
    if at.len() < 4 {
        return Vec::new();
    }
    let walks = walks(surface, at, None);
    let sides = walks.chunk_by(|a, b| a.0 == b.0).filter(|walks| walks.len() > 3);
    let grains = sides.filter_map(|walks| Some((walks[0].0.grain()?, walks.len())));
    grains.map(|(grain, elements)| Fault::Pinched { place: place_of(surface, at), grain, elements }).collect()
}

fn repeated_elements(surface: &Surface<'_>, at: &[Incidence]) -> Vec<Fault> {
    let corners = |element: u32| {
        let mut corners = surface.elements.corners(element).to_vec();
        corners.sort_unstable();
        corners
    };
    let mut faults = Vec::new();
    for (index, first) in at.iter().enumerate() {
        for second in &at[index + 1..] {
            let edges = if first.element < second.element { (first, second) } else { (second, first) };
            let elements = [edges.0.element, edges.1.element];
            let [a, b] = elements.map(|element| surface.elements.corners(element));
            // Each pair meets at all its edges: the one with the lowest point tells.
            if a.iter().all(|corner| b.contains(corner))
                && corners(elements[0]) == corners(elements[1])
                && tells(surface, first)
            {
                faults.push(Fault::DuplicateElements { elements });
            }
        }
    }
    faults
}

/// Whether an edge does not touch the highest point of its element (in the plane: is not its higher end).
fn tells(surface: &Surface<'_>, at: &Incidence) -> bool {
    let highest = surface.elements.corners(at.element).iter().max().copied();
    !at.ends(surface.elements).iter().any(|end| Some(*end) == highest)
}

fn place_of(surface: &Surface<'_>, at: &[Incidence]) -> Place {
    let [a, b] = at[0].ends(surface.elements);
    if a == b { Place::Point(a) } else { Place::Edge([a.min(b), a.max(b)]) }
}
