//! All patches of a network, and the way from their fields to those of the network.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use voronoi::Dimension;

use crate::energy::local_elements::{LocalElements, edges_across, edges_of, ends_of, local_elements};
use crate::energy::patch::{Law, Patch, PlaceTerms};
use crate::energy::stencils::LocalStencils;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::grouped::{Grouped, split};
use crate::mesh::id::id;
use crate::mesh::volume::Cone;
use crate::network::tension::in_unit;
use crate::{Mesh, Network};

/// Boundaries whose patches are made at a time: each is made of small arrays, which all together would leave memory in pieces.
const AT_ONCE: usize = 4096;

/// The patches of all boundaries.
///
/// Fields over the patches list the control points of the first patch, then those of the second, and so on; a
/// network's control point has a place in each of its patches. Fields over edges list these in the same order.
pub(crate) struct Patches {
    /// The control point of each place.
    control_points: Vec<u32>,
    /// The elements of the control mesh, patch after patch, and the edges across from the corners of triangles.
    elements: LocalElements,
    edges_across: Vec<[u32; 3]>,
    /// How the points of the surface follow, where it is that of the next level.
    stencils: Option<LocalStencils>,
    /// Of each patch.
    laws: Vec<Law>,
    /// The first place of each patch, and the end.
    first_places: Vec<usize>,
    /// The first element of each patch, and the end.
    first_elements: Vec<usize>,
    /// The first edge of each patch, and the end.
    first_edges: Vec<usize>,
    /// The places of each control point, patch after patch.
    places: Grouped<u32>,
    /// The patch of each place.
    patch_of_place: Vec<u32>,
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
        let law = |boundary: usize| Law {
            tension: in_unit(network.tensions()[boundary], tension_unit),
            mobility: in_unit(network.mobilities()[boundary], mobility_unit),
            share: if network.boundaries()[boundary].twin.is_some() { 0.5 } else { 1.0 },
        };
        let control_elements = BoundaryElements::of_level(control_level, count);
        let mut all = NewPatches::new(network.domain().dimension(), surface > control);
        let starts = |all: &NewPatches| [all.control_points.len(), all.elements.len(), all.ends.len()];
        let mut firsts = vec![starts(&all)];
        for first in (0..count).step_by(AT_ONCE) {
            let at_once = (first..count.min(first + AT_ONCE)).into_par_iter();
            let new = at_once.map(|boundary| {
                check_cancelled();
                let mut patch = NewPatches::new(network.domain().dimension(), surface > control);
                patch.add(&control_level.mesh, &control_elements.of(boundary));
                patch
            });
            for patch in new.collect::<Vec<_>>() {
                all.append(&patch);
                firsts.push(starts(&all));
            }
        }
        check_cancelled();
        let NewPatches { control_points, elements, edges_across, stencils, ends } = all;
        let firsts_of = |kind: usize| firsts.iter().map(|firsts| firsts[kind]).collect::<Vec<usize>>();
        let first_places = firsts_of(0);
        let point_count = control_level.vertex_count();
        let places = || {
            let points = control_points.iter().zip(0u32..);
            Grouped::new(point_count, points.map(|(point, place)| (*point as usize, place)))
        };
        let links = || {
            let links = ends
                .iter()
                .zip(0u32..)
                .flat_map(|([a, b], edge)| [(*a as usize, [*b, edge]), (*b as usize, [*a, edge])]);
            Grouped::new(point_count, links)
        };
        let patch_of_place = || {
            let numbered = (0u32..).zip(first_places.windows(2));
            numbered.flat_map(|(number, ends)| std::iter::repeat_n(number, ends[1] - ends[0])).collect()
        };
        let (links, (places, patch_of_place)) = rayon::join(links, || rayon::join(places, patch_of_place));
        let [first_elements, first_edges] = [1, 2].map(firsts_of);
        Self {
            control_points,
            elements,
            edges_across,
            stencils,
            laws: (0..count).map(law).collect(),
            first_places,
            first_elements,
            first_edges,
            places,
            patch_of_place,
            links,
            largest_cotangent,
        }
    }

    /// The patch of a boundary.
    pub(crate) fn patch(&self, boundary: usize) -> Patch<'_> {
        let range = |firsts: &[usize]| firsts[boundary]..firsts[boundary + 1];
        let (places, elements) = (range(&self.first_places), range(&self.first_elements));
        Patch {
            control_points: &self.control_points[places],
            elements: self.elements.part(elements.clone()),
            edges_across: self.edges_across.get(elements).unwrap_or_default(),
            stencils: self.stencils.as_ref().map(|stencils| stencils.of(boundary)),
            law: &self.laws[boundary],
        }
    }

    /// All patches, boundary by boundary.
    pub(crate) fn patches(&self) -> impl IndexedParallelIterator<Item = Patch<'_>> {
        (0..self.laws.len()).into_par_iter().map(|boundary| self.patch(boundary))
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
        let mut stiffness = vec![0.0; self.first_edges[self.laws.len()]];
        let of_patches = split(&mut of_place, &self.first_places)
            .into_par_iter()
            .zip(split(&mut stiffness, &self.first_edges));
        let add_terms = |(patch, (of_place, stiffness)): (Patch<'_>, (&mut [PlaceTerms], &mut [f64]))| {
            check_cancelled();
            patch.add_terms(points, self.largest_cotangent, of_place, stiffness)
        };
        let (energies, cones): (Vec<f64>, Vec<Cone>) = self.patches().zip(of_patches).map(add_terms).unzip();
        Terms { energy: energies.iter().sum(), cones, of_place, stiffness }
    }
}

/// Patches as they are made.
struct NewPatches {
    control_points: Vec<u32>,
    elements: LocalElements,
    edges_across: Vec<[u32; 3]>,
    stencils: Option<LocalStencils>,
    /// Of each edge.
    ends: Vec<[u32; 2]>,
}

impl NewPatches {
    /// None yet.
    fn new(dimension: Dimension, is_refined: bool) -> Self {
        Self {
            control_points: Vec::new(),
            elements: LocalElements::new(dimension),
            edges_across: Vec::new(),
            stencils: is_refined.then(LocalStencils::new),
            ends: Vec::new(),
        }
    }

    /// Adds the patch of a boundary that has these elements.
    fn add(&mut self, control: &Mesh, numbers: &[u32]) {
        let (control_points, elements) = local_elements(control.into(), numbers);
        let edges = edges_of(control, numbers);
        if let Some(stencils) = &mut self.stencils {
            let on_edges = edges.iter().map(|edge| id(control.vertex_count()) + edge);
            let stencil = |point, entries: &mut Vec<_>| control.stencil(point, entries);
            stencils.add(stencil, &control_points, control_points.iter().copied().chain(on_edges));
        }
        self.elements.append(&elements);
        self.edges_across.extend(edges_across(control, numbers, &edges));
        self.ends.extend(edges.iter().map(|edge| ends_of(control, *edge)));
        self.control_points.extend(control_points);
    }

    /// Adds others.
    fn append(&mut self, others: &Self) {
        self.control_points.extend_from_slice(&others.control_points);
        self.elements.append(&others.elements);
        self.edges_across.extend_from_slice(&others.edges_across);
        if let (Some(stencils), Some(others)) = (&mut self.stencils, &others.stencils) {
            stencils.append(others);
        }
        self.ends.extend_from_slice(&others.ends);
    }
}
