//! Which options do not go together.

use std::collections::BTreeSet;

use glam::BVec3;
use polycrystal::{Relaxation, Volumes};
use texture::SampleSymmetry;
use voronoi::Dimension;

use super::elements::SmallFeatures;
use super::inside::{InsideError, InsideOptions, InsidePattern};
use super::laws::{LawError, LawKind, LawOptions, LawProblem, LawSource};
use super::phases::{PhaseOptions, PhasesError};
use super::place::PhasePlace;
use super::sizes::SizeSource;
use super::{Config, PeriodicCut, SeedSource, Shape};

/// How far the sum of all fractions may be from 1: rounding of decimal numbers.
const SUM_TOLERANCE: f64 = 1e-9;

/// Options that do not go together. Each message names the options and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// Grains are cut at the walls of a box that does not repeat.
    #[error("--periodic-cut box needs periodic grains; give --periodic x,y,z or leave it out")]
    CutWithoutPeriods,
    /// Grains that grow to equilibrium.
    #[error("--free lets grains grow for a time, and has no equilibrium; give a time, such as --relax 0.3")]
    FreeEquilibrium,
    /// Shapes of the other dimension.
    #[error("{0}")]
    ShapeLengths(&'static str),
    /// Small grains are merged whose sizes are given.
    #[error("--min-diameter would change {what}; {remedy}")]
    MergedSizes {
        /// What would change.
        what: &'static str,
        /// What to do instead.
        remedy: &'static str,
    },
    /// Grains of several cells that stay as they are.
    #[error(
        "{what} makes grains of several cells, with sharp edges where these meet; leave --relax 0 out, or give --relax 0.02"
    )]
    SharpGrains {
        /// What makes them.
        what: &'static str,
    },
    /// Diameters change along an axis, and there are none.
    #[error("--gradient changes given sizes; give --diameters or --seeding packed as well")]
    GradientWithoutSizes,
    /// An axis that the plane has not.
    #[error("--gradient along z needs three dimensions; with --dim 2 give x or y")]
    GradientInPlane,
    /// A symmetry of a sample without orientations.
    #[error("--sample-symmetry needs a texture; give --texture as well")]
    SampleSymmetry,
    /// How sizes of elements change, without a size.
    #[error("--{0} changes sizes of elements; give --elements-per-grain or --element-size as well")]
    ElementsWithoutSize(&'static str),
    /// Triangles in the plane, without a size.
    #[error(
        "--{0} needs triangles, which have a size in 2D; give --elements-per-grain or --element-size as well"
    )]
    TrianglesWithoutSize(&'static str),
    /// A state across the plane, in space.
    #[error("--plane-state is for elements in 2D; give --dim 2 or leave it out")]
    PlaneStateInSpace,
    /// Nodes are tied where no period lies between any.
    #[error(
        "--periodic-equations ties nodes that are one period apart; give --periodic x,y,z or leave it out"
    )]
    EquationsWithoutPeriods,
    /// Cohesive elements between tetrahedra of second order.
    #[error(
        "--cohesive makes elements COH3D6 or COH2D4, and Abaqus has none of second order; leave --order 2 or --cohesive out"
    )]
    CohesiveOrder,
    /// Cohesive elements in a job for CalculiX.
    #[error(
        "--cohesive makes elements COH3D6 or COH2D4, which CalculiX does not know, and --solver-deck writes a job for it; leave one of them out"
    )]
    CohesiveDeck,
    /// A job for a domain whose sides are not alike.
    #[error(
        "--solver-deck loads a box that is periodic along all axes or none; leave --domain and --half-spaces out, and give --periodic x,y,z or no --periodic"
    )]
    DeckDomain,
    /// Phases.
    #[error(transparent)]
    Phases(#[from] PhasesError),
    /// Patterns inside grains.
    #[error(transparent)]
    Inside(#[from] InsideError),
    /// Laws of boundaries.
    #[error(transparent)]
    Law(#[from] LawError),
}

impl Config {
    /// Checks that the options go together.
    ///
    /// ```
    /// use grainsmooth::{Config, PeriodicCut};
    ///
    /// let config = Config { periodic_cut: PeriodicCut::Box, ..Config::default() };
    /// println!("{}", config.check().expect_err("nothing to cut in a box without periods"));
    /// ```
    ///
    /// # Errors
    /// The first that do not.
    pub fn check(&self) -> Result<(), ConfigError> {
        let (is_flat, is_sized) = (self.effective_relaxation() == Relaxation::Time(0.0), self.is_sized());
        if self.periodic_cut == PeriodicCut::Box && !self.periodic.any() {
            return Err(ConfigError::CutWithoutPeriods);
        }
        if self.volumes == Volumes::Free && self.effective_relaxation() == Relaxation::Equilibrium {
            return Err(ConfigError::FreeEquilibrium);
        }
        if let Some(shapes) = &self.grain_shapes {
            shapes.check(self.dimension).map_err(ConfigError::ShapeLengths)?;
        }
        let sized = [
            (
                !self.phases.is_empty(),
                "the shares of the phases",
                "cut small grains off with from=, or leave it out",
            ),
            (is_sized, "sizes that are given", "cut small ones off with from=, or give --seeding random"),
        ];
        if let Some((_, what, remedy)) =
            sized.into_iter().find(|(is_given, ..)| *is_given && self.min_diameter > 0.0)
        {
            return Err(ConfigError::MergedSizes { what, remedy });
        }
        if is_flat && self.has_grains_of_several_cells() {
            let what = if self.grain_shapes.is_some() { "--grain-shapes" } else { "place=" };
            return Err(ConfigError::SharpGrains { what });
        }
        if let Some(gradient) = &self.sizes.gradient {
            if !is_sized {
                return Err(ConfigError::GradientWithoutSizes);
            }
            if gradient.axis == 2 && self.dimension == Dimension::Two {
                return Err(ConfigError::GradientInPlane);
            }
        }
        self.check_elements()?;
        self.check_volume_mesh()?;
        self.check_phases()?;
        self.check_inside()?;
        self.check_laws()?;
        if self.texture.sample_symmetry != SampleSymmetry::default() && !self.has_texture() {
            return Err(ConfigError::SampleSymmetry);
        }
        Ok(())
    }

    fn check_elements(&self) -> Result<(), ConfigError> {
        let elements = &self.elements;
        if elements.are_asked() {
            return Ok(());
        }
        let changes = [
            ("adapt-curvature", elements.adapt_curvature.is_some()),
            ("size-growth", elements.size_growth.is_some()),
            ("small-features", elements.small_features != SmallFeatures::default()),
        ];
        match changes.into_iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => Err(ConfigError::ElementsWithoutSize(name)),
            None => Ok(()),
        }
    }

    fn check_volume_mesh(&self) -> Result<(), ConfigError> {
        let volume = &self.file.volume;
        let options = [
            ("volume-mesh", volume.volume_mesh),
            ("order", volume.order.is_some()),
            ("periodic-equations", volume.periodic_equations),
            ("cohesive", volume.cohesive),
            ("solver-deck", volume.solver_deck.is_some()),
        ];
        let first = options.into_iter().find(|(_, is_given)| *is_given);
        let is_plane = self.dimension == Dimension::Two;
        if let Some((name, _)) =
            first.filter(|_| is_plane && !self.elements.are_asked() && self.file.voxels.is_none())
        {
            return Err(ConfigError::TrianglesWithoutSize(name));
        }
        if volume.plane_state.is_some() && !is_plane {
            return Err(ConfigError::PlaneStateInSpace);
        }
        let [x, y, z] = [0, 1, 2].map(|axis| self.periodic.test(axis));
        // The third axis has no meaning in the plane.
        let periodic = BVec3::new(x, y, if is_plane { x } else { z });
        if volume.periodic_equations && !periodic.any() {
            return Err(ConfigError::EquationsWithoutPeriods);
        }
        let is_alike = self.shape == Shape::Box && periodic.any() == periodic.all();
        if volume.cohesive && volume.order == Some(2) {
            return Err(ConfigError::CohesiveOrder);
        }
        if volume.cohesive && volume.solver_deck.is_some() {
            return Err(ConfigError::CohesiveDeck);
        }
        if volume.solver_deck.is_some() && !is_alike {
            return Err(ConfigError::DeckDomain);
        }
        Ok(())
    }

    /// Checks that the phases go together, and with the options for all grains.
    ///
    /// # Errors
    /// What contradicts what.
    fn check_phases(&self) -> Result<(), PhasesError> {
        let phases = &self.phases;
        if phases.is_empty() {
            return Ok(());
        }
        let mut names = BTreeSet::new();
        if let Some(phase) = phases.iter().find(|phase| !names.insert(&phase.name)) {
            return Err(PhasesError::NameTwice { name: phase.name.clone() });
        }
        let sum: f64 = phases.iter().map(|phase| phase.fraction).sum();
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            let part = |phase: &PhaseOptions| format!("{}:{}", phase.name, digits(phase.fraction / sum));
            let remedy = phases.iter().map(part).collect::<Vec<_>>().join(" and ");
            return Err(PhasesError::Sum { sum: digits(sum), remedy });
        }
        let with = phases.iter().find(|phase| phase.diameters.is_some());
        let without = phases.iter().find(|phase| phase.diameters.is_none());
        match (with, without, &self.sizes.source) {
            (_, _, Some(SizeSource::VolumeFile(_))) => return Err(PhasesError::Volumes),
            (Some(with), Some(without), None) => {
                let [with, without] = [with, without].map(|phase| phase.name.clone());
                return Err(PhasesError::NoDiameters { with, without });
            }
            (_, None, Some(_)) => {
                return Err(PhasesError::NotUsed { option: "diameters", key: "diameters" });
            }
            _ => {}
        }
        self.check_places()?;
        if self.texture.source.is_some() && phases.iter().all(|phase| phase.texture.is_some()) {
            return Err(PhasesError::NotUsed { option: "texture", key: "texture" });
        }
        Ok(())
    }

    /// Checks that the places of phases go with each other and with other options.
    fn check_places(&self) -> Result<(), PhasesError> {
        let placed = self.phases.iter().filter_map(|phase| Some((phase, phase.place?)));
        for (phase, place) in placed {
            let is_put = place.of_inclusions().is_some();
            if place == PhasePlace::QuadruplePoints && self.dimension == Dimension::Two {
                return Err(PhasesError::PlaceInPlane { place });
            }
            let is_packed = matches!(self.seeds, SeedSource::Packed { .. });
            let options = [
                (is_put && !is_packed, "--seeding and --seeds-file, as its grains are between others"),
                (self.grain_shapes.is_some(), "--grain-shapes"),
                (self.sizes.gradient.is_some(), "--gradient"),
                (is_put && !self.inside.is_empty(), "--inside"),
                (self.phases.len() == 1, "a single phase"),
            ];
            if let Some((_, option)) = options.into_iter().find(|(is_given, _)| *is_given) {
                return Err(PhasesError::PlaceAnd { place, name: phase.name.clone(), option });
            }
        }
        let of_inclusions =
            |phase: &PhaseOptions| phase.place.filter(|place| place.of_inclusions().is_some());
        match self.phases.iter().map(of_inclusions).collect::<Option<Vec<_>>>().as_deref() {
            Some([place, ..]) => Err(PhasesError::NoMatrix { place: *place }),
            _ => Ok(()),
        }
    }

    /// Checks that what divides grains goes with the phases.
    ///
    /// # Errors
    /// What does not.
    fn check_inside(&self) -> Result<(), InsideError> {
        for (number, options) in self.inside.iter().enumerate() {
            if let Some(name) = &options.phase
                && !self.phases.iter().any(|phase| phase.name == *name)
            {
                let names: Vec<&str> = self.phases.iter().map(|phase| phase.name.as_str()).collect();
                let known = match names[..] {
                    [] => "there are none, so leave it out, or give some with --phase".to_owned(),
                    _ => format!("the phases are {}", names.join(", ")),
                };
                return Err(InsideError::UnknownPhase { name: name.clone(), known });
            }
            let is_same = |other: &InsideOptions| {
                other.phase == options.phase || other.phase.is_none() || options.phase.is_none()
            };
            if self.inside[..number].iter().any(is_same) {
                let grains = options.phase.as_ref().map(|phase| format!("grains of {phase}"));
                return Err(InsideError::Twice { grains: grains.unwrap_or_else(|| "grains".to_owned()) });
            }
            if let InsidePattern::Lamellae { normal: Some(normal), .. } = options.pattern
                && self.dimension == Dimension::Two
                && normal.z != 0.0
            {
                return Err(InsideError::OutOfPlane { pattern: options.pattern.to_string() });
            }
        }
        Ok(())
    }

    /// Checks that the laws of boundaries go with each other, the phases and the orientations.
    ///
    /// # Errors
    /// What does not.
    fn check_laws(&self) -> Result<(), LawError> {
        self.laws_of_pairs(LawKind::Tension)?;
        self.laws_of_pairs(LawKind::Mobility)?;
        if !self.mobilities.is_empty() && self.volumes == Volumes::Kept {
            return Err(LawError { kind: LawKind::Mobility, problem: LawProblem::NotFree });
        }
        Ok(())
    }

    /// Which laws of a kind the boundaries between each two phases have, as rows of a square table: of one row without phases. Nothing
    /// where no law is for them.
    ///
    /// # Errors
    /// As of [`Self::check_laws`].
    pub(crate) fn laws_of_pairs(&self, kind: LawKind) -> Result<Vec<Option<&LawSource>>, LawError> {
        self.find_laws(self.laws(kind)).map_err(|problem| LawError { kind, problem })
    }

    fn find_laws<'a>(&'a self, laws: &'a [LawOptions]) -> Result<Vec<Option<&'a LawSource>>, LawProblem> {
        let count = self.phases.len().max(1);
        let mut table: Vec<Option<&'a LawSource>> = vec![None; count * count];
        let known = || match self.phases.is_empty() {
            true => "none; give some with --phase".to_owned(),
            false => self.phases.iter().map(|phase| phase.name.as_str()).collect::<Vec<_>>().join(", "),
        };
        let mut of_all = None;
        for law in laws {
            let Some(names) = &law.phases else {
                if of_all.replace(&law.law).is_some() {
                    return Err(LawProblem::Twice { boundaries: "all boundaries".to_owned() });
                }
                continue;
            };
            let mut pair = [0; 2];
            for (place, name) in pair.iter_mut().zip(names) {
                let found = self.phases.iter().position(|phase| phase.name == *name);
                *place =
                    found.ok_or_else(|| LawProblem::UnknownPhase { name: name.clone(), known: known() })?;
            }
            let [first, second] = pair;
            if table[first * count + second].is_some() {
                return Err(LawProblem::Twice { boundaries: names.join("/") });
            }
            table[first * count + second] = Some(&law.law);
            table[second * count + first] = Some(&law.law);
        }
        for (place, law) in table.iter_mut().enumerate() {
            *law = law.or(of_all);
            let Some(source) = law else { continue };
            if matches!(source, LawSource::Number(_)) {
                continue;
            }
            let text = || LawOptions { phases: None, law: (*source).clone() }.to_string();
            if !self.has_texture() {
                return Err(LawProblem::NoOrientations { law: text() });
            }
            if self.texture.misorientations.is_some() {
                return Err(LawProblem::Swapped { law: text() });
            }
            let symmetry = |phase: usize| {
                self.phases.get(phase).and_then(|phase| phase.symmetry).unwrap_or(self.texture.symmetry)
            };
            let (first, second) = (place / count, place % count);
            if symmetry(first) != symmetry(second) {
                let [first, second] = [first, second].map(|phase| self.phases[phase].name.clone());
                return Err(LawProblem::NoDisorientation { first, second });
            }
        }
        Ok(table)
    }
}

/// A number with ten digits behind its point, without zeros at the end.
fn digits(number: f64) -> String {
    let text = format!("{number:.10}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
