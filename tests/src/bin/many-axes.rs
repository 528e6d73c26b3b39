//! A program of the library with many axes at once on a real network: one thread for each axis, blocking calls.
//!
//! - `many-axes ends INTERFACE NAME...`: all axes turn; the first is dropped, the caller of the second panics, the third is
//!   forgotten, the fourth is stopped by its handle while 1,000 reads wait for its drive. The others keep their speed until
//!   the drives of these four report that they are at rest. One JSON object a line says what happened.
//! - `many-axes wait|consent|panic|return|abort INTERFACE MILLISECONDS NAME...`: all axes turn. After this time, counted from
//!   the opening of the network, main panics, returns or aborts; `wait` goes on until a signal and exits with 130. `consent`
//!   does the same with drives that may run on without a controller; all others refuse these.
#![forbid(unsafe_code)]

use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock, mpsc};
use std::task::{Context, Waker};
use std::thread;
use std::time::{Duration, Instant};

use client::axis::{Purpose, Trouble};
use client::{Axis, AxisSettings, Enabled, Error, Samples, Session, StopHandle};
use profidrive::{Access, Caller, Network, Opening, Stop, Wait};
use profile::state::Zsw1;
use profinet::Instant as NetworkTime;
use serde_json::{Value, json};

const SPEED: f64 = 300.0;
const SECOND: Duration = Duration::from_secs(1);
/// Everything is over by then.
const LIMIT: Duration = Duration::from_secs(60);
/// Callers that wait for one drive when its axis is stopped.
const WAITING: usize = 1000;
/// Callers that may be needed for that, as the drive answers meanwhile.
const READERS: usize = 5000;
/// Stack of one of them.
const STACK: usize = 256 * 1024;
/// How the first axes end, in their order; the others are released.
const SPECIAL: [&str; 4] = ["dropped", "panic", "lease", "stopped"];
/// Speed below which an axis stands, in rpm.
const STANDSTILL: f64 = 0.5;
/// Share of its speed that an axis in its ramp has lost.
const RAMP: f64 = 0.05;
/// Exit code of a program that was interrupted.
const INTERRUPTED: u8 = 130;

type Done<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

fn main() -> Done<ExitCode> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments
        .iter()
        .map(String::as_str)
        .collect::<Vec<_>>()
        .as_slice()
    {
        ["ends", interface, names @ ..] => ends(interface, names),
        [
            how @ ("wait" | "consent" | "panic" | "return" | "abort"),
            interface,
            time,
            names @ ..,
        ] => {
            let time = Duration::from_millis(time.parse()?);
            run_until(how, interface, time, names)
        }
        _ => Err(
            "ends INTERFACE NAME..., or wait|consent|panic|return|abort INTERFACE MILLISECONDS NAME..."
                .into(),
        ),
    }
}

fn open(interface: &str) -> Done<Network> {
    let stop = Stop::on_signals()?;
    Ok(Opening::new(Access::Cyclic)
        .on(interface)
        .stopped_by(stop)
        .open()?)
}

fn report(event: &Value) {
    println!("{event}");
}

fn take(session: &mut Session, name: &str, lease: Duration, may_run_on: bool) -> Done<Axis> {
    let mut drive = session.find(&name.parse()?).wait()?;
    let settings = AxisSettings {
        lease,
        may_run_on,
        ..AxisSettings::for_purpose(Purpose::Speed)
    };
    Ok(session.take_axis(&mut drive, settings).wait()?)
}

fn turning(axis: &mut Axis) -> Result<Enabled<'_>, Error> {
    let mut enabled = axis.enable().wait()?;
    enabled.reach_speed(SPEED, None).wait()?;
    Ok(enabled)
}

/// How far all axes have come.
#[derive(Debug, Default)]
struct Course {
    turning: AtomicUsize,
    ended: AtomicUsize,
    answered: AtomicUsize,
    stopped_at: OnceLock<NetworkTime>,
}

impl Course {
    /// Keeps the speed until so many were counted.
    fn keep_until(enabled: &mut Enabled<'_>, count: &AtomicUsize, enough: usize) -> Done<()> {
        let begin = Instant::now();
        while count.load(Ordering::SeqCst) < enough {
            if begin.elapsed() > LIMIT {
                return Err("the other axes do not come up or do not end".into());
            }
            enabled.keep_speed(SPEED, SECOND / 20).wait()?;
        }
        Ok(())
    }
}

fn ends(interface: &str, names: &[&str]) -> Done<ExitCode> {
    let network = open(interface)?;
    let course = Arc::new(Course::default());
    let (handle_sender, handles) = mpsc::channel();
    let callers: Vec<_> = (0..names.len())
        .map(|number| {
            let (session, name) = (network.clone(), names[number].to_owned());
            let (course, handle_sender, axes) = (Arc::clone(&course), handle_sender.clone(), names.len());
            thread::spawn(move || caller(session, &name, (number, axes), &course, &handle_sender))
        })
        .collect();
    drop(handle_sender);
    let handle = handles.recv_timeout(LIMIT)?;
    let readers = stop_among_readers(&network, names[3], &handle, &course)?;
    // this process and the other axes go on until the drives themselves report all four ends
    for (name, end) in names.iter().zip(SPECIAL) {
        wait_for_rest(&mut network.clone(), name, end)?;
        course.ended.fetch_add(1, Ordering::SeqCst);
    }
    for (number, caller) in callers.into_iter().enumerate() {
        match caller.join() {
            Ok(end) => end.map_err(|error| format!("{}: {error}", names[number]))?,
            Err(_) => report(&json!({"axis": names[number], "end": "panicked"})),
        }
    }
    let count = readers.len();
    let refused = readers.into_iter().filter_map(|reader| reader.join().ok());
    let refused: Vec<String> = refused.flatten().collect();
    report(
        &json!({"readers": count, "answered": course.answered.load(Ordering::SeqCst), "refused": refused}),
    );
    drop(network);
    Ok(ExitCode::SUCCESS)
}

/// One caller with one axis.
fn caller(
    mut session: Caller,
    name: &str,
    (number, axes): (usize, usize),
    course: &Course,
    handle_sender: &mpsc::Sender<StopHandle>,
) -> Done<()> {
    // the lease stops only the axis that its owner abandoned
    let lease = if number == 2 { SECOND } else { LIMIT };
    // this program is not killed: drives as delivered will do
    let mut axis = take(&mut session, name, lease, true)?;
    let mut enabled = turning(&mut axis)?;
    course.turning.fetch_add(1, Ordering::SeqCst);
    Course::keep_until(&mut enabled, &course.turning, axes)?;
    match number {
        0 => {
            drop(enabled);
            drop(axis);
        }
        1 => panic!("the caller of {name} fails"),
        2 => {
            std::mem::forget(enabled);
            std::mem::forget(axis);
        }
        3 => {
            let mut samples = enabled.samples(100_000);
            handle_sender.send(enabled.stop_handle())?;
            let error = enabled.hold(LIMIT).wait();
            let Err(Error::Axis {
                trouble: Trouble::Stopped,
                ..
            }) = error
            else {
                return Err(format!("not stopped by its handle: {error:?}").into());
            };
            drop(enabled);
            axis.release().wait()?;
            let stopped_at = *course.stopped_at.get().ok_or("not stopped by this program")?;
            report(&json!({"axis": name, "ramp_after_ms": ramp_after(&mut samples, stopped_at)}));
        }
        _ => {
            let mut samples = enabled.samples(100_000);
            Course::keep_until(&mut enabled, &course.ended, SPECIAL.len())?;
            let course = judged(&mut samples);
            drop(enabled);
            axis.release().wait()?;
            report(&json!({"axis": name, "end": "released", "course": course}));
        }
    }
    Ok(())
}

/// Returns the verdict of the cyclic samples on an axis that kept its speed.
fn judged(samples: &mut Samples) -> Value {
    let (mut count, mut off, mut farthest) = (0, 0, 0.0_f64);
    let mut span = None;
    while let Some(sample) = samples.take() {
        count += 1;
        off += u32::from(!sample.seen.zsw1.has(Zsw1::OPERATION_ENABLED));
        let set = f64::from(sample.command.nsoll_a);
        let actual = sample.seen.nist_a.map_or(0.0, f64::from);
        farthest = farthest.max((actual - set).abs() / set.abs());
        let (first, _) = span.unwrap_or((sample.at, sample.at));
        span = Some((first, sample.at));
    }
    let seconds = span.map(|(first, last)| (last - first).as_secs_f64());
    json!({"samples": count, "dropped": samples.dropped(), "out_of_operation": off, "farthest": farthest, "seconds": seconds})
}

/// Returns the time from the stop to the first input with a speed that is lower by [`RAMP`], in milliseconds.
fn ramp_after(samples: &mut Samples, stopped_at: NetworkTime) -> Option<f64> {
    let mut before = None;
    while let Some(sample) = samples.take() {
        let speed = sample.seen.nist_a.map(f64::from)?;
        if sample.at <= stopped_at {
            before = Some(speed);
        } else if speed < before? * (1.0 - RAMP) {
            return Some((sample.at - stopped_at).as_secs_f64() * 1000.0);
        }
    }
    None
}

/// Stops the axis of a drive once a thousand callers wait for an answer of it.
fn stop_among_readers(
    network: &Caller,
    name: &str,
    handle: &StopHandle,
    course: &Arc<Course>,
) -> Done<Vec<thread::JoinHandle<Option<String>>>> {
    let mut session = network.clone();
    let drive = session.find(&name.parse()?).wait()?;
    let selection = drive.select("3-41")?;
    let waiting = |readers: &Vec<_>| readers.len() - course.answered.load(Ordering::SeqCst);
    let mut readers = Vec::new();
    while waiting(&readers) < WAITING {
        if readers.len() == READERS {
            return Err(format!("of {READERS} callers only {} wait", waiting(&readers)).into());
        }
        let (mut session, mut drive) = (session.clone(), drive.clone());
        let (selection, course) = (selection, Arc::clone(course));
        let mut call = Box::pin(async move { session.read_one(&mut drive, &selection).await });
        // the first poll hands the job to the engine
        if call
            .as_mut()
            .poll(&mut Context::from_waker(Waker::noop()))
            .is_ready()
        {
            return Err("an answer without an exchange".into());
        }
        let reader = thread::Builder::new().stack_size(STACK).spawn(move || {
            let answer = call.wait();
            course.answered.fetch_add(1, Ordering::SeqCst);
            answer.err().map(|error| error.to_string())
        })?;
        readers.push(reader);
    }
    let now = network.now();
    course.stopped_at.set(now).map_err(|_| "stopped twice")?;
    handle.stop();
    report(&json!({"axis": name, "waiting": waiting(&readers)}));
    Ok(readers)
}

/// Waits until the drive itself reports that its axis stands out of operation and without a controller.
fn wait_for_rest(session: &mut Session, name: &str, end: &str) -> Done<()> {
    let begin = Instant::now();
    let mut drive = session.find(&name.parse()?).wait()?;
    loop {
        let status = session.status(&mut drive).wait()?;
        let off = status.zsw1.is_some_and(|zsw1| !zsw1.has(Zsw1::OPERATION_ENABLED));
        let stands = status.speed_actual.is_some_and(|speed| speed.abs() < STANDSTILL);
        // an owner that is stopped by its lease keeps its connection
        let released = status.controller == Some(None) || end == "lease";
        if off && stands && released {
            report(&json!({"axis": name, "end": end}));
            return Ok(());
        }
        if begin.elapsed() > LIMIT {
            return Err(format!("{name} is not at rest ({end}): {status:?}").into());
        }
    }
}

fn run_until(how: &str, interface: &str, time: Duration, names: &[&str]) -> Done<ExitCode> {
    let mut network = open(interface)?;
    let may_run_on = how == "consent";
    report(&json!({"opened": names.len()}));
    let turning = Arc::new(AtomicUsize::new(0));
    let callers: Vec<_> = (0..names.len())
        .map(|number| {
            let (session, name) = (network.clone(), names[number].to_owned());
            let turning = Arc::clone(&turning);
            thread::spawn(move || run(session, &name, may_run_on, &turning))
        })
        .collect();
    if !["wait", "consent"].contains(&how) {
        network.pass(time).wait()?;
        report(&json!({"end": how, "turning": turning.load(Ordering::SeqCst)}));
        match how {
            "panic" => panic!("main fails"),
            "abort" => std::process::abort(),
            _ => return Ok(ExitCode::SUCCESS),
        }
    }
    for (number, caller) in callers.into_iter().enumerate() {
        let error = caller.join().map_err(|_| "a caller panicked")?;
        let error = error.err().ok_or("an axis ended without a signal")?;
        if !matches!(error.downcast_ref::<Error>(), Some(Error::Interrupted)) {
            return Err(format!("{}: {error}", names[number]).into());
        }
    }
    drop(network);
    Ok(ExitCode::from(INTERRUPTED))
}

/// Turns an axis until something ends it.
fn run(mut session: Caller, name: &str, may_run_on: bool, turning_axes: &AtomicUsize) -> Done<()> {
    let mut axis = take(&mut session, name, AxisSettings::default().lease, may_run_on)?;
    let mut enabled = turning(&mut axis)?;
    turning_axes.fetch_add(1, Ordering::SeqCst);
    report(&json!({"axis": name, "turning": turning_axes.load(Ordering::SeqCst)}));
    loop {
        enabled.keep_speed(SPEED, SECOND).wait()?;
    }
}
