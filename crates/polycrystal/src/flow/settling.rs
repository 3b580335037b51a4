//! The flow of flat fans on which grains come together and part.

use cancellation::check_cancelled;
use voronoi::Tessellation;

use crate::energy::fans::Fans;
use crate::energy::local_size::LocalSize;
use crate::energy::shape::Shape;
use crate::events::local_area::Conditions;
use crate::events::reconnection::{Reconnections, Reconnector, SHORT};
use crate::flow::fan_flow::{FanFlow, Motion, Taken};
use crate::flow::recipe::NetworkRecipe;
use crate::flow::relaxation::{Moving, Relaxation, RelaxationStep};
use crate::flow::tuning::Tuning;
use crate::network::{feature_size, mean_grain_size};
use crate::{CellComplex, NetworkError};

/// Most steps: long before that all is at rest.
const STEPS: usize = 150;

/// Steps in a row without an event that make an end ...
const QUIET_STEPS: usize = 5;

/// ... when the area also changes by less than this share of it from one to the next.
const QUIET_CHANGE: f64 = 2e-5;

/// Cells whose topology has followed their boundaries.
pub(crate) struct Settled {
    pub(crate) complex: CellComplex,
    /// How lines and boundaries bulge.
    pub(crate) shape: Shape,
    /// What changed the topology.
    pub(crate) reconnections: Reconnections,
    pub(crate) steps: usize,
    /// Time passed, in units of the mean grain size squared.
    pub(crate) time: f64,
}

/// Lets fans flow, and grains come together and part, for a time or until all is at rest.
///
/// After each step all short lines, and small boundaries with three sides, are looked at.
pub(crate) fn settle(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    volumes: &[f64],
    relaxation: &Relaxation,
    tuning: &Tuning,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<Settled, NetworkError> {
    let (count, step_time) = match *relaxation {
        Relaxation::Time(time) => equal_steps(time, tuning.cell_step_time),
        Relaxation::Equilibrium => (STEPS, tuning.cell_step_time),
    };
    let domain = tessellation.domain();
    let mean_size = mean_grain_size(domain, volumes.len());
    let size = LocalSize::new(domain.dimension(), tuning.small_grain * mean_size);
    let mut reconnector = Reconnector::new(SHORT * feature_size(domain, volumes.len()), size);
    let mut complex = CellComplex::from(tessellation);
    let mut fans = Fans::new(&complex, recipe.tension);
    let mut shape = Shape::default();
    let mut points = shape.points(&complex, &fans);
    let mut reconnections = Reconnections::default();
    let (mut quiet, mut last_energy) = (0, f64::INFINITY);
    let mut show = |done: usize, complex: &CellComplex, shape: &Shape| {
        let time = done as f64 * step_time;
        watch(RelaxationStep { done, count, time, now: Moving::Cells(&|| shape.cells(complex)) });
    };
    show(0, &complex, &shape);
    for steps in 1.. {
        check_cancelled();
        let before = complex.vertices.clone();
        let flow = FanFlow { fans: &fans, motion: Motion::Kept { volumes, size }, tuning };
        let Taken { energy, pressures } = flow.step(&mut points, step_time * mean_size.powi(2))?;
        complex.vertices.copy_from_slice(&points[..fans.vertex_count()]);
        shape = Shape::new(&fans, &points);
        show(steps, &complex, &shape);
        let conditions =
            Conditions { shape: &shape, tension: recipe.tension, volumes, pressures: &pressures };
        let mut excess = fans.volumes(volumes.len(), &points);
        excess.iter_mut().zip(volumes).for_each(|(volume, wanted)| *volume -= wanted);
        let events = reconnector.pass(&mut complex, &conditions, &before, &mut excess);
        reconnections.add(events);
        quiet = if events.count() > 0 { 0 } else { quiet + 1 };
        if events.count() > 0 {
            let changed = Fans::new(&complex, recipe.tension);
            shape = shape.with_new_ends(&fans, &changed);
            fans = changed;
        }
        points = shape.points(&complex, &fans);
        let is_at_rest = quiet > QUIET_STEPS && (last_energy - energy).abs() < QUIET_CHANGE * energy;
        if is_at_rest || steps == count {
            // In the last events, too, what would be folded became flat.
            let shape = Shape::new(&fans, &points);
            let time = steps as f64 * step_time;
            return Ok(Settled { complex, shape, reconnections, steps, time });
        }
        last_energy = energy;
    }
    unreachable!("the last step returns")
}

/// A time in as few equal steps as may be, and the time of each, given the longest. After the most steps all is at rest.
fn equal_steps(time: f64, longest: f64) -> (usize, f64) {
    let count = (1..=STEPS).find(|count| time <= longest * *count as f64);
    count.map_or((STEPS, longest), |count| (count, time / count as f64))
}
