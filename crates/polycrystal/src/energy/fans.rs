//! The boundaries of a cell complex as flat fans of triangles.
//!
//! The rim of a boundary leads through its vertices and a point in each of its lines; the fan's triangles lead from there to a centre.
//! Points are those of the vertices, in their order in the complex, then those of the lines, then the centres; each once, also in
//! a periodic domain.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::iter::repeat_n;
use rayon::prelude::*;
use voronoi::{Domain, FaceId, PeriodicVertex, Side, Translation, Wall};

use crate::energy::sides::{cell_and_offset, freedom_on, tension_between};
use crate::energy::triangle::Triangle;
use crate::mesh::fold::is_folded;
use crate::mesh::grouped::{Grouped, split};
use crate::mesh::id::id;
use crate::mesh::volume::{Cone, ConeSum};
use crate::{Boundary, CellComplex, ComplexEdge, Freedom};

/// Fans that one task works on.
const FANS_PER_TASK: usize = 256;

/// The fans of all boundaries.
pub(crate) struct Fans {
    domain: Domain,
    vertex_count: usize,
    pub(crate) lines: Vec<ComplexEdge>,
    pub(crate) faces: Vec<FaceId>,
    /// Of each fan.
    pub(crate) sides: Vec<[Side; 2]>,
    pub(crate) tensions: Vec<f64>,
    /// The slots of fan f are `starts[f]..starts[f + 1]`: those of its rim, in which lines follow vertices, and its centre.
    starts: Vec<usize>,
    slots: Vec<Slot>,
    /// The slots of each point, as pairs of a fan and a slot.
    of_point: Grouped<[u32; 2]>,
}

/// A point, and by how many periods it is away from its own place where a fan has it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slot {
    pub(crate) point: u32,
    pub(crate) translation: Translation,
}

/// What a slot brings to a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SlotTerms {
    /// Of the area weighted by tension, by the point.
    pub(crate) gradient: DVec3,
    /// Volume swept from the first side to the second, per displacement of the point.
    pub(crate) volume_gradient: DVec3,
    /// Share of the area that the point stands for.
    pub(crate) mass: f64,
}

/// The stiffness of the edges that begin at a slot.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct EdgeStiffness {
    /// To the next slot of the rim.
    pub(crate) rim: f64,
    pub(crate) to_center: f64,
}

/// The fans where their points are.
pub(crate) struct FanTerms {
    /// Area weighted by tension.
    pub(crate) energy: f64,
    pub(crate) of_slot: Vec<SlotTerms>,
    /// Of each slot. What holds a point is asked for without the rest: apart, less has to come through the memory.
    pub(crate) stiffness: Vec<EdgeStiffness>,
}

impl Fans {
    /// The fans of a complex whose boundaries have these tensions.
    pub(crate) fn new(complex: &CellComplex, tension: &(dyn Fn(&Boundary) -> f64 + Sync)) -> Self {
        let domain = complex.domain().clone();
        let (faces, lines) = rayon::join(|| complex.faces(), || complex.edges());
        let vertex_count = complex.vertices.len();
        let mut starts = vec![0];
        for face in &faces {
            starts.push(starts[starts.len() - 1] + 2 * complex.corners(*face).len() + 1);
        }
        let slot_count = starts[faces.len()];
        let mut slots: Vec<Slot> =
            repeat_n(Slot { point: 0, translation: Translation::ZERO }, slot_count).collect();
        let fill = |(fan, slots): (usize, &mut [Slot])| {
            let slot = |point: usize, translation| Slot { point: id(point), translation };
            let corners = complex.corners(faces[fan]);
            for (k, from) in corners.iter().enumerate() {
                let to = corners[(k + 1) % corners.len()];
                slots[2 * k] = slot(from.vertex as usize, from.translation);
                let (line, translation) = line_between(*from, to);
                let number = lines.binary_search(&line).expect("lines of faces are lines of the complex");
                slots[2 * k + 1] = slot(vertex_count + number, translation);
            }
            slots[2 * corners.len()] = slot(vertex_count + lines.len() + fan, Translation::ZERO);
        };
        split(&mut slots, &starts).into_par_iter().enumerate().with_min_len(FANS_PER_TASK).for_each(fill);
        let sides: Vec<[Side; 2]> = faces.par_iter().map(|face| complex.sides(*face)).collect();
        let point_count = vertex_count + lines.len() + faces.len();
        let of_point = || {
            let of_fan =
                (0..faces.len()).flat_map(|fan| (starts[fan]..starts[fan + 1]).map(move |slot| (fan, slot)));
            let pairs = of_fan.map(|(fan, slot)| (slots[slot].point as usize, [id(fan), id(slot)]));
            Grouped::new(point_count, pairs)
        };
        let tensions = || sides.par_iter().map(|sides| tension_between(*sides, tension)).collect();
        let (of_point, tensions) = rayon::join(of_point, tensions);
        Self { domain, vertex_count, lines, faces, sides, tensions, starts, slots, of_point }
    }

    /// Number of vertices, which come first among the points.
    pub(crate) fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    pub(crate) fn point_count(&self) -> usize {
        self.of_point.count()
    }

    /// The point of a line.
    pub(crate) fn point_of_line(&self, line: usize) -> usize {
        self.vertex_count + line
    }

    /// The centre of a fan.
    pub(crate) fn center_of(&self, fan: usize) -> usize {
        self.vertex_count + self.lines.len() + fan
    }

    /// Number of points in a fan's rim.
    pub(crate) fn rim_len(&self, fan: usize) -> usize {
        self.starts[fan + 1] - self.starts[fan] - 1
    }

    /// The slots of a fan, its centre last.
    pub(crate) fn slots_of(&self, fan: usize) -> &[Slot] {
        &self.slots[self.starts[fan]..self.starts[fan + 1]]
    }

    /// Where a fan has the point of a slot.
    pub(crate) fn position(&self, slot: Slot, points: &[DVec3]) -> DVec3 {
        points[slot.point as usize] + slot.translation.vector(&self.domain)
    }

    /// The first slot of a fan.
    pub(crate) fn first_slot(&self, fan: usize) -> usize {
        self.starts[fan]
    }

    /// The fans at a point, and which of their slots it is.
    pub(crate) fn at_point(&self, point: usize) -> impl Iterator<Item = (usize, usize)> {
        self.of_point
            .of(point)
            .iter()
            .map(|[fan, slot]| (*fan as usize, *slot as usize - self.starts[*fan as usize]))
    }

    /// The boundaries that meet at a line, sorted.
    pub(crate) fn faces_of_line(&self, line: usize) -> Vec<FaceId> {
        let mut faces: Vec<FaceId> =
            self.at_point(self.point_of_line(line)).map(|(fan, _)| self.faces[fan]).collect();
        faces.dedup();
        faces
    }

    /// What walls leave to a point.
    pub(crate) fn freedom(&self, point: usize) -> Freedom {
        let walls = self.at_point(point).filter_map(|(fan, _)| self.wall(fan));
        let mut walls: Vec<Wall> = walls.collect();
        walls.sort_unstable();
        walls.dedup();
        freedom_on(&self.domain, &walls)
    }

    /// The wall that a fan lies on.
    pub(crate) fn wall(&self, fan: usize) -> Option<Wall> {
        match self.sides[fan][1] {
            Side::Wall(wall) => Some(wall),
            Side::Cell(_) | Side::Image(..) => None,
        }
    }

    /// Where a line is halfway between its ends.
    pub(crate) fn middle(&self, line: ComplexEdge, points: &[DVec3]) -> DVec3 {
        let end = points[line.end.vertex as usize] + line.end.translation.vector(&self.domain);
        points[line.start as usize].midpoint(end)
    }

    /// The mean of the vertices of a fan.
    pub(crate) fn mean_of_corners(&self, fan: usize, points: &[DVec3]) -> DVec3 {
        let corners = self.slots_of(fan)[..self.rim_len(fan)].iter().step_by(2);
        corners.map(|slot| self.position(*slot, points)).sum::<DVec3>() / (self.rim_len(fan) / 2) as f64
    }

    /// The fans with neighbouring triangles that are further apart than the angle whose cosine is given.
    pub(crate) fn folded(&self, points: &[DVec3], cosine: f64) -> Vec<usize> {
        let is_folded = |normals: &mut Vec<DVec3>, fan: usize| {
            normals.clear();
            normals.extend(self.normals_of(fan, points));
            let mut pairs = normals.iter().zip(normals.iter().cycle().skip(1));
            pairs.any(|(a, b)| is_folded([*a, *b], cosine)).then_some(fan)
        };
        let fans = (0..self.faces.len()).into_par_iter().with_min_len(FANS_PER_TASK);
        fans.map_init(Vec::new, is_folded).flatten_iter().collect()
    }

    /// The rim of a fan, and its centre last.
    fn ring(&self, fan: usize, points: &[DVec3]) -> Vec<DVec3> {
        self.slots_of(fan).iter().map(|slot| self.position(*slot, points)).collect()
    }

    /// Of each slot of a fan's rim the normal of the triangle that begins there, twice as long as its area.
    pub(crate) fn normals_of(&self, fan: usize, points: &[DVec3]) -> impl Iterator<Item = DVec3> {
        let (rim, center) = self.slots_of(fan).split_at(self.rim_len(fan));
        let center = self.position(center[0], points);
        let spoke = move |slot: &Slot| self.position(*slot, points) - center;
        rim.iter().zip(rim.iter().cycle().skip(1)).map(move |(from, to)| spoke(from).cross(spoke(to)))
    }

    /// The volume of each cell.
    pub(crate) fn volumes(&self, cell_count: usize, points: &[DVec3]) -> Vec<f64> {
        let area = |fan: usize| -> DVec3 { 0.5 * self.normals_of(fan, points).sum::<DVec3>() };
        let areas = (0..self.faces.len()).into_par_iter().with_min_len(FANS_PER_TASK).map(area);
        let areas: Vec<DVec3> = areas.collect();
        let mut sums = vec![ConeSum::default(); cell_count];
        for (fan, (sides, area)) in self.sides.iter().zip(areas).enumerate() {
            let center = points[self.center_of(fan)];
            for (side, sign) in sides.iter().zip([1.0, -1.0]) {
                let Some((cell, offset)) = cell_and_offset(*side, &self.domain) else { continue };
                // All triangles end at the centre, so that the cone from there has no volume.
                let cone = Cone::new(center - offset, 0.0, area, voronoi::Dimension::Three);
                sums[cell.index()].add(&cone, sign);
            }
        }
        sums.into_iter().map(|sum| sum.volume).collect()
    }

    /// What a step needs to know, with no cotangent above the given one.
    pub(crate) fn terms(&self, points: &[DVec3], largest_cotangent: f64) -> FanTerms {
        let mut of_slot: Vec<SlotTerms> = repeat_n(SlotTerms::default(), self.slots.len()).collect();
        let mut stiffness: Vec<EdgeStiffness> =
            repeat_n(EdgeStiffness::default(), self.slots.len()).collect();
        let fill = |(fan, (terms, stiffness)): (usize, (&mut [SlotTerms], &mut [EdgeStiffness]))| {
            check_cancelled();
            fill_terms(&self.ring(fan, points), self.tensions[fan], largest_cotangent, terms, stiffness)
        };
        let of_fans = split(&mut of_slot, &self.starts).into_par_iter();
        let fans = of_fans.zip(split(&mut stiffness, &self.starts)).enumerate();
        let energies: Vec<f64> = fans.with_min_len(FANS_PER_TASK).map(fill).collect();
        FanTerms { energy: energies.iter().sum(), of_slot, stiffness }
    }
}

/// The terms of one fan; gives its area times tension.
fn fill_terms(
    ring: &[DVec3],
    tension: f64,
    largest_cotangent: f64,
    terms: &mut [SlotTerms],
    stiffness: &mut [EdgeStiffness],
) -> f64 {
    let center = ring.len() - 1;
    let mut area = 0.0;
    for k in 0..center {
        let next = (k + 1) % center;
        let slots = [center, k, next];
        let triangle = Triangle::new(slots.map(|slot| ring[slot]));
        let Triangle { normal, doubled_area, .. } = triangle;
        area += 0.5 * doubled_area;
        let half_pull = normal / doubled_area.max(f64::MIN_POSITIVE) * (0.5 * tension);
        for (slot, gradient) in slots.into_iter().zip(triangle.gradients(half_pull)) {
            let terms = &mut terms[slot];
            terms.gradient += gradient;
            terms.volume_gradient += triangle.volume_gradient();
            if tension > 0.0 {
                terms.mass += doubled_area / 6.0;
            }
        }
        let [at_center, at_k, at_next] =
            triangle.cotangents(largest_cotangent).map(|cotangent| 0.5 * tension * cotangent);
        stiffness[k].rim += at_center;
        stiffness[k].to_center += at_next;
        stiffness[next].to_center += at_k;
    }
    tension * area
}

/// The line between two corners in a row, and the translation of its point there.
fn line_between(from: PeriodicVertex, to: PeriodicVertex) -> (ComplexEdge, Translation) {
    let line = ComplexEdge::between([from, to]);
    let starts_here = line.start == from.vertex
        && line.end == PeriodicVertex { vertex: to.vertex, translation: to.translation - from.translation };
    (line, if starts_here { from.translation } else { to.translation })
}
