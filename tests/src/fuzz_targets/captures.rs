//! Recorded traffic: the files, and what `decode` says about them.

use std::time::Duration;

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

/// What `decode` says about a capture whose frames may be anybody's: one note at most in a bounded number of octets, and
/// the same capture always gives the same words.
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
    let notes = profidrive_cli::decode_frames(frames.iter().copied());
    let length: usize = notes.iter().map(String::len).sum();
    assert!(
        length <= 4096 + 200 * data.len(),
        "{length} octets of notes for {}",
        data.len()
    );
    assert_eq!(notes, profidrive_cli::decode_frames(frames));
}

/// What `decode --hex` says about octets: for every make, bounded, and the same every time.
pub fn octets(data: &[u8]) {
    let told = profidrive_cli::decode_octets(data);
    let length: usize = told.iter().map(String::len).sum();
    assert!(
        length <= 32_768 + 400 * data.len(),
        "{length} octets for {}",
        data.len()
    );
    assert_eq!(told, profidrive_cli::decode_octets(data));
}
