//! The program as its users meet it: run as a process, judged by what it prints, returns and writes.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod bad_arguments;
mod bad_outputs;
mod bad_relaxation;
mod bad_seed_files;
mod check;
mod check_files;
mod config_files;
mod control_meshes;
mod domains;
mod elements;
mod filling;
mod front;
mod given_networks;
mod good_runs;
mod grain_shapes;
mod inside;
mod map_agreement;
mod map_remedies;
mod maps;
mod measure;
mod measured_levels;
mod measured_relaxation;
mod measured_sets;
mod orientation_maps;
mod periodic;
mod phases;
mod pictures;
#[path = "../common/programs.rs"]
mod programs;
mod python_keywords;
mod remedies;
mod remesh;
mod seed_formats;
mod seed_sources;
mod series;
mod sizes;
mod statistics;
mod surface_file;
mod tensions;
mod textures;
mod told;
mod weights_and_tables;
mod workplace;
