//! What a run says about its result.

pub(crate) mod asked;
mod measured;
pub(crate) mod record;

use std::fmt;
use std::time::Duration;

use glam::DVec3;
use polycrystal::{
    AngleStatistics, Balance, Boundary, Collapsed, HerringResidual, Reconnections, Relaxation, Vanished,
    Volumes, measure_network,
};
use voronoi::{Dimension, Domain};

use crate::figures::counted::Counted;
use crate::figures::significant::significant;
use crate::grains::texture::TextureLine;
use crate::{
    Config, EquivalentDiameters, FilledPlane, LineMerged, ListedCells, Polycrystal, Reconnected,
    Regularization, SeedSource, ShapesReached, SizesReached, Stage, Synthesis, Tessellated, TriangleAngles,
    VolumeMesh,
};
use measured::{write_crystals, write_map};

/// A polycrystal in a few lines of text: counts, angles, volumes, validation, times.
pub struct Summary<'a>(pub &'a Polycrystal);

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Summary(polycrystal) = self;
        let network = &polycrystal.network;
        let finest = network.finest();
        let (points, elements) = (finest.vertex_count(), finest.element_count());
        let levels = polycrystal.level();
        let synthesis = polycrystal.synthesis();
        writeln!(out, "grains      {} in {}", network.grains_left(), network.domain())?;
        if let Some(Synthesis { vanished, .. }) = synthesis
            && let Some(Vanished { time, .. }) = vanished.last()
        {
            let (gone, all) = (vanished.len(), network.grain_count());
            writeln!(
                out,
                "vanished    {gone} of {all} grains, the last at the time {}",
                significant(*time, 3)
            )?;
        }
        writeln!(out, "diameters   {}", polycrystal.diameter_statistics())?;
        if let Some(Synthesis { config, cells, .. }) = synthesis {
            write_seeds(out, config, cells)?;
            if let Some(reached) = polycrystal.sizes_reached() {
                write!(out, "{reached}")?;
                write_phases(out, cells, network.cell_volumes(), &reached)?;
            }
            write_inside(out, cells)?;
            if let Some(reached) = polycrystal.shapes_reached() {
                write!(out, "{reached}")?;
            }
            write_texture(out, cells)?;
        }
        if let Some(measurement) = polycrystal.measurement() {
            if let Some(map) = &measurement.map {
                write_map(out, map)?;
            }
            write_crystals(out, measurement)?;
        }
        let count = |holds: fn(&Boundary) -> bool| network.boundaries().iter().filter(|b| holds(b)).count();
        let through_walls = count(|boundary| boundary.twin.is_some()) / 2;
        let between_grains = count(Boundary::is_interior) + through_walls;
        let on_walls = count(|boundary| boundary.wall.is_some());
        write!(out, "boundaries  {between_grains} between grains, {on_walls} on the walls")?;
        if network.domain().is_periodic() {
            write!(out, ", {through_walls} of the first twice, one period apart")?;
        }
        writeln!(out)?;
        if let Some(synthesis) = synthesis {
            write_regularization(out, synthesis)?;
        }
        let (places, element, measure, size) = match network.domain().dimension() {
            Dimension::Two => ("triple points", "segment", "areas", "length"),
            Dimension::Three => ("triple lines", "triangle", "volumes", "area"),
        };
        writeln!(out, "junctions   {}", polycrystal.topology)?;
        match &polycrystal.elements {
            None if synthesis.is_none() => {
                writeln!(out, "mesh        {points} points, {elements} {element}s")?
            }
            None => writeln!(out, "mesh        {points} points, {elements} {element}s at level {levels}")?,
            Some(reached) => {
                writeln!(out, "mesh        {points} points, {elements} {element}s; {reached}")?;
                write_merged_lines(out, &reached.merged_lines)?;
            }
        }
        if let Some(quality) = polycrystal.volume_mesh.as_ref().and_then(VolumeMesh::quality) {
            writeln!(out, "tetrahedra  {quality}")?;
        }
        if let Some(slid @ 1..) = polycrystal.volume_mesh.as_ref().map(|mesh| mesh.slid) {
            writeln!(
                out,
                "slid        {slid} points along boundaries, to where tetrahedra beside them are better"
            )?;
        }
        if let Some(quality) = polycrystal.plane_mesh.as_ref().and_then(FilledPlane::quality) {
            writeln!(out, "filled      {quality}")?;
        }
        if let Some(curved) = polycrystal.curved_edges() {
            writeln!(out, "curved      {curved}")?;
        }
        if polycrystal.moved_for_cut != DVec3::ZERO {
            let DVec3 { x, y, z } = polycrystal.moved_for_cut;
            writeln!(
                out,
                "cut         all grains moved by ({x:.4}, {y:.4}, {z:.4}) before, so that walls meet boundaries steeply"
            )?;
        }
        if let Some(stretched) = synthesis.and_then(|made| StretchLine::new(&made.config)) {
            // Triangles of a size are made of stretched boundaries.
            let before = match polycrystal.elements {
                None => "angles, residual and triangles",
                Some(_) => "angles and residual",
            };
            writeln!(out, "{stretched}; {before} are from before")?;
        }
        if let Some(Synthesis { angles_before, .. }) = synthesis {
            write_angles(out, *angles_before, polycrystal.validation.angles)?;
        } else if let Some(angles) = polycrystal.validation.angles {
            writeln!(out, "angles      {}", Angle(angles))?;
        }
        if let Some(tensions) = &polycrystal.tensions {
            write!(out, "{tensions}")?;
        }
        if let Some(mobilities) = &polycrystal.mobilities {
            writeln!(out, "mobilities  {mobilities}")?;
        }
        if let Some(HerringResidual { rms, largest }) = polycrystal.residual {
            writeln!(
                out,
                "residual    {rms:.4} rms of the tensions at {places}, largest {largest:.4}; 0 at rest"
            )?;
        }
        if let Some(quality) = polycrystal.validation.triangles {
            writeln!(out, "triangles   {}", TriangleAngles::from(quality))?;
        }
        if let Some(synthesis) = synthesis {
            write_relaxation(out, polycrystal, synthesis)?;
        }
        for attempt in &polycrystal.attempts {
            writeln!(out, "given up    {attempt}")?;
        }
        let validation = &polycrystal.validation;
        let error = validation.largest_volume_error;
        writeln!(out, "{measure:12}largest relative error of a grain {error:.1e}")?;
        // A good network has no other faults.
        let folds = validation.faults.0.len();
        let turned = if folds == 0 { "crossed or folded" } else { "crossed" };
        write!(
            out,
            "validation  good: every grain closed, nothing {turned}, no point twice, no {element} without {size}"
        )?;
        match folds {
            0 => writeln!(out)?,
            1 => writeln!(out, "; 1 pair of {element}s folded, as where grains are thin")?,
            _ => writeln!(out, "; {folds} pairs of {element}s folded, as where grains are thin")?,
        }
        write!(out, "time       ")?;
        for (stage, time) in &polycrystal.times {
            write!(out, " {} {},", stage.name(), Seconds(*time))?;
        }
        let total: Duration = polycrystal.times.iter().map(|(_, time)| *time).sum();
        write!(out, " in all {}", Seconds(total))
    }
}

/// Most lines that became points which the summary names one by one; all are in the JSON summary.
const NAMED: usize = 5;

/// Says which lines became points.
fn write_merged_lines(out: &mut fmt::Formatter<'_>, merged: &[LineMerged]) -> fmt::Result {
    if merged.is_empty() {
        return Ok(());
    }
    match merged.len() {
        1 => writeln!(out, "merged      1 short line became a point:")?,
        count => writeln!(out, "merged      {count} short lines became points, the shortest first:")?,
    }
    merged.iter().take(NAMED).try_for_each(|line| writeln!(out, "            {line}"))?;
    match merged.len().saturating_sub(NAMED) {
        0 => Ok(()),
        more => writeln!(out, "            and {more} more, named by --json-summary"),
    }
}

/// What became of short edges of the cells.
fn write_regularization(out: &mut fmt::Formatter<'_>, synthesis: &Synthesis) -> fmt::Result {
    let Collapsed { edges, faces } = synthesis.collapsed;
    if edges > 0 {
        let [edges, faces] =
            [(edges, "short edge"), (faces, "small boundary")].map(|(count, of)| Counted(count, of));
        writeln!(out, "collapsed   {edges} of cells, with them {faces}")?;
    }
    if synthesis.regularization.fell_back(&synthesis.config) {
        let kept = match synthesis.regularization {
            Regularization::None => "not at all",
            _ => "less than usual, short edges only",
        };
        writeln!(out, "regularized {kept}: with more removed, boundaries folded or crossed in relaxation")?;
    }
    Ok(())
}

/// Angles between boundaries. In lattices four or more grains meet, until they relax.
fn write_angles(
    out: &mut fmt::Formatter<'_>,
    before: Option<AngleStatistics>,
    after: Option<AngleStatistics>,
) -> fmt::Result {
    match (before, after) {
        (Some(before), Some(after)) => {
            writeln!(out, "angles      {} before relaxation, {} after", Angle(before), Angle(after))
        }
        (None, Some(after)) => writeln!(
            out,
            "angles      {} after relaxation; before, no line had exactly three grains",
            Angle(after)
        ),
        (Some(before), None) => writeln!(
            out,
            "angles      {} before relaxation; after, no line has exactly three grains",
            Angle(before)
        ),
        (None, None) => Ok(()),
    }
}

/// How the topology changed, and what relaxation left alone.
fn write_relaxation(
    out: &mut fmt::Formatter<'_>,
    polycrystal: &Polycrystal,
    Synthesis { config, relaxed, reconnected, .. }: &Synthesis,
) -> fmt::Result {
    if let Some(Reconnected { reconnections, balance }) = reconnected {
        write_topology(out, polycrystal.dimension(), *reconnections, balance.as_ref())?;
    } else if config.lets_topology_change() {
        let without = polycrystal.tensions.as_ref().map_or(0, |tensions| tensions.without_equilibrium.len());
        let cause = if without == 0 { "" } else { ", because lines without equilibrium never come to rest" };
        writeln!(
            out,
            "topology    kept: letting grains switch neighbours led to no valid network{cause}; angles are not in equilibrium where they would switch"
        )?;
    } else if config.effective_relaxation() == Relaxation::Equilibrium {
        writeln!(
            out,
            "topology    kept: angles are not in equilibrium where grains would switch neighbours"
        )?;
    }
    if !relaxed.given_up.is_empty() {
        writeln!(out, "relaxation  only of points up to level {}", relaxed.level)?;
    }
    Ok(())
}

/// A tessellation alone in a few lines of text.
pub struct CellsSummary<'a>(pub &'a Config, pub &'a Tessellated);

impl fmt::Display for CellsSummary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(config, cells) = self;
        let measures = cells.tessellation.cell_measures();
        write_cells(out, cells.tessellation.domain(), measures.iter().map(|cell| cell.volume))?;
        if let Some(stretched) = StretchLine::new(config) {
            writeln!(out, "{stretched}")?;
        }
        write_seeds(out, config, cells)?;
        if let Some(sizes) = &cells.sizes {
            let volumes = cells.volumes();
            let reached = sizes.reached(&cells.grains.by_parents(&volumes), None);
            write!(out, "{reached}")?;
            write_phases(out, cells, &volumes, &reached)?;
        }
        write_inside(out, cells)?;
        write_texture(out, cells)
    }
}

/// Cells without their complex in a few lines of text.
pub struct ListedSummary<'a>(pub &'a Config, pub &'a ListedCells);

impl fmt::Display for ListedSummary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(config, ListedCells { domain, cells, passed_over, .. }) = self;
        write_cells(out, domain, cells.measures().map(|cell| cell.volume))?;
        write_lattice(out, config, domain, cells.len())?;
        write_passed_over(out, config, *passed_over)
    }
}

/// How many cells there are, and their sizes.
fn write_cells(
    out: &mut fmt::Formatter<'_>,
    domain: &Domain,
    volumes: impl ExactSizeIterator<Item = f64>,
) -> fmt::Result {
    writeln!(out, "cells       {} in {domain}", volumes.len())?;
    let dimension = domain.dimension();
    let diameters: Vec<f64> = volumes.map(|volume| dimension.ball_diameter(volume)).collect();
    writeln!(out, "diameters   {}", EquivalentDiameters::new(dimension, &diameters))
}

/// The lattice that the seeds stand on.
fn write_lattice(
    out: &mut fmt::Formatter<'_>,
    config: &Config,
    domain: &Domain,
    seed_count: usize,
) -> fmt::Result {
    config.lattice_report(domain, seed_count).map_or(Ok(()), |lattice| writeln!(out, "lattice     {lattice}"))
}

/// What of the file of the seeds has no place.
fn write_passed_over(
    out: &mut fmt::Formatter<'_>,
    config: &Config,
    passed_over: Option<&str>,
) -> fmt::Result {
    match (passed_over, &config.seeds) {
        (Some(passed_over), SeedSource::File(path)) => {
            writeln!(out, "passed over {passed_over} in {}", path.display())
        }
        _ => Ok(()),
    }
}

/// By what grains are stretched.
struct StretchLine(DVec3, Dimension);

impl StretchLine {
    fn new(config: &Config) -> Option<Self> {
        let stretch = config.stretch();
        (stretch != DVec3::ONE).then_some(Self(stretch, config.dimension))
    }
}

impl fmt::Display for StretchLine {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(DVec3 { x, y, z }, dimension) = self;
        write!(out, "stretched   by {x:.4}, {y:.4}")?;
        if *dimension == Dimension::Three {
            write!(out, ", {z:.4} along x, y, z")
        } else {
            write!(out, " along x, y")
        }
    }
}

/// What divides grains.
fn write_inside(out: &mut fmt::Formatter<'_>, cells: &Tessellated) -> fmt::Result {
    let patterns = cells.grains.parents.iter().flat_map(|parents| parents.patterns());
    patterns.into_iter().try_for_each(|divided| writeln!(out, "inside      {divided}"))
}

/// What the orientations of the grains are.
fn write_texture(out: &mut fmt::Formatter<'_>, cells: &Tessellated) -> fmt::Result {
    let Some(texture) = &cells.grains.texture else { return Ok(()) };
    let volumes = cells.volumes();
    for number in 0..texture.texture_count() {
        let of_phase = cells.grains.phases.as_ref().and_then(|phases| phases.names().nth(number));
        let of_phase = of_phase.map_or_else(String::new, |name| format!("{name}: "));
        writeln!(out, "texture     {of_phase}{}", TextureLine { texture, number, volumes: &volumes })?;
    }
    Ok(())
}

/// What of the volume each phase has, for grains of some volumes, and how near its diameters came to what was asked for.
fn write_phases(
    out: &mut fmt::Formatter<'_>,
    cells: &Tessellated,
    volumes: &[f64],
    reached: &SizesReached,
) -> fmt::Result {
    let Some(phases) = &cells.grains.phases else { return Ok(()) };
    for (number, share) in phases.shares(&cells.volumes(), volumes).iter().enumerate() {
        writeln!(out, "phase {:<6}{share}", share.number)?;
        if let Some(fit) = reached.of_phases().get(number) {
            writeln!(out, "            {fit}")?;
        }
    }
    Ok(())
}

/// What became of the seeds: a lattice, and those that are left out.
fn write_seeds(out: &mut fmt::Formatter<'_>, config: &Config, cells: &Tessellated) -> fmt::Result {
    let seeds = cells.grain_count() + cells.dropped_seeds.len() + cells.merged_seeds.len();
    write_lattice(out, config, cells.tessellation.domain(), seeds)?;
    write_passed_over(out, config, cells.passed_over)?;
    if !cells.dropped_seeds.is_empty() {
        writeln!(out, "dropped     {} that others outweigh", Seeds(&cells.dropped_seeds))?;
    }
    if !cells.merged_seeds.is_empty() {
        let share = config.min_diameter;
        writeln!(out, "merged      {} with cells below {share} mean diameters", Seeds(&cells.merged_seeds))?;
    }
    Ok(())
}

/// Seeds by number, the first ten of many.
struct Seeds<'a>(&'a [u32]);

impl fmt::Display for Seeds<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMED: usize = 10;
        let Self(seeds) = self;
        let names: Vec<String> = seeds.iter().take(NAMED).map(u32::to_string).collect();
        let noun = if seeds.len() == 1 { "seed" } else { "seeds" };
        write!(out, "{} {noun} (SeedId {}", seeds.len(), names.join(", "))?;
        match seeds.len().saturating_sub(NAMED) {
            0 => write!(out, ")"),
            more => write!(out, " and {more} more)"),
        }
    }
}

/// How relaxation to equilibrium changed the topology, and how near it came.
fn write_topology(
    out: &mut fmt::Formatter<'_>,
    dimension: Dimension,
    Reconnections { lines_to_boundaries, boundaries_to_lines, neighbor_switches }: Reconnections,
    balance: Option<&Balance>,
) -> fmt::Result {
    let flags = match dimension {
        Dimension::Two => {
            writeln!(
                out,
                "topology    {neighbor_switches} neighbor switches (T1), {lines_to_boundaries} points split, {boundaries_to_lines} edges collapsed"
            )?;
            "points flagged (of more than three grains, or not at rest)"
        }
        Dimension::Three => {
            writeln!(
                out,
                "topology    {lines_to_boundaries} edge-to-triangle flips, {boundaries_to_lines} triangle-to-edge flips, {neighbor_switches} neighbor switches"
            )?;
            "triple lines flagged (short, of four boundaries, or not at rest)"
        }
    };
    match balance {
        Some(Balance { flagged_lines, largest_residual }) => writeln!(
            out,
            "equilibrium {flagged_lines} {flags}; largest residual of others {largest_residual:.4}"
        ),
        None => Ok(()),
    }
}

impl Polycrystal {
    /// How near the grains came to the sizes that were asked for, where some were.
    pub(crate) fn sizes_reached(&self) -> Option<SizesReached> {
        let Synthesis { config, cells, .. } = self.synthesis()?;
        let sizes = cells.sizes.as_ref()?;
        let found = self.validation.grain_volumes.iter();
        let grains: Vec<f64> = found.map(|(_, volume)| *volume).collect();
        let is_kept = config.volumes == Volumes::Kept;
        let (cells, grains) = (cells.volumes(), self.grains().by_parents(&grains));
        Some(sizes.reached(&self.grains().by_parents(&cells), is_kept.then_some(&grains[..])))
    }

    /// How near the grains came to the shapes that were asked for, where some were.
    pub(crate) fn shapes_reached(&self) -> Option<ShapesReached> {
        let shapes = self.synthesis()?.cells.shapes.as_ref()?;
        Some(shapes.reached(Some(&measure_network(&self.network, &self.points))))
    }

    /// How large the grains are that are left. Their volumes are those of their cells unless grains grow.
    pub fn diameter_statistics(&self) -> EquivalentDiameters {
        let all = self.equivalent_diameters().into_iter();
        let left: Vec<f64> = all.filter(|diameter| *diameter > 0.0).collect();
        EquivalentDiameters::new(self.dimension(), &left)
    }

    /// Adds the time that a stage took after the computation, such as writing.
    pub fn add_time(&mut self, stage: Stage, time: Duration) {
        match self.times.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, taken)) => *taken += time,
            None => self.times.push((stage, time)),
        }
    }
}

struct Angle(AngleStatistics);

impl fmt::Display for Angle {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:.2} +- {:.2} degrees", self.0.mean, self.0.standard_deviation)
    }
}

struct Seconds(Duration);

impl fmt::Display for Seconds {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:.3} s", self.0.as_secs_f64())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::{Origin, SeedSource, SummaryRecord, make_polycrystal};

    fn synthesis(polycrystal: &mut Polycrystal) -> &mut Synthesis {
        match &mut polycrystal.origin {
            Origin::Synthetic(synthesis) => synthesis,
            Origin::Measured(_) => panic!("made from cells"),
        }
    }

    #[test]
    fn weaker_regularization_is_told() {
        let config = Config { seeds: SeedSource::Random { count: 4 }, levels: 0, ..Config::default() };
        let mut polycrystal = make_polycrystal(&config, &|_, _, _| ()).unwrap();
        for (regularization, name, line) in [
            (Regularization::ByEnergy, "by_energy", None),
            (Regularization::Predicted, "full", None),
            (
                Regularization::Plain,
                "short_edges",
                Some("less than usual, short edges only: with more removed, "),
            ),
            (Regularization::None, "none", Some("not at all: with more removed, ")),
        ] {
            synthesis(&mut polycrystal).regularization = regularization;
            let said = Summary(&polycrystal).to_string();
            let told = said.lines().find_map(|line| line.strip_prefix("regularized "));
            assert_eq!(told.is_some(), line.is_some(), "{said}");
            assert!(told.unwrap_or_default().starts_with(line.unwrap_or_default()), "{said}");
            let record = serde_json::to_value(SummaryRecord::new(&polycrystal, Vec::new())).unwrap();
            assert_eq!(record["regularization"], name);
            assert_eq!(record["regularization_fell_back"], line.is_some());
        }
        synthesis(&mut polycrystal).config.regularize = Some(0.0);
        assert!(!Summary(&polycrystal).to_string().contains("regularized"), "as asked for");
    }
}
