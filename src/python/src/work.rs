//! Runs the library's work beside Python: the GIL is released, progress reaches the caller, Ctrl-C stops the work.
//!
//! The work runs on a thread of its own. The calling thread waits; several times a second it looks for signals and tells the
//! progress. To stop, the next report of progress unwinds the work's stack: everything that it holds is dropped, unfinished
//! files too. The stack is unwound without a message, because it is no fault.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;
use tokosen::base::progress::Progress;

use crate::error::exception;

/// How often signals are looked for and progress is told.
const LOOK: Duration = Duration::from_millis(50);
/// The stack of the work, as that of a program's main thread.
const STACK: usize = 8 << 20;

/// The value that unwinds a stack.
struct Stopped;

/// What the work tells the thread that waits for it.
#[derive(Default)]
struct Watch {
    state: Mutex<State>,
    changed: Condvar,
    is_stopped: AtomicBool,
}

#[derive(Default, Clone)]
struct State {
    step: &'static str,
    done: u64,
    total: u64,
    is_over: bool,
}

impl Watch {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Unwinds the stack if the work is to stop.
    fn look(&self) {
        if self.is_stopped.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }

    fn end(&self) {
        self.state().is_over = true;
        self.changed.notify_all();
    }

    /// Waits until the work is over or it is time to look.
    fn wait(&self) -> State {
        let state = self.state();
        if state.is_over {
            return state.clone();
        }
        self.changed.wait_timeout(state, LOOK).unwrap_or_else(PoisonError::into_inner).0.clone()
    }
}

impl Progress for Watch {
    fn start(&self, step: &'static str, total: u64) {
        self.look();
        let mut state = self.state();
        (state.step, state.done, state.total) = (step, 0, total);
    }

    fn advance(&self, amount: u64) {
        self.look();
        self.state().done += amount;
    }
}

/// Runs work of the library. `progress` is called with the name of the step and the share of it that is done, or `None` if
/// that is not known.
pub fn work<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Progress) -> tokosen::Result<T> + Send,
) -> PyResult<T> {
    let watch = Watch::default();
    let watch = &watch;
    let pool = pool()?;
    let done = std::thread::scope(|scope| {
        let run = move || {
            let done = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(watch))));
            watch.end();
            done
        };
        let name = "tokosen".to_owned();
        let started = std::thread::Builder::new().name(name).stack_size(STACK).spawn_scoped(scope, run);
        let running = started.map_err(|e| PyRuntimeError::new_err(format!("cannot start a thread: {e}")))?;
        let told = wait(py, watch, progress);
        if told.is_err() {
            watch.is_stopped.store(true, Ordering::Relaxed);
        }
        let done = py.detach(|| running.join());
        told.map(|()| done)
    })?;
    match done {
        Ok(Ok(result)) => result.map_err(|error| exception(py, &error)),
        Ok(Err(panic)) | Err(panic) => Err(fault(&*panic)),
    }
}

/// Waits for the work; tells its progress and looks for signals meanwhile.
fn wait(py: Python<'_>, watch: &Watch, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let mut told = ("", None);
    loop {
        let State { step, done, total, is_over } = py.detach(|| watch.wait());
        py.check_signals()?;
        if is_over {
            return Ok(());
        }
        let share = (total > 0).then(|| (done as f64 / total as f64).min(1.0));
        if let Some(progress) = progress.filter(|_| !step.is_empty() && told != (step, share)) {
            progress.call1((step, share))?;
            told = (step, share);
        }
    }
}

/// The exception for a fault of the program itself.
fn fault(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    PyRuntimeError::new_err(format!("a fault of tokosen itself: {}", text.unwrap_or("no message")))
}

/// The threads of the work, and the process that started them.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of this process. A process that was forked has none of its parent's, so it starts its own.
fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match &*known {
        Some((id, pool)) if *id == process::id() => Ok(Arc::clone(pool)),
        _ => {
            let made = rayon::ThreadPoolBuilder::new().thread_name(|k| format!("tokosen {k}")).build();
            let pool = Arc::new(made.map_err(|e| PyRuntimeError::new_err(format!("cannot start threads: {e}")))?);
            // The threads of the parent cannot be ended here.
            if let Some((_, old)) = known.replace((process::id(), Arc::clone(&pool))) {
                std::mem::forget(old);
            }
            Ok(pool)
        }
    }
}
