//! The parts of a step's linear system, gathered from the patches of a network.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::energy::patch::PlaceTerms;
use crate::energy::patches::{Patches, Terms};
use crate::flow::pressure_response::{CHUNK, PressureResponse};
use crate::flow::system::{Parts, softened};
use crate::flow::tied_points::Numbering;
use crate::flow::volume_constraint::{VolumeConstraint, VolumeGradients};
use crate::mesh::rounding::last_place;
use crate::solver::rows::{CsrRows, NewRow};
use crate::{Freedom, Level, Network, Volumes};

/// Share of a junction's mass that resists in all directions: without, nothing would hold points along a triple line.
const ALONG_LINES: f64 = 0.01;

/// What moves: groups of the points of a level.
pub(crate) struct Unknowns<'a> {
    pub(crate) level: &'a Level,
    pub(crate) points: &'a [DVec3],
    /// Of each point, as of [`LocalSize`](crate::energy::local_size::LocalSize).
    pub(crate) sizes: &'a [f64],
    pub(crate) groups: &'a Numbering,
    /// As of [`Tuning`](crate::Tuning).
    pub(crate) junction_softness: f64,
}

/// The parts of a step of some unknowns.
pub(crate) fn assemble(
    network: &Network,
    patches: &Patches,
    terms: Terms,
    unknowns: &Unknowns<'_>,
    volumes: Volumes,
) -> Parts {
    let Unknowns { level, groups, .. } = *unknowns;
    let freedoms = freedoms(network, unknowns);
    let softness_root = softness_root(unknowns, volumes);
    let by_group =
        (volumes == Volumes::Kept).then(|| volume_gradients(network, patches, &terms, unknowns, &freedoms));
    let masses = masses(patches, &terms, unknowns);
    let gradient = gradient(patches, &terms, groups);
    let sliding = match volumes {
        Volumes::Kept => Vec::new(),
        Volumes::Free => sliding_masses(patches, &terms, groups, level),
    };
    // Most of what a step holds up to here, and nothing of it is asked for again.
    drop(terms.of_place);
    let row = |group: usize, row: &mut NewRow<'_, f64>| {
        links(patches, &terms.stiffness, groups, group)
            .for_each(|(other, stiffness)| row.add(other, stiffness));
    };
    // To transpose a matrix takes one thread.
    let (stiffness, constraint) = rayon::join(
        || CsrRows::made_of_sums(groups.group_count(), row, softened(&softness_root)),
        || by_group.map(|by_group| VolumeConstraint::new(by_group, network.grain_count())),
    );
    Parts { masses, gradient, stiffness, softness_root, volumes: constraint, freedoms, sliding }
}

/// How some unknowns give way to pressures where their stiffness alone resists, and volumes are kept.
///
/// A pressure then moves a small element less than a large one, by about its area. Were it their masses that resist, all of a boundary would move
/// alike: one that misses a hundredth of a large grain's volume then went through the small elements at its rim.
pub(crate) fn pressure_response(
    network: &Network,
    patches: &Patches,
    terms: Terms,
    unknowns: &Unknowns<'_>,
) -> PressureResponse {
    let freedoms = freedoms(network, unknowns);
    let by_group = volume_gradients(network, patches, &terms, unknowns, &freedoms);
    let stiffnesses = stiffnesses(patches, &terms.stiffness, unknowns.groups);
    drop(terms);
    let constraint = VolumeConstraint::new(by_group, network.grain_count());
    PressureResponse::new(&stiffnesses, &freedoms, Some(constraint))
}

fn in_chunks(groups: &Numbering) -> impl IndexedParallelIterator<Item = usize> {
    (0..groups.group_count()).into_par_iter().with_min_len(CHUNK)
}

/// How each group can move.
fn freedoms(network: &Network, Unknowns { level, groups, .. }: &Unknowns<'_>) -> Vec<Freedom> {
    let freedom = |group| groups.freedom(group, |point| network.freedom(level.walls[point as usize]));
    in_chunks(groups).map(freedom).collect()
}

/// The root of the softness of each group, as of [`Parts`].
fn softness_root(unknowns: &Unknowns<'_>, volumes: Volumes) -> Vec<f64> {
    let Unknowns { level, groups, junction_softness, .. } = *unknowns;
    let of_junction = match volumes {
        Volumes::Kept => junction_softness.sqrt(),
        Volumes::Free => 1.0,
    };
    let is_junction = |point: &u32| is_junction(level, *point);
    let of_group =
        |group: usize| if groups.members(group).iter().any(is_junction) { of_junction } else { 1.0 };
    in_chunks(groups).map(of_group).collect()
}

/// The mass of each group.
fn masses(patches: &Patches, terms: &Terms, Unknowns { sizes, groups, .. }: &Unknowns<'_>) -> Vec<f64> {
    let mass = |group: usize| {
        let masses = groups.members(group).iter().map(|point| {
            let places = patches.places_of_point(*point).iter();
            let mass: f64 = places.map(|place| terms.of_place[*place as usize].mass).sum();
            mass / sizes[*point as usize].powi(2)
        });
        masses.sum::<f64>()
    };
    in_chunks(groups).map(mass).collect()
}

/// What holds each group to the others.
fn stiffnesses(patches: &Patches, of_edges: &[f64], groups: &Numbering) -> Vec<f64> {
    let stiffness =
        |group: usize| links(patches, of_edges, groups, group).map(|(_, stiffness)| stiffness).sum();
    in_chunks(groups).map(stiffness).collect()
}

/// The groups at the other ends of a group's edges, boundary by boundary, and what stiffness these edges have.
fn links(
    patches: &Patches,
    of_edges: &[f64],
    groups: &Numbering,
    group: usize,
) -> impl Iterator<Item = (u32, f64)> {
    let links = groups.members(group).iter().flat_map(|point| patches.links(*point));
    let to_groups = links.map(|[end, edge]| (groups.numbers()[*end as usize], of_edges[*edge as usize]));
    to_groups.filter(move |(other, _)| *other as usize != group)
}

/// The gradients of the volumes of grains, of groups with these freedoms.
fn volume_gradients(
    network: &Network,
    patches: &Patches,
    terms: &Terms,
    Unknowns { points, groups, .. }: &Unknowns<'_>,
    freedoms: &[Freedom],
) -> CsrRows<DVec3> {
    let fill = |group: usize, volume_gradients: &mut VolumeGradients<'_, '_>| {
        for place in groups.places(group, patches) {
            let boundary = &network.boundaries()[patches.patch_of_place(place)];
            // Walls do not move, so what lies on them changes no volume.
            if boundary.wall.is_none() {
                let gradient = terms.of_place[place as usize].volume_gradient;
                boundary
                    .signed_grains()
                    .for_each(|(grain, sign)| volume_gradients.add(grain, gradient * sign));
            }
        }
    };
    VolumeConstraint::by_group(freedoms, last_place(points), fill)
}

/// The gradient of the energy by the displacement of each group.
pub(crate) fn gradient(patches: &Patches, terms: &Terms, groups: &Numbering) -> Vec<DVec3> {
    let gradient = |group: usize| {
        groups.places(group, patches).map(|place| terms.of_place[place as usize].gradient).sum::<DVec3>()
    };
    in_chunks(groups).map(gradient).collect()
}

/// Whether three boundaries or more share a point, walls not counted.
fn is_junction(level: &Level, point: u32) -> bool {
    let point = point as usize;
    level.node_types[point].side_count() - i8::from(!level.walls[point].is_empty()) >= 3
}

/// The part of the mass of junctions that does not resist their motion.
///
/// Boundaries resist to be moved along their normals only, and junctions have no drag of their own: a boundary of mass m and
/// normal n has the mass matrix `m n n^T`. So polygons in the plane shrink and grow by the law of von Neumann and Mullins
/// exactly, to first order in their angles, whatever the lengths of the segments that meet: with force `sum of a n`, a the
/// angle by which a segment of length h is off equilibrium, the velocity v has `h/2 n v = a + c` with the same c for all
/// three, and the area that two of them sweep is the difference of their a.
///
/// Curvature flow of kept volumes leads to equilibrium with any masses.
fn sliding_masses(
    patches: &Patches,
    terms: &Terms,
    groups: &Numbering,
    level: &Level,
) -> Vec<(usize, DMat3)> {
    let is_junction = |point: &u32| is_junction(level, *point);
    let of_group = |group: usize| {
        groups.members(group).iter().any(is_junction).then(|| {
            let places = groups.places(group, patches);
            let parts = places.map(|place| {
                let PlaceTerms { volume_gradient, mass, .. } = terms.of_place[place as usize];
                (volume_gradient, mass)
            });
            (group, sliding_mass(parts))
        })
    };
    (0..groups.group_count()).into_par_iter().filter_map(of_group).collect()
}

/// What the mass of a junction is less than isotropic, given the normals, of any length, and the masses of the boundaries that meet there.
pub(crate) fn sliding_mass(parts: impl IntoIterator<Item = (DVec3, f64)>) -> DMat3 {
    let of_part = |(normal, mass): (DVec3, f64)| {
        let normal = normal.normalize_or_zero();
        let across = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        (DMat3::IDENTITY - across) * (mass * (1.0 - ALONG_LINES))
    };
    parts.into_iter().map(of_part).sum()
}
