//! What a run says about its result, for programs.

use std::collections::BTreeMap;
use std::path::PathBuf;

use polycrystal::{Boundary, HerringResidual};
use serde::Serialize;

use crate::figures::spread::Spread;
use crate::figures::triangle_angles::TriangleAngles;
use crate::{
    AskedAndReached, CellFit, ComponentShare, CurvedEdges, Divided, ElementsReached, EquivalentDiameters,
    FilledPlane, HistogramFit, LawReached, PhaseShare, PlaneQuality, Polycrystal, Reconnected, ShapesReached,
    SizesFit, SizesReached, TensionsReached, TetrahedronQuality, Topology, VolumeMesh,
};

/// The numbers of [`Summary`](crate::Summary), to be written as JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SummaryRecord {
    version: &'static str,
    command_line: String,
    settings: BTreeMap<String, toml::Value>,
    dimension: u8,
    /// Those that are left.
    grains: usize,
    /// Those that shrank to nothing, the first one first.
    vanished: Vec<VanishedGrain>,
    /// Seeds without a cell, and those whose cells were merged into what surrounds them.
    dropped_seeds: Vec<u32>,
    merged_seeds: Vec<u32>,
    boundaries: Boundaries,
    equivalent_diameter: EquivalentDiameters,
    triple_lines: usize,
    quadruple_points: usize,
    topology: Topology,
    /// Every figure that was asked for.
    asked_and_reached: Vec<AskedAndReached>,
    /// The sizes asked for and reached.
    sizes: Option<SizesReached>,
    /// The shapes asked for and reached.
    shapes: Option<ShapesReached>,
    /// None where no phases are asked for.
    phases: Vec<PhaseRecord>,
    /// What divides grains; none where nothing does.
    inside: Vec<Divided>,
    /// Of all grains; of phases each has its own.
    texture: Option<TextureRecord>,
    regularization: Option<&'static str>,
    /// Where cells were fitted to a map.
    fitted_cells: Option<CellFit>,
    regularization_fell_back: bool,
    collapsed_edges: usize,
    collapsed_boundaries: usize,
    topology_changes: Option<TopologyChanges>,
    equilibrium: Option<Equilibrium>,
    /// What was tried before and why it was given up, in order.
    attempts: Vec<Attempt>,
    residual: Option<Residual>,
    /// Where laws of them are asked for.
    tensions: Option<TensionsReached>,
    mobilities: Option<LawReached>,
    /// By what coordinates were multiplied in the end; angles and residual are those before.
    stretch: Option<[f64; 3]>,
    /// How far all grains were moved before a periodic box was cut.
    moved_for_cut: [f64; 3],
    points: usize,
    /// Triangles, in the plane segments.
    elements: usize,
    level: u32,
    /// Where elements of a size are asked for: the level is then that of the surface that they lie on.
    element_size: Option<ElementsReached>,
    /// Of grains that are filled.
    tetrahedra: Option<TetrahedronQuality>,
    /// How many points slid along boundaries for them.
    slid_points: Option<usize>,
    /// Of grains that are filled in the plane.
    filled: Option<PlaneQuality>,
    /// Of elements of second order on the smooth surface.
    curved_edges: Option<CurvedEdges>,
    /// In degrees.
    angles_before: Option<Spread>,
    angles_after: Option<Spread>,
    /// The same unit; none in the plane.
    triangle_angles: Option<TriangleAngles>,
    largest_relative_volume_error: f64,
    /// Pairs of elements that fold back on each other, as in grains of a map that are one voxel thick.
    folds: usize,
    /// Of a map: those that got another label, because a grain touched itself there.
    relabelled_voxels: usize,
    seconds: BTreeMap<&'static str, f64>,
    written: Vec<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Boundaries {
    between_grains: usize,
    on_walls: usize,
    /// Of those between grains, how many stand in the file twice, a period apart.
    twice: usize,
}

/// The orientations of the grains.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct TextureRecord {
    crystal_symmetry: &'static str,
    /// Shares of the volume.
    components: Vec<ComponentShare>,
    index: Option<f64>,
    /// How near the disorientations of neighbours came to a histogram.
    misorientations: Option<HistogramFit>,
}

/// A phase, its share of the volume, and what of its own was asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct PhaseRecord {
    #[serde(flatten)]
    share: PhaseShare,
    /// Where phases have diameters of their own.
    sizes: Option<SizesFit>,
    texture: Option<TextureRecord>,
}

/// How relaxation changed the topology, where it may. In the plane, lines are points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct TopologyChanges {
    lines_to_boundaries: usize,
    boundaries_to_lines: usize,
    neighbor_switches: usize,
}

/// How near relaxation came to equilibrium, where that was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Equilibrium {
    /// Lines (in the plane: points) that are not at rest: short, of more than three boundaries, or with a large residual.
    flagged_lines: usize,
    /// Of the lines that are not flagged.
    largest_residual: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Attempt {
    tried: String,
    said: String,
}

/// A grain that shrank to nothing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct VanishedGrain {
    /// Its number in the files.
    grain: i32,
    /// In units of the mean grain size squared at the start.
    time: f64,
}

/// Of Herring's condition at triple lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Residual {
    rms: f64,
    largest: f64,
}

/// What became of a texture, if grains have orientations.
fn texture_record(polycrystal: &Polycrystal, number: usize) -> Option<TextureRecord> {
    let texture = polycrystal.grains().texture.as_ref()?;
    let volumes = polycrystal.volumes_of_cells();
    Some(TextureRecord {
        crystal_symmetry: texture.members(number).0.rotation_group(),
        components: texture.shares(number, &volumes),
        index: texture.index(number, &volumes),
        misorientations: texture.fit(),
    })
}

fn phase_records(polycrystal: &Polycrystal) -> Vec<PhaseRecord> {
    let Some(phases) = &polycrystal.grains().phases else { return Vec::new() };
    let reached = polycrystal.sizes_reached();
    let shares = phases.shares(&polycrystal.volumes_of_cells(), polycrystal.network.cell_volumes());
    let record = |(number, share): (usize, PhaseShare)| PhaseRecord {
        share,
        sizes: reached.as_ref().and_then(|reached| reached.of_phases().get(number).cloned()),
        texture: texture_record(polycrystal, number),
    };
    shares.into_iter().enumerate().map(record).collect()
}

impl SummaryRecord {
    /// The numbers of a result and the files that it was written to.
    pub fn new(polycrystal: &Polycrystal, written: Vec<PathBuf>) -> Self {
        let (network, provenance) = (&polycrystal.network, polycrystal.provenance());
        let (synthesis, measurement) = (polycrystal.synthesis(), polycrystal.measurement());
        let map = measurement.and_then(|measurement| measurement.map.as_ref());
        let reconnected = synthesis.and_then(|made| made.reconnected);
        let finest = network.finest();
        let junctions = network.junction_counts();
        let count = |holds: fn(&Boundary) -> bool| network.boundaries().iter().filter(|b| holds(b)).count();
        let twice = count(|boundary| boundary.twin.is_some()) / 2;
        let seconds = polycrystal.times.iter().map(|(stage, time)| (stage.name(), time.as_secs_f64()));
        Self {
            version: env!("CARGO_PKG_VERSION"),
            command_line: provenance.command_line().into_owned(),
            settings: provenance.settings().into_iter().collect(),
            dimension: polycrystal.dimension().axes(),
            grains: network.grains_left(),
            vanished: synthesis
                .iter()
                .flat_map(|made| &made.vanished)
                .map(|gone| VanishedGrain {
                    grain: polycrystal.file().names.number(gone.grain),
                    time: gone.time,
                })
                .collect(),
            dropped_seeds: synthesis.map_or_else(Vec::new, |made| made.cells.dropped_seeds.clone()),
            merged_seeds: synthesis.map_or_else(Vec::new, |made| made.cells.merged_seeds.clone()),
            boundaries: Boundaries {
                between_grains: count(Boundary::is_interior) + twice,
                on_walls: count(|boundary| boundary.wall.is_some()),
                twice,
            },
            equivalent_diameter: polycrystal.diameter_statistics(),
            triple_lines: junctions.triple_lines,
            quadruple_points: junctions.quadruple_points,
            topology: polycrystal.topology.clone(),
            asked_and_reached: polycrystal.asked_and_reached(),
            sizes: polycrystal.sizes_reached(),
            shapes: polycrystal.shapes_reached(),
            texture: polycrystal.grains().phases.is_none().then(|| texture_record(polycrystal, 0)).flatten(),
            phases: phase_records(polycrystal),
            inside: polycrystal
                .grains()
                .parents
                .as_ref()
                .map_or_else(Vec::new, |parents| parents.patterns().to_vec()),
            regularization: synthesis.map(|made| made.regularization.name()),
            fitted_cells: map.and_then(|map| map.fit),
            regularization_fell_back: synthesis
                .is_some_and(|made| made.regularization.fell_back(&made.config)),
            collapsed_edges: synthesis.map_or(0, |made| made.collapsed.edges),
            collapsed_boundaries: synthesis.map_or(0, |made| made.collapsed.faces),
            topology_changes: reconnected.map(|Reconnected { reconnections, .. }| TopologyChanges {
                lines_to_boundaries: reconnections.lines_to_boundaries,
                boundaries_to_lines: reconnections.boundaries_to_lines,
                neighbor_switches: reconnections.neighbor_switches,
            }),
            equilibrium: reconnected.and_then(|reconnected| reconnected.balance).map(|balance| Equilibrium {
                flagged_lines: balance.flagged_lines,
                largest_residual: balance.largest_residual,
            }),
            attempts: polycrystal
                .attempts
                .iter()
                .map(|attempt| Attempt { tried: attempt.tried.clone(), said: attempt.said.clone() })
                .collect(),
            residual: polycrystal.residual.map(|HerringResidual { rms, largest }| Residual { rms, largest }),
            tensions: polycrystal.tensions.clone(),
            mobilities: polycrystal.mobilities.clone(),
            stretch: polycrystal.is_stretched().then(|| polycrystal.stretch().to_array()),
            moved_for_cut: polycrystal.moved_for_cut.to_array(),
            points: finest.vertex_count(),
            elements: finest.element_count(),
            level: polycrystal.level(),
            element_size: polycrystal.elements.clone(),
            tetrahedra: polycrystal.volume_mesh.as_ref().and_then(VolumeMesh::quality),
            slid_points: polycrystal.volume_mesh.as_ref().map(|mesh| mesh.slid),
            filled: polycrystal.plane_mesh.as_ref().and_then(FilledPlane::quality),
            curved_edges: polycrystal.curved_edges(),
            angles_before: synthesis.and_then(|made| made.angles_before).map(Spread::from),
            angles_after: polycrystal.validation.angles.map(Spread::from),
            triangle_angles: polycrystal.validation.triangles.map(TriangleAngles::from),
            largest_relative_volume_error: polycrystal.validation.largest_volume_error,
            folds: polycrystal.validation.faults.0.len(),
            relabelled_voxels: map.map_or(0, |map| map.relabelled),
            seconds: seconds.collect(),
            written,
        }
    }
}
