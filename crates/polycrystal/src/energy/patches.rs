//! All patches of a network, and the way from their fields to those of the network.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use subzero::{EdgeId, FaceId};
use voronoi::Dimension;

use crate::energy::patch::{Elements, Law, LocalStencils, Patch, PlaceTerms, index_in};
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::grouped::{Grouped, split};
use crate::mesh::id::id;
use crate::mesh::volume::Cone;
use crate::network::tension::in_unit;
use crate::{Mesh, Network};

/// The patches of all boundaries.
///
/// Fields over the patches list the control points of the first patch, then those of the second, and so on; a
/// network's control point has a place in each of its patches. Fields over edges list these in the same order.
pub(crate) struct Patches {
    pub(crate) patches: Vec<Patch>,
    /// The places of each control point, patch after patch.
    places: Grouped<u32>,
    /// The patch of each place.
    patch_of_place: Vec<u32>,
    /// The first place of each patch, and the end.
    first_places: Vec<usize>,
    /// The first edge of each patch, and the end.
    first_edges: Vec<usize>,
    /// Of each control point the other ends of its edges, and the edges.
    links: Grouped<[u32; 2]>,
    /// The largest cotangent that an angle counts with.
    largest_cotangent: f64,
}

/// What all patches bring to a step.
pub(crate) struct Terms {
    /// Area times tension.
    pub(crate) energy: f64,
    /// The cone to each patch's surface.
    pub(crate) cones: Vec<Cone>,
    pub(crate) of_place: Vec<PlaceTerms>,
    /// Stiffness of each edge.
    pub(crate) stiffness: Vec<f64>,
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
        let control_level = &network.levels()[control];
        let count = network.boundaries().len();
        let mobility_unit = network.mean_mobility();
        let control_elements = BoundaryElements::of_level(control_level, count);
        let patches: Vec<Patch> = (0..count)
            .into_par_iter()
            .map(|boundary| {
                let law = Law {
                    tension: in_unit(network.tensions()[boundary], tension_unit),
                    mobility: in_unit(network.mobilities()[boundary], mobility_unit),
                    share: if network.boundaries()[boundary].twin.is_some() { 0.5 } else { 1.0 },
                };
                let numbers = control_elements.of(boundary);
                new_patch(&control_level.mesh, &numbers, surface > control, law)
            })
            .collect();
        check_cancelled();
        let starts = |length: fn(&Patch) -> usize| {
            let ends = patches.iter().scan(0, |end, patch| {
                *end += length(patch);
                Some(*end)
            });
            std::iter::once(0).chain(ends).collect::<Vec<usize>>()
        };
        let first_places = starts(|patch| patch.control_points.len());
        let first_edges = starts(|patch| patch.edges.len());
        let point_count = control_level.vertex_count();
        let places = || {
            let points = patches.iter().flat_map(|patch| &patch.control_points);
            Grouped::new(point_count, points.zip(0u32..).map(|(point, place)| (*point as usize, place)))
        };
        let links = || {
            let edges = patches.iter().flat_map(|patch| {
                patch.edges.iter().map(|ends| ends.map(|end| patch.control_points[end as usize]))
            });
            let links = edges
                .zip(0u32..)
                .flat_map(|([a, b], edge)| [(a as usize, [b, edge]), (b as usize, [a, edge])]);
            Grouped::new(point_count, links)
        };
        let patch_of_place = || {
            let numbered = (0u32..).zip(&patches);
            let repeated =
                numbered.flat_map(|(number, patch)| std::iter::repeat_n(number, patch.control_points.len()));
            repeated.collect()
        };
        let (links, (places, patch_of_place)) = rayon::join(links, || rayon::join(places, patch_of_place));
        Self { patches, places, patch_of_place, first_places, first_edges, links, largest_cotangent }
    }

    /// The places of a control point, patch after patch.
    pub(crate) fn places_of_point(&self, point: u32) -> &[u32] {
        self.places.of(point as usize)
    }

    /// The patch that a place belongs to.
    pub(crate) fn patch_of_place(&self, place: u32) -> usize {
        self.patch_of_place[place as usize] as usize
    }

    /// Of a control point the other ends of its edges, and the edges; one in several patches comes as often.
    pub(crate) fn links(&self, point: u32) -> &[[u32; 2]] {
        self.links.of(point as usize)
    }

    /// What the patches bring to a step where control points are.
    pub(crate) fn terms(&self, points: &[DVec3]) -> Terms {
        let mut of_place: Vec<PlaceTerms> =
            rayon::iter::repeat_n(PlaceTerms::default(), self.patch_of_place.len()).collect();
        let mut stiffness = vec![0.0; self.first_edges[self.patches.len()]];
        let of_patches = split(&mut of_place, &self.first_places)
            .into_par_iter()
            .zip(split(&mut stiffness, &self.first_edges));
        let add_terms = |(patch, (of_place, stiffness)): (&Patch, (&mut [PlaceTerms], &mut [f64]))| {
            check_cancelled();
            patch.add_terms(points, self.largest_cotangent, of_place, stiffness)
        };
        let (energies, cones): (Vec<f64>, Vec<Cone>) =
            self.patches.par_iter().zip(of_patches).map(add_terms).unzip();
        Terms { energy: energies.iter().sum(), cones, of_place, stiffness }
    }
}

/// Some elements in terms of their own points, and these points, sorted.
pub(crate) fn local_elements(all: crate::Elements<'_>, elements: &[u32]) -> (Vec<u32>, Elements) {
    let mut points = Vec::with_capacity(3 * elements.len());
    for element in elements {
        points.extend_from_slice(&all.corners(*element));
    }
    points.sort_unstable();
    points.dedup();
    let local = |point: u32| index_in(&points, point);
    let elements = match all.dimension() {
        Dimension::Three => Elements::Triangles(elements.iter().map(|e| all.points(*e).map(local)).collect()),
        Dimension::Two => Elements::Segments(elements.iter().map(|e| all.points(*e).map(local)).collect()),
    };
    (points, elements)
}

fn new_patch(control: &Mesh, numbers: &[u32], is_refined: bool, law: Law) -> Patch {
    check_cancelled();
    let (control_points, elements) = local_elements(control.into(), numbers);
    let all_edges = edges_of(control, numbers);
    let (edges, edges_across) = local_edges(control, numbers, &all_edges, &control_points);
    let stencils = is_refined.then(|| {
        let on_edges = all_edges.iter().map(|edge| id(control.vertex_count()) + edge);
        let points: Vec<u32> = control_points.iter().copied().chain(on_edges).collect();
        LocalStencils::new(|point, entries| control.stencil(point, entries), &control_points, &points)
    });
    Patch { control_points, elements, edges, edges_across, stencils, law }
}

/// The edges of some elements, sorted; in the plane, these themselves.
fn edges_of(mesh: &Mesh, elements: &[u32]) -> Vec<u32> {
    match mesh {
        Mesh::Segments(_) => elements.to_vec(),
        Mesh::Triangles(mesh) => {
            let edges = elements.iter().flat_map(|e| mesh.triangle_edges(FaceId(*e)));
            let mut edges: Vec<u32> = edges.map(|edge| edge.0).collect();
            edges.sort_unstable();
            edges.dedup();
            edges
        }
    }
}

/// The edges of some elements between their own points, and of each triangle those across from its corners.
fn local_edges(
    mesh: &Mesh,
    elements: &[u32],
    edges: &[u32],
    points: &[u32],
) -> (Vec<[u32; 2]>, Vec<[u32; 3]>) {
    let local = |ends: [u32; 2]| ends.map(|end| index_in(points, end));
    match mesh {
        Mesh::Segments(mesh) => {
            (elements.iter().map(|e| local(mesh.segments()[*e as usize])).collect(), Vec::new())
        }
        Mesh::Triangles(mesh) => {
            let across = |element: &u32| {
                let [ab, bc, ca] = mesh.triangle_edges(FaceId(*element)).map(|edge| index_in(edges, edge.0));
                [bc, ca, ab]
            };
            let across = elements.iter().map(across).collect();
            (edges.iter().map(|edge| local(mesh.edge(EdgeId(*edge)))).collect(), across)
        }
    }
}
