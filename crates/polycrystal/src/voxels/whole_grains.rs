//! Grains that stay whole where a map repeats.

use voronoi::Translation;

use crate::voxels::labels::{OUTSIDE, VoxelLabel};
use crate::voxels::lattice::{Lattice, MixedPlace, Place};
use crate::voxels::pattern::{Meeting, octants_around};
use crate::{GrainId, NetworkError};

/// A grain that reaches farther than so many periods is taken for endless: translations have 8 bits.
const FARTHEST: i8 = 60;

/// By how many periods each voxel is moved so that its grain is whole, with its middle in the box; nothing where the lattice has no periods.
///
/// Voxels of a grain hang together through faces, and along edges where [`Meeting`] joins them. Parts of a grain that do not hang together are moved by themselves.
///
/// # Errors
/// [`NetworkError::PeriodicPores`]; [`NetworkError::EndlessGrain`] where a grain meets its own image.
pub(super) fn whole_grains(
    lattice: &Lattice<'_>,
    mixed: &[Vec<MixedPlace>],
) -> Result<Vec<Translation>, NetworkError> {
    if lattice.periodic == [false; 3] {
        return Ok(Vec::new());
    }
    if lattice.labels.contains(&VoxelLabel::EXTERIOR) {
        return Err(NetworkError::PeriodicPores);
    }
    let joined = joined_at_edges(lattice, mixed);
    let mut moved: Vec<Option<Translation>> = vec![None; lattice.labels.len()];
    for first in 0..moved.len() {
        if moved[first].is_some() {
            continue;
        }
        moved[first] = Some(Translation::ZERO);
        let label = lattice.labels[first];
        let mut part = vec![(first, Translation::ZERO)];
        let mut next = 0;
        while let Some((voxel, own)) = part.get(next).copied() {
            next += 1;
            let place = lattice.place_of(voxel);
            let at_faces = (0..6).filter_map(|face| {
                let mut step = [0; 3];
                step[face / 2] = if face % 2 == 0 { -1 } else { 1 };
                stepped(lattice, place, step).filter(|(other, _)| lattice.labels[*other] == label)
            });
            let start = joined.partition_point(|(from, ..)| *from < voxel);
            let at_edges = joined[start..].iter().take_while(|(from, ..)| *from == voxel);
            for (other, across) in at_faces.chain(at_edges.map(|(_, other, across)| (*other, *across))) {
                let there = own + across;
                match moved[other] {
                    None if there.0.iter().all(|periods| periods.abs() < FARTHEST) => {
                        moved[other] = Some(there);
                        part.push((other, there));
                    }
                    Some(known) if known == there => {}
                    _ => return Err(NetworkError::EndlessGrain { grain: GrainId(label.0) }),
                }
            }
        }
        let home = periods_to_middle(lattice, &part);
        part.iter().for_each(|(voxel, own)| moved[*voxel] = Some(*own - home));
    }
    Ok(moved.into_iter().map(|moved| moved.expect("all voxels are seen")).collect())
}

/// How many periods the middle of some voxels is away from the box.
fn periods_to_middle(lattice: &Lattice<'_>, part: &[(usize, Translation)]) -> Translation {
    Translation(std::array::from_fn(|axis| {
        let along = |(voxel, own): &(usize, Translation)| {
            (lattice.place_of(*voxel)[axis] as f64 + 0.5) / lattice.shape[axis] as f64
                + f64::from(own.0[axis])
        };
        let middle = part.iter().map(along).sum::<f64>() / part.len() as f64;
        #[expect(clippy::cast_possible_truncation, reason = "no farther than the voxels")]
        let periods = middle.floor() as i8;
        if lattice.periodic[axis] { periods } else { 0 }
    }))
}

/// The voxel so many steps on, and by how many periods it is moved there.
fn stepped(lattice: &Lattice<'_>, place: Place, step: [isize; 3]) -> Option<(usize, Translation)> {
    let voxel = lattice.voxel(place, step)?;
    let across = |axis: usize| match place[axis].checked_add_signed(step[axis]) {
        None => -1,
        Some(at) => i8::from(at >= lattice.shape[axis]),
    };
    Some((voxel, Translation(std::array::from_fn(across))))
}

/// Voxels of one grain that hang together along an edge of the lattice, from either, and by how much the second is moved as seen from the first; sorted.
fn joined_at_edges(lattice: &Lattice<'_>, mixed: &[Vec<MixedPlace>]) -> Vec<(usize, usize, Translation)> {
    let mut joined = Vec::new();
    let volume = |label: u32| lattice.volume(label);
    let mut join = |[one, other]: [Option<(usize, Translation)>; 2]| {
        if let Some(((one, from), (other, to))) = one.zip(other) {
            joined.extend([(one, other, to - from), (other, one, from - to)]);
        }
    };
    for MixedPlace { place, .. } in mixed.iter().flatten() {
        let in_octant = |octant: usize| {
            stepped(lattice, *place, [0, 1, 2].map(|axis| if octant >> axis & 1 == 1 { 0 } else { -1 }))
        };
        let axes = if lattice.is_plane { 2..3 } else { 0..3 };
        for axis in axes {
            let around = octants_around(axis).map(in_octant);
            let labels = around.map(|voxel| voxel.map_or(OUTSIDE, |(voxel, _)| lattice.labels[voxel].0));
            let [a, b, c, d] = around;
            match Meeting::of(labels, &volume) {
                Meeting::Together => {}
                Meeting::FirstJoined => join([a, c]),
                Meeting::SecondJoined => join([b, d]),
            }
        }
    }
    joined.sort_unstable();
    joined
}
