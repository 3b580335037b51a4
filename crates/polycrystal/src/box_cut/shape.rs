//! Points that make room for thin triangles after the cut.
//!
//! Around each triangle that is still thin, points try places nearby and take the one with the widest smallest angle around: in the
//! planes of the box those that lie there, both copies alike.

use std::collections::HashMap;

use glam::DVec3;
use voronoi::Domain;

use crate::box_cut::Piece;
use crate::box_cut::pieces::Pieces;
use crate::mesh::triangle_quality::squared_sine;
use crate::{BoundaryId, Freedom};

/// Sine of the smallest angle that is asked for (3 degrees): twice that of a thin triangle.
const WANTED_SINE: f64 = 0.052;

/// Sweeps over all thin triangles.
const SWEEPS: usize = 30;

/// How far points try to go, in mean lengths of the edges around.
const STEPS: [f64; 4] = [0.3, 0.1, 0.03, 0.01];

/// Factor by which the square of the smallest sine has to grow.
const GAIN: f64 = 1.02;

/// Cosine of the largest angle by which a triangle may turn from where its boundary faces there (32 degrees).
const LARGEST_TURN: f64 = 0.85;

/// Moves points around thin triangles, in flat networks only those inside caps.
pub(crate) fn widen(pieces: &mut Pieces, caps: &[Piece], is_flat: bool) {
    let all: Vec<&Piece> = pieces.pieces.iter().chain(caps).collect();
    let mut stars = vec![Vec::new(); pieces.positions.len()];
    for (number, piece) in all.iter().enumerate() {
        piece.corners.iter().for_each(|corner| stars[corner.vertex as usize].push(number));
    }
    let mut shape = Shape {
        domain: &pieces.domain,
        planes: &pieces.planes,
        positions: pieces.positions.clone(),
        facing: Vec::new(),
        is_free: stars
            .iter()
            .map(|star| !is_flat || star.iter().all(|piece| all[*piece].boundary.is_none()))
            .collect(),
        all,
        stars,
    };
    shape.face();
    for _ in 0..SWEEPS {
        let thin =
            (0..shape.all.len()).filter(|piece| shape.squared_sine(*piece) < WANTED_SINE * WANTED_SINE);
        let mut points: Vec<usize> = thin
            .flat_map(|piece| shape.all[piece].corners.iter().map(|corner| corner.vertex as usize))
            .collect();
        points.sort_unstable();
        points.dedup();
        let mut is_changed = false;
        for point in points {
            is_changed |= shape.improve(point);
        }
        if !is_changed {
            break;
        }
    }
    pieces.positions = shape.positions;
}

struct Shape<'a> {
    domain: &'a Domain,
    planes: &'a [[bool; 3]],
    positions: Vec<DVec3>,
    all: Vec<&'a Piece>,
    /// The pieces at each point.
    stars: Vec<Vec<usize>>,
    /// Where the boundary of each piece faces there.
    facing: Vec<DVec3>,
    /// Whether each point may move at all.
    is_free: Vec<bool>,
}

impl Shape<'_> {
    fn corners(&self, piece: usize) -> [DVec3; 3] {
        let corners = &self.all[piece].corners;
        [0, 1, 2].map(|k| {
            let corner = corners[k];
            crate::box_cut::position_in_box(
                self.domain,
                self.positions[corner.vertex as usize],
                corner.translation,
            )
        })
    }

    fn squared_sine(&self, piece: usize) -> f64 {
        squared_sine(self.corners(piece))
    }

    fn normal(&self, piece: usize) -> DVec3 {
        let [a, b, c] = self.corners(piece);
        (b - a).cross(c - a)
    }

    fn face(&mut self) {
        let mut normals: HashMap<(u32, BoundaryId), DVec3> = HashMap::new();
        for (number, piece) in self.all.iter().enumerate() {
            let Some(boundary) = piece.boundary else { continue };
            let normal = self.normal(number);
            piece
                .corners
                .iter()
                .for_each(|corner| *normals.entry((corner.vertex, boundary)).or_default() += normal);
        }
        let facing = |(number, piece): (usize, &&Piece)| match piece.boundary {
            Some(boundary) => piece.corners.iter().map(|corner| normals[&(corner.vertex, boundary)]).sum(),
            None => self.normal(number),
        };
        self.facing = self.all.iter().enumerate().map(|piece| facing(piece).normalize_or_zero()).collect();
    }

    fn freedom(&self, point: usize) -> Freedom {
        if !self.is_free[point] {
            return Freedom::Nowhere;
        }
        let position = self.positions[point];
        let held = (0..3).filter(|axis| {
            let is_wall = !self.domain.periodic().test(*axis)
                && [self.domain.lower()[*axis], self.domain.upper()[*axis]].contains(&position[*axis]);
            self.planes[point][*axis] || is_wall
        });
        held.fold(Freedom::Everywhere, |freedom, axis| freedom.and(Freedom::InPlane(DVec3::AXES[axis])))
    }

    /// The square of the smallest sine around a point; nothing where a triangle is turned.
    fn least(&self, point: usize) -> Option<f64> {
        let mut least = f64::INFINITY;
        for piece in &self.stars[point] {
            let normal = self.normal(*piece);
            if normal.dot(self.facing[*piece]) < LARGEST_TURN * normal.length() {
                return None;
            }
            least = least.min(self.squared_sine(*piece));
        }
        Some(least)
    }

    /// Moves a point to the best place nearby; whether there is a better one.
    fn improve(&mut self, point: usize) -> bool {
        let freedom = self.freedom(point);
        if freedom == Freedom::Nowhere {
            return false;
        }
        let start = self.positions[point];
        let mut best = (start, self.least(point).unwrap_or(0.0));
        let least_gain = GAIN * best.1;
        let length = self.mean_edge(point);
        let is_inside = |position: DVec3| {
            (0..3).all(|axis| {
                self.planes[point][axis]
                    || !self.domain.periodic().test(axis)
                    || (position[axis] > self.domain.lower()[axis]
                        && position[axis] < self.domain.upper()[axis])
            })
        };
        let steps = || [-1.0, 0.0, 1.0].into_iter();
        let mut positions = Vec::new();
        for direction in
            steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| DVec3::new(x, y, z))))
        {
            let Some(direction) = freedom.project(direction).try_normalize() else { continue };
            positions.extend(
                STEPS
                    .map(|step| start + direction * (step * length))
                    .into_iter()
                    .filter(|position| is_inside(*position)),
            );
        }
        for position in positions {
            self.positions[point] = position;
            if let Some(least) = self.least(point)
                && least > best.1
            {
                best = (position, least);
            }
        }
        let is_better = best.1 > least_gain;
        self.positions[point] = if is_better { best.0 } else { start };
        is_better
    }

    fn mean_edge(&self, point: usize) -> f64 {
        let star = &self.stars[point];
        let sum: f64 = star
            .iter()
            .map(|piece| {
                let [a, b, c] = self.corners(*piece);
                a.distance(b) + b.distance(c) + c.distance(a)
            })
            .sum();
        sum / (3 * star.len()).max(1) as f64
    }
}
