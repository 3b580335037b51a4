//! One run: its case in a fresh directory, the program, and the verdict.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use tempfile::TempDir;

use crate::case::{Case, Limits};
use crate::certify::{Certificate, certify};
use crate::process::{self, Ended};
use crate::record::{Outcome, Record};
use crate::refusals::refusal;

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// Seeds, and what becomes of their cells.
    Seeds,
    /// Measured maps for `grainsmooth smooth`.
    Maps,
}

/// A slice of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    /// The program to run.
    pub program: PathBuf,
    /// What is drawn.
    pub subject: Subject,
    /// The campaign's seed.
    pub seed: u64,
    /// Index of the first run.
    pub from: u64,
    /// Number of runs.
    pub runs: u64,
    /// What the runs are kept to.
    pub limits: Limits,
    /// Directory for the input of [notable](Record::is_notable) runs, each in a directory of its own.
    pub keep: Option<PathBuf>,
}

/// Runs a slice, one run after the other, and hands over what is recorded of each.
///
/// # Errors
/// When processes cannot be started, or directories cannot be made, or `each` fails.
pub fn run_slice(
    slice: &Slice,
    mut each: impl FnMut(&Record) -> anyhow::Result<()>,
) -> anyhow::Result<Vec<Record>> {
    let mut records = Vec::new();
    for index in slice.from..slice.from + slice.runs {
        let record = run_one(slice, index).with_context(|| format!("run {index} of seed {}", slice.seed))?;
        each(&record)?;
        records.push(record);
    }
    Ok(records)
}

/// Runs one case and judges it.
fn run_one(slice: &Slice, index: u64) -> anyhow::Result<Record> {
    let case = match slice.subject {
        Subject::Seeds => Case::draw(slice.seed, index, slice.limits),
        Subject::Maps => Case::draw_map(slice.seed, index),
    };
    let directory = TempDir::new()?;
    for (name, content) in &case.files {
        put(&directory.path().join(name), content)?;
    }
    let before = content(directory.path())?;
    let words = [case.command.clone(), case.options.words()].concat();
    let ended = process::run(&slice.program, &words, directory.path())?;
    let left: Vec<String> = match ended.code {
        0 => strangers(&case, &before, &content(directory.path())?),
        _ => changes(&before, &content(directory.path())?, &ended),
    };
    let (outcome, message, certificate) = judge(&case, slice, directory.path(), &ended)?;
    let record = Record {
        seed: slice.seed,
        index,
        kind: case.kind.clone(),
        dimension: case.dimension,
        command: shell_words(&words),
        exit: ended.code,
        outcome,
        message,
        left,
        seconds: ended.seconds,
        angle_class: case.angles,
        least_angle: certificate.angles.map(|[least, _]| least),
        first_percentile_angle: certificate.angles.map(|[_, percentile]| percentile),
        volume_error: certificate.volume_error,
        filled: (case.promise.mesh.is_some() && outcome != Outcome::Refused)
            .then_some(outcome == Outcome::Good),
    };
    if let Some(keep) = slice.keep.as_ref().filter(|_| record.is_notable()) {
        let kept = keep.join(format!("{}-{index}", slice.seed));
        case.files.iter().try_for_each(|(name, content)| put(&kept.join(name), content))?;
        put(&kept.join("command"), format!("grainsmooth {}\n", record.command).as_bytes())?;
    }
    Ok(record)
}

/// Lines before the message: what was tried, and the progress of long runs.
const LOG: [&str; 2] = ["given up    ", "progress    "];

/// The lines of standard error that are not of the log.
fn said(ended: &Ended) -> impl Iterator<Item = &str> {
    ended.err.lines().filter(|line| !LOG.iter().any(|start| line.starts_with(start)))
}

/// What the run ended with, and why it is not good.
fn judge(
    case: &Case,
    slice: &Slice,
    directory: &Path,
    ended: &Ended,
) -> anyhow::Result<(Outcome, String, Certificate)> {
    // Attempts that were given up come before it.
    let message = said(ended).next().unwrap_or_default().to_owned();
    let without = |outcome, message| Ok((outcome, message, Certificate::default()));
    if let Some(line) = ended.err.lines().find(|line| line.contains("panicked at")) {
        let said = ended.err.lines().skip_while(|other| *other != line).nth(1).unwrap_or_default();
        return without(Outcome::Panic, format!("{line} {said}"));
    }
    if ended.is_out_of_time() {
        return without(Outcome::TimeOut, message);
    }
    match (ended.code, &case.mistake) {
        (0, None) => {
            let certificate = certify(case, &slice.program, directory, &ended.out)?;
            match certificate.faults.first() {
                None => Ok((Outcome::Good, String::new(), certificate)),
                Some(fault) => Ok((Outcome::Invalid, fault.clone(), certificate)),
            }
        }
        (0, Some(_)) => without(Outcome::Invalid, format!("accepted: {}", case.kind)),
        (1 | 2, _) => match complaint(case, ended, &message) {
            Some(complaint) => without(Outcome::Invalid, format!("{complaint}: {message}")),
            None if ended.code == 2 || refusal(&message).is_some() => without(Outcome::Refused, message),
            None => without(Outcome::Failed, message),
        },
        // Signals, and aborts for lack of memory.
        (code, _) => without(Outcome::Panic, format!("ended with {code}: {message}")),
    }
}

/// What is wrong with how a failure is told.
fn complaint(case: &Case, ended: &Ended, message: &str) -> Option<String> {
    if !message.starts_with("error: ") {
        return Some("a failure without a message".to_owned());
    }
    // clap adds the usage below.
    if ended.code == 1 && said(ended).count() != 1 {
        return Some("a message of more than one line".to_owned());
    }
    let value = case.mistake.as_ref()?;
    (!message.contains(value)).then(|| format!("the message does not name {value}"))
}

/// Names and content of all files below a directory.
type Content = BTreeMap<String, Vec<u8>>;

fn content(directory: &Path) -> anyhow::Result<Content> {
    let mut all = Content::new();
    let mut folders = vec![directory.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let path = entry?.path();
            let name = path.strip_prefix(directory)?.display().to_string();
            if path.is_dir() {
                all.insert(format!("{name}/"), Vec::new());
                folders.push(path);
            } else {
                all.insert(name, fs::read(&path)?);
            }
        }
    }
    Ok(all)
}

/// Files that a failed run has left, changed or taken away. What a limit ends cannot take its half-written files away.
fn changes(before: &Content, after: &Content, ended: &Ended) -> Vec<String> {
    let is_excused = |name: &str| ended.is_out_of_time() && name.contains(".part");
    let new = after.keys().filter(|name| !before.contains_key(*name) && !is_excused(name));
    let changed = before.iter().filter(|(name, bytes)| after.get(*name) != Some(bytes)).map(|(name, _)| name);
    new.chain(changed).cloned().collect()
}

/// Files of a good run that nobody asked for.
fn strangers(case: &Case, before: &Content, after: &Content) -> Vec<String> {
    let is_known = |name: &&String| case.promise.stems.iter().any(|stem| name.starts_with(stem));
    after.keys().filter(|name| !before.contains_key(*name) && !is_known(name)).cloned().collect()
}

fn put(path: &Path, content: &[u8]) -> anyhow::Result<()> {
    fs::create_dir_all(path.parent().unwrap_or(path))?;
    fs::write(path, content).with_context(|| path.display().to_string())
}

/// Words as a shell takes them.
fn shell_words(words: &[String]) -> String {
    let quoted = |word: &String| match word.contains(' ') {
        true => format!("'{word}'"),
        false => word.clone(),
    };
    words.iter().map(quoted).collect::<Vec<_>>().join(" ")
}
