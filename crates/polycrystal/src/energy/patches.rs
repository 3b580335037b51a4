//! All patches of a network, and the way from their fields to those of the network.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use subzero::{EdgeId, FaceId, StencilTable};

use crate::energy::patch::{Elements, Law, LocalStencils, Patch, PatchTerms, Refinement, index_in};
use crate::network::tension::in_unit;
use crate::solver::rows::CsrRows;
use crate::{BoundaryId, Mesh, Network};

/// The patches of all boundaries.
///
/// Fields over the patches list the control points of the first patch, then those of the second, and so on; a
/// network's control point has a place in each of its patches.
pub(crate) struct Patches {
    pub(crate) patches: Vec<Patch>,
    /// The places of control point v are `places[place_starts[v]..place_starts[v + 1]]`.
    place_starts: Vec<usize>,
    places: Vec<usize>,
    /// The patch of each place.
    patch_of_place: Vec<u32>,
    /// The first place of each patch.
    first_places: Vec<usize>,
    /// The largest cotangent that an angle counts with.
    pub(crate) largest_cotangent: f64,
}

impl Patches {
    /// Patches whose control points are those of one level, and whose surface is that of the same level or the next. Their tensions are in
    /// the given unit.
    pub(crate) fn new(
        network: &Network,
        control: usize,
        surface: usize,
        tension_unit: f64,
        largest_cotangent: f64,
    ) -> Self {
        let [control_level, surface_level] = [control, surface].map(|level| &network.levels()[level]);
        let count = network.boundaries().len();
        let mobility_unit = network.mean_mobility();
        let control_elements = by_boundary(count, &control_level.boundary_of);
        let surface_elements = by_boundary(count, &surface_level.boundary_of);
        let patches: Vec<Patch> = (0..count)
            .into_par_iter()
            .map(|boundary| {
                let surface = (surface > control).then(|| {
                    (network.stencils(control), &surface_level.mesh, surface_elements[boundary].as_slice())
                });
                let law = Law {
                    tension: in_unit(network.tensions()[boundary], tension_unit),
                    mobility: in_unit(network.mobilities()[boundary], mobility_unit),
                    share: if network.boundaries()[boundary].twin.is_some() { 0.5 } else { 1.0 },
                };
                new_patch(&control_level.mesh, &control_elements[boundary], surface, law)
            })
            .collect();
        let mut place_starts = vec![0; control_level.vertex_count() + 1];
        for patch in &patches {
            for point in &patch.control_points {
                place_starts[*point as usize + 1] += 1;
            }
        }
        for point in 1..place_starts.len() {
            place_starts[point] += place_starts[point - 1];
        }
        let mut next = place_starts.clone();
        let mut places = vec![0; place_starts[place_starts.len() - 1]];
        for (place, point) in patches.iter().flat_map(|patch| &patch.control_points).enumerate() {
            places[next[*point as usize]] = place;
            next[*point as usize] += 1;
        }
        let first_places = patches
            .iter()
            .scan(0, |next, patch| Some(std::mem::replace(next, *next + patch.control_points.len())))
            .collect();
        let patch_of_place = (0u32..)
            .zip(&patches)
            .flat_map(|(number, patch)| std::iter::repeat_n(number, patch.control_points.len()))
            .collect();
        Self { patches, place_starts, places, patch_of_place, first_places, largest_cotangent }
    }

    /// The places of a control point, patch after patch.
    pub(crate) fn places_of_point(&self, point: usize) -> &[usize] {
        &self.places[self.place_starts[point]..self.place_starts[point + 1]]
    }

    /// The patch that a place belongs to, and which of its control points it is.
    pub(crate) fn point_of_place(&self, place: usize) -> (usize, usize) {
        let patch = self.patch_of_place[place] as usize;
        (patch, place - self.first_places[patch])
    }

    pub(crate) fn terms(&self, points: &[DVec3]) -> Vec<PatchTerms> {
        let terms = |patch: &Patch| {
            check_cancelled();
            patch.terms(points, self.largest_cotangent)
        };
        self.patches.par_iter().map(terms).collect()
    }
}

/// The numbers of each boundary's elements.
pub(crate) fn by_boundary(boundary_count: usize, boundary_of: &[BoundaryId]) -> Vec<Vec<u32>> {
    let mut elements = vec![Vec::new(); boundary_count];
    for (element, boundary) in (0u32..).zip(boundary_of) {
        elements[boundary.index()].push(element);
    }
    elements
}

/// Some elements of a mesh in terms of their own points, and these points, sorted.
pub(crate) fn local_elements(mesh: &Mesh, elements: &[u32]) -> (Vec<u32>, Elements) {
    let mut points: Vec<u32> = match mesh {
        Mesh::Triangles(mesh) => elements.iter().flat_map(|e| mesh.triangles()[*e as usize]).collect(),
        Mesh::Segments(mesh) => elements.iter().flat_map(|e| mesh.segments()[*e as usize]).collect(),
    };
    points.sort_unstable();
    points.dedup();
    let local = |point: u32| index_in(&points, point);
    let elements = match mesh {
        Mesh::Triangles(mesh) => {
            Elements::Triangles(elements.iter().map(|e| mesh.triangles()[*e as usize].map(local)).collect())
        }
        Mesh::Segments(mesh) => {
            Elements::Segments(elements.iter().map(|e| mesh.segments()[*e as usize].map(local)).collect())
        }
    };
    (points, elements)
}

fn new_patch(
    control: &Mesh,
    numbers: &[u32],
    surface: Option<(&StencilTable, &Mesh, &[u32])>,
    law: Law,
) -> Patch {
    let (control_points, elements) = local_elements(control, numbers);
    let (edges, edges_across) = local_edges(control, numbers, &control_points);
    let refinement = surface.map(|(stencils, mesh, numbers)| {
        let (points, elements) = local_elements(mesh, numbers);
        Refinement { stencils: LocalStencils::new(stencils, &control_points, &points), elements }
    });
    let links = links(control_points.len(), &edges);
    Patch { control_points, elements, edges, edges_across, links, refinement, law }
}

/// Of each point the other ends of its edges, and their numbers.
fn links(point_count: usize, edges: &[[u32; 2]]) -> CsrRows<u32> {
    let mut links = vec![Vec::new(); point_count];
    for (number, [a, b]) in (0u32..).zip(edges) {
        links[*a as usize].push((*b, number));
        links[*b as usize].push((*a, number));
    }
    CsrRows::new(links)
}

/// The edges of some elements, each once, between the given points, and of each triangle those across from its corners.
fn local_edges(mesh: &Mesh, elements: &[u32], points: &[u32]) -> (Vec<[u32; 2]>, Vec<[u32; 3]>) {
    let local = |ends: [u32; 2]| ends.map(|end| index_in(points, end));
    match mesh {
        Mesh::Segments(mesh) => {
            (elements.iter().map(|e| local(mesh.segments()[*e as usize])).collect(), Vec::new())
        }
        Mesh::Triangles(mesh) => {
            let edges = elements.iter().flat_map(|e| mesh.triangle_edges(FaceId(*e)));
            let mut edges: Vec<u32> = edges.map(|edge| edge.0).collect();
            edges.sort_unstable();
            edges.dedup();
            let across = |element: &u32| {
                let [ab, bc, ca] = mesh.triangle_edges(FaceId(*element)).map(|edge| index_in(&edges, edge.0));
                [bc, ca, ab]
            };
            let across = elements.iter().map(across).collect();
            (edges.iter().map(|edge| local(mesh.edge(EdgeId(*edge)))).collect(), across)
        }
    }
}
