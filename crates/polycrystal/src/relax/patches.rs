//! All patches of a network, and the way from their fields to those of the network.

use glam::DVec3;
use rayon::prelude::*;
use subzero::StencilTable;

use super::clusters::Numbering;
use super::patch::{Patch, PatchElements, PatchTerms};
use crate::volume::sum_over_grains;
use crate::{Boundary, Mesh, Network};

/// The patches of all boundaries.
///
/// Fields over the patches list the control points of the first patch, then those of the second, and so on; a
/// network's control point has a place in each of its patches.
pub(super) struct Patches {
    pub(super) patches: Vec<Patch>,
    /// The places of control point v are `places[place_starts[v]..place_starts[v + 1]]`.
    place_starts: Vec<usize>,
    places: Vec<usize>,
    /// The patch of each place.
    patch_of_place: Vec<u32>,
    /// Cones for volumes start here.
    origin: DVec3,
}

impl Patches {
    /// Patches whose surface is that of the given level: 0 for the control mesh itself, or 1.
    pub(super) fn new(network: &Network, level: usize) -> Self {
        let control = network.control_mesh();
        let surface = &network.levels()[level];
        let control_elements = by_boundary(network.boundaries().len(), &control.boundary_of);
        let surface_elements = by_boundary(network.boundaries().len(), &surface.boundary_of);
        let stencils = (level > 0).then(|| network.stencils(0));
        let patches: Vec<Patch> = network
            .boundaries()
            .par_iter()
            .zip(control_elements.par_iter().zip(&surface_elements))
            .map(|(boundary, (control_elements, surface_elements))| {
                let edges = edges(&control.mesh, control_elements);
                new_patch(boundary, &surface.mesh, surface_elements, stencils, &edges)
            })
            .collect();
        let mut place_starts = vec![0; control.vertex_count() + 1];
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
        let patch_of_place = (0u32..)
            .zip(&patches)
            .flat_map(|(number, patch)| std::iter::repeat_n(number, patch.control_points.len()))
            .collect();
        let origin = network.domain().lower().midpoint(network.domain().upper());
        Self { patches, place_starts, places, patch_of_place, origin }
    }

    /// Number of places in all patches.
    pub(super) fn place_count(&self) -> usize {
        self.places.len()
    }

    /// The places of a control point, patch after patch.
    fn places_of_point(&self, point: usize) -> &[usize] {
        &self.places[self.place_starts[point]..self.place_starts[point + 1]]
    }

    /// The places of all control points of a cluster.
    pub(super) fn places_of_cluster<'a>(
        &'a self,
        clusters: &'a Numbering,
        cluster: usize,
    ) -> impl Iterator<Item = usize> + 'a {
        let members = clusters.members(cluster).iter();
        members.flat_map(|point| self.places_of_point(*point as usize).iter().copied())
    }

    /// The patch that a place belongs to.
    pub(super) fn patch_of_place(&self, place: usize) -> usize {
        self.patch_of_place[place] as usize
    }

    /// Splits a field over the places into one slice a patch.
    pub(super) fn split<'a, T>(&self, mut field: &'a mut [T]) -> Vec<&'a mut [T]> {
        let mut slices = Vec::with_capacity(self.patches.len());
        for patch in &self.patches {
            let (slice, rest) = field.split_at_mut(patch.control_points.len());
            slices.push(slice);
            field = rest;
        }
        slices
    }

    pub(super) fn terms(&self, points: &[DVec3]) -> Vec<PatchTerms> {
        self.patches.par_iter().map(|patch| patch.terms(points)).collect()
    }

    pub(super) fn volume_gradients(&self, points: &[DVec3]) -> Vec<Vec<DVec3>> {
        self.patches.par_iter().map(|patch| patch.volume_gradient(points)).collect()
    }

    /// Volumes of the grains on the level that the patches were made for.
    pub(super) fn grain_volumes(&self, network: &Network, points: &[DVec3]) -> Vec<f64> {
        let volumes: Vec<f64> =
            self.patches.par_iter().map(|patch| patch.volume(points, self.origin)).collect();
        sum_over_grains(network.boundaries(), &volumes, network.grain_count())
    }
}

/// The numbers of each boundary's elements.
fn by_boundary(boundary_count: usize, boundary_of: &[crate::BoundaryId]) -> Vec<Vec<u32>> {
    let mut elements = vec![Vec::new(); boundary_count];
    for (element, boundary) in (0u32..).zip(boundary_of) {
        elements[boundary.index()].push(element);
    }
    elements
}

/// The edges of some elements, each once.
fn edges(mesh: &Mesh, elements: &[u32]) -> Vec<[u32; 2]> {
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut edges: Vec<[u32; 2]> = match mesh {
        Mesh::Triangles(mesh) => {
            let corners = elements.iter().map(|element| mesh.triangles()[*element as usize]);
            corners.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]].map(sorted)).collect()
        }
        Mesh::Segments(mesh) => {
            elements.iter().map(|element| sorted(mesh.segments()[*element as usize])).collect()
        }
    };
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn new_patch(
    boundary: &Boundary,
    surface: &Mesh,
    elements: &[u32],
    stencils: Option<&StencilTable>,
    control_edges: &[[u32; 2]],
) -> Patch {
    let mut refined: Vec<u32> = match surface {
        Mesh::Triangles(mesh) => {
            elements.iter().flat_map(|element| mesh.triangles()[*element as usize]).collect()
        }
        Mesh::Segments(mesh) => {
            elements.iter().flat_map(|element| mesh.segments()[*element as usize]).collect()
        }
    };
    refined.sort_unstable();
    refined.dedup();
    let row = |point: u32| match stencils {
        Some(table) => {
            let (ids, weights) = table.row(point as usize);
            ids.iter().copied().zip(weights.iter().copied()).collect()
        }
        None => vec![(point, 1.0)],
    };
    let rows: Vec<Vec<(u32, f64)>> = refined.iter().map(|point| row(*point)).collect();
    let mut control_points: Vec<u32> = rows.iter().flatten().map(|(point, _)| *point).collect();
    control_points.sort_unstable();
    control_points.dedup();

    let mut starts = vec![0];
    let mut weights = Vec::new();
    for row in &rows {
        weights.extend(row.iter().map(|(point, weight)| (place_in(&control_points, *point), *weight)));
        starts.push(weights.len());
    }
    let local = |point: u32| place_in(&refined, point);
    let elements = match surface {
        Mesh::Triangles(mesh) => {
            let corners = elements.iter().map(|element| mesh.triangles()[*element as usize].map(local));
            PatchElements::Triangles(corners.collect())
        }
        Mesh::Segments(mesh) => {
            let ends = elements.iter().map(|element| mesh.segments()[*element as usize].map(local));
            PatchElements::Segments(ends.collect())
        }
    };
    let control_edges =
        control_edges.iter().map(|ends| ends.map(|end| place_in(&control_points, end))).collect();
    Patch { control_points, starts, weights, elements, control_edges, has_tension: boundary.is_interior() }
}

/// The place of an id in a sorted list that holds it.
fn place_in(sorted: &[u32], id: u32) -> u32 {
    let place = sorted.binary_search(&id).expect("a patch's surface depends on its own control points alone");
    u32::try_from(place).expect("a place in a list of ids fits an id")
}
