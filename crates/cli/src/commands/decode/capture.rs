//! `profidrive decode FILE`, `-` for standard input, or `-i IFACE` for what is on the wire now.

use std::fs::File;
use std::io::stdin;
use std::path::Path;
use std::time::Duration;

use client::ErrorKind;
use dissect::Weight;
use dissect::capture::{Counts, DeviceSummary, Event, StreamSummary, Walker, seconds};
use dissect::report::DecodeReport;
use indicatif::ProgressBar;
use network::ethernet::Capture;
use network::pcap::{ReadError, Reader};
use network::system::Stop;

use super::painted;
use crate::args::{Decode, Only};
use crate::failure::Failure;
use crate::output::{Output, bytes};

/// Decodes a capture file, or what comes through standard input.
pub fn file(path: &Path, args: &Decode, output: &Output) -> Result<(), Failure> {
    if path.as_os_str() == "-" {
        let source = Reader::new(stdin()).map_err(|error| unreadable("standard input", &error))?;
        return decode(
            source,
            "standard input",
            None,
            &ProgressBar::hidden(),
            args,
            output,
        );
    }
    let shown = path.display().to_string();
    let open = || -> Result<(Reader, u64), Failure> {
        let file = File::open(path).map_err(|error| unreadable(&shown, &error))?;
        let size = file.metadata().map_or(0, |data| data.len());
        let reader = Reader::new(file).map_err(|error| unreadable(&shown, &error))?;
        Ok((reader, size))
    };
    // a name may appear only after the first frames of its station
    let known = match args.station {
        Some(_) => Some(names(open()?.0, args)),
        None => None,
    };
    let (source, size) = open()?;
    let bar = progress(size, output);
    decode(source, &shown, known, &bar, args, output)
}

fn unreadable(shown: &str, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(ErrorKind::Local, format!("cannot read {shown}: {error}"))
}

/// Reads a whole capture for the names of its stations.
fn names(source: Reader, args: &Decode) -> Walker {
    let mut walker = Walker::new(args.model.model);
    let mut clock = Clock::default();
    for captured in source {
        let Ok(captured) = captured else { break };
        walker.frame(clock.since_start(captured.time), &captured.frame);
    }
    walker
}

/// Time since the first frame.
#[derive(Debug, Default)]
struct Clock(Option<Duration>);

impl Clock {
    fn since_start(&mut self, time: Duration) -> Duration {
        time.saturating_sub(*self.0.get_or_insert(time))
    }
}

fn decode(
    source: Reader,
    shown: &str,
    known: Option<Walker>,
    bar: &ProgressBar,
    args: &Decode,
    output: &Output,
) -> Result<(), Failure> {
    let mut session = Session::new(args, known, output);
    let mut damage: Option<ReadError> = None;
    for captured in source {
        let captured = match captured {
            Ok(captured) => captured,
            Err(error) => {
                damage = Some(error);
                break;
            }
        };
        bar.inc(captured.frame.len() as u64 + 32);
        if !session.frame(captured.time, &captured.frame, bar) || output.is_closed() {
            break;
        }
    }
    let damage = damage.map(|damage| damage.to_string());
    session.end(damage.as_deref(), bar);
    match damage {
        Some(damage) => Err(Failure::new(ErrorKind::Local, format!("{shown}: {damage}"))
            .hint("what is printed above comes from the sound part before it")),
        None => Ok(()),
    }
}

/// Decodes what is on the wire until Ctrl-C, or for the time of --until.
pub fn live(interface: &str, args: &Decode, output: &Output) -> Result<(), Failure> {
    let failed = |error: network::system::Error| {
        let failure = Failure::new(ErrorKind::Unreachable, error.to_string());
        match error.hint() {
            Some(hint) => failure.hint(hint),
            None => failure,
        }
    };
    let stop = Stop::on_signals()
        .map_err(|error| Failure::new(ErrorKind::Internal, format!("cannot watch for Ctrl-C: {error}")))?;
    let mut capture = Capture::open(interface, stop.clone()).map_err(failed)?;
    output.say(&format!(
        "capturing on {interface}; Ctrl-C ends and prints the summary"
    ));
    let mut session = Session::new(args, None, output);
    let bar = ProgressBar::hidden();
    let result = loop {
        let wait = Duration::from_millis(200);
        match capture.next(wait) {
            Ok(Some((time, frame))) => {
                let goes_on = session.frame(time, frame, &bar);
                if !goes_on || stop.is_stopped() || output.is_closed() {
                    break Ok(());
                }
            }
            Ok(None) if stop.is_stopped() || output.is_closed() || session.is_over(wait) => break Ok(()),
            Ok(None) => {}
            Err(error) => break Err(failed(error)),
        }
    };
    session.end(None, &bar);
    let missed = capture.missed();
    if missed > 0 {
        output.warn(&format!(
            "{missed} frames were not captured: this computer was too slow"
        ));
    }
    result
}

/// One pass over frames: which events are printed, and the summary at the end.
struct Session<'a> {
    walker: Walker,
    /// The names of all of the capture, where it was read before.
    known: Option<Walker>,
    args: &'a Decode,
    output: &'a Output,
    clock: Clock,
    /// Time without frames, of a live capture.
    idle: Duration,
    now: Duration,
    began: bool,
    /// An event of the station that was requested was seen, printed or not.
    met: bool,
}

impl<'a> Session<'a> {
    fn new(args: &'a Decode, known: Option<Walker>, output: &'a Output) -> Self {
        Self {
            walker: Walker::new(args.model.model),
            known,
            args,
            output,
            clock: Clock::default(),
            idle: Duration::ZERO,
            now: Duration::ZERO,
            began: args.since.is_none(),
            met: false,
        }
    }

    /// Looks at a frame; false when it is behind the time of --until.
    fn frame(&mut self, time: Duration, frame: &[u8], bar: &ProgressBar) -> bool {
        let at = self.clock.since_start(time);
        self.now = at;
        self.idle = Duration::ZERO;
        if self.args.until.is_some_and(|until| at > until) {
            return false;
        }
        if !self.began && self.args.since.is_some_and(|since| at >= since) {
            self.began = true;
            self.walker.restart_summary();
        }
        let events = self.walker.frame(at, frame);
        self.print(&events, bar);
        true
    }

    /// Counts time without a frame; true when the time of --until has passed.
    fn is_over(&mut self, waited: Duration) -> bool {
        self.idle += waited;
        self.args.until.is_some_and(|until| self.now + self.idle > until)
    }

    fn end(&mut self, damage: Option<&str>, bar: &ProgressBar) {
        // what waits for an answer when --until cuts the capture is not without one
        if self.args.until.is_none() {
            let events = self.walker.end();
            self.print(&events, bar);
        }
        bar.finish_and_clear();
        let mut devices = self.walker.summary();
        if let Some(wanted) = &self.args.station {
            devices.retain(|device| device.is(wanted));
            if devices.is_empty() && !self.met {
                self.output
                    .warn(&format!("no frame is from, to or about {wanted}"));
            }
        }
        summary(&devices, self.walker.counts(), damage, self.output);
    }

    fn print(&mut self, events: &[Event], bar: &ProgressBar) {
        for event in events {
            if !self.is_of_drive(event) {
                continue;
            }
            self.met = true;
            if self.wants(event) {
                bar.suspend(|| print(event, self.output));
            }
        }
    }

    /// Returns true for an event of the station that was requested, or of any station without such a wish.
    fn is_of_drive(&self, event: &Event) -> bool {
        self.args.station.as_ref().is_none_or(|wanted| {
            let mut walkers = std::iter::once(&self.walker).chain(&self.known);
            walkers.any(|walker| walker.is_about(event, wanted))
        })
    }

    fn wants(&self, event: &Event) -> bool {
        self.args.since.is_none_or(|since| event.at >= since)
            && (self.args.only != Some(Only::Trouble) || event.is_trouble())
    }
}

fn progress(size: u64, output: &Output) -> ProgressBar {
    // a terminal that shows the events needs no bar between them
    if size < 4_000_000 || output.live() {
        return ProgressBar::hidden();
    }
    bytes(output, size)
}

fn print(event: &Event, output: &Output) {
    if output.json() {
        output.json_event(&DecodeReport::Event(event));
    } else {
        output.line(&line(event, output));
    }
}

fn line(event: &Event, output: &Output) -> String {
    let who = if event.to.is_empty() {
        event.from.clone()
    } else {
        format!("{} > {}", event.from, event.to)
    };
    let mark = match event.weight {
        Weight::Normal => " ",
        Weight::Warning => "!",
        Weight::Error => "#",
    };
    let text = painted(
        event.weight,
        &format!("{mark} {:<9} {}", event.topic, event.text),
        output,
    );
    format!("{:>7} {:>12} {who:<40} {text}", event.frame, time(event.at))
}

fn time(at: Duration) -> String {
    format!("{}.{:06}", at.as_secs(), at.subsec_micros())
}

/// What was seen: for each device how regular its frames are, and the numbers of frames.
fn summary(devices: &[DeviceSummary], counts: Counts, damage: Option<&str>, output: &Output) {
    if output.json() {
        for data in devices {
            let kind = "summary";
            output.json_event(&DecodeReport::Device { kind, data });
        }
        output.json_event(&DecodeReport::End {
            kind: "end",
            end: true,
            counts,
            damage,
        });
        return;
    }
    for device in devices {
        device_lines(device, output);
    }
    output.say(&counts_text(counts));
}

/// One line for a device and one for each direction of its cyclic data.
fn device_lines(device: &DeviceSummary, output: &Output) {
    let mut text = device.device.clone();
    if let Some(ip) = device.ip.filter(|ip| ip.to_string() != device.device) {
        text = format!("{text} ({ip})");
    }
    for (count, one, many) in [
        (device.restarts, "restart", "restarts"),
        (device.connection_losses, "connection lost", "connections lost"),
        (device.alarms, "alarm", "alarms"),
        (device.faults, "fault", "faults"),
    ] {
        let what = if count == 1 { one } else { many };
        text = format!("{text}, {count} {what}");
    }
    output.line(&text);
    for stream in &device.streams {
        output.line(&format!("  {}", stream_text(stream)));
    }
}

fn stream_text(stream: &StreamSummary) -> String {
    let jitter = match (stream.jitter_p50, stream.jitter_p99) {
        (Some(half), Some(most)) => format!("jitter p50 {}, p99 {}", seconds(half), seconds(most)),
        _ => "jitter not measured".into(),
    };
    let repeated = if stream.repeated > 0 {
        format!(", {} repeated or late", stream.repeated)
    } else {
        String::new()
    };
    format!(
        "{} > {}: {} frames every {}, {jitter}, {} lost{repeated}, longest gap {}",
        stream.from,
        stream.to,
        stream.frames,
        seconds(stream.cycle),
        stream.lost,
        seconds(stream.longest_gap)
    )
}

fn counts_text(counts: Counts) -> String {
    let mut text = format!(
        "{} frames: {} cyclic, {} DCP, {} RPC packets, {} alarm frames",
        counts.frames,
        counts.cyclic + counts.cyclic_unknown,
        counts.dcp,
        counts.rpc,
        counts.alarms
    );
    if counts.cyclic_unknown > 0 {
        text = format!(
            "{text}; {} cyclic frames of connections that began earlier",
            counts.cyclic_unknown
        );
    }
    if counts.malformed > 0 {
        text = format!("{text}; {} malformed", counts.malformed);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_microseconds() {
        assert_eq!(time(Duration::from_micros(1_000_031)), "1.000031");
    }
}
