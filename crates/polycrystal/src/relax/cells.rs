//! Relaxation of cells, with the changes of topology that it takes.

use voronoi::Tessellation;

use crate::energy::unit::Unit;
use crate::events::merged_lines::MergedLines;
use crate::flow::balance::Balance;
use crate::flow::recipe::{Certified, NetworkRecipe, RelaxedCells};
use crate::flow::relaxation::{Relaxation, RelaxationStep, Relaxed, TIME_OF_KEPT_TOPOLOGY};
use crate::flow::settling::{Settled, settle};
use crate::flow::tuning::Tuning;
use crate::network::tension::checked_tension;
use crate::relax::{Plan, Start, relax_levels};
use crate::{Boundary, FaceMesh, Network, NetworkError, Volumes, arcs};

/// Relaxes the grains of a tessellation, and lets them come together and part. Every grain keeps the volume of its cell.
///
/// Triple lines that shrink to nothing become boundaries, and boundaries triple lines, where that lessens the area; each
/// grain stays a closed ball. The network is valid. Control points are in fans.
///
/// In the plane, where only [`Relaxation::Equilibrium`] changes the topology, boundaries become arcs of circles, in segments that turn by
/// a quarter of a degree at most, and meet at triple points. Steps are Newton's there, and count as time 1 each.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{FaceMesh, Junctions, NetworkRecipe, Relaxation, relax_cells};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds: Vec<DVec3> = (1..=20).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
/// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
/// let recipe = NetworkRecipe { face_mesh: FaceMesh::Fan, junctions: Junctions::Crease, levels: 1, tension: &|_| 1.0 };
/// let relaxed = relax_cells(&cells, &recipe, &Relaxation::USUAL, |_| ())?;
/// assert!(relaxed.validation.is_good());
/// assert!(relaxed.validation.largest_volume_error < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As of [`relax`](crate::relax), and [`NetworkError::Invalid`], where no way leads to a valid network.
pub fn relax_cells(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    relaxation: &Relaxation,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<RelaxedCells, NetworkError> {
    relax_cells_tuned(tessellation, recipe, relaxation, &Tuning::default(), &mut watch)
}

/// As [`relax_cells`], with other numbers than the tuned ones.
///
/// # Errors
/// As of [`relax_cells`].
#[doc(hidden)]
pub fn relax_cells_tuned(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    relaxation: &Relaxation,
    tuning: &Tuning,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<RelaxedCells, NetworkError> {
    relaxation.check()?;
    let unit = Unit::of(tessellation, recipe.tension, checked_tension)?;
    let tension = |boundary: &Boundary| unit.measure((recipe.tension)(boundary));
    let in_units = NetworkRecipe { tension: &tension, ..*recipe };
    let moves = unit.is_of_any && *relaxation != Relaxation::Time(0.0);
    let mut relaxed = match (tessellation.domain().dimension(), relaxation) {
        (voronoi::Dimension::Two, Relaxation::Equilibrium) => {
            arcs::equilibrate(tessellation, &in_units, watch)
        }
        (voronoi::Dimension::Three, _) if moves => {
            relax_in_space(tessellation, &in_units, relaxation, tuning, watch)
        }
        _ => relax_as_they_are(tessellation, &in_units, relaxation, tuning, watch),
    }?;
    relaxed.network = relaxed.network.with_tensions(recipe.tension)?;
    Ok(relaxed)
}

/// As [`relax_cells`] where nothing moves, with tensions whose mean is 1.
pub(crate) fn still(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    tuning: &Tuning,
) -> Result<RelaxedCells, NetworkError> {
    relax_as_they_are(tessellation, recipe, &Relaxation::Time(0.0), tuning, &mut |_| ())
}

/// As [`relax_cells`] where the topology stays, with tensions whose mean is 1.
fn relax_as_they_are(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    relaxation: &Relaxation,
    tuning: &Tuning,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<RelaxedCells, NetworkError> {
    let (network, flat) =
        Network::with_face_mesh(tessellation, recipe.face_mesh, recipe.junctions, recipe.levels)?;
    let network = network.with_tensions(recipe.tension)?;
    let plan = plan(*relaxation, Start::Flat, tuning);
    let certified = |relaxed: &Relaxed| Certified::new(&network, relaxed, Volumes::Kept);
    let (relaxed, certified) = relax_levels(&network, &flat, &plan, watch, &certified)?;
    Ok(RelaxedCells::of_kept_topology(network, relaxed, certified))
}

/// The plan for tensions whose mean is 1.
fn plan(relaxation: Relaxation, start: Start, tuning: &Tuning) -> Plan<'_> {
    Plan { relaxation, start, volumes: Volumes::Kept, tuning, tension_unit: 1.0 }
}

/// As [`relax_cells`] in space, with tensions whose mean is 1 at first.
fn relax_in_space(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    relaxation: &Relaxation,
    tuning: &Tuning,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<RelaxedCells, NetworkError> {
    let volumes: Vec<f64> = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
    let settled = settle(tessellation, recipe, &volumes, relaxation, tuning, watch)?;
    // Most of a given time has passed.
    let later = match *relaxation {
        Relaxation::Time(time) => Relaxation::Time(time.min(TIME_OF_KEPT_TOPOLOGY)),
        Relaxation::Equilibrium => Relaxation::Equilibrium,
    };
    smoothed(&settled, &volumes, recipe, later, tuning, watch)
}

/// The network of cells whose topology is what it is to be, relaxed further; each grain has the volume that is given. Tensions have a mean of 1.
pub(crate) fn smoothed(
    settled: &Settled,
    volumes: &[f64],
    recipe: &NetworkRecipe<'_>,
    relaxation: Relaxation,
    tuning: &Tuning,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<RelaxedCells, NetworkError> {
    let tuning = match relaxation {
        Relaxation::Time(_) => *tuning,
        Relaxation::Equilibrium => tuning.to_rest(),
    };
    let mut attempts = Vec::new();
    let mut smooth = |merged_length: f64| {
        let MergedLines { cells, middles, centers, collapsed: merged } =
            MergedLines::new(&settled.complex, &settled.shape, merged_length);
        let NetworkRecipe { face_mesh, junctions, levels, .. } = *recipe;
        let ((network, points), start) = match face_mesh {
            FaceMesh::Fan | FaceMesh::SparseFan => {
                (Network::of_curved_lines(&cells, &middles, &centers, junctions, levels)?, Start::Relaxed)
            }
            FaceMesh::Plain | FaceMesh::Refined { .. } => {
                (Network::with_face_mesh(&cells, face_mesh, junctions, levels)?, Start::Flat)
            }
        };
        let network = network.with_cell_volumes(volumes.to_vec()).with_tensions(recipe.tension)?;
        let mut watch_later = |step: RelaxationStep<'_>| {
            // Where it starts is where the last step ended.
            if step.done > 0 {
                let (done, count) = (settled.steps + step.done, settled.steps + step.count);
                watch(RelaxationStep { done, count, time: settled.time + step.time, ..step });
            }
        };
        let plan = plan(relaxation, start, &tuning);
        let certified = |relaxed: &Relaxed| Certified::new(&network, relaxed, Volumes::Kept);
        let (relaxed, certified) = relax_levels(&network, &points, &plan, &mut watch_later, &certified)?;
        let relaxed =
            Relaxed { steps: settled.steps + relaxed.steps, time: settled.time + relaxed.time, ..relaxed };
        let cells = RelaxedCells::of_kept_topology(network, relaxed, certified);
        let balance =
            (relaxation == Relaxation::Equilibrium).then(|| Balance::in_space(&cells.network, &cells.points));
        let reconnections = settled.reconnections;
        Ok::<_, NetworkError>(RelaxedCells { reconnections, merged, balance, ..cells })
    };
    match smooth(tuning.merged_length) {
        Err(error) if error.is_tangle() => error.give_up("relaxing without short lines", &mut attempts),
        result => return result,
    }
    match smooth(0.0) {
        Ok(relaxed) => Ok(RelaxedCells { attempts, ..relaxed }),
        Err(error) => Err(error.after(attempts)),
    }
}
