//! Points that make room for thin triangles.
//!
//! With s the sum of a triangle's squared sides and a its area, `q = s / (4 sqrt(3) a)` is 1 for an equilateral triangle and grows as
//! one over the smallest angle (Bank and Smith 1997). The points go down the gradient of the sum of `q^k`, pulled back through
//! subdivision. The area is that of the triangle's shadow on the surface as it was, so that what is turned over has a
//! negative one; `(a + sqrt(a^2 + d^2 s^2)) / 2` stands in for it, which leads it back (Escobar et al. 2003).

use glam::DVec3;
use subzero::{FaceId, VertexRule};

use crate::energy::local_elements::{LocalElements, index_in, local_elements};
use crate::energy::stencils::LocalStencils;
use crate::mesh::fold::LARGEST_FOLD;
use crate::mesh::level::LevelMesh;
use crate::mesh::triangle_quality::squared_sine;
use crate::{Freedom, LevelView, Mesh, Network};

/// k: the higher, the more the thinnest triangle alone counts.
const POWER: i32 = 3;

/// d: the area that counts as none, in units of s. A needle of a tenth of a degree has as much.
const NO_AREA: f64 = 1e-3;

/// Most steps down the gradient; most places take some ten. Much longer searches make of rounding what can be seen.
pub(crate) const STEPS: usize = 100;

/// So many steps in a row that make no angle wider lead nowhere: a line is too short, or a corner too sharp.
const PATIENCE: usize = 20;

/// Share of the wanted sine from which on points move although it is not reached. The least gains would cost as much: they move lines, and with
/// them angles between boundaries.
const WORTH: f64 = 0.5;

/// Times that a step is halved before it counts as one that leads nowhere.
const HALVINGS: usize = 20;

/// How far points on lines go where points inside boundaries go a length of one: with lines, angles between boundaries change.
const EASE_OF_LINES: f64 = 0.2;

/// Share of the decrease promised by the gradient which a step must bring (Armijo).
const LEAST_DECREASE: f64 = 1e-4;

/// Some points of one level that can move, and all triangles of the finest level in the boundaries around.
pub(crate) struct Room {
    /// The points of the level that the boundaries depend on, by number in the network.
    points: Vec<u32>,
    start: Vec<DVec3>,
    movable: Vec<Movable>,
    /// From level to level, up to the finest.
    stencils: Vec<LocalStencils>,
    triangles: Vec<[u32; 3]>,
    /// Where each triangle faces at first.
    facing: Vec<DVec3>,
}

/// What a search has found.
pub(crate) struct Widened {
    /// Where points go, by number in the network; none where that was no use.
    pub(crate) points: Vec<(u32, DVec3)>,
    /// Steps that were taken.
    pub(crate) steps: usize,
}

/// A point that can move.
struct Movable {
    /// Its place among all points.
    place: u32,
    freedom: Freedom,
    /// How far it goes where others go a length of one.
    ease: f64,
}

impl Room {
    /// The room of some points of a level: those inside boundaries move within their tangent plane, those on lines freely. `elements` are
    /// those of all boundaries around the points, boundary by boundary. None in the plane.
    pub(crate) fn new(
        network: &Network,
        level: usize,
        mut elements: Vec<u32>,
        movable: &[u32],
        points: &[DVec3],
    ) -> Option<Self> {
        let coarsest = &network.levels()[level];
        let Mesh::Triangles(mesh) = &coarsest.mesh else { return None };
        let (own, triangles) = local_triangles((&coarsest.mesh).into(), &elements)?;
        let start: Vec<DVec3> = own.iter().map(|point| points[*point as usize]).collect();
        let normals = vertex_normals(&triangles, &start);
        let movable = movable.iter().map(|point| {
            let walls = network.freedom(coarsest.walls[*point as usize]);
            let place = index_in(&own, *point);
            let (freedom, ease) = if mesh.vertex_rule(*point) == VertexRule::Smooth {
                (walls.and(Freedom::InPlane(normals[place as usize])), 1.0)
            } else {
                (walls, EASE_OF_LINES)
            };
            Movable { place, freedom, ease }
        });
        let movable = movable.collect();
        let mut room =
            Self { points: own.clone(), start, movable, stencils: Vec::new(), triangles, facing: Vec::new() };
        let mut coarser = own;
        for finer in level + 1..=network.level_count() {
            let LevelMesh::Triangles(mesh) = network.level(finer - 1).mesh() else { return None };
            let counts = mesh.counts();
            let children = |element: &u32| counts.triangle_children(FaceId(*element));
            elements = elements.iter().flat_map(children).map(|triangle| triangle.0).collect();
            let (points, triangles) = local_triangles(network.level(finer).elements(), &elements)?;
            let stencil = |point, entries: &mut Vec<_>| network.stencil(finer, point, entries);
            let mut stencils = LocalStencils::new();
            stencils.add(stencil, &coarser, points.iter().copied());
            room.stencils.push(stencils);
            (coarser, room.triangles) = (points, triangles);
        }
        room.face(&elements, network.finest());
        Some(room)
    }

    /// Remembers where triangles face, smoothed within each boundary.
    fn face(&mut self, elements: &[u32], finest: LevelView<'_>) {
        let surface = self.surfaces(&self.start).pop().expect("the level itself is one");
        let mut rest = self.triangles.as_slice();
        for part in elements.chunk_by(|a, b| finest.boundary(*a) == finest.boundary(*b)) {
            let triangles;
            (triangles, rest) = rest.split_at(part.len());
            let normals = vertex_normals(triangles, &surface);
            let mean =
                |corners: &[u32; 3]| corners.iter().map(|corner| normals[*corner as usize]).sum::<DVec3>();
            self.facing.extend(triangles.iter().map(|corners| mean(corners).normalize_or_zero()));
        }
    }

    /// Where the points go so that no triangle has an angle whose sine is below `wanted`, or as near to that as they come in so many steps if
    /// that is worth it.
    pub(crate) fn widened(&self, wanted: f64, most_steps: usize) -> Widened {
        let mut points = self.start.clone();
        let mut at = self.distortion(&points);
        let bend = at.least_cosine.min(LARGEST_FOLD);
        let (mut widest, mut best) = (at.least_sine, None);
        let (mut steps, mut last_gain) = (0, 0);
        let mut direction = at.toward.clone();
        let mut length: f64 = 1.0;
        while widest < wanted && steps < most_steps.min(last_gain + PATIENCE) {
            steps += 1;
            let mut gain = dot(&at.descent, &direction);
            if gain <= 0.0 {
                direction.clone_from(&at.toward);
                gain = dot(&at.descent, &direction);
            }
            length = (2.0 * length).min(1.0);
            let lower = (0..HALVINGS).find_map(|_| {
                let mut moved = points.clone();
                let moves = self.movable.iter().zip(&direction);
                moves.for_each(|(point, by)| moved[point.place as usize] += *by * (length * point.ease));
                let there = self.distortion(&moved);
                let is_lower = there.energy < at.energy - LEAST_DECREASE * length * gain;
                length *= if is_lower { 1.0 } else { 0.5 };
                is_lower.then_some((moved, there))
            });
            let Some((moved, there)) = lower else { break };
            if there.least_sine > widest && there.least_cosine >= bend {
                (widest, best, last_gain) = (there.least_sine, Some(moved.clone()), steps);
            }
            // Conjugate directions (Polak and Ribiere).
            let change = dot(&there.descent, &there.toward) - dot(&at.descent, &there.toward);
            let kept = (change / dot(&at.descent, &at.toward)).max(0.0);
            direction =
                there.toward.iter().zip(&direction).map(|(toward, last)| *toward + *last * kept).collect();
            (points, at) = (moved, there);
        }
        let places = self.movable.iter().map(|point| point.place as usize);
        let moved = |points: Vec<DVec3>| places.map(|place| (self.points[place], points[place])).collect();
        let best = best.filter(|_| widest >= WORTH * wanted);
        Widened { points: best.map(moved).unwrap_or_default(), steps }
    }

    /// The points of all levels, up to the finest.
    fn surfaces(&self, points: &[DVec3]) -> Vec<Vec<DVec3>> {
        let mut surfaces = vec![points.to_vec()];
        for stencils in &self.stencils {
            surfaces.push(stencils.of(0).apply(&surfaces[surfaces.len() - 1]));
        }
        surfaces
    }

    fn distortion(&self, points: &[DVec3]) -> Distortion {
        let surfaces = self.surfaces(points);
        let surface = &surfaces[surfaces.len() - 1];
        let (mut energy, mut least, mut least_cosine) = (0.0, f64::INFINITY, f64::INFINITY);
        let mut descent = vec![DVec3::ZERO; surface.len()];
        // In all three components the same.
        let mut stiffness = descent.clone();
        for (corners, facing) in self.triangles.iter().zip(&self.facing) {
            let triangle = corners.map(|corner| surface[corner as usize]);
            least = f64::min(least, squared_sine(triangle));
            let [a, b, c] = triangle;
            let across = [c - b, a - c, b - a];
            let squares: f64 = across.iter().map(|side| side.length_squared()).sum();
            let normal = across[0].cross(across[1]);
            let area = 0.5 * normal.dot(*facing);
            least_cosine = least_cosine.min(2.0 * area / normal.length());
            let root = area.hypot(NO_AREA * squares);
            let positive = 0.5 * (area + root);
            let power = (squares / (4.0 * 3f64.sqrt() * positive)).powi(POWER);
            energy += power;
            // The slopes of the logarithm of q by the squares and by the area.
            let by_squares = 1.0 / squares - 0.5 * NO_AREA * NO_AREA * squares / (root * positive);
            let by_area = -1.0 / root;
            for k in 0..3 {
                let of_squares = 2.0 * (across[(k + 1) % 3] - across[(k + 2) % 3]);
                let of_area = 0.5 * facing.cross(across[k]);
                let slope = (of_squares * by_squares + of_area * by_area) * f64::from(POWER);
                descent[corners[k] as usize] -= slope * power;
                stiffness[corners[k] as usize] += DVec3::splat(slope.length_squared() * power);
            }
        }
        for (stencils, coarser) in self.stencils.iter().zip(&surfaces).rev() {
            for field in [&mut descent, &mut stiffness] {
                let mut pulled = vec![DVec3::ZERO; coarser.len()];
                stencils.of(0).pull_back(field, &mut pulled);
                *field = pulled;
            }
        }
        let eased = |point: &Movable| point.freedom.project(descent[point.place as usize]) * point.ease;
        let descent: Vec<DVec3> = self.movable.iter().map(eased).collect();
        let softly =
            |(point, by): (&Movable, &DVec3)| *by / (point.ease.powi(2) * stiffness[point.place as usize].x);
        let toward = self.movable.iter().zip(&descent).map(softly).collect();
        Distortion { energy, descent, toward, least_sine: least.sqrt(), least_cosine }
    }
}

/// How far triangles are from equilateral.
struct Distortion {
    /// The sum of `q^k`.
    energy: f64,
    /// Minus its gradient at each movable point, by the point's ease.
    descent: Vec<DVec3>,
    /// That in units of how stiff each point is held: a step of Gauss and Newton, but for what couples the points.
    toward: Vec<DVec3>,
    /// The sine of the smallest angle.
    least_sine: f64,
    /// The cosine of the largest angle by which a triangle is turned from where it faced at first.
    least_cosine: f64,
}

/// Some elements of a mesh in terms of their own points, and these points, sorted.
fn local_triangles(all: crate::Elements<'_>, elements: &[u32]) -> Option<(Vec<u32>, Vec<[u32; 3]>)> {
    match local_elements(all, elements) {
        (points, LocalElements::Triangles(triangles)) => Some((points, triangles)),
        (_, LocalElements::Segments(_)) => None,
    }
}

/// The sum of the triangles' normals around each point, as a unit vector.
fn vertex_normals(triangles: &[[u32; 3]], points: &[DVec3]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; points.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        corners.iter().for_each(|corner| normals[*corner as usize] += (b - a).cross(c - a));
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::Junctions;

    /// Three grains, and the room of a point inside a boundary and one on a line.
    fn room() -> Room {
        let seeds = [(0.25, 0.3), (0.75, 0.25), (0.4, 0.8)].map(|(x, y)| DVec3::new(x, y, 0.5));
        let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&tessellation, Junctions::Crease, 2).expect("a network");
        let control = network.control_mesh();
        let Mesh::Triangles(mesh) = &control.mesh else { unreachable!("three dimensions") };
        let inside = |point: &u32| control.walls[*point as usize].is_empty();
        let points = || (0u32..).take(control.vertex_count()).filter(inside);
        let mut movable = [VertexRule::Smooth, VertexRule::Crease]
            .map(|rule| points().find(|point| mesh.vertex_rule(*point) == rule).expect("there are some"));
        movable.sort_unstable();
        let mut elements: Vec<u32> = (0u32..).take(control.element_count()).collect();
        elements.sort_by_key(|element| control.boundary_of[*element as usize]);
        Room::new(&network, 0, elements, &movable, &flat).expect("triangles")
    }

    #[test]
    fn the_gradient_is_that_of_the_energy() {
        let room = room();
        let mut points = room.start.clone();
        for (place, point) in points.iter_mut().enumerate() {
            *point += DVec3::splat(0.01 * (place as f64).sin());
        }
        let descent = room.distortion(&points).descent;
        for (point, descent) in room.movable.iter().zip(&descent) {
            for axis in DVec3::AXES {
                let along = point.freedom.project(axis) * point.ease;
                let energy = |step: f64| {
                    let mut moved = points.clone();
                    moved[point.place as usize] += along * step;
                    room.distortion(&moved).energy
                };
                let slope = (energy(1e-6) - energy(-1e-6)) / 2e-6;
                assert!(
                    (slope + descent.dot(axis)).abs() < 1e-6 * room.distortion(&points).energy,
                    "{slope}"
                );
            }
        }
    }

    #[test]
    fn a_point_that_makes_thin_triangles_goes_back_among_its_neighbours() {
        let mut room = room();
        let inside = room.movable.iter().find(|point| point.ease == 1.0).expect("one inside").place as usize;
        let start = room.start[inside];
        let others = room.start.iter().filter(|point| **point != start);
        let nearest = *others.min_by(|a, b| a.distance(start).total_cmp(&b.distance(start))).expect("others");
        let before = room.distortion(&room.start).least_sine;
        room.start[inside] = start.lerp(nearest, 0.95);
        let after = room.distortion(&room.start).least_sine;
        assert!(after < 0.5 * before, "{after} {before}");
        let wanted = 0.9 * before;
        let mut go = |wanted| {
            for (point, place) in room.widened(wanted, STEPS).points {
                let place_of = room.points.iter().position(|other| *other == point).expect("one of them");
                room.start[place_of] = place;
            }
            room.distortion(&room.start).least_sine
        };
        let [reached, wider, as_wide] = [wanted, 1.9 * wanted, 1.0].map(&mut go);
        assert!(reached >= wanted, "{reached} {wanted}");
        // As wide as there is room for, and no farther for a gain that is not worth it.
        assert!(wider > reached && wider < 1.9 * wanted, "{wider} {reached}");
        assert_eq!(as_wide, wider);
    }
}
