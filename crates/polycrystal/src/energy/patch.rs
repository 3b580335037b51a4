//! One boundary as a finite element.
//!
//! The points of a boundary's subdivided surface depend on the control points of that boundary alone, for triple lines are
//! creases. So all that a boundary brings to the energy is made by itself, in parallel with the others.
//!
//! How area and volume change with the points of the surface ([`Triangle`]) is pulled back to the control points by the transposed weights
//! of subdivision.

use std::ops::{AddAssign, Mul};

use glam::DVec3;
use voronoi::Dimension;

use crate::energy::local_elements::ElementsPart;
use crate::energy::stencils::Stencils;
use crate::energy::triangle::Triangle;
use crate::mesh::id::id;
use crate::mesh::volume::{Cone, segment_area, triangle_volume};

/// A boundary's control mesh, and its surface in terms of the control points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Patch<'a> {
    /// The control points that the boundary depends on; all other fields count them from 0.
    pub(crate) control_points: &'a [u32],
    /// The elements of the control mesh. Its points and edges come in the order of their ids, so points of the next level do, too: first the control
    /// points, then those on the edges.
    pub(crate) elements: ElementsPart<'a>,
    /// Of each triangle of the control mesh, the edge across from each corner. In the plane, a segment is its own edge.
    pub(crate) edges_across: &'a [[u32; 3]],
    /// How the points of the surface follow, where it is that of the next level.
    pub(crate) stencils: Option<Stencils<'a>>,
    pub(crate) law: &'a Law,
}

/// How a boundary pulls and moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Law {
    /// Energy per area.
    pub(crate) tension: f64,
    /// Velocity per pressure, above 0.
    pub(crate) mobility: f64,
    /// 1, or 1/2 for a boundary that a periodic network holds twice.
    pub(crate) share: f64,
}

/// What a boundary brings to a step at one of its points.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PlaceTerms {
    /// Of the energy, by the point.
    pub(crate) gradient: DVec3,
    /// Volume swept from the first side to the second, per displacement of the point.
    pub(crate) volume_gradient: DVec3,
    /// Share of the area over mobility that the point stands for: of each triangle a third, as of its volume gradient, so that no
    /// volume gradient is longer than its mass. It has to be the same surface: masses of flat control triangles had gradients 200 times as
    /// long beside them where triangles of unlike size meet, and points so light went through their neighbours as soon as a volume was
    /// restored. Of a boundary without tension it is 0.
    pub(crate) mass: f64,
}

impl AddAssign for PlaceTerms {
    fn add_assign(&mut self, other: Self) {
        self.gradient += other.gradient;
        self.volume_gradient += other.volume_gradient;
        self.mass += other.mass;
    }
}

impl Mul<f64> for PlaceTerms {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        let Self { gradient, volume_gradient, mass } = self;
        Self { gradient: gradient * factor, volume_gradient: volume_gradient * factor, mass: mass * factor }
    }
}

impl Patch<'_> {
    /// Adds the terms at the given control points, and the stiffness of each edge; gives area times tension, and the cone to the surface.
    pub(crate) fn add_terms(
        &self,
        points: &[DVec3],
        largest_cotangent: f64,
        terms: &mut [PlaceTerms],
        stiffness: &mut [f64],
    ) -> (f64, Cone) {
        // From a point of the patch, for far from the origin volumes lose digits.
        let apex = points[self.control_points[0] as usize];
        let local: Vec<DVec3> = self.control_points.iter().map(|p| points[*p as usize] - apex).collect();
        self.add_stiffness(&local, largest_cotangent, stiffness);
        let Some(stencils) = self.stencils else {
            let [energy, volume] = match self.elements {
                ElementsPart::Triangles(triangles) => {
                    self.law.add_triangles(triangles.iter().copied(), &local, terms)
                }
                ElementsPart::Segments(segments) => {
                    self.law.add_segments(segments.iter().copied(), &local, terms)
                }
            };
            return (energy, cone(apex, volume, terms, self.elements));
        };
        let surface = stencils.apply(&local);
        let mut fine_terms = vec![PlaceTerms::default(); surface.len()];
        let first = id(self.control_points.len());
        let [energy, volume] = match self.elements {
            ElementsPart::Triangles(triangles) => {
                let finer = refined_triangles(triangles, self.edges_across, first);
                self.law.add_triangles(finer, &surface, &mut fine_terms)
            }
            ElementsPart::Segments(segments) => {
                let finer = (first..).zip(segments).flat_map(|(middle, [a, b])| [[*a, middle], [middle, *b]]);
                self.law.add_segments(finer, &surface, &mut fine_terms)
            }
        };
        stencils.pull_back(&fine_terms, terms);
        (energy, cone(apex, volume, &fine_terms, self.elements))
    }

    /// Adds the cotangent Laplacian times the tension as the stiffness of each edge.
    fn add_stiffness(&self, local: &[DVec3], largest_cotangent: f64, stiffness: &mut [f64]) {
        let tension = self.law.share * self.law.tension;
        if tension == 0.0 {
            return;
        }
        let at = |point: u32| local[point as usize];
        match self.elements {
            ElementsPart::Triangles(triangles) => {
                for (corners, across) in triangles.iter().zip(self.edges_across) {
                    let cotangents = Triangle::new(corners.map(at)).cotangents(largest_cotangent);
                    for (edge, cotangent) in across.iter().zip(cotangents) {
                        stiffness[*edge as usize] += 0.5 * tension * cotangent;
                    }
                }
            }
            ElementsPart::Segments(segments) => {
                for (ends, stiffness) in segments.iter().zip(stiffness) {
                    let length = at(ends[0]).distance(at(ends[1])).max(f64::MIN_POSITIVE);
                    *stiffness += tension / length;
                }
            }
        }
    }
}

impl Law {
    /// Adds the terms of the points of a surface in space, and gives its energy and its volume.
    fn add_triangles(
        &self,
        triangles: impl Iterator<Item = [u32; 3]>,
        points: &[DVec3],
        terms: &mut [PlaceTerms],
    ) -> [f64; 2] {
        let (tension, mass_share) = self.shares();
        let (mut area, mut volume) = (0.0, 0.0);
        for corners in triangles {
            let at = corners.map(|corner| points[corner as usize]);
            let triangle = Triangle::new(at);
            let Triangle { normal, doubled_area, .. } = triangle;
            let half_pull =
                if doubled_area > 0.0 { normal * (0.5 * tension / doubled_area) } else { DVec3::ZERO };
            for (corner, of_corner) in corners.iter().zip(triangle.gradients(half_pull)) {
                let terms = &mut terms[*corner as usize];
                terms.gradient += of_corner;
                terms.volume_gradient += triangle.volume_gradient();
                terms.mass += mass_share * doubled_area / 6.0;
            }
            area += 0.5 * doubled_area;
            volume += triangle_volume(at);
        }
        [tension * area, volume]
    }

    /// The same for lines in the plane.
    fn add_segments(
        &self,
        segments: impl Iterator<Item = [u32; 2]>,
        points: &[DVec3],
        terms: &mut [PlaceTerms],
    ) -> [f64; 2] {
        let (tension, mass_share) = self.shares();
        let (mut area, mut volume) = (0.0, 0.0);
        for ends in segments {
            let [start, end] = ends.map(|end| points[end as usize]);
            let along = end - start;
            let length = along.length();
            let unit = along.normalize_or_zero() * tension;
            for (end, sign) in ends.iter().zip([-1.0, 1.0]) {
                let terms = &mut terms[*end as usize];
                terms.gradient += unit * sign;
                terms.volume_gradient += along.cross(DVec3::Z) / 2.0;
                terms.mass += 0.5 * mass_share * length.max(f64::MIN_POSITIVE);
            }
            area += length;
            volume += segment_area([start, end]);
        }
        [tension * area, volume]
    }

    /// The tension that counts, and what area counts as mass.
    fn shares(&self) -> (f64, f64) {
        let mass_share = if self.tension == 0.0 { 0.0 } else { self.share / self.mobility };
        (self.share * self.tension, mass_share)
    }
}

/// The triangles one subdivision on, given the edges across from the corners of each; points on edges have numbers from `first` on.
fn refined_triangles(
    triangles: &[[u32; 3]],
    edges_across: &[[u32; 3]],
    first: u32,
) -> impl Iterator<Item = [u32; 3]> {
    let with_middles = move |(corners, across): (&[u32; 3], &[u32; 3])| {
        let [bc, ca, ab] = across.map(|edge| first + edge);
        (*corners, [ab, bc, ca])
    };
    let parents = move || triangles.iter().zip(edges_across).map(with_middles);
    let corners = parents().flat_map(|([a, b, c], [ab, bc, ca])| [[a, ab, ca], [b, bc, ab], [c, ca, bc]]);
    corners.chain(parents().map(|(_, [ab, bc, ca])| [ca, ab, bc]))
}

/// The cone to a surface whose volume, and how it changes with its points, are those from the apex.
fn cone(apex: DVec3, volume: f64, terms: &[PlaceTerms], elements: ElementsPart<'_>) -> Cone {
    let dimension = match elements {
        ElementsPart::Triangles(_) => Dimension::Three,
        ElementsPart::Segments(_) => Dimension::Two,
    };
    // All points that move as one sweep along the sum of normals.
    Cone::new(apex, volume, terms.iter().map(|terms| terms.volume_gradient).sum(), dimension)
}
