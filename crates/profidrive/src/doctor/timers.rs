//! How late the timers of this computer are.

use std::time::Duration;

use client::Advice;
use futures::channel::oneshot;
use network::system::{Stop, lateness};

use crate::report::{Check, DoctorReport, Finding, Severity, TimerReport, Wording};

const PERIOD: Duration = Duration::from_millis(1);
const TIME: Duration = Duration::from_secs(2);

/// Measures in a thread of its own, beside everything else.
pub(super) fn start(stop: Option<Stop>) -> oneshot::Receiver<Vec<Duration>> {
    let (send, measured) = oneshot::channel();
    let measure = move || {
        let _ = send.send(lateness(PERIOD, TIME, stop.as_ref()));
    };
    // without a thread the channel is closed, and nothing was measured
    drop(std::thread::Builder::new().name("timers".into()).spawn(measure));
    measured
}

/// Returns the figures; `None` without a measurement.
fn figures(mut late: Vec<Duration>) -> Option<TimerReport> {
    late.sort_unstable();
    let at = |part: f64| {
        let index = (late.len() as f64 * part) as usize;
        late.get(index.min(late.len().saturating_sub(1)))
            .map(Duration::as_secs_f64)
    };
    Some(TimerReport {
        period: PERIOD.as_secs_f64(),
        count: late.len(),
        min: at(0.0)?,
        median: at(0.5)?,
        p99: at(0.99)?,
        max: at(1.0)?,
    })
}

pub(super) fn finish(late: Vec<Duration>, report: &mut DoctorReport, wording: &dyn Wording) {
    report.timers = figures(late);
    report.findings.push(judged(report.timers, wording));
}

/// Late timers make late frames: a drive with an update time of 4 ms and a watchdog of three gives up after 12 ms.
fn judged(timers: Option<TimerReport>, wording: &dyn Wording) -> Finding {
    let Some(timers) = timers else {
        return Finding::new(Check::Timers, Severity::Unchecked, "nothing could be measured");
    };
    let ms = |seconds: f64| format!("{:.2} ms", seconds * 1e3);
    let found = format!(
        "{} late in the median, {} of 99 %, {} at most ({} timers)",
        ms(timers.median),
        ms(timers.p99),
        ms(timers.max),
        timers.count
    );
    let severity = if timers.p99 >= 0.002 || timers.max >= 0.012 {
        Severity::Warning
    } else {
        Severity::Ok
    };
    let finding = Finding::new(Check::Timers, severity, found);
    if severity == Severity::Ok {
        return finding;
    }
    let advice =
        "end other programs, or use a longer update time and a watchdog of 100 ms or more: {choose cycle}";
    finding
        .because("a cyclic connection ends when this computer is late for longer than its watchdog")
        .remedied(&Advice::from(advice), wording)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::PlainWording;

    fn found(late: Vec<Duration>) -> (Severity, Option<TimerReport>) {
        let timers = figures(late);
        (judged(timers, &PlainWording).severity, timers)
    }

    #[test]
    fn figures_and_their_judgement() {
        assert_eq!(found(Vec::new()), (Severity::Unchecked, None));
        let ms = Duration::from_millis;
        let us = Duration::from_micros;
        let (severity, timers) = found((1..=100).rev().map(us).collect());
        let timers = timers.unwrap();
        assert_eq!(
            (timers.count, timers.min, timers.p99, timers.max),
            (100, 1e-6, 1e-4, 1e-4)
        );
        assert_eq!(severity, Severity::Ok);
        let once = |late: Duration| found([vec![us(50); 1999], vec![late]].concat()).0;
        assert_eq!(once(ms(11)), Severity::Ok);
        assert_eq!(once(ms(12)), Severity::Warning);
        assert_eq!(found(vec![ms(2); 10]).0, Severity::Warning);
    }
}
