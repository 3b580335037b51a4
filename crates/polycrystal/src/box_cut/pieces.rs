//! Elements cut at the planes between copies of the box.

use std::collections::HashMap;

use glam::DVec3;
use voronoi::{Dimension, Domain, PeriodicVertex, Translation};

use crate::box_cut::{Piece, periodic_axes, position_in_box};
use crate::mesh::id::id;
use crate::mesh::triangle_quality::squared_sine;
use crate::{Elements, Network};

/// Pieces of elements, and the points of the torus in the box.
pub(crate) struct Pieces {
    pub(crate) domain: Domain,
    pub(crate) pieces: Vec<Piece>,
    /// Positions with lower <= x < upper along periodic axes.
    pub(crate) positions: Vec<DVec3>,
    /// The axes on whose lower plane each point lies.
    pub(crate) planes: Vec<[bool; 3]>,
}

/// What is nearer to a plane than this share of the box's side lies in it: relaxation leaves lattices so far off by rounding.
pub(crate) const ROUNDING: f64 = 1e-13;

/// Which of two opposite walls: by how many periods it is moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    Lower = 0,
    Upper = 1,
}

/// Where an edge meets a plane: the axis, the edge from one of its points, and the plane as seen from there.
type Cut = (usize, PeriodicVertex, PeriodicVertex, i8);

/// The points of a network on the torus, and its vertices as copies of them.
pub(crate) struct Torus {
    /// The point that each vertex is, and the translation from there.
    pub(crate) originals: Vec<PeriodicVertex>,
    /// Positions of points with lower <= x < upper along periodic axes.
    pub(crate) positions: Vec<DVec3>,
    /// The periods from there to the point.
    pub(crate) moved: Vec<Translation>,
    /// The axes on whose lower plane each point lies.
    pub(crate) planes: Vec<[bool; 3]>,
}

impl Torus {
    pub(crate) fn new(network: &Network, points: &[DVec3]) -> Self {
        let level = network.finest_level();
        assert_eq!(points.len(), level.vertex_count(), "there must be one point per vertex");
        let domain = network.domain();
        let originals = level.copies.originals(points.len());
        let mut torus = Self {
            positions: points.to_vec(),
            moved: vec![Translation::ZERO; points.len()],
            planes: vec![[false; 3]; points.len()],
            originals,
        };
        for (point, position) in points.iter().enumerate() {
            if torus.originals[point].vertex == id(point) {
                (torus.positions[point], torus.moved[point]) = home(domain, *position);
                for axis in periodic_axes(domain) {
                    torus.planes[point][axis] = torus.positions[point][axis] == domain.lower()[axis];
                }
            }
        }
        torus
    }

    /// A vertex as a point moved by whole periods.
    pub(crate) fn corner(&self, vertex: u32) -> PeriodicVertex {
        let PeriodicVertex { vertex: point, translation } = self.originals[vertex as usize];
        PeriodicVertex { vertex: point, translation: translation + self.moved[point as usize] }
    }
}

impl Pieces {
    /// Whole elements, of boundaries that come twice those of one.
    pub(crate) fn of_network(network: &Network, torus: Torus) -> Self {
        let level = network.finest_level();
        let mut pieces = Self {
            pieces: Vec::new(),
            domain: network.domain().clone(),
            positions: Vec::new(),
            planes: Vec::new(),
        };
        let elements = Elements::from(&level.mesh);
        for (element, boundary) in (0u32..).zip(&level.boundary_of) {
            let beside = network.boundaries()[boundary.index()];
            if beside.twin.is_some_and(|twin| twin.boundary < *boundary) {
                continue;
            }
            let sides = beside.sides_across(network.boundaries());
            // Where a grain meets its own image there is nothing between the two.
            if sides[0] == sides[1] {
                continue;
            }
            let corners = elements.corners(element).iter().map(|vertex| torus.corner(*vertex)).collect();
            pieces.pieces.push(Piece { corners, sides, boundary: Some(*boundary) });
        }
        Self { positions: torus.positions, planes: torus.planes, ..pieces }
    }

    /// Divides polygons into triangles, each so that the smallest angle is as large as it can be.
    pub(crate) fn triangulate(&mut self) {
        for piece in std::mem::take(&mut self.pieces) {
            let count = piece.corners.len();
            let fan = |apex: usize| {
                let at = move |k: usize| (apex + k) % count;
                (2..count).map(move |k| [apex, at(k - 1), at(k)])
            };
            let position = |k: usize| self.position(piece.corners[k]);
            let least = |apex: usize| {
                fan(apex).map(|ends| squared_sine(ends.map(position))).fold(f64::INFINITY, f64::min)
            };
            let apexes = (0..count).map(|apex| (least(apex), apex));
            let best = apexes.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
            let (_, apex) = best.expect("a piece has corners");
            let triangle =
                |ends: [usize; 3]| Piece { corners: ends.map(|k| piece.corners[k]).to_vec(), ..piece };
            self.pieces.extend(fan(apex).map(triangle));
        }
    }

    /// Where a corner of a piece in the box is.
    pub(crate) fn position(&self, corner: PeriodicVertex) -> DVec3 {
        position_in_box(&self.domain, self.positions[corner.vertex as usize], corner.translation)
    }

    /// Cuts all pieces at the planes across an axis.
    pub(crate) fn cut(&mut self, axis: usize) {
        let mut cuts: HashMap<Cut, PeriodicVertex> = HashMap::new();
        for mut piece in std::mem::take(&mut self.pieces) {
            let cells = piece.corners.iter().map(|corner| corner.translation.0[axis]);
            let (first, last) = (cells.clone().min().expect("corners"), cells.max().expect("corners"));
            for plane in first + 1..=last {
                let (below, above) = self.halves(&piece, axis, plane, &mut cuts);
                self.pieces.push(below);
                piece = above;
            }
            // What only touches a plane from below ends there.
            if !piece.corners.is_empty() {
                self.pieces.push(piece);
            }
        }
    }

    /// The parts of a piece on both sides of a plane; that above has no corners where the piece reaches the plane only.
    fn halves(
        &mut self,
        piece: &Piece,
        axis: usize,
        plane: i8,
        cuts: &mut HashMap<Cut, PeriodicVertex>,
    ) -> (Piece, Piece) {
        let count = piece.corners.len();
        let is_segment = self.domain.dimension() == Dimension::Two;
        // 0 in the plane.
        let side = |corner: PeriodicVertex| match corner.translation.0[axis] - plane {
            0 if self.planes[corner.vertex as usize][axis] => 0,
            0.. => 1,
            _ => -1,
        };
        let sides_of_corners: Vec<i8> = piece.corners.iter().map(|corner| side(*corner)).collect();
        let mut halves = [Vec::with_capacity(count + 1), Vec::with_capacity(count + 1)];
        for k in 0..count {
            let next = (k + 1) % count;
            let [from, to] = [k, next].map(|k| sides_of_corners[k]);
            if from <= 0 {
                halves[0].push(piece.corners[k]);
            }
            if from >= 0 {
                halves[1].push(piece.corners[k]);
            }
            if from * to < 0 && !(is_segment && k + 1 == count) {
                let cut = self.cut_edge([piece.corners[k], piece.corners[next]], axis, plane, cuts);
                halves.iter_mut().for_each(|half| half.push(cut));
            }
        }
        if !sides_of_corners.contains(&1) {
            halves[1].clear();
        }
        let [below, above] =
            halves.map(|corners| Piece { corners, sides: piece.sides, boundary: piece.boundary });
        (below, above)
    }

    /// Where an edge meets a plane: the same point whichever piece asks, from whichever end, wherever its copy is.
    fn cut_edge(
        &mut self,
        ends: [PeriodicVertex; 2],
        axis: usize,
        plane: i8,
        cuts: &mut HashMap<Cut, PeriodicVertex>,
    ) -> PeriodicVertex {
        let seen = |from: PeriodicVertex, to: PeriodicVertex| {
            let back = Translation::ZERO - from.translation;
            (axis, from.moved(back), to.moved(back), plane - from.translation.0[axis])
        };
        let [one, other] = [seen(ends[0], ends[1]), seen(ends[1], ends[0])];
        let (cut, base) =
            if one <= other { (one, ends[0].translation) } else { (other, ends[1].translation) };
        if let Some(corner) = cuts.get(&cut) {
            return corner.moved(base);
        }
        let (_, from, to, plane) = cut;
        let [from_planes, to_planes] = [from, to].map(|end| self.planes[end.vertex as usize]);
        let mut across = Translation::ZERO;
        across.0[axis] = plane;
        let lower = self.domain.lower();
        let height = lower[axis] + across.vector(&self.domain)[axis];
        let start = self.positions[from.vertex as usize];
        let end = self.positions[to.vertex as usize] + to.translation.vector(&self.domain);
        let share = (height - start[axis]) / (end[axis] - start[axis]);
        // Where both ends have the same coordinate, as on a wall, so has this: a weighted mean of the two would round.
        let (mut position, mut translation) = home(&self.domain, start + (end - start) * share);
        position[axis] = lower[axis];
        translation.0[axis] = plane;
        let mut planes = [false; 3];
        planes[axis] = true;
        for other in periodic_axes(&self.domain).filter(|other| *other != axis) {
            // What joins two points of a plane lies in it.
            if from_planes[other] && to_planes[other] && to.translation.0[other] == 0 {
                (position[other], translation.0[other]) = (lower[other], 0);
            }
            planes[other] = position[other] == lower[other];
        }
        let corner = self.add(position, planes).moved(translation);
        cuts.insert(cut, corner);
        corner.moved(base)
    }

    /// A new point of the torus.
    pub(crate) fn add(&mut self, position: DVec3, planes: [bool; 3]) -> PeriodicVertex {
        self.positions.push(position);
        self.planes.push(planes);
        PeriodicVertex { vertex: id(self.positions.len() - 1), translation: Translation::ZERO }
    }

    /// Moves every piece into the box, of whose upper walls corners are moved by a period.
    pub(crate) fn move_into_box(&mut self) {
        for piece in &mut self.pieces {
            let cell = [0, 1, 2].map(|axis| {
                let translations = piece.corners.iter().map(|corner| corner.translation.0[axis]);
                translations.min().expect("a piece has corners")
            });
            let back = Translation::ZERO - Translation(cell);
            piece.corners.iter_mut().for_each(|corner| *corner = corner.moved(back));
        }
    }

    /// Whether a corner lies on a wall of the box across an axis.
    pub(crate) fn is_on(&self, corner: PeriodicVertex, axis: usize, end: End) -> bool {
        self.planes[corner.vertex as usize][axis] && corner.translation.0[axis] == end as i8
    }

    /// The corner on the lower wall opposite of one on a wall.
    pub(crate) fn lowered(&self, corner: PeriodicVertex, axis: usize, end: End) -> PeriodicVertex {
        let mut down = Translation::ZERO;
        down.0[axis] = -(end as i8);
        corner.moved(down)
    }

    /// Whether a piece lies in the lower wall across an axis.
    pub(crate) fn is_within(&self, piece: &Piece, axis: usize) -> bool {
        piece.corners.iter().all(|corner| self.is_on(*corner, axis, End::Lower))
    }

    /// The point in the corner of a box that is periodic along all axes.
    pub(crate) fn origin(&mut self) -> PeriodicVertex {
        let planes = [0, 1, 2].map(|axis| axis < self.domain.dimension().axes());
        match self.planes.iter().position(|known| *known == planes) {
            Some(point) => PeriodicVertex { vertex: id(point), translation: Translation::ZERO },
            None => self.add(self.domain.lower(), planes),
        }
    }
}

/// A position moved into the box along periodic axes, and the periods from there.
fn home(domain: &Domain, mut position: DVec3) -> (DVec3, Translation) {
    let mut translation = Translation::ZERO;
    for axis in periodic_axes(domain) {
        let (lower, upper, period) = (domain.lower()[axis], domain.upper()[axis], domain.size()[axis]);
        while position[axis] < lower {
            position[axis] += period;
            translation.0[axis] -= 1;
        }
        while position[axis] >= upper {
            position[axis] -= period;
            translation.0[axis] += 1;
        }
        if upper - position[axis] <= ROUNDING * period {
            position[axis] = lower;
            translation.0[axis] += 1;
        } else if position[axis] - lower <= ROUNDING * period {
            position[axis] = lower;
        }
    }
    (position, translation)
}
