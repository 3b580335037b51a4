//! What is usual beside the other options of a config, and what follows from them.

use glam::DVec3;
use polycrystal::{FaceMesh, Relaxation, Volumes};
use voronoi::Dimension;

use super::inside::InsidePattern;
use super::laws::{LawKind, LawOptions};
use super::sizes::{SizeSource, USUAL_DIAMETERS};
use super::{Config, SeedSource};

impl Config {
    /// The length to regularise by where grains cannot come together and part, in mean grain sizes: the shortest that leaves triangles as
    /// good as longer ones do. Of random grains, 0.15 made three times as many points of more than four grains; docs/relaxation.md has
    /// the figures.
    pub const REGULARIZE: f64 = 0.05;

    /// The same where grains are of several cells: edges of their boundaries close that are shorter than this part of the smallest grain there.
    pub const REGULARIZE_OF_SHAPES: f64 = 0.25;

    /// The usual relaxation of grains of given shapes, which it rounds: 200 of 2:1:1 with a ratio of 2.08 have 1.97 at 0.02, 1.82 at 0.1 and 1.70
    /// at 0.3, with angles that spread by 11.9, 12.7 and 13.9 degrees.
    pub const RELAXATION_OF_SHAPES: Relaxation = Relaxation::Time(0.05);

    /// Centroid steps of grains with given sizes: with 10 they have 13.7 faces and a sphericity of 0.855, as those of measured metals.
    pub const LLOYD_OF_SIZES: u32 = 10;

    /// The default of `--relax`. In the plane to equilibrium, which is quick and exact there; in space for a time, which is longer if the other
    /// options let grains switch neighbours. Not at all if grains are divided into lamellae, which would bend and come apart.
    ///
    /// It is decided here alone; a test compares the help, from which all other texts follow.
    pub(super) fn usual_relaxation(&self) -> Relaxation {
        if self.inside.iter().any(|inside| matches!(inside.pattern, InsidePattern::Lamellae { .. })) {
            return Relaxation::Time(0.0);
        }
        if self.has_grains_of_several_cells() {
            return Self::RELAXATION_OF_SHAPES;
        }
        let usual = match self.dimension {
            Dimension::Two => Relaxation::Equilibrium,
            Dimension::Three => Relaxation::USUAL,
        };
        let lets_change = Self { relaxation: Some(usual), ..self.clone() }.lets_topology_change();
        if lets_change { usual } else { Relaxation::KEPT_TOPOLOGY }
    }

    /// How far boundaries relax.
    pub fn effective_relaxation(&self) -> Relaxation {
        self.relaxation.unwrap_or_else(|| self.usual_relaxation())
    }

    /// How far boundaries relax where the topology stays: where it should have changed, for no longer than is usual then.
    pub(crate) fn relaxation_of_kept_topology(&self) -> Relaxation {
        match (self.effective_relaxation(), Relaxation::KEPT_TOPOLOGY) {
            (Relaxation::Time(time), Relaxation::Time(usual)) if self.lets_topology_change() => {
                Relaxation::Time(time.min(usual))
            }
            (relaxation, _) => relaxation,
        }
    }

    /// The length to regularise by, where the topology is to stay or cannot change: none without relaxation.
    pub(crate) fn effective_regularize(&self) -> f64 {
        if self.effective_relaxation() == Relaxation::Time(0.0) {
            0.0
        } else {
            let usual = if self.has_grains_of_several_cells() {
                Self::REGULARIZE_OF_SHAPES
            } else {
                Self::REGULARIZE
            };
            self.regularize.unwrap_or(usual)
        }
    }

    /// Whether grains may switch neighbours: at kept volumes, unless the cells' own are asked for. In the plane they do so on the way to
    /// equilibrium only.
    pub(crate) fn lets_topology_change(&self) -> bool {
        let is_on_the_way = match self.dimension {
            // Arcs of circles are divided as they curve.
            Dimension::Two => {
                self.effective_relaxation() == Relaxation::Equilibrium
                    && !matches!(self.face_mesh, FaceMesh::Refined { .. })
            }
            Dimension::Three => self.effective_relaxation() != Relaxation::Time(0.0),
        };
        is_on_the_way
            && !self.has_grains_of_several_cells()
            && self.regularize.is_none()
            && self.volumes == Volumes::Kept
    }

    /// Control points on the boundaries of regularised cells: in a fan, whose triangles at short lines are thin, those stay whole.
    pub(crate) fn regular_face_mesh(&self) -> FaceMesh {
        if self.face_mesh == FaceMesh::Fan { FaceMesh::SparseFan } else { self.face_mesh }
    }

    /// Whether grains grow, vanish and switch neighbours on the way: freely, unless the cells' own neighbours are asked for. Curves in the plane
    /// have points of their own.
    pub(crate) fn lets_grains_vanish(&self) -> bool {
        let has_own_points =
            self.dimension == Dimension::Two && matches!(self.face_mesh, FaceMesh::Refined { .. });
        self.volumes == Volumes::Free
            && self.regularize.is_none()
            && !self.has_grains_of_several_cells()
            && !has_own_points
    }

    /// Number of voxels that are asked for.
    pub(crate) fn voxel_count(&self) -> u128 {
        self.file.voxel_count(self.dimension)
    }

    /// Bytes of a voxel in VTK's ImageData: its grain, its phase where there are some, and three colours where grains have orientations.
    pub(crate) fn bytes_of_voxel(&self) -> u32 {
        let phase = if self.phases.is_empty() { 0 } else { 4 };
        4 + phase + if self.has_texture() { 3 * 3 } else { 0 }
    }

    /// By what coordinates are multiplied in the end: the aspect ratio, with the product 1.
    pub fn stretch(&self) -> DVec3 {
        let stretch = self.aspect_ratio / self.dimension.cube_edge(self.aspect_ratio.element_product());
        if self.dimension == Dimension::Two { stretch.with_z(1.0) } else { stretch }
    }

    /// Whether phases are put into the grains of others, which then are of several cells.
    pub(crate) fn has_inclusions(&self) -> bool {
        self.phases.iter().filter_map(|phase| phase.place).any(|place| place.of_inclusions().is_some())
    }

    /// Whether grains are of several cells, and need not be convex.
    pub fn has_grains_of_several_cells(&self) -> bool {
        self.grain_shapes.is_some() || self.has_inclusions()
    }

    /// Whether grains have given volumes: phases have exact shares, so their grains do.
    pub fn is_sized(&self) -> bool {
        self.sizes.source.is_some()
            || matches!(self.seeds, SeedSource::Packed { .. })
            || !self.phases.is_empty()
            || self.grain_shapes.is_some()
    }

    /// Whether sizes are asked for that say how many grains there are.
    pub fn has_sizes(&self) -> bool {
        self.sizes.source.is_some() || self.phases_have_diameters()
    }

    /// Number of times that every seed moves to the centroid of its cell.
    pub fn centroid_steps(&self) -> u32 {
        let has_places = matches!(self.seeds, SeedSource::File(_));
        let usual = if self.is_sized() && !has_places { Self::LLOYD_OF_SIZES } else { 0 };
        self.lloyd_steps.unwrap_or(usual)
    }

    /// What is asked for in words.
    pub(crate) fn asked_sizes(&self) -> String {
        match &self.sizes.source {
            None => USUAL_DIAMETERS.to_owned(),
            Some(SizeSource::VolumeFile(path)) => format!("volumes of {}", path.display()),
            Some(source) => source.to_string(),
        }
    }

    /// What is asked for in a phase, in words.
    pub(crate) fn asked_sizes_of_phase(&self, phase: usize) -> String {
        match &self.phases[phase].diameters {
            Some(source) => source.to_string(),
            None => self.asked_sizes(),
        }
    }

    /// The share of the volume that each phase is to have; they add up to 1. None without phases.
    pub(crate) fn phase_fractions(&self) -> Vec<f64> {
        let sum: f64 = self.phases.iter().map(|phase| phase.fraction).sum();
        self.phases.iter().map(|phase| phase.fraction / sum).collect()
    }

    /// Whether phases have diameters of their own.
    pub(crate) fn phases_have_diameters(&self) -> bool {
        self.phases.iter().any(|phase| phase.diameters.is_some())
    }

    /// Whether grains have orientations that are asked for.
    pub fn has_texture(&self) -> bool {
        self.texture.source.is_some() || self.phases.iter().any(|phase| phase.texture.is_some())
    }

    /// What divides the grains of a phase, by its index; of phase 0 without phases.
    pub(crate) fn pattern_inside(&self, phase: usize) -> Option<usize> {
        let name = self.phases.get(phase).map(|phase| &phase.name);
        self.inside.iter().position(|options| options.phase.is_none() || options.phase.as_ref() == name)
    }

    /// The laws of a kind that are asked for.
    pub fn laws(&self, kind: LawKind) -> &[LawOptions] {
        match kind {
            LawKind::Tension => &self.tensions,
            LawKind::Mobility => &self.mobilities,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Args as _;

    use super::*;

    #[test]
    fn help_has_the_usual_relaxation() {
        let relax = |config: Config| match config.effective_relaxation() {
            Relaxation::Time(time) => time.to_string(),
            Relaxation::Equilibrium => "equilibrium".to_owned(),
        };
        let plane = Config { dimension: Dimension::Two, ..Config::default() };
        let lamellae = vec!["lamellae(width=0.1)".parse().expect("a pattern")];
        let shapes = Some(crate::ShapeSource::parse("2:1:1").expect("a shape"));
        let kept = [
            relax(Config { volumes: Volumes::Free, ..Config::default() }),
            relax(Config { regularize: Some(0.05), ..Config::default() }),
            relax(Config { face_mesh: FaceMesh::Refined { edge_length: 0.1 }, ..plane.clone() }),
        ];
        assert_eq!(kept, [&*kept[0]; 3]);
        let usual = format!(
            "[default: {}, in 2D {}; {} with lamellae, {} for grains of several cells, {} with --free or --regularize, in 2D with --edge-length too]",
            relax(Config::default()),
            relax(plane),
            relax(Config { inside: lamellae, ..Config::default() }),
            relax(Config { grain_shapes: shapes, ..Config::default() }),
            kept[0],
        );
        let command = Config::augment_args(clap::Command::new("grainsmooth"));
        let option = command.get_arguments().find(|option| option.get_long() == Some("relax"));
        let help = option.and_then(|option| option.get_help()).expect("it has a help").to_string();
        assert!(help.contains(&usual), "{help}");
    }
}
