//! Recorded traffic: the files, and the output of `decode` for them.

use std::time::Duration;

use dissect::capture::{Event, Walker};
use dissect::octets::{self, Kind};
use profile::model::Model;
use uss::Protocol;

use super::steps::{Step, Steps};

/// Capture files, damaged ones included: bounded in what they make us hold, and they end.
pub fn pcap(data: &[u8]) {
    let Ok(reader) = network::pcap::Reader::new(std::io::Cursor::new(data.to_vec())) else {
        return;
    };
    let mut frames = 0;
    for captured in reader {
        let Ok(captured) = captured else { break };
        assert!(captured.frame.len() <= data.len());
        frames += 1;
        assert!(frames <= data.len(), "more frames than octets");
    }
}

/// Runs `decode` on a capture with arbitrary frames: at most one note per bounded number of octets, and the same
/// capture always gives the same text.
pub fn capture(data: &[u8]) {
    let mut now = Duration::ZERO;
    let mut frames = Vec::new();
    for step in Steps(data) {
        match step {
            Step::Frame(frame) | Step::Datagram(frame) => frames.push((now, frame)),
            Step::Wait(time) => now += time,
        }
    }
    frames.push((now, data));
    let notes = walked(&frames);
    let length: usize = notes.iter().map(|event| event.text.len()).sum();
    assert!(
        length <= 4096 + 200 * data.len(),
        "{length} octets of notes for {}",
        data.len()
    );
    assert_eq!(notes, walked(&frames));
}

fn walked(frames: &[(Duration, &[u8])]) -> Vec<Event> {
    let mut walker = Walker::default();
    let mut events = Vec::new();
    for (at, frame) in frames {
        events.extend(walker.frame(*at, frame));
        let tree = walker.tree(frame);
        assert!(tree.end == frame.len() && tree.path(frame.len()).is_empty());
    }
    events.extend(walker.end());
    events
}

/// Output of `decode --hex`: bounded and reproducible for every model.
pub fn octets(data: &[u8]) {
    let lines = explained(data);
    let length: usize = lines.iter().map(String::len).sum();
    assert!(
        length <= 32_768 + 400 * data.len(),
        "{length} octets for {}",
        data.len()
    );
    assert_eq!(lines, explained(data));
}

/// As everything that they may be, from every model.
fn explained(data: &[u8]) -> Vec<String> {
    let mut lines = Vec::new();
    for model in Model::names().filter_map(Model::by_name) {
        let rows = model.catalogue.map_or(&[][..], |tables| tables.device.telegrams);
        let telegrams = rows.iter().map(|row| Kind::Telegram(row.telegram));
        let kinds = [
            Kind::Job(None),
            Kind::Pkw,
            Kind::Serial(Protocol::Fc),
            Kind::Serial(Protocol::Uss),
        ];
        for kind in kinds.into_iter().chain(telegrams) {
            let decoded = octets::decode(kind, data, Some(model), None, None);
            lines.extend(decoded.into_iter().flat_map(|decoded| decoded.lines));
        }
    }
    lines.into_iter().map(|(_, line)| line).collect()
}
