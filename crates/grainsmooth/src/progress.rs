//! One line on a terminal that says how far the run is.

use std::io::IsTerminal;
use std::time::Duration;

use grainsmooth::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Stages of a single step say nothing of what is left.
const UNCOUNTED: &str = "{prefix} {msg:12} {elapsed}";
/// Fits a terminal of 80 columns, where a longer line would break and flicker.
const COUNTED: &str = "{prefix} {msg:12} {bar:20} {pos}/{len}  {elapsed}, about {eta} left in stage";

/// A progress bar on standard error where that is a terminal, else nothing.
pub struct ProgressLine(ProgressBar);

impl ProgressLine {
    /// Shows nothing when `quiet`.
    pub fn new(quiet: bool) -> Self {
        let target = if quiet || !std::io::stderr().is_terminal() {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::hidden());
        // Nothing is drawn before there is a stage to name.
        bar.set_style(style(UNCOUNTED));
        bar.set_draw_target(target);
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Shows the stage and how many of its steps are done.
    pub fn show(&self, stage: Stage, done: usize, count: usize) {
        let number = 1 + Stage::ALL.iter().take_while(|other| **other != stage).count();
        if done == 0 {
            self.0.reset();
        }
        let template = if count > 1 { COUNTED } else { UNCOUNTED };
        self.0.set_style(style(template));
        self.0.set_prefix(format!("[{number}/{}]", Stage::ALL.len()));
        self.0.set_message(stage.name());
        self.0.set_length(count as u64);
        self.0.set_position(done as u64);
    }

    /// Takes the line off the terminal.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is fixed")
}
