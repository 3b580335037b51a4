//! How far the run is: a line that changes on a terminal, lines of a log elsewhere.

mod log;

use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use grainsmooth::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::say;
use log::ProgressLog;

/// Stages of a single step say nothing of what is left.
const UNCOUNTED: &str = "{prefix} {msg:12} {elapsed}";
/// Fits a terminal of 80 columns, where a longer line would break and flicker.
const COUNTED: &str = "{prefix} {msg:12} {bar:20} {pos}/{len}  {elapsed}, about {eta} left in stage";

/// How often it is looked whether it is time for a line of the log.
const LOOK: Duration = Duration::from_secs(1);

/// Says on standard error how far the run is.
pub enum ProgressLine {
    /// A bar, where standard error is a terminal, and the stages that it counts.
    Bar(ProgressBar, Vec<Stage>),
    /// Lines of a log, few and far between, where it is not.
    Log(Logger),
    /// Nothing.
    Quiet,
}

impl ProgressLine {
    /// Of a run of these stages. Shows nothing when `quiet`.
    pub fn new(quiet: bool, stages: Vec<Stage>) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !std::io::stderr().is_terminal() {
            return Self::Log(Logger::start(stages));
        }
        let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::hidden());
        // Nothing is drawn before there is a stage to name.
        bar.set_style(style(UNCOUNTED));
        bar.set_draw_target(ProgressDrawTarget::stderr());
        bar.enable_steady_tick(Duration::from_millis(100));
        Self::Bar(bar, stages)
    }

    /// Shows the stage and how many of its steps are done.
    pub fn show(&self, stage: Stage, done: usize, count: usize) {
        match self {
            Self::Bar(bar, stages) => {
                if done == 0 {
                    bar.reset();
                }
                let template = if count > 1 { COUNTED } else { UNCOUNTED };
                bar.set_style(style(template));
                bar.set_prefix(format!("[{}/{}]", place(stage, stages), stages.len()));
                bar.set_message(stage.name());
                bar.set_length(count as u64);
                bar.set_position(done as u64);
            }
            Self::Log(logger) => logger.with(|log, now| log.note(now, stage, done, count)),
            Self::Quiet => {}
        }
    }

    /// Takes the line off the terminal, and ends the log.
    pub fn clear(&self) {
        match self {
            Self::Bar(bar, _) => bar.finish_and_clear(),
            Self::Log(logger) => logger.with(|log, _| log.end()),
            Self::Quiet => {}
        }
    }
}

/// The stage's place among all of a run, from 1.
fn place(stage: Stage, stages: &[Stage]) -> usize {
    1 + stages.iter().take_while(|other| **other != stage).count()
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is fixed")
}

/// Writes the lines of a log when their time has come, whatever the run is at.
pub struct Logger {
    log: Arc<Mutex<ProgressLog>>,
    start: Instant,
    /// Ends the thread when it is dropped.
    _alive: Sender<()>,
}

impl Logger {
    fn start(stages: Vec<Stage>) -> Self {
        let log = Arc::new(Mutex::new(ProgressLog::new(stages)));
        let start = Instant::now();
        let (alive, ended) = channel();
        let of_thread = Arc::clone(&log);
        thread::spawn(move || {
            while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                let line = of_thread.lock().unwrap_or_else(PoisonError::into_inner).line(start.elapsed());
                if let Some(line) = line {
                    say(&line);
                }
            }
        });
        Self { log, start, _alive: alive }
    }

    fn with(&self, change: impl FnOnce(&mut ProgressLog, Duration)) {
        change(&mut self.log.lock().unwrap_or_else(PoisonError::into_inner), self.start.elapsed());
    }
}
