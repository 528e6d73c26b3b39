//! A drive whose cyclic data are recorded.

use std::time::Duration;

use client::axis::{AxisSignal, Sample, Seen};
use client::{Axis, Drive, Error, Samples, Session};

use super::error::RecordingError;
use super::producer::{Absence, Away, Place, Producer};
use super::source::{Observed, same_signals};
use super::table::{Column, Kind, Value};

/// Samples of one drive that are buffered: about four seconds of the shortest cycle.
pub(super) const WAITING: usize = 4096;
/// Interval at which buffered samples are read. Their time stamps are those of their arrival. Each look wakes two threads, which costs
/// as much as a cycle of the connection.
const TAKEN: Duration = Duration::from_millis(50);
/// Time between two attempts to connect to a drive that was lost or is in use.
const AGAIN: Duration = Duration::from_secs(1);

/// Records the cyclic data of a drive until the recording ends. A drive that was lost is connected to again. The connection of a
/// drive that is in use is closed until it is at rest, where that does not stop its motor.
pub(super) async fn observe(
    producer: &mut Producer,
    observed: Observed,
    columns: &[Column],
) -> Result<(), RecordingError> {
    let Observed {
        mut axis,
        mut signals,
        settings,
    } = observed;
    let mut drive = axis.drive().clone();
    let mut samples = axis.samples(WAITING);
    loop {
        let mut last = None;
        let end = record(producer, &mut axis, &mut samples, &signals, &mut last).await;
        if matches!(end, Ok(End::Recording)) {
            wait_for_rest(producer, &mut axis, &mut samples).await;
        }
        // a connection is found lost long after its last frame
        let since = match (&end, last) {
            (Ok(End::Drive(Absence::Silent)), Some(last)) => last.at + axis.cycle(),
            _ => producer.session.now(),
        };
        // of a connection that is lost, the result of the release has no information
        let released = axis.release().await;
        let absence = match end? {
            End::Recording => return Ok(released?),
            End::Drive(absence) => absence,
        };
        let mut away: Option<Away> = None;
        producer.gap(since, 0).await;
        producer.away(&mut away, since, absence);
        axis = loop {
            producer.flush().await;
            let wait = away.as_mut().map_or(AGAIN, |away| away.wait(AGAIN));
            let due = producer.session.now() + wait;
            if !producer.wait_until(due).await? {
                return Ok(());
            }
            match producer.session.take_axis(&mut drive, settings).await {
                Ok(axis) => break axis,
                Err(Error::Interrupted) => return Ok(()),
                Err(error) => match Absence::of(&error) {
                    Some(absence) => producer.away(&mut away, since, absence),
                    None => return Err(error.into()),
                },
            }
            // a drive that was lost would not receive a release
            producer.session.forget(&drive);
        };
        // the drive may have another telegram since
        signals = match same_signals(&axis, columns) {
            Ok(signals) => signals,
            Err(error) => {
                let _ = axis.release().await;
                return Err(error);
            }
        };
        samples = axis.samples(WAITING);
        let cycles = (producer.session.now() - since).as_nanos() / axis.cycle().as_nanos().max(1);
        producer.missed(u64::try_from(cycles).unwrap_or(u64::MAX));
        producer.back(&mut drive, since).await;
    }
}

/// Keeps the connection of a recording that has ended until its end does not stop the motor, or the caller insists. A first wish to
/// stop is the normal end of a recording without a time, and does not end the wait.
async fn wait_for_rest(producer: &mut Producer, axis: &mut Axis, samples: &mut Samples) {
    let mut reported = false;
    let mut seen = axis.status().and_then(|status| status.view.seen);
    loop {
        let lost = axis.status().is_none_or(|status| status.lost);
        let stays = seen.is_some_and(|seen| matches!(use_of(seen, axis), Use::Stay));
        let insists = producer.is_stopped_at_once() || producer.session.hurry_requested();
        if lost || !stays || insists {
            return;
        }
        if !reported {
            reported = true;
            producer.waits(axis.loss_reaction());
            producer.flush().await;
        }
        let session = &mut producer.session;
        let passed = session.uninterrupted(async |session: &mut Session| session.pass(TAKEN).await);
        if passed.await.is_err() {
            return;
        }
        while let Some(sample) = samples.take() {
            seen = Some(sample.seen);
        }
    }
}

/// How the recording of a connection ends.
enum End {
    /// The recording ended.
    Recording,
    /// The drive is not recorded for a while.
    Drive(Absence),
}

/// Sends the samples of a connection until the recording ends, the connection is lost or the drive is in use.
async fn record(
    producer: &mut Producer,
    axis: &mut Axis,
    samples: &mut Samples,
    signals: &[AxisSignal],
    last: &mut Last,
) -> Result<End, Error> {
    let drive = axis.drive().clone();
    let mut noticed = false;
    loop {
        // read before the samples, so that all samples before the loss are recorded
        let lost = axis.status().is_none_or(|status| status.lost);
        let seen = send(producer, &drive, (samples, axis.cycle()), signals, last).await;
        if lost {
            return Ok(End::Drive(Absence::Silent));
        }
        match seen.map(|seen| use_of(seen, axis)) {
            Some(Use::Leave) => return Ok(End::Drive(Absence::InUse)),
            Some(Use::Stay) if !noticed => {
                noticed = true;
                producer.power_on(axis.loss_reaction());
                producer.flush().await;
            }
            Some(Use::None) => noticed = false,
            _ => {}
        }
        let due = producer.session.now() + TAKEN;
        if !producer.wait_until(due).await? {
            send(producer, &drive, (samples, axis.cycle()), signals, last).await;
            return Ok(End::Recording);
        }
    }
}

/// What the use of the drive means for the connection.
enum Use {
    /// At rest, and not operated.
    None,
    /// In use: the end of the connection does not disturb it now.
    Leave,
    /// The power stage is on, and the end of the connection would stop the motor.
    Stay,
}

/// Returns what to do about a drive that reports this. A drive reacts to the end of a connection while its power stage is on as to
/// a lost controller.
fn use_of(seen: Seen, axis: &Axis) -> Use {
    if seen.power_is_on() {
        if axis.loss_reaction().leaves_alone() {
            Use::Leave
        } else {
            Use::Stay
        }
    } else if seen.control_requested() {
        Use::None
    } else {
        // in local operation it can be started at any time
        Use::Leave
    }
}

/// The sample before.
pub(super) type Last = Option<Sample>;

/// Sends the buffered samples. Returns what the drive reported in the last one.
async fn send(
    producer: &mut Producer,
    drive: &Drive,
    (samples, cycle): (&mut Samples, Duration),
    signals: &[AxisSignal],
    last: &mut Last,
) -> Option<Seen> {
    let mut seen = None;
    while let Some(sample) = samples.take() {
        seen = Some(sample.seen);
        let missing = last.map_or(0, |before| sample.missing_since(&before));
        if let Some(before) = *last {
            producer.lost_cycles(before.at + cycle, cycle, missing).await;
        }
        *last = Some(sample);
        let value = |place: &Place, kind: Kind| value_of(signals.get(place.at)?, &sample, kind);
        let (fault, warning) = (sample.seen.fault(), sample.seen.warning());
        producer.note_fault(fault, drive).await;
        producer.row(sample.at, fault, warning, value).await;
    }
    producer.flush().await;
    seen
}

/// Returns the value of a signal in a sample.
pub(super) fn value_of(signal: &AxisSignal, sample: &Sample, kind: Kind) -> Option<Value> {
    let raw = signal.raw(sample)?;
    kind.of(match signal.engineering(raw) {
        Some(value) => Value::Number(value),
        None => Value::Integer(raw),
    })
}
