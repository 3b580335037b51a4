//! Relaxation toward the equilibrium of grain-boundary tension at fixed grain volumes.
//!
//! The energy is the area of all boundaries between grains; its gradient flow is motion by mean curvature. A semi-implicit
//! step of time dt solves `(M + dt (K + S)) d = -dt K x + J^T p`, `J d = v` for the displacement d of the control points x,
//! with M the area that each control point stands for, K the cotangent stiffness of the subdivided surface pulled back
//! to the control points (Dziuk 1991), S springs on small features, J the gradient of the grains' volumes, v what these
//! lack, and p the pressures that make up for it.

mod clusters;
mod conjugate_gradients;
mod face_corners;
mod patch;
mod patches;
mod springs;
mod system;
mod volume_constraint;

use glam::DVec3;

use crate::folds::{element_normals, folded_edges};
use crate::{GrainId, Level, Mesh, Network, NetworkError};
use clusters::Clusters;
use conjugate_gradients::dot;
use face_corners::FaceCorners;
use patch::PatchTerms;
use patches::Patches;
use system::System;

/// Steps that the relaxation time is divided into.
const STEPS: usize = 10;

/// Attempts at a step (and at the whole flow), each with what the last one folded made rigid.
const ATTEMPTS: usize = 12;

/// Length, in units of the feature size, below which a control edge no longer changes.
const RIGID_LENGTH: f64 = 0.04;

/// Cosine of the largest angle between neighbouring elements after a step (75 degrees), so that later subdivision
/// has room before the 90 degrees of a fold.
const LARGEST_BEND: f64 = 0.26;

/// Cosine of the largest angle that an element may turn by within a step (60 degrees).
const LARGEST_TURN: f64 = 0.5;

/// Difference of a grain's volume from its cell's, as a share of the cell's, that ends the iteration on volumes.
const VOLUME_TOLERANCE: f64 = 1e-12;

/// Difference that is accepted where rounding keeps the iteration above that: small grains in large boxes.
const VOLUME_LIMIT: f64 = 1e-10;

/// Bounds on the factor by which a volume correction is larger than its gradient asks for.
const SMALLEST_GAIN: f64 = 0.3;
const LARGEST_GAIN: f64 = 2.0;

/// Most Newton steps on the volumes; each gains about a digit, for its gradient is that of a coarser level.
const VOLUME_STEPS: usize = 40;

/// How to relax.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// Time under curvature flow with unit mobility, in units of the mean grain size squared; 0 leaves boundaries flat.
    pub time: f64,
}

impl Default for Relaxation {
    /// Time 0.3: the angles of random Voronoi grains spread by 12 degrees instead of 24, and no boundary has to vanish.
    fn default() -> Self {
        Self { time: 0.3 }
    }
}

/// What relaxation gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// The control points of the relaxed network.
    pub control_points: Vec<DVec3>,
    /// Steps taken.
    pub steps: usize,
}

/// Relaxes a network from the given control points; on the finest level every grain keeps the volume of its cell.
///
/// `progress` is called after each step with the number of steps done and their total.
///
/// # Errors
/// [`NetworkError::BadRelaxationTime`]; [`NetworkError::PeriodicRelaxation`]; [`NetworkError::Folded`] or [`NetworkError::VolumeNotRestored`] when the
/// network cannot be relaxed for so long without a change of its topology.
pub fn relax(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    progress: impl Fn(usize, usize),
) -> Result<Relaxed, NetworkError> {
    let time = relaxation.time;
    if !(time.is_finite() && time >= 0.0) {
        return Err(NetworkError::BadRelaxationTime(time));
    }
    if time > 0.0 && network.domain().is_periodic() {
        return Err(NetworkError::PeriodicRelaxation);
    }
    let has_tension = network.boundaries().iter().any(|boundary| boundary.is_interior());
    if time == 0.0 || !has_tension {
        return Ok(Relaxed { control_points: control_points.to_vec(), steps: 0 });
    }
    let mut flow = Flow::new(network);
    let step_time = time * network.mean_grain_size().powi(2) / STEPS as f64;
    let mut states = vec![control_points.to_vec()];
    let mut count = 0;
    for _ in 0..ATTEMPTS {
        while states.len() <= STEPS {
            states.push(flow.step(&states[states.len() - 1], step_time)?);
            progress(states.len() - 1, STEPS);
        }
        let mut points = states[STEPS].clone();
        flow.restore_volumes(&mut points)?;
        let folds = flow.finest_folds(&points);
        if folds.is_empty() {
            return Ok(Relaxed { control_points: points, steps: STEPS });
        }
        // The finest level folds although no step did: back to where it did not, and on with an eye on that level.
        count = folds.len();
        flow.checks_finest = true;
        flow.make_rigid(network.levels().len() - 1, folds.into_iter().flatten());
        states.pop();
        while states.len() > 1 && !flow.finest_folds(&states[states.len() - 1]).is_empty() {
            states.pop();
        }
    }
    Err(NetworkError::Folded { count })
}

/// A network under relaxation.
struct Flow<'a> {
    network: &'a Network,
    patches: Patches,
    /// The level whose surface carries energy and volumes during the flow: one subdivision, if there is any.
    level: usize,
    corners: FaceCorners,
    clusters: Clusters,
    /// Whether each step is checked for folds on the finest level too, which is seldom worth its time.
    checks_finest: bool,
}

impl<'a> Flow<'a> {
    fn new(network: &'a Network) -> Self {
        let level = (network.levels().len() - 1).min(1);
        let clusters = Clusters::new(network.control_mesh().vertex_count());
        let (patches, corners) = (Patches::new(network, level), FaceCorners::new(network));
        Self { network, patches, level, corners, clusters, checks_finest: false }
    }

    /// One step of curvature flow; tried again where it folds.
    fn step(&mut self, points: &[DVec3], time: f64) -> Result<Vec<DVec3>, NetworkError> {
        let terms = self.patches.terms(points);
        let before = element_normals(self.surface(), &self.refined(points));
        let missing = self.missing(&self.patches.grain_volumes(self.network, points));
        self.clusters.join_short_edges(self.network, points, self.rigid_length());
        let mut count = 0;
        for _ in 0..ATTEMPTS {
            let moves = self.system(points, &terms, &self.clusters, time).displacement(&missing);
            let moved: Vec<DVec3> = points.iter().zip(&moves).map(|(point, by)| *point + *by).collect();
            let broken = self.broken_elements(&before, &moved);
            let folding = self.corners.folding(points, &moved);
            count = broken.len() + folding.len();
            self.make_rigid(self.level, broken.into_iter());
            folding.iter().for_each(|corner| self.clusters.join_all(corner));
            if count == 0 && self.checks_finest {
                let folds = self.finest_folds(&moved);
                count = folds.len();
                self.make_rigid(self.network.levels().len() - 1, folds.into_iter().flatten());
            }
            if count == 0 {
                return Ok(moved);
            }
        }
        Err(NetworkError::Folded { count })
    }

    /// Moves points so that the grains of the finest level have the volumes of their cells.
    ///
    /// Where much has become rigid, some grain may be unable to change its volume: then only short edges stay rigid, and
    /// at last none.
    fn restore_volumes(&self, points: &mut [DVec3]) -> Result<(), NetworkError> {
        let free = Clusters::new(points.len());
        let mut short = free.clone();
        short.join_short_edges(self.network, points, self.rigid_length());
        let start = points.to_vec();
        self.restore_with(&self.clusters, points)
            .or_else(|_| {
                points.copy_from_slice(&start);
                self.restore_with(&short, points)
            })
            .or_else(|_| {
                points.copy_from_slice(&start);
                self.restore_with(&free, points)
            })
    }

    fn restore_with(&self, clusters: &Clusters, points: &mut [DVec3]) -> Result<(), NetworkError> {
        let terms = self.patches.terms(points);
        let system = self.system(points, &terms, clusters, 0.0);
        let mut last: Option<Vec<f64>> = None;
        // The gradient is that of a coarser level: what is too small or large in it is measured and made up for.
        let mut gain = 1.0;
        for step in 0.. {
            let surface = self.network.subdivide(points);
            let missing = self.missing(&self.network.grain_volumes(self.network.finest(), &surface));
            let (grain, relative_error) = self.largest_error(&missing);
            let mut stalled = false;
            if let Some(last) = &last {
                let left = dot(&missing, last) / dot(last, last);
                stalled = relative_error > 0.5 * self.largest_error(last).1;
                gain = (gain / (1.0 - left)).clamp(SMALLEST_GAIN, LARGEST_GAIN);
            }
            if relative_error <= VOLUME_TOLERANCE || (stalled && relative_error <= VOLUME_LIMIT) {
                return Ok(());
            }
            // A correction that makes things worse (NaN included) would only be followed by others.
            if step == VOLUME_STEPS || relative_error.is_nan() || relative_error >= 1.0 {
                return Err(NetworkError::VolumeNotRestored { grain, relative_error });
            }
            let wanted: Vec<f64> = missing.iter().map(|lack| gain * lack).collect();
            let moves = system.volume_correction(&wanted);
            points.iter_mut().zip(&moves).for_each(|(point, by)| *point += *by);
            last = Some(missing);
        }
        Ok(())
    }

    fn system(&self, points: &[DVec3], terms: &[PatchTerms], clusters: &Clusters, time: f64) -> System<'_> {
        System::new(self.network, &self.patches, terms, points, clusters.number(), time)
    }

    fn rigid_length(&self) -> f64 {
        RIGID_LENGTH * self.network.feature_size()
    }

    /// What each grain's volume lacks.
    fn missing(&self, volumes: &[f64]) -> Vec<f64> {
        self.network.cell_volumes().iter().zip(volumes).map(|(cell, grain)| cell - grain).collect()
    }

    fn largest_error(&self, missing: &[f64]) -> (GrainId, f64) {
        let relative =
            missing.iter().zip(self.network.cell_volumes()).map(|(lack, cell)| (lack / cell).abs());
        let errors = (0u32..).map(GrainId).zip(relative);
        errors.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a network has grains")
    }

    fn surface(&self) -> &'a Level {
        &self.network.levels()[self.level]
    }

    /// The points of the level that carries the flow.
    fn refined(&self, points: &[DVec3]) -> Vec<DVec3> {
        if self.level == 0 { points.to_vec() } else { self.network.stencils(0).apply(points) }
    }

    fn finest_folds(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        folded_edges(self.network.finest(), &self.network.subdivide(points), 0.0)
    }

    /// Elements that a step has bent or turned too far.
    fn broken_elements(&self, before: &[DVec3], moved: &[DVec3]) -> Vec<u32> {
        let refined = self.refined(moved);
        let folds = folded_edges(self.surface(), &refined, LARGEST_BEND);
        let after = element_normals(self.surface(), &refined);
        let turned = (0u32..).zip(before.iter().zip(&after)).filter(|(_, (before, after))| {
            before.dot(**after) < LARGEST_TURN * before.length() * after.length()
        });
        turned.map(|(element, _)| element).chain(folds.into_iter().flatten()).collect()
    }

    /// Makes rigid all control points that the given elements of a level depend on.
    fn make_rigid(&mut self, level: usize, elements: impl Iterator<Item = u32>) {
        for element in elements {
            let element = ancestor(&self.network.levels()[self.level..=level], element) as usize;
            let vertices: &[u32] = match &self.surface().mesh {
                Mesh::Triangles(mesh) => &mesh.triangles()[element],
                Mesh::Segments(mesh) => &mesh.segments()[element],
            };
            if self.level == 0 {
                self.clusters.join_all(vertices);
                continue;
            }
            let rows = vertices.iter().map(|vertex| self.network.stencils(0).row(*vertex as usize).0);
            let depends_on: Vec<u32> = rows.flatten().copied().collect();
            self.clusters.join_all(&depends_on);
        }
    }
}

/// The element of the first of some consecutive levels that an element of the last descends from.
fn ancestor(levels: &[Level], element: u32) -> u32 {
    levels[..levels.len() - 1].iter().rev().fold(element, |element, parent| match &parent.mesh {
        Mesh::Triangles(mesh) => mesh.counts().triangle_parent(element),
        Mesh::Segments(_) => element / 2,
    })
}
