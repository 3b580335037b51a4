//! Boundaries in space, as fans of triangles, that grow.

use glam::DVec3;
use voronoi::{CellId, FaceId, Tessellation};

use super::GrowthRecipe;
use super::front::{Front, Happened};
use super::tuning::GrowthTuning;
use crate::energy::fans::Fans;
use crate::energy::local_size::LocalSize;
use crate::energy::shape::Shape;
use crate::energy::sides::boundary;
use crate::events::local_area::Conditions;
use crate::events::reconnection::{Reconnections, Reconnector, SHORT};
use crate::flow::adaptive_steps::{Evolution, extrapolated};
use crate::flow::fan_flow::{FanFlow, Motion};
use crate::flow::recipe::RelaxedCells;
use crate::flow::relaxation::{Relaxation, Relaxed, TIME_OF_KEPT_TOPOLOGY};
use crate::flow::settling::Settled;
use crate::network::{feature_size, mean_grain_size};
use crate::relax::cells::smoothed;
use crate::{CellComplex, FaceMesh, GrainId, Network, NetworkError, Tuning};

/// Steps of Newton's method that bring the volumes of grains back after events. Each event changes volumes by up to a tenth of the mean; one step leaves 1e-3, two 1e-5.
const CORRECTIONS: usize = 2;

/// The boundaries of a complex in space.
pub(super) struct Sheets<'a> {
    recipe: &'a GrowthRecipe<'a>,
    growth: &'a GrowthTuning,
    tuning: &'a Tuning,
    complex: CellComplex,
    shape: Shape,
    fans: Fans,
    mobilities: Vec<f64>,
    /// Of all points of the fans.
    points: Vec<DVec3>,
    /// Where vertices were before the last step.
    before: Vec<DVec3>,
    reconnector: Reconnector,
}

impl<'a> Sheets<'a> {
    /// The flat faces of some cells.
    pub(super) fn new(
        cells: &Tessellation,
        recipe: &'a GrowthRecipe<'a>,
        growth: &'a GrowthTuning,
        tuning: &'a Tuning,
    ) -> Self {
        let complex = CellComplex::from(cells);
        let (domain, count) = (cells.domain(), cells.cell_count());
        let fans = Fans::new(&complex, recipe.network.tension);
        let points = Shape::default().points(&complex, &fans);
        let shape = Shape::new(&fans, &points);
        let size = LocalSize::new(domain.dimension(), tuning.small_grain * mean_grain_size(domain, count));
        let reconnector = Reconnector::new(SHORT * feature_size(domain, count), size);
        let mut sheets = Self {
            recipe,
            growth,
            tuning,
            complex,
            shape,
            fans,
            mobilities: Vec::new(),
            points,
            before: Vec::new(),
            reconnector,
        };
        sheets.find_mobilities();
        sheets
    }

    /// The volume of each grain now; 0 of those that have vanished.
    fn volumes_now(&self) -> Vec<f64> {
        self.volumes(&self.points)
    }

    fn find_mobilities(&mut self) {
        let mobility = |sides: &[voronoi::Side; 2]| (self.recipe.mobility)(&boundary(*sides));
        self.mobilities = self.fans.sides.iter().map(mobility).collect();
    }

    /// Takes over how the complex has changed.
    fn follow_complex(&mut self) {
        let fans = Fans::new(&self.complex, self.recipe.network.tension);
        self.shape = std::mem::take(&mut self.shape).with_new_ends(&self.fans, &fans);
        self.fans = fans;
        self.find_mobilities();
        self.points = self.shape.points(&self.complex, &self.fans);
    }

    fn flow(&self) -> FanFlow<'_> {
        let motion = Motion::Free { mobilities: &self.mobilities };
        FanFlow { fans: &self.fans, motion, tuning: self.tuning }
    }

    /// Gives a grain to the neighbour that it shares the largest boundary with, of those that can have it: to which one.
    fn vanish(&mut self, cell: CellId) -> Option<CellId> {
        let area = |face: FaceId| {
            let fan = self.fans.faces.binary_search(&face).expect("each face has a fan");
            self.fans.normals_of(fan, &self.points).map(DVec3::length).sum::<f64>()
        };
        let beyond = |face: FaceId| {
            let sides = self.complex.sides(face);
            sides.iter().filter_map(|side| side.cell()).map(|(other, _)| other).find(|other| *other != cell)
        };
        let faces = self.complex.faces_of_cell(cell);
        let mut ways: Vec<(f64, FaceId, CellId)> =
            faces.filter_map(|face| Some((area(face), face, beyond(face)?))).collect();
        ways.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let corners = self.complex.corners_of_cell(cell);
        let mut ways = [false, true].into_iter().flat_map(|allows| ways.iter().map(move |way| (way, allows)));
        let ((.., heir), _) =
            ways.find(|((_, face, _), allows)| self.complex.cell_to_neighbor_across(cell, *face, *allows))?;
        // A grain of four faces leaves one of its corners, in the middle of all that are on the same walls.
        let left: Vec<_> = corners
            .iter()
            .filter(|(corner, _)| !self.complex.faces_at(&[corner.vertex]).is_empty())
            .collect();
        if let [(kept, walls)] = left.as_slice()
            && walls.len() < 3
        {
            let beside = corners.iter().filter(|(_, at)| walls.iter().all(|wall| at.contains(wall)));
            let places: Vec<DVec3> = beside.map(|(corner, _)| self.complex.position(*corner)).collect();
            let middle = places.iter().sum::<DVec3>() / places.len() as f64;
            self.complex.vertices[kept.vertex as usize] =
                middle - kept.translation.vector(self.complex.domain());
        }
        Some(*heir)
    }

    /// Moves points so that grains have the volumes again that they had before events.
    fn restore(&mut self, volumes: &[f64], size: LocalSize) -> Result<(), NetworkError> {
        let motion = Motion::Kept { volumes, size };
        let flow = FanFlow { fans: &self.fans, motion, tuning: self.tuning };
        let mut points = self.points.clone();
        for _ in 0..CORRECTIONS {
            flow.step(&mut points, 0.0)?;
        }
        self.take(points);
        Ok(())
    }
}

impl Evolution for Sheets<'_> {
    type Points = Vec<DVec3>;

    fn step(&self, start: &Vec<DVec3>, time: f64) -> Result<Vec<DVec3>, NetworkError> {
        let mut points = start.clone();
        self.flow().step(&mut points, time)?;
        Ok(points)
    }

    fn extrapolated(&self, start: &Vec<DVec3>, halves: Vec<DVec3>, whole: &Vec<DVec3>) -> Vec<DVec3> {
        let mut end = extrapolated(&halves, whole);
        loop {
            // What goes too far that way stays where the halves lead.
            let mut is_changed = false;
            for point in self.flow().broken_on_way(start, &end).into_iter().flatten() {
                let point = point as usize;
                is_changed |= end[point] != halves[point];
                end[point] = halves[point];
            }
            if !is_changed {
                return end;
            }
        }
    }

    fn volumes(&self, points: &Vec<DVec3>) -> Vec<f64> {
        self.fans.volumes(self.complex.cell_count(), points)
    }
}

impl Front for Sheets<'_> {
    fn start(&mut self, _: f64) -> Vec<DVec3> {
        let mut points = self.points.clone();
        self.flow().center(&mut points);
        self.before = self.complex.vertices.clone();
        points
    }

    fn take(&mut self, points: Vec<DVec3>) {
        self.complex.vertices.copy_from_slice(&points[..self.fans.vertex_count()]);
        self.shape = Shape::new(&self.fans, &points);
        self.points = points;
    }

    fn pass(&mut self, volumes: &[f64], mean: f64) -> Result<Happened, NetworkError> {
        let mut small: Vec<(f64, u32)> = volumes.iter().copied().zip(0u32..).collect();
        small.retain(|(volume, cell)| {
            *volume < self.growth.vanished * mean && self.complex.faces_of_cell(CellId(*cell)).len() > 0
        });
        small.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut vanished = Vec::new();
        let mut volumes = volumes.to_vec();
        for (volume, cell) in small {
            if let Some(heir) = self.vanish(CellId(cell)) {
                vanished.push(GrainId(cell));
                volumes[cell as usize] = 0.0;
                volumes[heir.index()] += volume;
                self.follow_complex();
            }
        }
        let left = volumes.iter().filter(|volume| **volume != 0.0).count();
        let domain = self.complex.domain();
        let unit = self.tuning.small_grain * mean_grain_size(domain, left);
        let size = LocalSize::new(domain.dimension(), unit);
        self.reconnector.measure_by(SHORT * feature_size(domain, left), size);
        let pressures = vec![0.0; volumes.len()];
        let conditions = Conditions {
            shape: &self.shape,
            tension: self.recipe.network.tension,
            volumes: &volumes,
            pressures: &pressures,
        };
        let mut excess = vec![0.0; volumes.len()];
        let reconnections = self.reconnector.pass(&mut self.complex, &conditions, &self.before, &mut excess);
        if reconnections != Reconnections::default() {
            self.follow_complex();
        } else {
            // What is folded becomes flat.
            self.take(self.shape.points(&self.complex, &self.fans));
        }
        if reconnections != Reconnections::default() || !vanished.is_empty() {
            self.restore(&volumes, size)?;
        }
        Ok(Happened { vanished, reconnections })
    }

    fn network(&self) -> Result<(Network, Vec<DVec3>), NetworkError> {
        let (cells, points) = self.shape.cells(&self.complex);
        let recipe = &self.recipe.network;
        let (network, _) = Network::new(&cells, recipe.junctions, recipe.levels)?;
        let network = network.with_tensions(recipe.tension)?.with_mobilities(self.recipe.mobility)?;
        Ok((network.with_cell_volumes(self.volumes_now()), points))
    }

    fn finish(
        self,
        steps: usize,
        reconnections: Reconnections,
        time: f64,
    ) -> Result<RelaxedCells, NetworkError> {
        let volumes = self.volumes_now();
        let Self { recipe, growth, tuning, complex, shape, .. } = self;
        let settled = Settled { complex, shape, reconnections, steps, time };
        // Time does not pass any more: what is left to do is for points that have not moved yet.
        let smoothing = match recipe.network.face_mesh {
            FaceMesh::Fan | FaceMesh::SparseFan => growth.smoothing,
            FaceMesh::Plain | FaceMesh::Refined { .. } => TIME_OF_KEPT_TOPOLOGY,
        };
        let smoothing = Relaxation::Time(smoothing);
        let cells = smoothed(&settled, &volumes, &recipe.network, smoothing, tuning, &mut |_| ())?;
        let relaxed = Relaxed { steps, time, ..cells.relaxed };
        Ok(RelaxedCells { relaxed, ..cells })
    }
}
