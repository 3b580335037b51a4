//! Polygons cut into triangles.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

use crate::ids::id;
use crate::mesh_checks::{check_faces, check_size};
use crate::{FaceId, HalfEdgeId, HalfEdgeMesh, MeshError};

/// The least amount by which the angles opposite a diagonal must exceed two right angles, as a sum of cotangents, for it to be
/// turned: a square's diagonals stay as they are, whatever rounding says.
const CLEARLY: f64 = 1e-9;

/// Cuts faces into triangles; returns these, face after face, and the face of each.
///
/// A polygon is seen along its normal, convex or not, in a plane or not, and no triangle leaves it or has no area there. Of the ways to
/// cut it, the one is taken whose triangles are least thin (Delaunay's, by the angles in space); where two are as good, the diagonals from
/// the first corner.
///
/// ```
/// use glam::DVec3;
/// use subzero::{FaceId, triangulate};
///
/// let points = [DVec3::ZERO, DVec3::X, DVec3::new(1., 1., 0.), DVec3::Y];
/// let (triangles, face_of) = triangulate(&points, &[vec![0, 1, 2, 3]])?;
/// assert_eq!(triangles.len(), 2);
/// assert_eq!(face_of, [FaceId(0); 2]);
/// # Ok::<(), subzero::MeshError>(())
/// ```
///
/// # Errors
/// [`MeshError::FlatFace`] for one without area, [`MeshError::CrossedFace`] for one that crosses or touches itself; a face with fewer
/// than three corners or with a vertex twice, a vertex id out of range, two faces with the same vertices, or more elements than
/// 32-bit ids can count.
pub fn triangulate(points: &[DVec3], faces: &[Vec<u32>]) -> Result<(Vec<[u32; 3]>, Vec<FaceId>), MeshError> {
    check_size("half-edges", faces.iter().map(Vec::len).sum::<usize>().saturating_mul(6))?;
    check_faces(points.len(), faces)?;
    let (mut triangles, mut face_of) = (Vec::new(), Vec::new());
    for (f, face) in faces.iter().enumerate() {
        let number = FaceId(id(f));
        match <[u32; 3]>::try_from(&face[..]) {
            Ok(triangle) => triangles.push(triangle),
            Err(_) => {
                let corners: Vec<DVec3> = face.iter().map(|&v| points[v as usize]).collect();
                let found = cut(&corners).map_err(|why| why.of_face(number))?;
                triangles.extend(found.into_iter().map(|triangle| triangle.map(|i| face[i as usize])));
            }
        }
        face_of.resize(triangles.len(), number);
    }
    Ok((triangles, face_of))
}

/// The sum of the triangles' normals from any point, each twice the triangle's area long (Newell).
pub(crate) fn doubled_area_vector(corners: &[DVec3]) -> DVec3 {
    let [first, rest @ ..] = corners else { return DVec3::ZERO };
    rest.windows(2).map(|pair| (pair[0] - *first).cross(pair[1] - *first)).sum()
}

/// Why a polygon cannot be cut.
enum Uncut {
    Flat,
    Crossed,
}

impl Uncut {
    fn of_face(self, face: FaceId) -> MeshError {
        match self {
            Self::Flat => MeshError::FlatFace { face },
            Self::Crossed => MeshError::CrossedFace { face },
        }
    }
}

/// Triangles of a polygon, by the positions of its corners.
fn cut(corners: &[DVec3]) -> Result<Vec<[u32; 3]>, Uncut> {
    let normal = doubled_area_vector(corners);
    let Some(direction) = normal.try_normalize() else { return Err(Uncut::Flat) };
    // Along an axis no coordinate is rounded; polygons that are far from flat may cross themselves there and not along their normal.
    let along_axis: Vec<DVec2> = corners.iter().map(|&point| drop_axis(point, normal)).collect();
    let (right, up) = direction.any_orthonormal_pair();
    let along_normal = || corners.iter().map(|point| DVec2::new(point.dot(right), point.dot(up))).collect();
    let cut_seen = |seen: Vec<DVec2>| Some((clip_ears(&seen)?, seen));
    let (triangles, seen) =
        cut_seen(along_axis).or_else(|| cut_seen(along_normal())).ok_or(Uncut::Crossed)?;
    Ok(improved(triangles, corners, &seen))
}

/// A point without the coordinate along which the normal is longest, so that what winds about the normal counter-clockwise does so
/// there.
fn drop_axis(point: DVec3, normal: DVec3) -> DVec2 {
    let size = normal.abs();
    let (kept, along) = if size.x >= size.y && size.x >= size.z {
        (DVec2::new(point.y, point.z), normal.x)
    } else if size.y >= size.z {
        (DVec2::new(point.z, point.x), normal.y)
    } else {
        (DVec2::new(point.x, point.y), normal.z)
    };
    if along < 0.0 { DVec2::new(kept.y, kept.x) } else { kept }
}

/// Which way three points turn: 1 counter-clockwise, -1 clockwise, 0 on a line. Exact.
fn turn([a, b, c]: [DVec2; 3]) -> i8 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    let doubled_area = orient2d(coord(a), coord(b), coord(c));
    i8::from(doubled_area > 0.0) - i8::from(doubled_area < 0.0)
}

/// Takes one triangle of three corners in a row after the other; nothing where the polygon crosses or touches itself.
fn clip_ears(seen: &[DVec2]) -> Option<Vec<[u32; 3]>> {
    if crosses_itself(seen) {
        return None;
    }
    let at = |i: u32| seen[i as usize];
    let mut left: Vec<u32> = (0..id(seen.len())).collect();
    let mut triangles = Vec::with_capacity(seen.len() - 2);
    while left.len() > 3 {
        let count = left.len();
        let around = |k: usize| [left[(k + count - 1) % count], left[k], left[(k + 1) % count]];
        let is_ear = |&k: &usize| {
            let ear = around(k);
            let [a, b, c] = ear.map(at);
            let is_inside = |point: DVec2| {
                let within = [[a, b], [b, c], [c, a]].map(|[from, to]| turn([from, to, point]));
                // Corners of other sides may lie where the ear's do.
                within.iter().all(|side| *side >= 0) && ![a, b, c].contains(&point)
            };
            turn([a, b, c]) > 0 && !left.iter().any(|&i| !ear.contains(&i) && is_inside(at(i)))
        };
        // From the second corner on, so that a convex polygon is cut from its first.
        let ear = (1..count).chain([0]).find(is_ear)?;
        triangles.push(around(ear));
        left.remove(ear);
    }
    let last = [left[0], left[1], left[2]];
    triangles.push(last);
    (turn(last.map(at)) > 0).then_some(triangles)
}

/// Whether two sides cross each other in points that are no corners.
fn crosses_itself(seen: &[DVec2]) -> bool {
    let count = seen.len();
    let side = |i: usize| [seen[i], seen[(i + 1) % count]];
    (0..count).any(|i| {
        let [a, b] = side(i);
        let (low, high) = (a.min(b), a.max(b));
        (i + 2..count).any(|j| {
            let [c, d] = side(j);
            let apart = c.max(d).cmplt(low) | c.min(d).cmpgt(high);
            !apart.any() && turn([a, b, c]) * turn([a, b, d]) < 0 && turn([c, d, a]) * turn([c, d, b]) < 0
        })
    })
}

/// The triangles after diagonals were turned as long as that makes them less thin.
fn improved(triangles: Vec<[u32; 3]>, corners: &[DVec3], seen: &[DVec2]) -> Vec<[u32; 3]> {
    let Ok(mut mesh) = HalfEdgeMesh::new(corners.len(), &triangles) else { return triangles };
    // Each turn lessens the same sum, so there is an end to them; rounding must not make it another.
    let mut turns_left = triangles.len() * triangles.len();
    let mut waiting: Vec<HalfEdgeId> = mesh.edges().filter(|&h| mesh.twin(h).is_some()).collect();
    while let Some(h) = waiting.pop() {
        let Some(twin) = mesh.twin(h) else { continue };
        let [a, b, c, d] = [mesh.start(h), mesh.end(h), mesh.start(h.prev()), mesh.start(twin.prev())];
        let at = |v: u32| seen[v as usize];
        let stays_inside = turn([at(d), at(c), at(a)]) > 0 && turn([at(c), at(d), at(b)]) > 0;
        let [a, b, c, d] = [a, b, c, d].map(|v| corners[v as usize]);
        if stays_inside
            && cotangent(c, [a, b]) + cotangent(d, [a, b]) < -CLEARLY
            && turns_left > 0
            && mesh.flip(h).is_ok()
        {
            turns_left -= 1;
            let around = [h.next(), h.prev(), twin.next(), twin.prev()];
            waiting.extend(around.into_iter().filter(|&h| mesh.twin(h).is_some()));
        }
    }
    mesh.triangles().map(|(_, triangle)| triangle).collect()
}

/// The cotangent of the angle at `apex` between two points.
fn cotangent(apex: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let [to_a, to_b] = [a - apex, b - apex];
    to_a.dot(to_b) / to_a.cross(to_b).length()
}
