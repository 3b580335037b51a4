//! Relaxation toward the equilibrium of grain-boundary tension at fixed grain volumes.
//!
//! The energy is the area of all boundaries between grains; its gradient flow is motion by mean curvature. A semi-implicit
//! step of time dt solves `(M + dt K) d = -dt g + J^T p`, `J d = v` for the displacement d of the moved points x, with
//! M the area that each stands for, K the cotangent stiffness of the mesh that they make up (Dziuk 1991), g the gradient of
//! the area of the next finer level, J the gradient of the grains' volumes, v what these
//! lack, and p the pressures that make up for it.
//!
//! First the control points move, then those of level 1, which start where subdivision puts them.

pub(crate) mod cells;
pub(crate) mod fitted_levels;
pub(crate) mod regular_cells;

use glam::DVec3;

use crate::flow::adaptive_steps::AdaptiveSteps;
use crate::flow::boundary_flow::{End, Flow, Stage, has_kept_volumes};
use crate::flow::recipe::Certified;
use crate::flow::relaxation::TIME_OF_KEPT_TOPOLOGY;
use crate::{Mesh, Moving, Network, NetworkError, Relaxation, RelaxationStep, Relaxed, Tuning, Volumes};

/// Most steps toward equilibrium on the finest level that moves.
const REST_STEPS: usize = 200;

/// Where the control points are before a relaxation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Start {
    /// On the flat cells: coarse levels go first.
    Flat,
    /// Nearly where the control mesh has them at rest: a given time passes on the finest level that moves alone, and before the flow to rest on
    /// the level before it.
    Relaxed,
}

/// Relaxes a network from the given control points; on the finest level every grain keeps the volume of its cell.
///
/// `progress` is called after each step with the number of steps done and their total.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{Junctions, Network, Relaxation, herring_residual, relax};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds: Vec<DVec3> = (1..=20).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
/// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
/// let (network, flat) = Network::new(&cells, Junctions::Crease, 1)?;
/// let relaxed = relax(&network, &flat, &Relaxation::Time(0.1), |step, of| println!("step {step} of {of}"))?;
///
/// let residual = |points: &[DVec3]| herring_residual(&network, points).expect("there are triple lines").rms;
/// let [before, after] = [network.subdivide(&flat), relaxed.finest_points(&network)].map(|points| residual(&points));
/// assert!(after < before, "nearer to equilibrium");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NetworkError::BadRelaxationTime`]; [`NetworkError::Folded`] or [`NetworkError::VolumeNotRestored`] when the
/// network cannot be relaxed for so long without a change of its topology.
pub fn relax(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    progress: impl Fn(usize, usize),
) -> Result<Relaxed, NetworkError> {
    relax_watched(network, control_points, relaxation, Volumes::Kept, |step| progress(step.done, step.count))
}

/// As [`relax`], with a choice about volumes, and the start and every step shown to `watch`.
///
/// # Errors
/// As of [`relax`].
pub fn relax_watched(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    volumes: Volumes,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<Relaxed, NetworkError> {
    relax_tuned(network, control_points, relaxation, volumes, &Tuning::default(), &mut watch)
}

/// As [`relax_watched`], with other numbers than the tuned ones.
///
/// # Errors
/// As of [`relax`].
#[doc(hidden)]
pub fn relax_tuned(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    volumes: Volumes,
    tuning: &Tuning,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<Relaxed, NetworkError> {
    let plan = plan_of(network, relaxation, volumes, tuning);
    relax_levels(network, control_points, &plan, watch, &|_| Ok(())).map(|(relaxed, ())| relaxed)
}

/// As [`relax_watched`], and the finest level certified. Where it is not valid, as triangles cross, coarser points have to do.
///
/// # Errors
/// As of [`relax`], and [`NetworkError::Invalid`].
pub fn relax_certified(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    volumes: Volumes,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<(Relaxed, Certified), NetworkError> {
    let tuning = Tuning::default();
    let plan = plan_of(network, relaxation, volumes, &tuning);
    relax_levels(network, control_points, &plan, &mut watch, &|relaxed| {
        Certified::new(network, relaxed, volumes)
    })
}

/// The plan for a flat start, with tensions in any unit.
fn plan_of<'a>(network: &Network, relaxation: &Relaxation, volumes: Volumes, tuning: &'a Tuning) -> Plan<'a> {
    let tension_unit = network.mean_tension();
    Plan { relaxation: *relaxation, start: Start::Flat, volumes, tuning, tension_unit }
}

/// How to relax a network.
#[derive(Clone, Copy)]
struct Plan<'a> {
    relaxation: Relaxation,
    start: Start,
    volumes: Volumes,
    tuning: &'a Tuning,
    tension_unit: f64,
}

/// As [`relax_tuned`], by a plan, and what `accept` makes of the result.
///
/// Where the points of a level tangle, or what they lead to is not accepted, those of the level before have to do, and the result tells why. What does not come to rest goes
/// as far as in the usual time.
fn relax_levels<T>(
    network: &Network,
    control_points: &[DVec3],
    plan: &Plan<'_>,
    // Not generic from here on: the closure of each caller would compile all of this once more.
    watch: &mut dyn FnMut(RelaxationStep<'_>),
    accept: &dyn Fn(&Relaxed) -> Result<T, NetworkError>,
) -> Result<(Relaxed, T), NetworkError> {
    let Plan { relaxation, start, volumes, tuning, tension_unit } = *plan;
    relaxation.check()?;
    let (time, finest) = match relaxation {
        Relaxation::Time(time) => (time, tuning.finest_moved),
        Relaxation::Equilibrium => (TIME_OF_KEPT_TOPOLOGY, tuning.finest_balanced),
    };
    let last = network.level_count().min(finest);
    let network = &*network.holding(last);
    let is_in_space = matches!(network.control_mesh().mesh, Mesh::Triangles(_));
    let flow = |level: usize| Flow::new(network, level, volumes, tension_unit, *tuning);
    let accepted = |relaxed: Relaxed| accept(&relaxed).map(|made| (relaxed, made));
    let has_tension = network.tensions().iter().any(|tension| *tension > 0.0);
    if time == 0.0 || !has_tension {
        let mut points = control_points.to_vec();
        // Cells that were regularised have lost the volumes that their grains are to have.
        let is_lost = || !has_kept_volumes(network, 0, &points);
        if volumes == Volumes::Kept && is_lost() {
            flow(0).restore_volumes(&mut points)?;
        }
        let is_flat = points == control_points;
        return accepted(Relaxed { is_flat, ..Relaxed::new(0, points) });
    }
    if volumes == Volumes::Free {
        let begin = network.subdivide_between(0, last, control_points);
        let mut done = 0;
        let mut show = |steps: &AdaptiveSteps, points: &[DVec3]| {
            done = steps.taken();
            let now = Moving::Points { level: last, points };
            watch(RelaxationStep { done, count: steps.count(), time: steps.time(), now });
        };
        // Grains grow for the time that was asked for, not once more on each level.
        let points = flow(last).grow(&begin, time, &mut show)?;
        return accepted(Relaxed { steps: done, time, ..Relaxed::new(last, points) });
    }
    let whole_time = time * network.mean_grain_size().powi(2);
    let (first, first_steps) = match (start, relaxation) {
        (Start::Relaxed, Relaxation::Time(_)) => (last, tuning.settled_steps),
        (Start::Relaxed, Relaxation::Equilibrium) => (last.saturating_sub(1), tuning.settled_steps),
        (Start::Flat, _) => (0, tuning.coarse_steps),
    };
    let count = first_steps + (last - first) * tuning.fine_steps;
    watch(RelaxationStep {
        done: 0,
        count,
        time: 0.0,
        now: Moving::Points { level: 0, points: control_points },
    });
    // The start, and where the points of each level come to.
    let mut good = vec![Relaxed::new(0, control_points.to_vec())];
    let timed = |level: usize, end: End| {
        let steps = if level == first { first_steps } else { tuning.fine_steps };
        Stage { step_time: whole_time / steps as f64, steps, least_gain: 0.0, end }
    };
    let last_stage = match relaxation {
        Relaxation::Equilibrium => {
            // As long as those on the control mesh. Twice as long takes a tenth longer, and folds more of coarse meshes.
            let parts = if is_in_space { tuning.coarse_steps } else { 1 };
            let (step_time, least_gain) = (whole_time / parts as f64, Relaxation::LEAST_GAIN);
            Stage { step_time, steps: REST_STEPS, least_gain, end: End::Finished }
        }
        Relaxation::Time(_) => timed(last, End::Finished),
    };
    // Moves the points of a level from where those of the level before have come.
    let run = |before: &Relaxed, level: usize, stage: &Stage, watch: &mut dyn FnMut(RelaxationStep<'_>)| {
        let (mut steps, mut passed) = (before.steps, before.time);
        let mut show = |done: usize, points: &[DVec3]| {
            steps = before.steps + done;
            passed = before.time + done as f64 * time * (stage.step_time / whole_time);
            let now = Moving::Points { level, points };
            watch(RelaxationStep { done: steps, count, time: passed, now });
        };
        let start = network.subdivide_between(before.level, level, &before.points);
        let points = flow(level).run(&start, stage, &mut show)?;
        Ok(Relaxed { steps, time: passed, ..Relaxed::new(level, points) })
    };
    let mut level = first;
    let mut result = loop {
        let before = &good[good.len() - 1];
        if level == last {
            break run(before, level, &last_stage, watch).and_then(accepted);
        }
        match run(before, level, &timed(level, End::Open), watch) {
            Ok(relaxed) => good.push(relaxed),
            Err(error) => break Err(error),
        }
        level += 1;
    };
    // Once more as the end, if need be, as then what folds goes back toward where it began: for a time, and of coarser points.
    let is_timed = usize::from(relaxation != Relaxation::Equilibrium || level < last);
    let again =
        (first..=level).rev().skip(is_timed).map(|level| (level - first, level, timed(level, End::Finished)));
    let as_it_is = Stage { step_time: 0.0, steps: 0, least_gain: 0.0, end: End::Finished };
    let mut given_up = Vec::new();
    // A start whose own level moves is not relaxed.
    for (before, coarser, stage) in again.chain((first > 0).then_some((0, 0, as_it_is))) {
        match result {
            Err(error) if error.is_tangle() => {
                let how_far = if coarser == level { " to rest" } else { "" };
                error.give_up(format!("moving the points of level {level}{how_far}"), &mut given_up);
            }
            end => {
                result = end;
                break;
            }
        }
        level = coarser;
        result = run(&good[before], level, &stage, &mut |_| ()).and_then(accepted);
    }
    match result {
        Ok((relaxed, made)) => Ok((Relaxed { given_up, ..relaxed }, made)),
        Err(error) => Err(error.after(given_up)),
    }
}

/// Where the points of a control mesh in space go in the usual time, as a forecast: volumes are right, triangles may be thin.
pub(crate) fn predicted_points(
    network: &Network,
    control_points: &[DVec3],
    tuning: &Tuning,
) -> Result<Vec<DVec3>, NetworkError> {
    let steps = tuning.forecast_steps;
    let step_time = TIME_OF_KEPT_TOPOLOGY * network.mean_grain_size().powi(2) / steps as f64;
    let stage = Stage { step_time, steps, least_gain: 0.0, end: End::Volumes };
    let mut flow = Flow::new(network, 0, Volumes::Kept, network.mean_tension(), *tuning);
    flow.run(control_points, &stage, &mut |_, _| ())
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{Attempt, Fault, Faults, Junctions};

    /// What crossed only in the end was once refused, though coarser points did not cross.
    #[test]
    fn points_whose_finest_level_crosses_give_way_to_those_of_the_level_before() {
        let seeds: Vec<DVec3> =
            (1..=12).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
        let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&cells, Junctions::Crease, 2).expect("a small network");
        let tuning = Tuning::default();
        let relaxation = Relaxation::Time(0.1);
        let plan = plan_of(&network, &relaxation, Volumes::Kept, &tuning);
        let crossing = || NetworkError::Invalid(Faults(vec![Fault::NoArea { element: 7 }]));
        let relaxed = |finest: usize| {
            relax_levels(&network, &flat, &plan, &mut |_| (), &|relaxed| {
                if relaxed.level > finest { Err(crossing()) } else { Ok(relaxed.level) }
            })
        };
        let (coarse, level) = relaxed(0).expect("the control points will do");
        assert_eq!((coarse.level, level), (0, 0));
        let [Attempt { tried, said }] = &coarse.given_up[..] else { panic!("{:?}", coarse.given_up) };
        assert_eq!((tried.as_str(), said), ("moving the points of level 1", &crossing().to_string()));
        // It is complete: volumes are right on the finest level.
        assert!(has_kept_volumes(&network, coarse.level, &coarse.points));
        let (fine, _) = relaxed(1).expect("all points will do");
        assert_eq!((fine.level, fine.given_up.len()), (1, 0));
        assert!(coarse.time < fine.time && coarse.steps < fine.steps);
        let is_moved = |coarse: &Relaxed| coarse.points.iter().zip(&flat).any(|(a, b)| a != b);
        assert!(is_moved(&coarse));
        // A flat start is not relaxed: where no level will do there is none.
        let error = relax_levels(&network, &flat, &plan, &mut |_| (), &|_| Err::<(), _>(crossing()));
        let (attempts, last) = error.expect_err("nothing is accepted").into_attempts();
        assert_eq!((attempts.len(), last.to_string()), (1, crossing().to_string()));
    }
}
