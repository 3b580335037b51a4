//! What is recorded of a run, a line of JSON, and what many records sum up to.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::case::AngleClass;
use crate::refusals::without_numbers;

/// Angles below this count as thin, in degrees.
const THIN: f64 = 1.5;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// With a result that is certified.
    Good,
    /// With a message that names a reason in the input.
    Refused,
    /// With a message that names another reason.
    Failed,
    /// With a result that is wrong, or with a message that does not do.
    Invalid,
    /// With a panic or a signal.
    Panic,
    /// At the limit of processor time.
    TimeOut,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Seed of the campaign.
    pub seed: u64,
    /// Index of the run.
    pub index: u64,
    /// Kind of input drawn.
    pub kind: String,
    /// Two or three.
    pub dimension: usize,
    /// Command line, without the program.
    pub command: String,
    /// Exit code; 128 and more where a signal ended it.
    pub exit: i32,
    /// How it ended.
    pub outcome: Outcome,
    /// Why it is not good.
    pub message: String,
    /// Files that it should not have left.
    pub left: Vec<String>,
    /// Processor time, in seconds.
    pub seconds: f64,
    /// What its angles are counted with.
    pub angle_class: AngleClass,
    /// Least angle of a triangle, in degrees.
    pub least_angle: Option<f64>,
    /// A hundredth of the triangles have an angle below this, in degrees.
    pub first_percentile_angle: Option<f64>,
    /// Largest relative error of a grain's volume.
    pub volume_error: Option<f64>,
    /// Whether all grains are filled with elements that are certified, where they were to be.
    #[serde(default)]
    pub filled: Option<bool>,
}

impl Record {
    /// Whether no campaign may have such a run: a panic, an invalid result or message, or files left behind.
    pub fn is_unacceptable(&self) -> bool {
        matches!(self.outcome, Outcome::Invalid | Outcome::Panic) || !self.left.is_empty()
    }

    /// Whether somebody may want to repeat the run: it is neither good nor refused, or has thin triangles that regularized cells
    /// should not have.
    pub fn is_notable(&self) -> bool {
        let is_thin = self.least_angle.is_some_and(|angle| angle < THIN);
        !matches!(self.outcome, Outcome::Good | Outcome::Refused)
            || self.is_unacceptable()
            || is_thin && ![AngleClass::Unregularized, AngleClass::Measured].contains(&self.angle_class)
    }
}

/// What records sum up to, in a text for people.
pub struct Summary<'a>(pub &'a [Record]);

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = self.0;
        let with = |outcome| all.iter().filter(move |record| record.outcome == outcome);
        let count = |outcome| with(outcome).count();
        let accepted = count(Outcome::Good) + count(Outcome::Refused);
        let share = 100.0 * accepted as f64 / all.len().max(1) as f64;
        writeln!(out, "runs            {}", all.len())?;
        writeln!(out, "good            {}", count(Outcome::Good))?;
        writeln!(out, "refused input   {}", count(Outcome::Refused))?;
        writeln!(out, "  of both       {share:.2} %")?;
        for (name, outcome) in [
            ("failed result", Outcome::Failed),
            ("invalid result", Outcome::Invalid),
            ("panic", Outcome::Panic),
            ("time-out", Outcome::TimeOut),
        ] {
            writeln!(out, "{name:15} {}", count(outcome))?;
            write_kinds(out, with(outcome))?;
        }
        let left: Vec<&Record> = all.iter().filter(|record| !record.left.is_empty()).collect();
        writeln!(out, "files left      {}", left.len())?;
        for record in left.iter().take(10) {
            writeln!(out, "  {} ({})", record.left.join(", "), record.index)?;
        }
        let to_fill = all.iter().filter_map(|record| record.filled);
        let filled = to_fill.clone().filter(|filled| *filled).count();
        writeln!(out, "filled grains   {filled} of {} runs", to_fill.count())?;
        write_angles(out, all)?;
        let errors = all.iter().filter_map(|record| record.volume_error);
        if let Some(error) = errors.max_by(f64::total_cmp) {
            writeln!(out, "volume error    {error:.1e} at most")?;
        }
        write_times(out, all)
    }
}

/// Messages by kind, the most frequent first, with the indices of some of their runs.
fn write_kinds<'a>(out: &mut fmt::Formatter<'_>, records: impl Iterator<Item = &'a Record>) -> fmt::Result {
    let mut kinds: BTreeMap<String, Vec<&Record>> = BTreeMap::new();
    for record in records {
        let kind = without_numbers(record.message.trim_start_matches("error: "));
        kinds.entry(kind).or_default().push(record);
    }
    let mut kinds: Vec<_> = kinds.into_iter().collect();
    kinds.sort_by_key(|(_, runs)| std::cmp::Reverse(runs.len()));
    for (kind, runs) in kinds {
        let indices: Vec<String> =
            runs.iter().take(5).map(|run| format!("{}:{}", run.seed, run.index)).collect();
        writeln!(out, "  {:4} {kind} [{}]", runs.len(), indices.join(" "))?;
    }
    Ok(())
}

/// How many runs of each class have thin triangles.
fn write_angles(out: &mut fmt::Formatter<'_>, all: &[Record]) -> fmt::Result {
    for (class, name) in AngleClass::ALL {
        let of_class = all.iter().filter(|record| record.angle_class == class);
        let angles: Vec<f64> = of_class.clone().filter_map(|record| record.least_angle).collect();
        if angles.is_empty() {
            continue;
        }
        let thin = angles.iter().filter(|angle| **angle < THIN).count();
        let least = angles.iter().copied().fold(f64::INFINITY, f64::min);
        let percentiles = of_class.filter_map(|record| record.first_percentile_angle);
        let percentile = percentiles.fold(f64::INFINITY, f64::min);
        writeln!(
            out,
            "angles          {name}: {thin} of {} below {THIN} degrees, least {least:.2}; a hundredth below {percentile:.1} at worst",
            angles.len()
        )?;
    }
    Ok(())
}

fn write_times(out: &mut fmt::Formatter<'_>, all: &[Record]) -> fmt::Result {
    let mut seconds: Vec<f64> = all.iter().map(|record| record.seconds).collect();
    seconds.sort_unstable_by(f64::total_cmp);
    let Some(longest) = seconds.last() else { return Ok(()) };
    let quantile = |percent: usize| seconds[(seconds.len() - 1) * percent / 100];
    write!(
        out,
        "processor time  {:.2} s median, {:.2} s 90 %, {:.2} s 99 %, {longest:.2} s longest, {:.0} s in all",
        quantile(50),
        quantile(90),
        quantile(99),
        seconds.iter().sum::<f64>()
    )
}
