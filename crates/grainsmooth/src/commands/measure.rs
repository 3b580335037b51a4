//! `grainsmooth measure`: what a sample is like, and how to make another like it.

use std::io::Write;

use grainsmooth::{MeasuredSample, Output, SampleReport, TableFormat};

use grainsmooth::cli::MeasureArguments;

/// Measures the file and reports on standard output.
pub fn run(arguments: &MeasureArguments) -> anyhow::Result<()> {
    let MeasureArguments { file, json, table, crystal_symmetry, dim } = arguments;
    let output = table.as_ref().map(|path| Output::check_as(path, TableFormat::Csv)).transpose()?;
    let sample = MeasuredSample::read(file, *dim)?;
    if let Some(output) = &output {
        sample.write_table(output)?;
    }
    let report = SampleReport::new(file, &sample, *crystal_symmetry, table.as_deref());
    let mut out = std::io::stdout().lock();
    if *json {
        serde_json::to_writer(&mut out, &report)?;
        writeln!(out)?;
    } else {
        writeln!(out, "{report}")?;
    }
    Ok(())
}
