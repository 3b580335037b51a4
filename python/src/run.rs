//! Long work beside other Python threads: it can be watched, and Ctrl-C ends it.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use cancellation::{CancelToken, RunError};
use grainsmooth::{Error, Progress, Stage};
use pyo3::prelude::*;

use crate::errors::{InternalError, ended, to_python};

/// How often signals are looked for and progress is told: fast enough that nobody waits for either.
const LOOK: Duration = Duration::from_millis(50);

/// How long an interrupted caller waits for its threads, which end by themselves soon after.
const GRACE: Duration = Duration::from_millis(100);

/// Runs work of the library in threads of its own, 0 for one a processor, while other Python threads go on.
///
/// `progress` is called with the name of a stage, the steps done and their number. An exception that it raises, and Ctrl-C, end the work.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(Progress<'_>) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let token = CancelToken::new();
    let reached: Arc<Mutex<Option<(Stage, usize, usize)>>> = Arc::default();
    let (sender, receiver) = channel();
    {
        let (token, reached) = (token.clone(), Arc::clone(&reached));
        thread::spawn(move || {
            let tell = |stage, done, count| {
                *reached.lock().unwrap_or_else(PoisonError::into_inner) = Some((stage, done, count));
            };
            // An interrupted caller is gone.
            let _ = sender.send(token.run(threads, || work(&tell)));
        });
    }
    let receiver = Mutex::new(receiver);
    let wait = |time: Duration| {
        py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(time))
    };
    let mut told = None;
    loop {
        match wait(LOOK) {
            Ok(result) => return result.map_err(ended)?.map_err(to_python),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(InternalError::new_err(
                    RunError::Panicked("a thread ended".to_owned()).to_string(),
                ));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let now = *reached.lock().unwrap_or_else(PoisonError::into_inner);
        let tell = || match (progress, now) {
            (Some(progress), Some((stage, done, count))) if now != told => {
                progress.call1((stage.name(), done, count)).map(|_| ())
            }
            _ => Ok(()),
        };
        if let Err(interruption) = py.check_signals().and_then(|()| tell()) {
            token.cancel();
            let _ = wait(GRACE);
            return Err(interruption);
        }
        told = now;
    }
}
