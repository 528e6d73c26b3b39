//! A drive whose parameters are read at an interval.

use std::time::Duration;

use client::{Drive, Error, Session, Snapshot};
use profile::value::{Reading, Selection};
use profinet::Instant;

use super::producer::{Absence, Away, Place, Producer};
use super::source::value_of;
use crate::monitor::SILENCE;
use crate::report::DriveWords;

/// Reads a drive until the recording ends. A drive that does not answer is tried again.
pub(super) async fn poll(
    producer: &mut Producer,
    mut drive: Drive,
    selections: Vec<Selection>,
    interval: Duration,
    words: bool,
) -> Result<(), Error> {
    let mut due = producer.session.now();
    let mut away: Option<Away> = None;
    while producer.wait_until(due).await? {
        let begun = due;
        match read(&mut producer.session, &mut drive, &selections, words).await {
            Ok((readings, state)) => {
                let at = producer.session.now();
                if away.is_none() && at - begun >= SILENCE {
                    // the answer came after all
                    producer.away(&mut away, begun, Absence::Silent);
                }
                let values = readings.into_iter().map(Result::ok);
                let values: Vec<Option<Reading>> = values.collect();
                let (fault, warning) = state;
                due = next(begun, interval, at);
                let missed = skipped(begun, interval, due);
                if missed > 0 {
                    producer.gap(begun + interval, missed).await;
                }
                let place = |place: &Place, kind| {
                    let reading = values.get(place.at)?.as_ref()?;
                    value_of(reading, kind)
                };
                producer.note_fault(fault, &drive).await;
                producer.row(at, fault, warning, place).await;
                if let Some(Away { since, .. }) = away.take() {
                    producer.back(&mut drive, since).await;
                }
            }
            Err(Error::Interrupted) => return Ok(()),
            Err(error) => {
                let Some(absence) = Absence::of(&error) else {
                    return Err(error);
                };
                let at = producer.session.now();
                let is_new = away.is_none();
                producer.away(&mut away, begun, absence);
                let wait = away.as_mut().map_or(interval, |away| away.wait(interval));
                due = next(begun, interval, at.max(begun + wait));
                let missed = 1 + skipped(begun, interval, due);
                if is_new {
                    producer.gap(begun, missed).await;
                } else {
                    producer.missed(missed);
                }
                // it would not receive a release
                producer.session.forget(&drive);
            }
        }
    }
    Ok(())
}

/// Reads the values; with `words` also whether the drive reports a fault and a warning.
async fn read(
    session: &mut Session,
    drive: &mut Drive,
    selections: &[Selection],
    words: bool,
) -> Result<(Vec<Result<Reading, client::Refusal>>, (bool, bool)), Error> {
    if !words {
        return Ok((session.read(drive, selections).await?, (false, false)));
    }
    let snapshot: Snapshot = session.snapshot(drive, selections).await?;
    let words = DriveWords::from(&snapshot);
    let state = (words.fault_bit == Some(true), words.warning_bit == Some(true));
    Ok((snapshot.readings, state))
}

/// Returns when the next reading is due after one that was due at `begun` and ended at `at`: at once where it took longer
/// than the interval.
fn next(begun: Instant, interval: Duration, at: Instant) -> Instant {
    let passed = (at - begun).as_nanos() / interval.as_nanos().max(1);
    let count = u32::try_from(passed).unwrap_or(u32::MAX).max(1);
    begun + interval * count
}

/// Returns how many readings that were due between two were not made.
fn skipped(begun: Instant, interval: Duration, next: Instant) -> u64 {
    let count = (next - begun).as_nanos() / interval.as_nanos().max(1);
    u64::try_from(count).unwrap_or(u64::MAX).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_stay_on_their_grid() {
        let at = Instant::from_millis;
        let interval = Duration::from_millis(10);
        for (end, due, missed) in [
            (100, 110, 0),
            (109, 110, 0),
            (115, 110, 0),
            (120, 120, 1),
            (139, 130, 2),
        ] {
            let next = next(at(100), interval, at(end));
            assert_eq!(
                (next, skipped(at(100), interval, next)),
                (at(due), missed),
                "{end}"
            );
        }
    }
}
