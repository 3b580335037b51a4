//! The network of whole grains in a domain that repeats, from the surfaces of all of them.

use glam::DVec3;
use voronoi::{CellId, Domain, PeriodicVertex, Tessellation, Translation};

use crate::network::build::{check_size, surface_size};
use crate::network::control_mesh::ControlMesh;
use crate::network::labelled_mesh::{SurfaceKind, wall_of};

use crate::{Junctions, MeshSize, Network, NetworkError, Side, Surface};

/// How far a copy may be from where whole periods lead from its original, in periods.
const OFF_PERIOD: f64 = 1e-9;

impl Network {
    /// The network of whole grains that fill a periodic domain, from the triangles (in the plane: segments) around all of them, and its points.
    ///
    /// Of a boundary whose sides are whole periods apart, each of the two grains has its own copy, with the exterior beyond. `originals` has the point that each point is
    /// a copy of, or its own number. The network has copies exactly where whole periods lead.
    ///
    /// # Errors
    /// As of [`Self::of_surface`]; [`NetworkError::NoPeriodicCopy`] where a point or an element at the exterior is no copy of another, and on no wall.
    ///
    /// # Panics
    /// As of [`Self::of_surface`]; when there is not one original per point.
    pub fn of_periodic_grains(
        domain: &Domain,
        surface: &Surface<'_>,
        originals: &[u32],
        junctions: Junctions,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        assert_eq!(originals.len(), surface.points.len(), "one original for each point");
        check_size(domain, &surface_size(surface), 0)?;
        let certificate = SurfaceKind::Whole.certify(domain, surface)?;
        let volumes: Vec<f64> = certificate.grain_volumes.iter().map(|(_, volume)| *volume).collect();
        let places = places(domain, surface.points, originals)?;
        let faces = faces(domain, surface, &places)?;
        Self::of_torus_faces(domain, surface.points, faces, volumes, junctions)
    }

    /// The network of whole grains, from elements that are there once on the torus, each as one of its grains has it, and its points. No grain is checked.
    pub(crate) fn of_torus_faces(
        domain: &Domain,
        points: &[DVec3],
        faces: impl IntoIterator<Item = Face>,
        volumes: Vec<f64>,
        junctions: Junctions,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        let seeds = vec![domain.center(); volumes.len()];
        let (complex, _) = Tessellation::of_whole_cells(domain, &seeds, points, faces);
        let count = complex.face_count() as u128;
        check_size(domain, &MeshSize { points: points.len() as u128, edges: count, triangles: count }, 0)?;
        Self::assemble(domain, ControlMesh::of_elements(&complex, junctions)?, volumes, 0)
    }
}

/// Each point as an original, moved by whole periods.
fn places(domain: &Domain, points: &[DVec3], originals: &[u32]) -> Result<Vec<PeriodicVertex>, NetworkError> {
    let periodic = domain.periodic();
    let place = |(point, original): (u32, &u32)| {
        let missing = NetworkError::NoPeriodicCopy { point };
        let Some(from) = points.get(*original as usize) else { return Err(missing) };
        if originals[*original as usize] != *original {
            return Err(missing);
        }
        let periods = DVec3::select(periodic, (points[point as usize] - from) / domain.size(), DVec3::ZERO);
        let whole = periods.round();
        let is_copy = (periods - whole).abs().max_element() <= OFF_PERIOD
            && whole.abs().max_element() <= f64::from(i8::MAX)
            && (*original == point || whole != DVec3::ZERO);
        #[expect(clippy::cast_possible_truncation, reason = "whole and small")]
        let translation = Translation(whole.to_array().map(|count| count as i8));
        if is_copy { Ok(PeriodicVertex { vertex: *original, translation }) } else { Err(missing) }
    };
    (0u32..).zip(originals).map(place).collect()
}

/// An element: its sides as cells have them, and its corners.
pub(crate) type Face = ([voronoi::Side; 2], Vec<PeriodicVertex>);

/// The elements, each once, with the sides that they have where they stand.
fn faces(
    domain: &Domain,
    surface: &Surface<'_>,
    places: &[PeriodicVertex],
) -> Result<Vec<Face>, NetworkError> {
    let cell = |side: Side| side.grain().map(|grain| voronoi::Side::Cell(CellId(grain.0)));
    let (mut faces, mut outer) = (Vec::new(), Vec::new());
    for element in (0u32..).take(surface.elements.len()) {
        let corners: Vec<PeriodicVertex> =
            surface.elements.corners(element).iter().map(|corner| places[*corner as usize]).collect();
        match surface.sides_of(element).map(cell) {
            [Some(first), Some(second)] => faces.push(([first, second], corners)),
            [Some(own), None] => outer.push((seen_from_least(&corners), element, own, corners)),
            [None, Some(own)] => {
                let corners: Vec<_> = corners.into_iter().rev().collect();
                outer.push((seen_from_least(&corners), element, own, corners));
            }
            [None, None] => {}
        }
    }
    outer.sort_by(|a, b| a.0.0.cmp(&b.0.0).then(a.1.cmp(&b.1)));
    let mut once: Vec<(u32, Face)> = Vec::new();
    for same in outer.chunk_by(|a, b| a.0.0 == b.0.0) {
        let ((_, at), element, own, corners) = &same[0];
        let beyond = match same {
            [_] => wall_of(domain, surface, *element).map(voronoi::Side::Wall),
            [_, ((_, from), _, beyond, _)] => Some(beyond.moved(*at - *from)),
            _ => None,
        };
        let point = surface.elements.corners(*element)[0];
        let beyond = beyond.ok_or(NetworkError::NoPeriodicCopy { point })?;
        once.push((*element, ([*own, beyond], corners.clone())));
    }
    once.sort_unstable_by_key(|(element, _)| *element);
    faces.extend(once.into_iter().map(|(_, face)| face));
    Ok(faces)
}

/// Corners as seen from the least of them, the same for all copies of an element, and how far that is moved.
fn seen_from_least(corners: &[PeriodicVertex]) -> (Vec<PeriodicVertex>, Translation) {
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    let from = sorted[0].translation;
    let seen =
        sorted.iter().map(|corner| PeriodicVertex { translation: corner.translation - from, ..*corner });
    (seen.collect(), from)
}
