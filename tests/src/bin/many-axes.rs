//! A program of the library with many axes at once on a real network: one thread for each axis, blocking calls.
//!
//! - `many-axes ends INTERFACE NAME...`: all axes turn; the first is dropped, the caller of the second panics, the third is
//!   forgotten, the fourth is stopped by its handle while 1,000 reads wait for its drive. The others keep their speed
//!   meanwhile and are released at the end. One JSON object a line says what happened.
//! - `many-axes wait|panic|return INTERFACE MILLISECONDS NAME...`: all axes turn. After this time, counted from the opening
//!   of the network, main panics or returns; `wait` goes on until a signal and exits with 130.
#![forbid(unsafe_code)]

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use client::axis::{Purpose, Trouble};
use client::{Axis, AxisSettings, Enabled, Error, Samples, Session, StopHandle};
use profidrive::{Access, Network, Opening, Stop, Wait};
use profile::state::Zsw1;
use serde_json::{Value, json};

const SPEED: f64 = 300.0;
const SECOND: Duration = Duration::from_secs(1);
/// Everything is over by then.
const LIMIT: Duration = Duration::from_secs(60);
/// Callers that read parameters of one drive at once.
const READERS: usize = 1000;
/// Stack of one of them.
const STACK: usize = 256 * 1024;
/// Axes that do not end by their release.
const SPECIAL: usize = 4;
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
        [how @ ("wait" | "panic" | "return"), interface, time, names @ ..] => {
            let time = Duration::from_millis(time.parse()?);
            run_until(how, interface, time, names)
        }
        _ => Err("ends INTERFACE NAME..., or wait|panic|return INTERFACE MILLISECONDS NAME...".into()),
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

fn take(session: &mut Session, name: &str, lease: Duration) -> Done<Axis> {
    let mut drive = session.find(&name.parse()?).wait()?;
    let settings = AxisSettings {
        lease,
        // the ends of this program are what the tests are about, on drives as delivered too
        may_run_on: true,
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
    wait_for_lease(&mut network.clone(), names[2])?;
    course.ended.fetch_add(1, Ordering::SeqCst);
    for (number, caller) in callers.into_iter().enumerate() {
        match caller.join() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(format!("{}: {error}", names[number]).into()),
            Err(_) => report(&json!({"axis": names[number], "end": "panic"})),
        }
    }
    let refused = readers.into_iter().filter_map(|reader| reader.join().ok());
    let refused: Vec<String> = refused.flatten().collect();
    report(&json!({"answered": course.answered.load(Ordering::SeqCst), "refused": refused}));
    drop(network);
    Ok(ExitCode::SUCCESS)
}

/// One caller with one axis.
fn caller(
    mut session: Session,
    name: &str,
    (number, axes): (usize, usize),
    course: &Course,
    handle_sender: &mpsc::Sender<StopHandle>,
) -> Done<()> {
    // the lease stops only the axis that its owner abandoned
    let lease = if number == 2 { SECOND } else { LIMIT };
    let mut axis = take(&mut session, name, lease)?;
    let mut enabled = turning(&mut axis)?;
    course.turning.fetch_add(1, Ordering::SeqCst);
    Course::keep_until(&mut enabled, &course.turning, axes)?;
    match number {
        0 => {
            drop(enabled);
            drop(axis);
            report(&json!({"axis": name, "end": "dropped"}));
        }
        1 => {
            course.ended.fetch_add(1, Ordering::SeqCst);
            panic!("the caller of {name} fails");
        }
        2 => {
            std::mem::forget(enabled);
            std::mem::forget(axis);
            report(&json!({"axis": name, "end": "forgotten"}));
            // counted by main, when the lease has stopped it
            return Ok(());
        }
        3 => {
            handle_sender.send(enabled.stop_handle())?;
            let error = enabled.hold(LIMIT).wait();
            let waiting = READERS - course.answered.load(Ordering::SeqCst);
            let Err(Error::Axis {
                trouble: Trouble::Stopped,
                ..
            }) = error
            else {
                return Err(format!("not stopped by its handle: {error:?}").into());
            };
            drop(enabled);
            axis.release().wait()?;
            report(&json!({"axis": name, "end": "stopped", "waiting": waiting}));
        }
        _ => {
            let mut samples = enabled.samples(100_000);
            Course::keep_until(&mut enabled, &course.ended, SPECIAL)?;
            let course = judged(&mut samples);
            drop(enabled);
            axis.release().wait()?;
            report(&json!({"axis": name, "end": "released", "course": course}));
            return Ok(());
        }
    }
    course.ended.fetch_add(1, Ordering::SeqCst);
    Ok(())
}

/// Returns the verdict of the cyclic samples on an axis that kept its speed.
fn judged(samples: &mut Samples) -> Value {
    let (mut count, mut off, mut farthest) = (0, 0, 0.0_f64);
    let mut span = None;
    while let Some(sample) = samples.take() {
        count += 1;
        off += u32::from(!sample.seen.zsw1.has(Zsw1::OPERATION_ENABLED));
        if let Some(actual) = sample.seen.nist_a {
            let set = f64::from(sample.command.nsoll_a);
            farthest = farthest.max((f64::from(actual) - set).abs() / set.abs());
        }
        let (first, _) = span.unwrap_or((sample.at, sample.at));
        span = Some((first, sample.at));
    }
    let seconds = span.map(|(first, last)| (last - first).as_secs_f64());
    json!({"samples": count, "dropped": samples.dropped(), "out_of_operation": off, "farthest": farthest, "seconds": seconds})
}

/// Stops the axis of a drive once a thousand callers wait for an answer of it.
fn stop_among_readers(
    network: &Session,
    name: &str,
    handle: &StopHandle,
    course: &Arc<Course>,
) -> Done<Vec<thread::JoinHandle<Option<String>>>> {
    let mut session = network.clone();
    let drive = session.find(&name.parse()?).wait()?;
    let selection = drive.select("3-41")?;
    let begun = Arc::new(AtomicUsize::new(0));
    let mut readers = Vec::new();
    for _ in 0..READERS {
        let (mut session, mut drive) = (session.clone(), drive.clone());
        let (begun, course) = (Arc::clone(&begun), Arc::clone(course));
        let reader = thread::Builder::new().stack_size(STACK).spawn(move || {
            begun.fetch_add(1, Ordering::SeqCst);
            let answer = session.read_one(&mut drive, &selection).wait();
            course.answered.fetch_add(1, Ordering::SeqCst);
            answer.err().map(|error| error.to_string())
        })?;
        readers.push(reader);
    }
    while begun.load(Ordering::SeqCst) < READERS {
        thread::yield_now();
    }
    handle.stop();
    Ok(readers)
}

/// Waits until a drive without an owner stands out of operation.
fn wait_for_lease(session: &mut Session, name: &str) -> Done<()> {
    let begin = Instant::now();
    let mut drive = session.find(&name.parse()?).wait()?;
    loop {
        let status = session.status(&mut drive).wait()?;
        let operates = status.zsw1.is_none_or(|zsw1| zsw1.has(Zsw1::OPERATION_ENABLED));
        if !operates {
            report(&json!({"axis": name, "end": "lease"}));
            return Ok(());
        }
        if begin.elapsed() > LIMIT {
            return Err(format!("{name}: its lease does not end").into());
        }
    }
}

fn run_until(how: &str, interface: &str, time: Duration, names: &[&str]) -> Done<ExitCode> {
    let mut network = open(interface)?;
    report(&json!({"opened": names.len()}));
    let turning = Arc::new(AtomicUsize::new(0));
    let callers: Vec<_> = (0..names.len())
        .map(|number| {
            let (session, name) = (network.clone(), names[number].to_owned());
            let turning = Arc::clone(&turning);
            thread::spawn(move || run(session, &name, &turning))
        })
        .collect();
    if how != "wait" {
        network.pass(time).wait()?;
        report(&json!({"end": how, "turning": turning.load(Ordering::SeqCst)}));
        assert!(how != "panic", "main fails");
        return Ok(ExitCode::SUCCESS);
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
fn run(mut session: Session, name: &str, turning_axes: &AtomicUsize) -> Done<()> {
    let mut axis = take(&mut session, name, AxisSettings::default().lease)?;
    let mut enabled = turning(&mut axis)?;
    turning_axes.fetch_add(1, Ordering::SeqCst);
    report(&json!({"axis": name, "turning": turning_axes.load(Ordering::SeqCst)}));
    loop {
        enabled.keep_speed(SPEED, SECOND).wait()?;
    }
}
