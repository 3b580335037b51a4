//! Virtual polycrystals with smooth, watertight grain boundaries.
//!
//! The library behind the `grainsmooth` program: seeds, Voronoi cells, relaxation, subdivision, validation and files.
//!
//! ```
//! use grainsmooth::{Config, Output, SeedSource, make_polycrystal};
//!
//! let config = Config { seeds: SeedSource::Random { count: 10 }, levels: 1, ..Config::default() };
//! let polycrystal = make_polycrystal(&config, &|_, _, _| ())?;
//! assert_eq!(polycrystal.network.grain_count(), 10);
//!
//! let directory = tempfile::tempdir()?;
//! polycrystal.write(&Output::check(directory.path().join("grains.vtp"))?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod asked;
mod boundary_law;
mod cell_table;
mod check_report;
mod config;
mod direction_frame;
mod domain_file;
mod embedded_config;
mod equivalent_diameters;
mod error;
mod estimate;
mod failed_grain;
mod failure;
mod formats;
mod gradient;
mod grain_cells;
mod grain_phases;
mod grain_shapes;
mod grain_sizes;
mod grain_texture;
mod inner_grains;
mod inside_options;
mod labelled_file;
mod lattice;
mod law_options;
mod measured_arrays;
mod measured_sample;
pub mod memory;
pub mod mesh;
mod network_file;
mod output;
mod phase_options;
mod phase_place;
mod picture;
mod pipeline;
mod placed_grains;
mod poisson_disc;
mod report;
mod sample_report;
mod seed_file;
mod seeding;
mod series;
mod settings;
mod shape_options;
mod significant;
mod size_file;
mod size_options;
mod staged_files;
mod statistics;
mod summary;
mod summary_record;
mod table;
mod tessellated;
mod text_table;
mod texture_file;
mod texture_options;
mod topology;
mod triangle_angles;
mod unfinished;
pub mod vtk;

pub use asked::AskedAndReached;
pub use boundary_law::{BoundaryLaw, LawReached, TensionsReached};
pub use cell_table::{CellTable, TableFormat};
pub use check_report::{CheckReport, Expectation, ReportedFault, SizesFound, Spread, Statistic};
pub use config::{Config, FileOptions, PeriodicCut, SeedSource, Shape};
pub use embedded_config::embedded_config;
pub use equivalent_diameters::EquivalentDiameters;
pub use error::Error;
pub use estimate::Estimate;
pub use failed_grain::FailedGrain;
pub use failure::{Failure, Growth};
pub use formats::{LabelGrid, Names, OutputFormat, StlEncoding};
pub use formats::{
    Oriented, Tess, TessCopy, TessDomain, TessFace, TessPeriodicity, TessProblem, TessSeed, read_tess,
};
pub use gradient::GradientSource;
pub use grain_cells::GrainCells;
pub use grain_phases::{GrainPhases, PhaseShare};
pub use grain_shapes::{GrainShapes, ShapesReached};
pub use grain_sizes::{GrainSizes, SizesFit, SizesReached};
pub use grain_texture::{ComponentShare, GrainTexture, HistogramFit};
pub use inner_grains::{Divided, Parents};
pub use inside_options::{InsideError, InsideOptions, InsidePattern};
pub use labelled_file::{FileElements, LabelledFile};
pub use lattice::{Lattice, LatticeFit};
pub use law_options::{LawCurve, LawError, LawKind, LawOptions, LawProblem, LawSource};
pub use measured_sample::{MeasuredGrain, MeasuredSample};
pub use mesh::{
    BezierFile, Connectivity, EdgeEdit, Level, Limits, Scheme, bezier_json, edit_edges, levels_json, limits,
    mesh_json, read_bezier, subdivide,
};
pub use output::{Output, OutputDirectory};
pub use phase_options::{PhaseOptions, PhasesError};
pub use phase_place::PhasePlace;
pub use picture::{Coloring, Picture, Png};
pub use pipeline::{
    Polycrystal, Progress, Reconnected, Regularization, Stage, check_expected_size, make_polycrystal, smooth,
    smooth_watched,
};
pub use poisson_disc::poisson_disc_seeds;
pub use report::Html;
pub use sample_report::{FittedDistribution, MeasuredPhase, MeasuredTexture, SampleReport};
pub use seed_file::{
    FileDomain, FileSeed, FileSeeds, SeedPlace, SeedProblem, read_file_domain, read_seed_file,
};
pub use seeding::random_seeds;
pub use series::{Series, SeriesOutput};
pub use shape_options::{ShapeSource, ShapeSpec};
pub use size_options::{SizeDraw, SizeOptions, SizeSource};
pub use staged_files::{StagedFiles, write_together};
pub use statistics::{NetworkStatistics, StatisticsOutput};
pub use summary::{CellsSummary, Summary};
pub use summary_record::SummaryRecord;
pub use tessellated::{Tessellated, tessellate};
pub use texture_file::{OrientationList, TextureFormat, read_disorientation_file, read_texture_file};
pub use texture_options::{TextureOptions, TextureSource};
pub use topology::Topology;
pub use triangle_angles::TriangleAngles;
pub use unfinished::discard_unfinished;
