//! Lines that say how far a long run is, for whoever reads a log.

use std::time::Duration;

use grainsmooth::Stage;

use super::place;

/// Shortest time from one line to the next, and from the start to the first: short runs log nothing.
const BETWEEN_LINES: Duration = Duration::from_secs(30);

/// How far a run is, and when it last said so. Times are those since its start.
#[derive(Debug)]
pub struct ProgressLog {
    /// All stages of the run.
    stages: Vec<Stage>,
    at: Option<Place>,
    last_line: Duration,
}

/// A place in the run.
#[derive(Debug, Clone, Copy)]
struct Place {
    stage: Stage,
    started: Duration,
    done: usize,
    count: usize,
}

impl ProgressLog {
    /// Of a run of these stages.
    pub fn new(stages: Vec<Stage>) -> Self {
        Self { stages, at: None, last_line: Duration::ZERO }
    }

    /// Notes the stage and how many of its steps are done.
    pub fn note(&mut self, now: Duration, stage: Stage, done: usize, count: usize) {
        let same_stage = self.at.filter(|at| at.stage == stage && done > 0);
        let started = same_stage.map_or(now, |at| at.started);
        self.at = Some(Place { stage, started, done, count });
    }

    /// Has no more to say.
    pub fn end(&mut self) {
        self.at = None;
    }

    /// The line to write now, if it is time for one.
    pub fn line(&mut self, now: Duration) -> Option<String> {
        let Place { stage, started, done, count } = self.at?;
        if now < self.last_line + BETWEEN_LINES {
            return None;
        }
        self.last_line = now;
        let taken = now.saturating_sub(started);
        let mut line = format!(
            "progress    {}, stage {} of {}",
            stage.name(),
            place(stage, &self.stages),
            self.stages.len()
        );
        if count > 1 {
            line += &format!(": {} % done", 100 * done / count);
        }
        line += &format!(", {} so far", in_words(taken));
        if count > 1 && done > 0 {
            let left = taken.mul_f64((count - done.min(count)) as f64 / done as f64);
            line += &format!(", about {} left in stage", in_words(left));
        }
        Some(line)
    }
}

fn in_words(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {} s", seconds / 60, seconds % 60),
        _ => format!("{} h {} min", seconds / 3600, seconds / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STAGES: [Stage; 7] = [
        Stage::Seeds,
        Stage::Cells,
        Stage::Network,
        Stage::Relaxation,
        Stage::Subdivision,
        Stage::Validation,
        Stage::Writing,
    ];

    fn seconds(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn lines_tell_stage_share_and_time_left() {
        let mut log = ProgressLog::new(STAGES.to_vec());
        log.note(seconds(2), Stage::Relaxation, 0, 1);
        log.note(seconds(12), Stage::Relaxation, 10, 40);
        let line = log.line(seconds(42)).expect("time for a line");
        assert_eq!(
            line,
            "progress    relaxation, stage 4 of 7: 25 % done, 40 s so far, about 2 min 0 s left in stage"
        );
        log.note(seconds(4000), Stage::Relaxation, 39, 40);
        let line = log.line(seconds(4002)).expect("time for a line");
        assert_eq!(
            line,
            "progress    relaxation, stage 4 of 7: 97 % done, 1 h 6 min so far, about 1 min 42 s left in stage"
        );
    }

    /// A run was once silent for 43 minutes.
    #[test]
    fn long_stages_without_steps_are_not_silent() {
        let mut log = ProgressLog::new(STAGES.to_vec());
        log.note(seconds(5), Stage::Validation, 0, 1);
        let said: Vec<u64> = (0..43 * 60).filter(|now| log.line(seconds(*now)).is_some()).collect();
        assert_eq!(said, (1..86).map(|half_minute| 30 * half_minute).collect::<Vec<_>>());
        assert_eq!(
            log.line(seconds(43 * 60)).as_deref(),
            Some("progress    validation, stage 6 of 7, 42 min 55 s so far")
        );
    }

    #[test]
    fn short_runs_log_nothing() {
        let mut log = ProgressLog::new(STAGES.to_vec());
        log.note(seconds(0), Stage::Seeds, 0, 1);
        assert_eq!(log.line(seconds(29)), None);
        log.end();
        assert_eq!(log.line(seconds(300)), None);
    }

    #[test]
    fn what_is_tried_once_more_starts_anew() {
        let mut log = ProgressLog::new(STAGES.to_vec());
        log.note(seconds(0), Stage::Relaxation, 0, 1);
        log.note(seconds(50), Stage::Relaxation, 5, 10);
        log.note(seconds(60), Stage::Relaxation, 0, 10);
        let line = log.line(seconds(70)).expect("time for a line");
        assert_eq!(line, "progress    relaxation, stage 4 of 7: 0 % done, 10 s so far");
    }
}
