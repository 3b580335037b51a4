//! Whether the elements around each edge (in the plane: each point) close the surfaces of all grains.

use std::collections::BTreeMap;

use crate::check::fault::{Fault, Place};
use crate::mesh::seams::{Seams, Use};
use crate::{GrainId, Side, Surface};

/// What is wrong at the places where not two elements of one boundary meet.
///
/// An element whose change of sides would close all its places is blamed for them; other places are told one by one.
pub(crate) fn faults_of_closing(surface: &Surface<'_>, seams: &Seams) -> Vec<Fault> {
    let places: Vec<&[Use]> = seams.places().collect();
    let mut faults: Vec<Fault> = places.iter().flat_map(|at| repeated_elements(surface, at)).collect();
    let mut open: BTreeMap<u32, &[Use]> =
        places.iter().filter(|at| !is_closed(surface, at, None)).map(|at| (at[0].place, *at)).collect();
    for (element, places) in suspects(surface, &open) {
        let places: Vec<&[Use]> = places.iter().filter_map(|place| open.get(place).copied()).collect();
        // Another suspect may have explained some of its places.
        if places.len() < surface.elements.corners(element).len() {
            continue;
        }
        if let Some(sides) = sides_that_close(surface, element, &places) {
            let stated = surface.sides_of(element);
            let is_turned = sides == [stated[1], stated[0]];
            faults.push(if is_turned {
                Fault::Turned { element }
            } else {
                Fault::WrongSides { element, stated, fitting: sides }
            });
            for at in places {
                open.remove(&at[0].place);
            }
        }
    }
    faults.extend(open.values().map(|at| fault_at(surface, at)));
    faults.extend(places.iter().flat_map(|at| pinches(surface, at)));
    faults
}

/// Number of places where some grain, or the exterior, is not closed.
pub(crate) fn open_place_count(surface: &Surface<'_>, seams: &Seams) -> usize {
    seams.places().filter(|at| !is_closed(surface, at, None)).count()
}

/// Sides at a place, each with 1 for each element that walks it one way around and -1 for the other; sorted.
fn walks(surface: &Surface<'_>, at: &[Use], changed: Option<(u32, [Side; 2])>) -> Vec<(Side, i32)> {
    let mut walks = Vec::with_capacity(2 * at.len());
    for at in at {
        let sides = match changed {
            Some((element, sides)) if element == at.element => sides,
            _ => surface.sides_of(at.element),
        };
        // An element walks its place one way for its first side and the other way for its second.
        let direction = at.direction(surface.elements);
        walks.extend(sides.into_iter().zip([direction, -direction]));
    }
    walks.sort_unstable();
    walks
}

fn is_closed(surface: &Surface<'_>, at: &[Use], changed: Option<(u32, [Side; 2])>) -> bool {
    if changed.is_none()
        && let [a, b, c] = at
    {
        // Nearly all places are like this, and this is quick.
        let walk = |at: &Use| {
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

/// Elements with nothing but open places, and these.
fn suspects(surface: &Surface<'_>, open: &BTreeMap<u32, &[Use]>) -> BTreeMap<u32, Vec<u32>> {
    let mut places: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for at in open.values().copied().flatten() {
        places.entry(at.element).or_default().push(at.place);
    }
    places.retain(|element, places| places.len() == surface.elements.corners(*element).len());
    places
}

/// The sides with which an element would close all its places: its own the other way around, or those of a neighbour.
fn sides_that_close(surface: &Surface<'_>, element: u32, places: &[&[Use]]) -> Option<[Side; 2]> {
    let own = surface.sides_of(element);
    let mut candidates = vec![[own[1], own[0]]];
    for at in places.iter().copied().flatten().filter(|at| at.element != element) {
        let sides = surface.sides_of(at.element);
        candidates.extend([sides, [sides[1], sides[0]]]);
    }
    let closes = |sides: &[Side; 2]| places.iter().all(|at| is_closed(surface, at, Some((element, *sides))));
    candidates.into_iter().find(closes)
}

fn fault_at(surface: &Surface<'_>, at: &[Use]) -> Fault {
    let place = place(surface, at);
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

/// Grains whose surface passes a place more than once. In the plane a grain may touch itself in no point either.
fn pinches(surface: &Surface<'_>, at: &[Use]) -> Vec<Fault> {
    if at.len() < 4 {
        return Vec::new();
    }
    let walks = walks(surface, at, None);
    let sides = walks.chunk_by(|a, b| a.0 == b.0).filter(|walks| walks.len() > 3);
    let grains = sides.filter_map(|walks| Some((walks[0].0.grain()?, walks.len())));
    grains.map(|(grain, elements)| Fault::Pinched { place: place(surface, at), grain, elements }).collect()
}

fn repeated_elements(surface: &Surface<'_>, at: &[Use]) -> Vec<Fault> {
    let corners = |element: u32| {
        let mut corners = surface.elements.corners(element).to_vec();
        corners.sort_unstable();
        corners
    };
    let mut faults = Vec::new();
    for (index, first) in at.iter().enumerate() {
        for second in &at[index + 1..] {
            let places = if first.element < second.element { (first, second) } else { (second, first) };
            let elements = [places.0.element, places.1.element];
            let [a, b] = elements.map(|element| surface.elements.corners(element));
            // Each pair meets at all its places: the one with the lowest point tells.
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

/// Whether a place does not touch the highest point of its element (in the plane: is not its higher end).
fn tells(surface: &Surface<'_>, at: &Use) -> bool {
    let highest = surface.elements.corners(at.element).iter().max();
    !at.ends(surface.elements).iter().any(|end| Some(end) == highest)
}

fn place(surface: &Surface<'_>, at: &[Use]) -> Place {
    let [a, b] = at[0].ends(surface.elements);
    if a == b { Place::Point(a) } else { Place::Edge([a.min(b), a.max(b)]) }
}
