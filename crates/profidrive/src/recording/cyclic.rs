//! A drive whose cyclic data are recorded.

use std::time::Duration;

use client::axis::{AxisSignal, Sample};
use client::{Axis, Error, ErrorKind, Samples};
use profinet::Instant;

use super::producer::{Place, Producer};
use super::source::{Observed, chosen, column_of};
use super::table::{Column, Kind, Table, Value};

/// Samples of one drive that wait to be taken: some four seconds of the shortest cycle.
pub(super) const WAITING: usize = 4096;
/// How often waiting samples are taken. They are stamped when they arrive.
const TAKEN: Duration = Duration::from_millis(20);
/// How long a drive that was lost is left alone before it is tried again.
const AGAIN: Duration = Duration::from_secs(1);

/// Records the cyclic data of a drive until the recording ends. A drive that was lost is connected to again.
pub(super) async fn observe(
    mut producer: Producer,
    observed: Observed,
    names: Vec<String>,
    table: Table,
) -> Result<(), Error> {
    let Observed {
        mut axis,
        mut signals,
        settings,
    } = observed;
    let mut drive = axis.drive().clone();
    loop {
        let lost = record(&mut producer, &mut axis, &signals).await;
        let since = producer.session.now();
        // its end says nothing new about a connection that is lost
        let released = axis.release().await;
        match lost {
            Ok(true) => {}
            Ok(false) => return released,
            Err(error) => return Err(error),
        }
        producer.gap(since, 0).await;
        producer.silent(since);
        producer.flush().await;
        let mut due = since + AGAIN;
        axis = loop {
            if !producer.wait_until(due).await? {
                return Ok(());
            }
            match producer.session.take_axis(&mut drive, settings).await {
                Ok(axis) => break axis,
                Err(Error::Interrupted) => return Ok(()),
                Err(error) if is_passing(&error) => due = producer.session.now() + AGAIN,
                // another controller has it now
                Err(error) => return Err(error),
            }
        };
        // the drive may have another telegram since
        signals = chosen(&axis, &names).unwrap_or_default();
        let columns: Vec<Column> = signals.iter().map(column_of).collect();
        producer.wire(&table, &columns);
        let now = producer.session.now();
        producer.answers(now, since);
        let cycles = (now - since).as_nanos() / axis.cycle().as_nanos().max(1);
        producer.missed(u64::try_from(cycles).unwrap_or(u64::MAX));
    }
}

/// Whether a drive that could not be connected to may be there later. One that another controller has meanwhile, or that is
/// in operation, is left alone.
fn is_passing(error: &Error) -> bool {
    let others = matches!(error, Error::OwnedByController { .. });
    !others && matches!(error.kind(), ErrorKind::Unreachable | ErrorKind::Lost)
}

/// Sends the samples of a connection until the recording ends (false) or it is lost (true).
async fn record(producer: &mut Producer, axis: &mut Axis, signals: &[AxisSignal]) -> Result<bool, Error> {
    let mut samples = axis.samples(WAITING);
    let mut last = None;
    loop {
        // looked at first: what came before the loss is recorded
        let lost = axis.status().is_none_or(|status| status.lost);
        send(producer, &mut samples, signals, axis.cycle(), &mut last).await;
        if lost {
            return Ok(true);
        }
        let due = producer.session.now() + TAKEN;
        if !producer.wait_until(due).await? {
            send(producer, &mut samples, signals, axis.cycle(), &mut last).await;
            return Ok(false);
        }
    }
}

/// When a sample came, its number, and how many had been lost until then.
pub(super) type Last = Option<(Instant, u64, u64)>;

async fn send(
    producer: &mut Producer,
    samples: &mut Samples,
    signals: &[AxisSignal],
    cycle: Duration,
    last: &mut Last,
) {
    while let Some(sample) = samples.take() {
        let missing = missing(last, &sample);
        if let Some((at, ..)) = *last {
            producer.lost_cycles(at + cycle, cycle, missing).await;
        }
        *last = Some((sample.at, sample.number, sample.missed));
        let value = |place: &Place, kind: Kind| value_of(signals.get(place.at)?, &sample, kind);
        let (fault, warning) = (sample.seen.fault(), sample.seen.warning());
        producer.row(sample.at, fault, warning, value).await;
    }
    producer.flush().await;
}

/// Returns the cycles between two samples that have none: lost on the network, or dropped because they were not taken in time.
pub(super) fn missing(last: &Last, sample: &Sample) -> u64 {
    last.map_or(0, |(_, number, missed)| {
        let lost = sample.missed.saturating_sub(missed);
        let dropped = sample.number.saturating_sub(number).saturating_sub(1);
        lost + dropped
    })
}

/// Returns the value of a signal in a sample.
pub(super) fn value_of(signal: &AxisSignal, sample: &Sample, kind: Kind) -> Option<Value> {
    let raw = signal.raw(sample)?;
    kind.of(match signal.engineering(raw) {
        Some(value) => Value::Number(value),
        None => Value::Integer(raw),
    })
}
