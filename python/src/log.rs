//! What happens, for the logging of Python. No call of Python is made where it happens: records wait in a queue that is bounded,
//! and a thread hands them over.

use std::fmt::Display;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant as Clock};

use ::plant::{Event, EventKind};
use profidrive::motion;
use pyo3::prelude::*;
use pyo3::types::PyModule;

use crate::attention::LOOK;
use crate::joined::locked;
use crate::process::Process;

/// Records that wait at most.
const ROOM: usize = 1024;
/// How often the levels of the loggers are read.
const LEVELS: Duration = Duration::from_secs(1);
/// How long a program that ends waits for its handlers.
const AT_END: Duration = Duration::from_secs(2);

/// Levels of Python.
const DEBUG: u8 = 10;
const INFO: u8 = 20;
const WARNING: u8 = 30;

/// The loggers below `profidrive`.
#[derive(Debug, Clone, Copy)]
pub enum Logger {
    Network,
    Axis,
    Plant,
}

const LOGGERS: [&str; 3] = ["profidrive.network", "profidrive.axis", "profidrive.plant"];

struct Record {
    logger: Logger,
    level: u8,
    text: String,
}

/// The thread that hands records over.
struct Pump {
    records: SyncSender<Record>,
    thread: JoinHandle<()>,
    /// A copy of the process has none.
    process: Process,
}

static PUMP: Mutex<Option<Pump>> = Mutex::new(None);
/// The lowest level of each logger; nothing is recorded before the first one is read.
static LOWEST: [AtomicU8; 3] = [const { AtomicU8::new(u8::MAX) }; 3];
/// Records for which there was no room.
static DROPPED: AtomicU64 = AtomicU64::new(0);

fn record(logger: Logger, level: u8, text: impl FnOnce() -> String) {
    let lowest = LOWEST.get(logger as usize);
    if lowest.is_none_or(|lowest| level < lowest.load(Ordering::Relaxed)) {
        return;
    }
    let records = locked(&PUMP).as_ref().map(|pump| pump.records.clone());
    let text = text();
    let full = records.is_none_or(|records| records.try_send(Record { logger, level, text }).is_err());
    if full {
        DROPPED.fetch_add(1, Ordering::Relaxed);
    }
}

/// Something that a program may look at when it searches for an error.
pub fn debug(logger: Logger, text: impl FnOnce() -> String) {
    record(logger, DEBUG, text);
}

/// Something that was changed, or begins or ends.
pub fn info(logger: Logger, text: impl FnOnce() -> String) {
    record(logger, INFO, text);
}

/// Something that is not as it should be.
pub fn warning(logger: Logger, text: impl FnOnce() -> String) {
    record(logger, WARNING, text);
}

/// What happened in a plant.
pub fn of_plant(event: Event) {
    match event.kind {
        EventKind::Sample(_) => {}
        EventKind::FaultRaised { .. } => info(Logger::Plant, || event.to_string()),
        _ => debug(Logger::Plant, || event.to_string()),
    }
}

/// What happened on the way of a motion.
pub fn of_motion(drive: &str, event: &motion::Event) {
    for remark in event.remarks() {
        let text = || format!("{drive}: {}", remark.sentence);
        match remark.is_warning {
            true => warning(Logger::Axis, text),
            false => info(Logger::Axis, text),
        }
    }
}

/// Records how a call for a drive ended.
pub fn call<T, E: Display>(logger: Logger, what: impl Display, done: &Result<T, E>, changes: bool) {
    match done {
        Ok(_) if changes => info(logger, || format!("{what}: done")),
        Ok(_) => debug(logger, || format!("{what}: done")),
        // it is raised, which is louder than a record
        Err(error) => info(logger, || format!("{what}: {error}")),
    }
}

/// Begins to log where that was not done, and reads the levels.
pub fn begin(py: Python<'_>) -> PyResult<()> {
    read_levels(py)?;
    let first = {
        // Python is not called in here: it would let another thread go on, which may wait for this lock
        let mut pump = locked(&PUMP);
        if pump.as_ref().is_some_and(|pump| pump.process.is_this()) {
            return Ok(());
        }
        let (records, queue) = sync_channel(ROOM);
        let thread = Builder::new()
            .name("profidrive-log".into())
            .spawn(move || hand_over(&queue))?;
        let before = pump.replace(Pump {
            records,
            thread,
            process: Process::this(),
        });
        before.is_none()
    };
    if first {
        let end = wrap_pyfunction!(end_log, py)?;
        py.import("atexit")?.call_method1("register", (end,))?;
    }
    Ok(())
}

/// Hands over what is left, before Python ends.
#[pyfunction]
fn end_log(py: Python<'_>) {
    py.detach(|| {
        let pump = locked(&PUMP).take();
        if let Some(Pump {
            records,
            thread,
            process,
        }) = pump
            && process.is_this()
        {
            drop(records);
            let begin = Clock::now();
            // a handler that waits for something must not hold up the end of the program
            while !thread.is_finished() && begin.elapsed() < AT_END {
                std::thread::sleep(LOOK / 10);
            }
        }
    });
}

fn read_levels(py: Python<'_>) -> PyResult<()> {
    let logging = py.import("logging")?;
    for (name, lowest) in LOGGERS.into_iter().zip(&LOWEST) {
        let logger = logging.call_method1("getLogger", (name,))?;
        let level: i64 = logger.call_method0("getEffectiveLevel")?.extract()?;
        lowest.store(u8::try_from(level).unwrap_or(u8::MAX), Ordering::Relaxed);
    }
    Ok(())
}

/// Hands records over until no thread can make one any more.
fn hand_over(queue: &Receiver<Record>) {
    let mut read = Clock::now();
    loop {
        let first = match queue.recv_timeout(LEVELS) {
            Ok(first) => Some(first),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return,
        };
        let records: Vec<_> = first.into_iter().chain(queue.try_iter().take(ROOM)).collect();
        let dropped = DROPPED.swap(0, Ordering::Relaxed);
        let levels = read.elapsed() >= LEVELS;
        if levels {
            read = Clock::now();
        }
        let done = Python::try_attach(|py| {
            // what a handler raises is its own matter
            let _ = log(py, records, dropped);
            if levels {
                let _ = read_levels(py);
            }
        });
        if done.is_none() {
            // Python has ended
            return;
        }
    }
}

fn log(py: Python<'_>, records: Vec<Record>, dropped: u64) -> PyResult<()> {
    let logging: Bound<'_, PyModule> = py.import("logging")?;
    let hand = |name: &str, level: u8, text: String| {
        let logger = logging.call_method1("getLogger", (name,))?;
        logger.call_method1("log", (level, "%s", text)).map(drop)
    };
    for Record { logger, level, text } in records {
        let name = LOGGERS.get(logger as usize).copied().unwrap_or("profidrive");
        hand(name, level, text)?;
    }
    if dropped > 0 {
        hand(
            "profidrive",
            WARNING,
            format!("{dropped} records were dropped: the handlers are too slow"),
        )?;
    }
    Ok(())
}
