//! The way down to the least area.

use glam::DVec3;
use smallvec::SmallVec;

use super::fan::Fan;
use super::{Beside, LocalArea, OfCells, OfCorners, OfVertices, Place};

/// Most steps of descent.
const STEPS: usize = 20;

/// Halvings of a step that does not lessen the area.
const HALVINGS: usize = 10;

/// The least cotangent that an angle counts with: all are positive, so that each step goes down.
pub(super) const LEAST_COTANGENT: f64 = 0.05;

/// The largest one: that of 11 degrees. Needles would otherwise glue their ends together.
pub(super) const LARGEST_COTANGENT: f64 = 5.0;

/// Most that a step is longer than the one before.
const LARGEST_GROWTH: f64 = 10.0;

/// Share of the area by which a step has to lessen it for another one to follow. Two topologies differ by a hundred times as much;
/// most searches take some five steps.
const PROGRESS: f64 = 1e-5;

/// What there is for each two vertices that move, as many as [`OfVertices`].
type OfPairs = SmallVec<[f64; 16]>;

impl LocalArea {
    /// Moves the vertices down to the least area near by, or to one that is no more than `enough`, and gives that: no more than
    /// [`Self::area_now`].
    ///
    /// Steps go along the gradient as the stiffness of the faces has it, so that they need not be small where triangles are.
    pub(crate) fn minimize(&mut self, enough: f64) -> f64 {
        // What cells resist may well make the whole negative: the faces alone tell how large the place is.
        let mut rings = self.rings();
        let faces: f64 = self.fans(&rings).map(|(_, fan)| fan.area()).sum();
        let stiffness = self.stiffness(&rings);
        let (mut area, mut slope) = self.area(&rings);
        let mut direction = self.solve(&stiffness, &slope);
        let mut step = 1.0;
        for _ in 0..STEPS {
            let mut lower = None;
            for _ in 0..HALVINGS {
                let moved: OfVertices<DVec3> =
                    self.points.iter().zip(&direction).map(|(point, by)| *point - *by * step).collect();
                self.place_rings(&moved, &mut rings);
                let (moved_area, moved_slope) = self.area(&rings);
                if moved_area < area {
                    lower = Some((moved, moved_area, moved_slope));
                    break;
                }
                step *= 0.5;
            }
            let Some((moved, moved_area, moved_slope)) = lower else { break };
            // The next step is as long as the change of the slope has it (Barzilai and Borwein 1988).
            let dot = |slope: &[DVec3]| slope.iter().zip(&direction).map(|(a, b)| a.dot(*b)).sum::<f64>();
            let square = dot(&slope);
            let bent = square - dot(&moved_slope);
            step *= if bent > 0.0 { (square / bent).min(LARGEST_GROWTH) } else { 2.0 };
            let is_slow = area - moved_area < PROGRESS * faces;
            (self.points, area, slope) = (moved, moved_area, moved_slope);
            if is_slow || area <= enough {
                break;
            }
            direction = self.solve(&stiffness, &slope);
        }
        area
    }

    /// The stiffness of the faces between the vertices: that of the linear elements that the fans are, in each direction the same.
    pub(super) fn stiffness(&self, rings: &[DVec3]) -> OfPairs {
        let count = self.points.len();
        let mut stiffness = OfPairs::from_elem(0.0, count * count);
        let mut add = |i: usize, j: usize, value: f64| stiffness[i * count + j] += value;
        let mut rims: SmallVec<[f64; 8]> = SmallVec::new();
        let mut to_center = rims.clone();
        for (face, Fan { ring, center }) in self.fans(rings) {
            let corners = ring.len();
            let cotangent_weight = |apex: DVec3, from: DVec3, to: DVec3| {
                let (a, b) = (from - apex, to - apex);
                let cotangent = a.dot(b) / a.cross(b).length().max(f64::MIN_POSITIVE);
                0.5 * face.tension * cotangent.clamp(LEAST_COTANGENT, LARGEST_COTANGENT)
            };
            rims.clear();
            to_center.clear();
            to_center.resize(corners, 0.0);
            for k in 0..corners {
                let next = (k + 1) % corners;
                rims.push(cotangent_weight(center, ring[k], ring[next]));
                to_center[k] += cotangent_weight(ring[next], center, ring[k]);
                to_center[next] += cotangent_weight(ring[k], ring[next], center);
            }
            // The centre follows all corners alike.
            let follows = 1.0 / corners as f64;
            let moving = || {
                face.corners.iter().enumerate().filter_map(|(k, corner)| match corner {
                    Place::Moving(moving, _) => Some((k, *moving)),
                    Place::Fixed(_) => None,
                })
            };
            let all: f64 = to_center.iter().sum();
            for (k, i) in moving() {
                let next = (k + 1) % corners;
                let previous = (k + corners - 1) % corners;
                add(i, i, to_center[k] + rims[k] + rims[previous]);
                if let Place::Moving(j, _) = face.corners[next] {
                    add(i, j, -rims[k]);
                    add(j, i, -rims[k]);
                }
                for (_, j) in moving() {
                    add(i, j, (all * follows - to_center[k]) * follows);
                    add(j, i, -to_center[k] * follows);
                }
            }
        }
        stiffness
    }

    /// The displacement under some forces, within what the walls leave.
    fn solve(&self, stiffness: &[f64], forces: &[DVec3]) -> OfVertices<DVec3> {
        let count = forces.len();
        let mut matrix = OfPairs::from_slice(stiffness);
        let mut result: OfVertices<DVec3> = SmallVec::from_slice(forces);
        for pivot in 0..count {
            let diagonal = matrix[pivot * count + pivot];
            for row in pivot + 1..count {
                let factor = matrix[row * count + pivot] / diagonal;
                for column in pivot..count {
                    matrix[row * count + column] -= factor * matrix[pivot * count + column];
                }
                let by = result[pivot] * factor;
                result[row] -= by;
            }
        }
        for row in (0..count).rev() {
            for column in row + 1..count {
                let by = result[column] * matrix[row * count + column];
                result[row] -= by;
            }
            result[row] /= matrix[row * count + row];
        }
        result.iter_mut().zip(&self.freedoms).for_each(|(by, freedom)| *by = freedom.project(*by));
        result
    }

    /// The area weighted by tension together with what cells resist, and how it changes with the points.
    pub(super) fn area(&self, rings: &[DVec3]) -> (f64, OfVertices<DVec3>) {
        let mut normals = OfCorners::<DVec3>::new();
        let volumes = self.volumes_and_normals(rings, |normal| normals.push(normal));
        let mut area = 0.0;
        let mut pulls = OfCells::<f64>::new();
        for (cell, volume) in self.cells.iter().zip(volumes) {
            let excess = volume - cell.volume;
            area += (0.5 * cell.stiffness * excess - cell.pressure) * excess;
            pulls.push(cell.stiffness * excess - cell.pressure);
        }
        let mut slope: OfVertices<DVec3> = SmallVec::from_elem(DVec3::ZERO, self.points.len());
        let mut normals = normals.iter().copied();
        for (face, Fan { ring, center }) in self.fans(rings) {
            // All cells beside a face together pull on its cone from the origin, and on its area.
            let (mut pull, mut pull_of_offset) = (0.0, DVec3::ZERO);
            for Beside { cell, offset, sign } in &face.beside {
                pull += sign * pulls[*cell] / 6.0;
                pull_of_offset += *offset * (sign * pulls[*cell] / 6.0);
            }
            let count = ring.len();
            let (mut doubled_areas, mut of_center) = (0.0, DVec3::ZERO);
            for ((k, a), normal) in ring.iter().enumerate().zip(&mut normals) {
                let next = (k + 1) % count;
                let b = ring[next];
                let doubled_area = normal.length();
                doubled_areas += doubled_area;
                let half_pull = normal * (0.5 * face.tension / doubled_area.max(f64::MIN_POSITIVE));
                of_center += half_pull.cross(b - *a) + a.cross(b) * pull;
                if let Place::Moving(moving, _) = face.corners[k] {
                    slope[moving] += half_pull.cross(center - b);
                }
                if let Place::Moving(moving, _) = face.corners[next] {
                    slope[moving] += half_pull.cross(*a - center);
                }
            }
            area += 0.5 * face.tension * doubled_areas;
            let of_center = of_center / count as f64;
            // A cone from an origin that is off changes as an area does.
            let pull_of_cone = center * pull - pull_of_offset;
            for (k, corner) in face.corners.iter().enumerate() {
                if let Place::Moving(moving, _) = corner {
                    let chord = ring[(k + 1) % count] - ring[(k + count - 1) % count];
                    slope[*moving] += of_center + chord.cross(pull_of_cone);
                }
            }
        }
        slope.iter_mut().zip(&self.freedoms).for_each(|(slope, freedom)| *slope = freedom.project(*slope));
        (area, slope)
    }
}
