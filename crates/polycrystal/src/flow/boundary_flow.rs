//! Curvature flow of the points of one level.

mod best;
mod growth;
mod level_elements;
mod rounding;
mod step;
mod volumes;
mod widening;

use std::cell::LazyCell;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;

use crate::energy::local_size::LocalSize;
use crate::energy::patches::{Patches, Terms};
use crate::flow::assembly::{Unknowns, assemble};
use crate::flow::pressure_response::CHUNK;
use crate::flow::system::System;
use crate::flow::thin_triangles::Room;
use crate::flow::tied_points::{Numbering, TiedPoints};
use crate::flow::tuning::Tuning;
use crate::measures::rms_residual;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::level_points::LevelPoints;
use crate::solver::conjugate_gradients::dot;
use crate::{GrainId, LevelView, Mesh, Network, NetworkError, Volumes};
use best::{Best, Defects};
pub(crate) use growth::LEAST_GRAIN;
use level_elements::{LevelElements, LevelSectors};
use step::Taken;
pub(crate) use volumes::has_kept_volumes;

/// Most edges of the control mesh, as long as the mean, to a feature. Fans have three.
const FEATURE_EDGES: f64 = 6.0;

/// Share of its first residual at which a step of grains that grow is solved: rates of growth are asked for, not only where they lead.
pub(crate) const FREE_TOLERANCE: f64 = 1e-3;

/// Most attempts in a row to mend what the finest level folds, of which none leaves fewer places folded than there were. With 6, 12 or 24 the same three of five hard networks come out good, 12 takes up to twice
/// and 24 up to 2.6 times as long.
const MENDING_ATTEMPTS: usize = 3;

/// A number of steps on one level.
pub(crate) struct Stage {
    pub(crate) step_time: f64,
    pub(crate) steps: usize,
    /// The stage ends early when a step lessens the energy by less than this share; never for 0.
    pub(crate) least_gain: f64,
    pub(crate) end: End,
}

/// What has to be right at the end of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// Nothing yet: finer levels follow.
    Open,
    /// The volumes of the finest level.
    Volumes,
    /// These, and no triangle of the finest level is thin.
    Finished,
}

/// What becomes of places that the finest level folds at the end of a stage.
#[derive(Debug, Clone, Copy)]
enum Mending {
    /// Points there have moved too far from where it did not fold, and are carried along.
    GiveWay,
    /// It folded before anything moved: they go to the middle of their neighbours.
    Round,
}

/// Points at the end of a stage, those of the finest level, and the points that each place depends on that folds there.
struct Ending<'a> {
    points: Vec<DVec3>,
    surface: LevelPoints<'a>,
    places: Vec<Vec<u32>>,
}

/// A network whose points of one level move.
pub(crate) struct Flow<'a> {
    network: &'a Network,
    patches: Patches,
    /// Of each control point, as of [`LocalSize::at_points`].
    sizes: Vec<f64>,
    /// The level whose points move.
    level: usize,
    /// The level whose surface carries energy and volumes during the flow: one subdivision on, if there is any.
    surface: usize,
    /// The elements of each boundary on that level.
    elements: LevelElements<'a>,
    /// Points that are copies of others move as these.
    copies: TiedPoints,
    /// What steps move as one: what earlier ones would have folded, too. It could not live, and the others find the way to rest around it.
    tied: TiedPoints,
    volumes: Volumes,
    tuning: Tuning,
}

impl<'a> Flow<'a> {
    /// The flow of the points of one level, by tensions in the given unit: steps are right where this is their mean.
    pub(crate) fn new(
        network: &'a Network,
        level: usize,
        volumes: Volumes,
        tension_unit: f64,
        tuning: Tuning,
    ) -> Self {
        let surface = network.level_count().min(level + 1);
        let copies = TiedPoints::new(&network.levels()[level]);
        let (patches, elements) = rayon::join(
            || Patches::new(network, level, surface, tension_unit, tuning.largest_cotangent),
            || {
                LevelElements::new(
                    network,
                    surface,
                    &Adjacency::of_level(network.level_from_before(surface).held()),
                )
            },
        );
        check_cancelled();
        let unit = tuning.small_grain * network.mean_grain_size();
        let sizes =
            LocalSize::new(network.domain().dimension(), unit).at_points(network, level, &patches, volumes);
        check_cancelled();
        Self {
            network,
            patches,
            sizes,
            level,
            surface,
            elements,
            tied: copies.clone(),
            copies,
            volumes,
            tuning,
        }
    }

    /// Takes the steps of a stage.
    ///
    /// `progress` is told the number of steps done and where the points are.
    pub(crate) fn run(
        &mut self,
        start: &[DVec3],
        stage: &Stage,
        progress: &mut dyn FnMut(usize, &[DVec3]),
    ) -> Result<Vec<DVec3>, NetworkError> {
        let mut points = start.to_vec();
        let finest = self.finest_sectors();
        let mut last_energy = f64::INFINITY;
        let mut best = Best::new();
        let mut surface = self.refined(&points);
        for step in 1..=stage.steps {
            check_cancelled();
            let Taken { energy, broken } = self.take_step(&mut points, &mut surface, stage.step_time)?;
            broken.iter().for_each(|points| self.tied.join_all(points));
            progress(step, &points);
            if stage.least_gain > 0.0
                && let Some(defects) = self.defects(&surface, &finest)
            {
                best.offer(defects, &points);
                if best.is_final() {
                    break;
                }
            }
            if (last_energy - energy).abs() < stage.least_gain * energy {
                break;
            }
            last_energy = energy;
        }
        drop(surface);
        self.finished(best.into_points().unwrap_or(points), start, stage.end, &finest)
    }

    /// The points at the end of a stage, good where its end has to be. The finest level, which may be large, is looked at in the end alone.
    fn finished(
        &self,
        mut points: Vec<DVec3>,
        start: &[DVec3],
        end: End,
        finest: &LazyCell<LevelSectors<'a>, impl FnOnce() -> LevelSectors<'a>>,
    ) -> Result<Vec<DVec3>, NetworkError> {
        let copies = self.copies.number();
        let mut giving_way = self.giving_way(&copies, start);
        let surface = self.surface_at_end(&mut points, end)?;
        let places = self.folded_places(&surface, finest);
        let mut best = Ending { points, surface, places };
        for way in [Mending::GiveWay, Mending::Round] {
            let (mut points, mut places) = (best.points.clone(), best.places.clone());
            let mut attempts = 0;
            while !best.places.is_empty() && attempts < MENDING_ATTEMPTS {
                check_cancelled();
                points = match way {
                    Mending::GiveWay => {
                        let ways: Vec<DVec3> =
                            points.iter().zip(start).map(|(to, from)| *to - *from).collect();
                        let mut moves = copies.means(&ways, |point| self.freedom(point));
                        let places = places.iter().map(|points| copies.of(points.iter().copied()));
                        giving_way.smooth(&mut moves, places.flatten());
                        displaced(start, &copies.of_points(&moves))
                    }
                    Mending::Round => displaced(&points, &self.rounding(&points, &places)),
                };
                attempts += 1;
                let mut ended = points.clone();
                // Where volumes cannot be right, the same places are mended once more.
                let surface = match self.surface_at_end(&mut ended, end) {
                    Err(error) if error.is_tangle() => continue,
                    surface => surface?,
                };
                points = ended;
                places = self.folded_places(&surface, finest);
                if places.len() < best.places.len() {
                    best = Ending { points: points.clone(), surface, places: places.clone() };
                    attempts = 0;
                }
            }
        }
        match (best.places.is_empty(), end) {
            (true, End::Finished) => self.widen_all(&mut best.points, &best.surface, finest),
            // What nothing mends here, finer points may.
            (true, _) | (false, End::Open) => {}
            (false, End::Volumes | End::Finished) => {
                let grains = self.folded_grains(&best.surface, finest);
                return Err(NetworkError::Folded { count: best.places.len(), grains });
            }
        }
        Ok(best.points)
    }

    /// The points of the finest level at the end of a stage.
    fn surface_at_end(&self, points: &mut [DVec3], end: End) -> Result<LevelPoints<'a>, NetworkError> {
        match end {
            End::Open => Ok(self.finest_points(points)),
            End::Volumes | End::Finished => self.restored(points),
        }
    }

    /// How far points are from rest; nothing where no boundaries meet, and in the plane.
    fn defects(&self, surface: &[DVec3], finest: &LevelSectors<'_>) -> Option<Defects> {
        let Mesh::Triangles(_) = self.control_mesh() else { return None };
        let residual = rms_residual(self.network, self.surface(), surface)?;
        let folds = finest.folds(&self.network.points_between(self.surface, self.finest(), surface));
        Some(Defects { has_folds: !folds.is_empty(), residual })
    }

    fn system(&self, terms: Terms, groups: &Numbering, time: f64, points: &[DVec3]) -> System {
        let tolerance = match self.volumes {
            Volumes::Kept => self.tuning.tolerance,
            Volumes::Free => FREE_TOLERANCE,
        };
        let unknowns = self.unknowns(points, groups);
        System::new(assemble(self.network, &self.patches, terms, &unknowns, self.volumes), time, tolerance)
    }

    fn unknowns<'b>(&'b self, points: &'b [DVec3], groups: &'b Numbering) -> Unknowns<'b> {
        let junction_softness = self.tuning.junction_softness;
        Unknowns {
            level: &self.network.levels()[self.level],
            points,
            sizes: &self.sizes,
            groups,
            junction_softness,
        }
    }

    /// The feature size as control edges of this level have it. Where they are fine, what is short among them is not what is
    /// small in the network.
    fn feature_size(&self, points: &[DVec3]) -> f64 {
        let usual = 0.5f64.powi(i32::try_from(self.level).expect("a level is a small number"));
        (usual * self.network.feature_size())
            .min(FEATURE_EDGES * self.control_mesh().mean_edge_length(points))
    }

    fn finest(&self) -> usize {
        self.network.level_count()
    }

    /// How the elements of the finest level meet, once that is asked for.
    fn finest_sectors(&self) -> LazyCell<LevelSectors<'a>, impl FnOnce() -> LevelSectors<'a> + use<'a>> {
        let (network, level) = (self.network, self.finest());
        LazyCell::new(move || LevelSectors::new(network, level))
    }

    /// Where volumes are free the flow itself is asked for: nothing is held but what a step would fold.
    fn rigid_length(&self, points: &[DVec3]) -> f64 {
        match self.volumes {
            Volumes::Kept => self.tuning.rigid_length * self.feature_size(points),
            Volumes::Free => 0.0,
        }
    }

    /// Some points, and all ends of short edges, as one.
    fn with_short_edges(&self, tied: &TiedPoints, points: &[DVec3]) -> TiedPoints {
        let mut groups = tied.clone();
        groups.join_short_edges(self.control_mesh(), points, &self.sizes, self.rigid_length(points));
        groups
    }

    fn surface(&self) -> LevelView<'a> {
        self.network.level(self.surface)
    }

    fn control_mesh(&self) -> &'a Mesh {
        &self.network.levels()[self.level].mesh
    }

    /// The points of the level that carries the flow.
    fn refined(&self, points: &[DVec3]) -> Vec<DVec3> {
        self.network.subdivide_between(self.level, self.surface, points)
    }

    /// The points of the finest level.
    fn finest_points(&self, points: &[DVec3]) -> LevelPoints<'a> {
        self.network.points_between(self.level, self.finest(), points)
    }

    /// The points that each element depends on which is folded on the finest level, or has passed another.
    fn folded_places(&self, surface: &LevelPoints<'_>, finest: &LevelSectors<'_>) -> Vec<Vec<u32>> {
        let folds = finest.folds(surface).into_iter().flatten();
        folds.map(|element| self.dependencies(self.finest(), element)).collect()
    }

    /// The grains beside what is folded on the finest level, in order.
    fn folded_grains(&self, surface: &LevelPoints<'_>, finest: &LevelSectors<'_>) -> Vec<GrainId> {
        let level = self.network.finest();
        let folds = finest.folds(surface).into_iter().flatten();
        let sides =
            folds.flat_map(|element| self.network.boundaries()[level.boundary(element).index()].sides);
        let mut grains: Vec<GrainId> = sides.filter_map(|side| side.grain()).collect();
        grains.sort_unstable();
        grains.dedup();
        grains
    }

    /// All control points that an element of a level depends on; those of the surface's element that it descends from.
    fn dependencies(&self, level: usize, element: u32) -> Vec<u32> {
        let coarser = (self.surface..level).rev();
        let element = coarser.fold(element, |element, level| self.network.level(level).parent(element));
        let vertices = self.surface().elements().corners(element);
        if self.level == self.surface {
            return vertices.to_vec();
        }
        let mut entries = Vec::new();
        let mut points = Vec::new();
        for vertex in vertices.iter() {
            self.control_mesh().stencil(*vertex, &mut entries);
            points.extend(entries.iter().map(|(point, _)| *point));
        }
        points
    }
}

pub(crate) fn displaced(points: &[DVec3], moves: &[DVec3]) -> Vec<DVec3> {
    points.par_iter().zip(moves).with_min_len(CHUNK).map(|(point, by)| *point + *by).collect()
}
