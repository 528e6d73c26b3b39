//! `profidrive decode FILE`, `-` for standard input, or `-i IFACE` for what is on the wire now.

use std::fs::File;
use std::io::stdin;
use std::path::Path;
use std::time::Duration;

use client::ErrorKind;
use dissect::Weight;
use dissect::capture::{
    Counts, DeviceSummary, Event, Selection, StreamSummary, Summary, View, Walker, seconds,
};
use dissect::report::DecodeReport;
use dissect::tree::Node;
use indicatif::ProgressBar;
use network::ethernet::{Capture, Captured};
use network::pcap::{ReadError, Reader};
use network::system::Stop;
use profidrive::documents::traffic::KeptTraffic;
use profidrive::lasting;

use super::painted;
use crate::args::{Decode, Only};
use crate::failure::Failure;
use crate::output::{Output, bytes};

/// Decodes a capture file, or what comes through standard input.
pub fn file(path: &Path, args: &Decode, output: &Output) -> Result<(), Failure> {
    if let Some(number) = args.frame {
        return frame(path, number, args, output);
    }
    if path.as_os_str() == "-" {
        let source = Reader::new(stdin()).map_err(|error| unreadable("standard input", &error))?;
        return decode(
            source,
            "standard input",
            view(args),
            &ProgressBar::hidden(),
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
    let mut view = view(args);
    if args.station.is_some() {
        view = view.with_names(open()?.0.map_while(|captured| Some(captured.ok()?.frame)));
    }
    let (source, size) = open()?;
    decode(source, &shown, view, &progress(size, output), output)
}

/// Prints one frame with its fields. What the frames before it show is known then.
fn frame(path: &Path, number: u64, args: &Decode, output: &Output) -> Result<(), Failure> {
    let shown = path.display().to_string();
    let source = if path.as_os_str() == "-" {
        Reader::new(stdin()).map_err(|error| unreadable("standard input", &error))?
    } else {
        let file = File::open(path).map_err(|error| unreadable(&shown, &error))?;
        Reader::new(file).map_err(|error| unreadable(&shown, &error))?
    };
    let mut walker = Walker::new(args.model.model);
    let mut first = None;
    for captured in source {
        let captured = captured.map_err(|error| unreadable(&shown, &error))?;
        let at = captured.time.saturating_sub(*first.get_or_insert(captured.time));
        let events = walker.frame(at, &captured.frame);
        if walker.counts().frames < number {
            continue;
        }
        let events: Vec<Event> = events.into_iter().filter(|event| event.frame == number).collect();
        let tree = walker.tree(&captured.frame);
        output.json_report(&DecodeReport::Frame {
            kind: "frame",
            events: &events,
            tree: &tree,
        });
        if !output.json() {
            print(&events, &ProgressBar::hidden(), output);
            node(&tree, 0, output);
        }
        return Ok(());
    }
    let frames = walker.counts().frames;
    Err(Failure::usage(format!(
        "{shown} has {frames} frames, none has the number {number}"
    )))
}

/// Prints a node and its children: octets, name, value.
fn node(node: &Node, depth: usize, output: &Output) {
    let name = format!("{:indent$}{}", "", node.name, indent = 2 * depth);
    let places = match node.octets().len() {
        0 | 1 => format!("{:>4}     ", node.start),
        _ => format!("{:>4}-{:<4}", node.start, node.end - 1),
    };
    let line = format!("{places} {name:<44} {}", node.value);
    output.line(&painted(node.weight, line.trim_end(), output));
    for child in &node.children {
        self::node(child, depth + 1, output);
    }
}

fn view(args: &Decode) -> View {
    let selection = Selection {
        station: args.station.clone(),
        only_trouble: args.only == Some(Only::Trouble),
        since: args.since,
        until: args.until,
    };
    View::new(args.model.model, selection)
}

fn unreadable(shown: &str, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(ErrorKind::Local, format!("cannot read {shown}: {error}"))
}

fn decode(
    source: Reader,
    shown: &str,
    mut view: View,
    bar: &ProgressBar,
    output: &Output,
) -> Result<(), Failure> {
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
        let Some(events) = view.frame(captured.time, &captured.frame) else {
            break;
        };
        print(&events, bar, output);
        if output.is_closed() {
            break;
        }
    }
    let damage = damage.map(|damage| damage.to_string());
    end(view, damage.as_deref(), bar, output);
    match damage {
        Some(damage) => Err(Failure::new(ErrorKind::Local, format!("{shown}: {damage}"))
            .hint("what is printed above comes from the part before the damage")),
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
    let mut view = view(args);
    let mut kept = args.keep.map(|time| keep(interface, time, output)).transpose()?;
    let bar = ProgressBar::hidden();
    let result = loop {
        let wait = Duration::from_millis(200);
        match capture.next(wait) {
            Ok(Some(Captured {
                time,
                frame,
                after_gap,
                ..
            })) => {
                if after_gap {
                    view.skip_to(time);
                }
                if let Some(Err(error)) = kept.as_mut().map(|kept| kept.write(time, frame)) {
                    output.warn(&format!("no more traffic is kept: {error}"));
                    kept = None;
                }
                let Some(events) = view.frame(time, frame) else {
                    break Ok(());
                };
                print(&events, &bar, output);
                if stop.is_stopped() || output.is_closed() {
                    break Ok(());
                }
            }
            Ok(None) if stop.is_stopped() || output.is_closed() || view.waited(wait) => break Ok(()),
            Ok(None) => {}
            Err(error) => break Err(failed(error)),
        }
    };
    end(view, None, &bar, output);
    let missed = capture.missed();
    if missed > 0 {
        output.warn(&format!(
            "{missed} frames were not captured: this computer was too slow"
        ));
    }
    result
}

/// Keeps the last traffic for `bundle`.
fn keep(interface: &str, time: Duration, output: &Output) -> Result<KeptTraffic, Failure> {
    let state = profidrive::state_folder().ok_or_else(|| {
        Failure::new(ErrorKind::Local, "there is no folder for the traffic to keep")
            .hint("the variable HOME or XDG_STATE_HOME names it")
    })?;
    let kept = KeptTraffic::begin(&state, interface, time)?;
    output.say(&format!(
        "keeps the last {} in {}; `profidrive bundle` adds them",
        lasting(time),
        kept.folder().display()
    ));
    Ok(kept)
}

fn end(mut view: View, damage: Option<&str>, bar: &ProgressBar, output: &Output) {
    print(&view.end(), bar, output);
    bar.finish_and_clear();
    let Summary {
        devices,
        counts,
        missing,
    } = view.summary();
    if let Some(station) = missing {
        output.warn(&format!("no frame is from, to or about {station}"));
    }
    summary(&devices, counts, damage, output);
}

fn progress(size: u64, output: &Output) -> ProgressBar {
    // a terminal that shows the events needs no bar between them
    if size < 4_000_000 || output.live() {
        return ProgressBar::hidden();
    }
    bytes(output, size)
}

fn print(events: &[Event], bar: &ProgressBar, output: &Output) {
    for event in events {
        bar.suspend(|| {
            if output.json() {
                output.json_event(&DecodeReport::Event(event));
            } else {
                output.line(&line(event, output));
            }
        });
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
