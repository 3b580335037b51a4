//! Virtual polycrystals with smooth, watertight grain boundaries.
//!
//! The library behind the `grainsmooth` program: seeds, Voronoi cells, relaxation, subdivision, validation and files.
//!
//! ```
//! use grainsmooth::prelude::*;
//!
//! let config = Config { seeds: SeedSource::Random { count: 10 }, levels: 1, ..Config::default() };
//! let polycrystal = make_polycrystal(&config, &|_, _, _| ())?;
//! assert_eq!(polycrystal.network.grain_count(), 10);
//!
//! let directory = tempfile::tempdir()?;
//! polycrystal.write(&Output::check(directory.path().join("grains.vtp"))?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! What a run is asked for is a [`Config`]; what comes of it a [`Polycrystal`]. Own seeds, labelled triangles, laws of boundaries and formats: see
//! `docs/library.md`. The crates that this one is made of are handed on: [`voronoi`] makes cells, [`polycrystal`] networks of them, which [`subzero`]
//! subdivides; [`sizes`] and [`texture`] draw diameters and orientations.

mod check;
#[doc(hidden)]
pub mod cli;
mod config;
mod error;
mod estimate;
mod figures;
mod files;
mod fill;
mod formats;
mod grains;
mod input;
mod maps;
mod measure;
pub mod memory;
pub mod mesh;
mod names;
mod page;
mod picture;
mod report;
mod run;
mod seeds;
mod summary;
mod tables;
mod volume_mesh;
pub mod vtk;

pub use glam;
pub use polycrystal;
pub use sizes;
pub use subzero;
pub use texture;
pub use voronoi;

pub use check::report::{
    CheckReport, Expectation, GrainAgreement, MapAgreement, ReportedFault, SizesFound, Statistic,
};
pub use check::volume::{ElementQuality, VolumeReport};
pub use config::check::ConfigError;
pub use config::elements::{ElementOptions, SmallFeatures};
pub use config::files::{FileOptions, StlEncoding};
pub use config::gradient::GradientSource;
pub use config::inside::{InsideError, InsideOptions, InsidePattern};
pub use config::lattice::Lattice;
pub use config::laws::{LawCurve, LawError, LawKind, LawOptions, LawProblem, LawSource};
pub use config::phases::{PhaseOptions, PhasesError};
pub use config::place::PhasePlace;
pub use config::provenance::Provenance;
pub use config::shapes::{ShapeSource, ShapeSpec};
pub use config::sizes::{SizeDraw, SizeOptions, SizeSource};
#[doc(hidden)]
pub use config::spelling;
pub use config::texture::{TextureFormat, TextureOptions, TextureSource};
pub use config::volume_mesh::{PlaneState, SolverDeck, VolumeMeshOptions};
pub use config::{Config, PeriodicCut, SeedSource, Shape};
pub use error::Error;
pub use error::failed_grain::FailedGrain;
pub use error::failure::{Failure, Growth};
pub use error::map_file::MapProblem;
pub use error::mesh_file::MeshFileProblem;
pub use error::seed_file::{SeedPlace, SeedProblem};
pub use error::usage::UsageError;
pub use estimate::Estimate;
pub use figures::asked::AskedAndReached;
pub use figures::counted::Counted;
pub use figures::equivalent_diameters::EquivalentDiameters;
pub use figures::spread::Spread;
pub use figures::triangle_angles::TriangleAngles;
pub use files::output::OutputPath;
pub use files::staged_files::{StagedFiles, write_together};
pub use files::unfinished::discard_unfinished;
pub use fill::check_gmsh;
pub use formats::embedded_config::embedded_config;
pub use formats::inp::deck::DeckOutput;
pub use formats::label_grid::LabelGrid;
pub use formats::output::{Output, OutputDirectory};
pub use formats::output_format::{OutputFormat, ToWrite};
pub use formats::series::{Series, SeriesOutput, write_collection};
pub use grains::attributes::{GrainAttributes, MeasuredAttributes};
pub use grains::boundary_law::{BoundaryLaw, LawReached, TensionsReached};
pub use grains::cells::GrainCells;
pub use grains::inner::{Divided, Parents};
pub use grains::phases::{GrainPhases, PhaseShare};
pub use grains::shapes::{GrainShapes, ShapesReached};
pub use grains::sizes::{GrainSizes, SizesFit, SizesReached};
pub use grains::texture::{ComponentShare, GrainTexture, HistogramFit};
pub use input::labelled_file::{FileElements, LabelledFile};
pub use input::seed_file::{FileDomain, FileSeed, FileSeeds, read_file_domain, read_seed_file};
pub use input::tess::{
    Oriented, Tess, TessCopy, TessDomain, TessFace, TessPeriodicity, TessProblem, TessSeed, read_tess,
};
pub use input::texture_file::{OrientationList, read_disorientation_file, read_texture_file};
pub use input::volume_file::VolumeFile;
pub use maps::ebsd_options::{AxisAngle, EbsdOptions};
pub use maps::label_map::{LabelMap, MeasuredCrystals, MeasuredMap, PointCounts};
pub use maps::map_slice::MapSlice;
pub use maps::network_options::MapNetworkOptions;
pub use maps::options::{Axes, Crop, LabelParts, MapOptions};
pub use maps::orientations::OrientationMap;
pub use maps::read::read_map;
pub use measure::report::{FittedDistribution, MeasuredPhase, MeasuredTexture, SampleReport};
pub use measure::sample::{MeasuredGrain, MeasuredSample};
pub use mesh::{
    BezierFile, Connectivity, Level, Limits, Scheme, bezier_json, levels_json, limits, mesh_json,
    read_bezier, subdivide,
};
pub use names::Names;
pub use page::{EditContent, PageDocument, PageLinks, PageServer, PageStop};
pub use picture::{Coloring, Picture, Png, Scene, SceneColors, SceneNumbers, ScenePicture, Shading, Slice};
pub use report::{Html, SceneReport};
pub use run::elements_reached::{ElementsReached, LineMerged, TrianglesNarrow};
pub use run::fitted_cells::CellFit;
pub use run::listed::{ListedCells, list_cells};
pub use run::measured::{MapRun, smooth_map};
pub use run::origin::{Measurement, Origin, SmoothedMap, Synthesis};
pub use run::pipeline::{check_expected_size, make_polycrystal, smooth, smooth_watched};
pub use run::polycrystal::Polycrystal;
pub use run::regularization::{Reconnected, Regularization};
pub use run::stage::{Progress, Stage};
pub use run::tessellated::{Tessellated, tessellate};
pub use run::topology::Topology;
pub use seeds::lattice::LatticeFit;
pub use seeds::poisson_disc::poisson_disc_seeds;
pub use seeds::random::random_seeds;
pub use summary::record::SummaryRecord;
pub use summary::{CellsSummary, ListedSummary, Summary};
pub use tables::cell_table::{CellTable, TableFormat};
pub use tables::statistics::{NetworkStatistics, StatisticsOutput};
pub use volume_mesh::filled_plane::{FilledPlane, PlaneQuality};
pub use volume_mesh::quality::{PoorTetrahedron, ShapeHistogram, TetrahedronQuality};
pub use volume_mesh::{CurvedEdges, VolumeMesh};

/// What most programs need.
pub mod prelude {
    pub use glam::DVec3;
    pub use polycrystal::Relaxation;
    pub use voronoi::Dimension;

    pub use crate::{Config, Error, Output, OutputFormat, Polycrystal, SeedSource, make_polycrystal};
}

/// The examples of the page for users of the library.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/library.md")]
struct LibraryPage;
