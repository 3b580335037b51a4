//! A slice of a campaign: random runs of the program, each certified. `crates/campaign` runs as many as one likes.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::PathBuf;

use campaign::{Limits, Outcome, Record, Slice, Subject, Summary, run_slice};

#[test]
fn sixty_random_runs_end_without_panic_invalid_result_or_leftover() {
    let slice = Slice {
        program: PathBuf::from(env!("CARGO_BIN_EXE_grainsmooth")),
        subject: Subject::Seeds,
        seed: 17,
        from: 0,
        runs: 60,
        // Small, so that all of them take less than a minute.
        limits: Limits { grains: 30, triangles: 10_000 },
        keep: None,
    };
    let records = run_slice(&slice, |_| Ok(())).unwrap();
    assert_eq!(records.len(), 60);
    let bad: Vec<&Record> = records.iter().filter(|record| record.is_unacceptable()).collect();
    assert!(bad.is_empty(), "{bad:#?}\n{}", Summary(&records));
    // A campaign that certifies nothing would be as quiet.
    let good = records.iter().filter(|record| record.outcome == Outcome::Good);
    let certified = good.filter(|record| record.volume_error.is_some_and(|error| error <= 1e-9)).count();
    assert!(certified >= 20, "{}", Summary(&records));
}

#[test]
fn fifty_random_maps_end_without_panic_invalid_result_or_leftover() {
    let slice = Slice {
        program: PathBuf::from(env!("CARGO_BIN_EXE_grainsmooth")),
        subject: Subject::Maps,
        seed: 17,
        from: 0,
        runs: 50,
        limits: Limits::USUAL,
        keep: None,
    };
    let records = run_slice(&slice, |_| Ok(())).unwrap();
    let bad: Vec<&Record> = records.iter().filter(|record| record.is_unacceptable()).collect();
    assert!(bad.is_empty(), "{bad:#?}\n{}", Summary(&records));
    let good = records.iter().filter(|record| record.outcome == Outcome::Good);
    let certified = good.filter(|record| record.volume_error.is_some_and(|error| error <= 1e-9)).count();
    assert!(certified >= 30, "{}", Summary(&records));
}
