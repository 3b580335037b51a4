//! Long work that can be ended from outside.
//!
//! ```
//! use cancellation::{CancelToken, RunError, check_cancelled};
//!
//! let token = CancelToken::new();
//! assert_eq!(token.run(2, || 6 * 7).unwrap(), 42);
//!
//! let canceller = token.clone();
//! std::thread::spawn(move || canceller.cancel());
//! let endless = || loop {
//!     check_cancelled();
//! };
//! assert!(matches!(token.run::<()>(2, endless), Err(RunError::Cancelled)));
//! ```
//!
//! Loops deep in a computation ask the token of their thread by [`check_cancelled`], so nothing on the way to them knows of it. Work ends by unwinding:
//! what it holds is dropped. Outside of [`CancelToken::run`] threads have no token, and asking costs a nanosecond.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

thread_local! {
    static TOKEN: RefCell<Option<CancelToken>> = const { RefCell::new(None) };
}

/// Ends work, from any thread. Its clones are the same token.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

/// Why work has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Its token ended it.
    #[error("cancelled")]
    Cancelled,
    /// It panicked: a mistake in the program.
    #[error("internal error: {0}; please report it with what led to it")]
    Panicked(String),
    /// Its threads cannot be started.
    #[error("cannot start the threads: {0}; ask for fewer")]
    Threads(#[from] ThreadPoolBuildError),
}

/// What unwinding carries from a loop to where its work began.
struct Cancelled;

impl CancelToken {
    /// A token that ends nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Ends the work of all who ask.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether work is to end.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Runs work in a pool of so many threads of its own, 0 for one a processor, all of which have this token.
    ///
    /// # Errors
    /// [`RunError`]: also where the work panicked, after the panic's message was printed as usual.
    pub fn run<T: Send>(&self, threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, RunError> {
        let token = self.clone();
        let give_token = move |_| TOKEN.set(Some(token.clone()));
        let pool = ThreadPoolBuilder::new().num_threads(threads).start_handler(give_token).build()?;
        // Nothing that the work changed is looked at after a panic.
        catch_unwind(AssertUnwindSafe(|| pool.install(work))).map_err(|payload| {
            if payload.is::<Cancelled>() {
                RunError::Cancelled
            } else {
                RunError::Panicked(message(&*payload))
            }
        })
    }
}

/// Ends the work of this thread, where its token says so.
pub fn check_cancelled() {
    if TOKEN.with_borrow(|token| token.as_ref().is_some_and(CancelToken::is_cancelled)) {
        // No message is printed, as none is for a panic that goes on.
        resume_unwind(Box::new(Cancelled));
    }
}

/// What a panic said.
fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref().cloned()).unwrap_or_else(|| "a panic without a message".to_owned())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use std::sync::mpsc::channel;

    use rayon::prelude::*;

    use super::*;

    #[test]
    fn parallel_loops_end_and_drop_what_they_hold() {
        let token = CancelToken::new();
        let (started, first) = channel();
        let held = Arc::new(());
        let work = {
            let held = Arc::clone(&held);
            move || {
                (0..64).into_par_iter().for_each(|_| {
                    let _held = Arc::clone(&held);
                    started.send(()).unwrap();
                    loop {
                        check_cancelled();
                    }
                });
            }
        };
        let canceller = token.clone();
        let waits = std::thread::spawn(move || {
            first.recv().unwrap();
            canceller.cancel();
            first
        });
        assert!(matches!(token.run(2, work), Err(RunError::Cancelled)));
        waits.join().unwrap();
        assert_eq!(Arc::strong_count(&held), 1);
    }

    #[test]
    fn panics_are_told_and_other_threads_have_no_token() {
        let token = CancelToken::new();
        token.cancel();
        check_cancelled();
        let error = CancelToken::new().run(1, || -> u8 { panic!("grain {}", 3) }).unwrap_err();
        assert_eq!(error.to_string(), "internal error: grain 3; please report it with what led to it");
    }
}
