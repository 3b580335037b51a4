//! Bezier surfaces as one mesh: seams and poles joined, holes filled.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::ids::id;
use crate::mesh_checks::fits;
use crate::{BezierError, BezierSurface, orient, triangulate};

/// The triangles of several surfaces over points that they share.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MergedSurfaces {
    /// The points, each once.
    pub points: Vec<DVec3>,
    /// The triangles, none without area; winding agrees wherever it can.
    pub triangles: Vec<[u32; 3]>,
    /// Per triangle: the surface that it is from; nothing where it fills a hole.
    pub surface_of: Vec<Option<u32>>,
    /// Sides of surfaces that were joined, each counted once for a pair.
    pub seams: usize,
    /// Sides of surfaces that are a single point.
    pub poles: usize,
    /// Holes that were filled.
    pub filled: usize,
    /// Holes that are left.
    pub holes: usize,
}

/// A point's coordinates as bits, no zero being negative.
type Place = [u64; 3];

/// Where a point of the tessellation lies, the same for surfaces that share it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    /// At a corner of surfaces: the first of those that are one, four to a surface.
    Corner(u32),
    /// So many steps from the start of a side with these control points.
    Side(Vec<Place>, u32),
    /// Inside a surface.
    Inside(usize, u32, u32),
}

impl MergedSurfaces {
    /// Tessellates surfaces by `steps` along each side, and joins them where their control points say that they meet: sides with the same
    /// control points, in either direction. No distance is measured, and surfaces that touch in a point alone stay apart. A side whose
    /// control points are one becomes a point. If `fill`, every hole is filled with triangles between the points of its rim.
    ///
    /// ```
    /// use subzero::{MergedSurfaces, teapot};
    ///
    /// let teapot = MergedSurfaces::new(&teapot(), 4, true)?;
    /// assert_eq!(teapot.holes, 0);
    /// # Ok::<(), subzero::BezierError>(())
    /// ```
    ///
    /// # Errors
    /// [`BezierError::TooLarge`] if there are more points than 32-bit ids can count.
    pub fn new(surfaces: &[BezierSurface<DVec3>], steps: u32, fill: bool) -> Result<Self, BezierError> {
        let steps = steps.max(1);
        let per_side = steps as usize + 1;
        let count = surfaces.len().saturating_mul(per_side.saturating_mul(per_side));
        let half_edges = count.saturating_mul(12);
        if !fits(half_edges) {
            return Err(BezierError::TooLarge { what: "half-edges", count: half_edges });
        }
        let mut merged = Self::default();
        let mut ids: BTreeMap<Key, u32> = BTreeMap::new();
        let sides: Vec<Sides> = surfaces.iter().map(Sides::new).collect();
        let corners = merged.join_corners(&sides);
        for (number, surface) in surfaces.iter().enumerate() {
            let (sides, corners) = (&sides[number], &corners[4 * number..4 * number + 4]);
            let mut grid = Vec::with_capacity(per_side * per_side);
            for i in 0..=steps {
                for j in 0..=steps {
                    let key = sides.key(number, corners, [i, j], steps);
                    let next = id(merged.points.len());
                    let found = *ids.entry(key).or_insert(next);
                    if found == next {
                        let [u, v] = [i, j].map(|step| f64::from(step) / f64::from(steps));
                        merged.points.push(surface.point(u, v));
                    }
                    grid.push(found);
                }
            }
            for (i, j) in (0..per_side - 1).flat_map(|i| (0..per_side - 1).map(move |j| (i, j))) {
                let at = |i: usize, j: usize| grid[i * per_side + j];
                for triangle in
                    [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
                {
                    merged.add(triangle, Some(id(number)));
                }
            }
        }
        merged.make_winding_agree();
        merged.fill_holes(fill);
        Ok(merged)
    }

    /// For each corner of each surface the first of those that are one, as joined sides say; counts seams and poles.
    fn join_corners(&mut self, sides: &[Sides]) -> Vec<u32> {
        let mut first: Vec<u32> = (0..id(4 * sides.len())).collect();
        let mut joined = |a: u32, b: u32| {
            let root = |mut corner: u32, first: &[u32]| {
                while first[corner as usize] != corner {
                    corner = first[corner as usize];
                }
                corner
            };
            let [a, b] = [a, b].map(|corner| root(corner, &first));
            first[a.max(b) as usize] = a.min(b);
        };
        let mut ends_of: BTreeMap<Vec<Place>, Vec<[u32; 2]>> = BTreeMap::new();
        for (surface, sides) in (0..).zip(sides) {
            for (side, ends) in sides.with_ends() {
                let [start, end] = ends.map(|corner| 4 * surface + corner);
                if is_point(side) {
                    self.poles += 1;
                    joined(start, end);
                } else {
                    let (side, is_reversed) = forward(side);
                    ends_of.entry(side).or_default().push(if is_reversed {
                        [end, start]
                    } else {
                        [start, end]
                    });
                }
            }
        }
        for ends in ends_of.values().filter(|ends| ends.len() > 1) {
            self.seams += 1;
            for pair in ends.windows(2) {
                (0..2).for_each(|end| joined(pair[0][end], pair[1][end]));
            }
        }
        // None points to a later one.
        for corner in 0..first.len() {
            first[corner] = first[first[corner] as usize];
        }
        first
    }

    /// Adds a triangle if it has area.
    fn add(&mut self, [a, b, c]: [u32; 3], surface: Option<u32>) {
        let [p, q, r] = [a, b, c].map(|v| self.points[v as usize]);
        if a != b && b != c && c != a && (q - p).cross(r - p) != DVec3::ZERO {
            self.triangles.push([a, b, c]);
            self.surface_of.push(surface);
        }
    }

    fn make_winding_agree(&mut self) {
        let mut faces: Vec<Vec<u32>> = self.triangles.iter().map(|triangle| triangle.to_vec()).collect();
        // Where it cannot, as on a Moebius strip, surfaces wind as they were given.
        if let Ok(orientation) = orient(self.points.len(), &faces) {
            orientation.apply(&mut faces);
            for (triangle, face) in self.triangles.iter_mut().zip(faces) {
                triangle.copy_from_slice(&face);
            }
        }
    }

    /// Counts holes, and fills those that can be filled if so asked.
    fn fill_holes(&mut self, fill: bool) {
        for rim in self.rims() {
            let corners: Vec<DVec3> = rim.iter().map(|&v| self.points[v as usize]).collect();
            let face: Vec<u32> = (0..id(rim.len())).collect();
            match triangulate(&corners, &[face]) {
                Ok((triangles, _)) if fill => {
                    for triangle in triangles {
                        self.add(triangle.map(|corner| rim[corner as usize]), None);
                    }
                    self.filled += 1;
                }
                _ => self.holes += 1,
            }
        }
    }

    /// The points around each hole, in the direction in which a face that fills it runs.
    fn rims(&self) -> Vec<Vec<u32>> {
        let mut half_edges: Vec<[u32; 2]> =
            self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        half_edges.sort_unstable();
        let is_open = |&[a, b]: &[u32; 2]| half_edges.binary_search(&[b, a]).is_err();
        // From the end of an open half-edge to its start; where several rims touch in a point, they are taken one after the other.
        let mut onward: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for [a, b] in half_edges.iter().copied().filter(is_open) {
            onward.entry(b).or_default().push(a);
        }
        let mut rims = Vec::new();
        while let Some((&first, _)) = onward.iter().find(|(_, next)| !next.is_empty()) {
            let mut rim = Vec::new();
            let mut at = first;
            while let Some(next) = onward.get_mut(&at).and_then(Vec::pop) {
                rim.push(at);
                at = next;
                if at == first {
                    break;
                }
            }
            onward.retain(|_, next| !next.is_empty());
            rims.push(rim);
        }
        rims
    }
}

/// The control points along the four sides of a surface.
struct Sides {
    /// At u = 0 and at u = 1, along v.
    along_v: [Vec<Place>; 2],
    /// At v = 0 and at v = 1, along u.
    along_u: [Vec<Place>; 2],
}

impl Sides {
    fn new(surface: &BezierSurface<DVec3>) -> Self {
        let rows = surface.rows();
        let row = |row: usize| rows[row].control().iter().map(|point| place(*point)).collect();
        let column = |last: bool| {
            let end = |row: &crate::BezierCurve<DVec3>| row.control()[if last { row.degree() } else { 0 }];
            rows.iter().map(|row| place(end(row))).collect()
        };
        Self { along_v: [row(0), row(rows.len() - 1)], along_u: [column(false), column(true)] }
    }

    /// Each side with its two corners: 0 where u = v = 0, 1 at v = 1, 2 at u = 1, and 3 at both.
    fn with_ends(&self) -> [(&Vec<Place>, [u32; 2]); 4] {
        let ([low_u, high_u], [low_v, high_v]) = (&self.along_v, &self.along_u);
        [(low_u, [0, 1]), (high_u, [2, 3]), (low_v, [0, 2]), (high_v, [1, 3])]
    }

    /// What the point of a step along u and of one along v is known by.
    fn key(&self, surface: usize, corners: &[u32], [i, j]: [u32; 2], steps: u32) -> Key {
        let end = |step: u32| match step {
            0 => Some(0),
            _ if step == steps => Some(1),
            _ => None,
        };
        match (end(i), end(j)) {
            (Some(u), Some(v)) => Key::Corner(corners[2 * u + v]),
            (Some(u), None) => on_side(&self.along_v[u], corners[2 * u], j, steps),
            (None, Some(v)) => on_side(&self.along_u[v], corners[v], i, steps),
            (None, None) => Key::Inside(surface, i, j),
        }
    }
}

fn on_side(side: &[Place], corner: u32, step: u32, steps: u32) -> Key {
    if is_point(side) {
        return Key::Corner(corner);
    }
    let (side, is_reversed) = forward(side);
    Key::Side(side, if is_reversed { steps - step } else { step })
}

/// A side in the one of its two directions that comes first, and whether that is the other.
fn forward(side: &[Place]) -> (Vec<Place>, bool) {
    let reversed: Vec<Place> = side.iter().rev().copied().collect();
    if reversed[..] < *side { (reversed, true) } else { (side.to_vec(), false) }
}

fn is_point(side: &[Place]) -> bool {
    side.iter().all(|place| *place == side[0])
}

fn place(point: DVec3) -> Place {
    // Minus zero becomes zero.
    point.to_array().map(|coordinate| (coordinate + 0.0).to_bits())
}
