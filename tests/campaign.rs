//! A slice of a campaign: random runs of the program, each certified. `crates/campaign` runs as many as one likes.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::PathBuf;

use campaign::{Limits, Outcome, Record, Slice, Subject, Summary, run_slice};

/// Runs a slice in which none may be unacceptable, and at least so many certified: a campaign that certifies nothing would be as quiet.
fn assert_good(subject: Subject, runs: u64, limits: Limits, fewest_certified: usize) {
    let program = PathBuf::from(env!("CARGO_BIN_EXE_grainsmooth"));
    let slice = Slice { program, subject, seed: 17, from: 0, runs, limits, keep: None };
    let records = run_slice(&slice, |_| Ok(())).unwrap();
    assert_eq!(records.len() as u64, runs);
    let bad: Vec<&Record> = records.iter().filter(|record| record.is_unacceptable()).collect();
    assert!(bad.is_empty(), "{bad:#?}\n{}", Summary(&records));
    let good = records.iter().filter(|record| record.outcome == Outcome::Good);
    let certified = good.filter(|record| record.volume_error.is_some_and(|error| error <= 1e-9)).count();
    assert!(certified >= fewest_certified, "{}", Summary(&records));
}

#[test]
fn sixty_random_runs_end_without_panic_invalid_result_or_leftover() {
    // Small, so that all of them take less than a minute.
    assert_good(Subject::Seeds, 60, Limits { grains: 30, triangles: 10_000 }, 20);
}

#[test]
fn fifty_random_maps_end_without_panic_invalid_result_or_leftover() {
    assert_good(Subject::Maps, 50, Limits::USUAL, 30);
}
