//! Cyclic data: only what changes.

use std::net::Ipv4Addr;

use profidrive::pkw::Pkw;
use profidrive::telegram::Telegram;
use profinet::MacAddress;
use profinet::wire::Uuid;
use profinet::wire::block::{ConnectResponse, IocrType};
use profinet::wire::ethernet::Frame;
use profinet::wire::rt::{Cyclic, DataStatus, Iops};

use super::channel::Channel;
use super::connect::{self, Asked};
use super::names::Names;
use super::{Sink, Weight};
use crate::job::JobDrive;
use crate::job::telegram::Half;
use crate::render::hex16;

/// Most directions of connections followed at a time.
const MAX_STREAMS: usize = 1024;
/// The API of the drive profile.
const PROFIDRIVE: u32 = 0x3A00;

/// The cyclic connections of a capture.
#[derive(Debug, Default)]
pub struct Relations {
    streams: Vec<Stream>,
}

/// One direction of one connection.
#[derive(Debug)]
struct Stream {
    sender: MacAddress,
    receiver: MacAddress,
    frame_id: u16,
    /// True from controller to device.
    output: bool,
    data_length: usize,
    /// Address of the device.
    device: Ipv4Addr,
    /// Drive telegrams in it.
    drives: Vec<DriveData>,
    status: Option<DataStatus>,
    ar: Uuid,
    /// Released: what still comes tells nothing.
    closed: bool,
}

/// Where a telegram is, and what it was.
#[derive(Debug)]
struct DriveData {
    slot: u16,
    subslot: u16,
    offset: usize,
    length: usize,
    telegram: Option<&'static Telegram>,
    word: Option<u16>,
    speed: Speed,
    channel: Channel,
    provider: Option<Iops>,
}

/// What goes the other way to or from the same submodule.
#[derive(Debug, Clone, Copy, Default)]
struct Sent {
    word: Option<u16>,
    pkw: Pkw,
}

/// A speed that so many frames have said stays.
const SETTLED: u32 = 3;

/// What a frame is to a speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SpeedStep {
    /// The first with another one than that which stayed.
    Left,
    /// It has been the same for a while.
    Settled,
}

/// The speed as it was told last, and for how many frames it is what it is now.
#[derive(Debug, Default)]
struct Speed {
    told: Option<i64>,
    now: i64,
    frames: u32,
}

impl Relations {
    /// Remembers the cyclic data of a connect that was accepted.
    pub fn open(&mut self, asked: &Asked, response: &ConnectResponse, device: Ipv4Addr, drive: &JobDrive) {
        let Some(ar) = &asked.ar else { return };
        for (at, request) in asked.iocrs.iter().enumerate() {
            let output = request.iocr_type == IocrType::OUTPUT;
            let chosen = response
                .iocrs
                .iter()
                .find(|answer| answer.reference == request.reference);
            let frame_id = chosen
                .or_else(|| response.iocrs.get(at))
                .map_or(request.frame_id, |row| row.frame_id);
            let (controller, drive_mac) = (ar.initiator_mac, response.ar.responder_mac);
            let (sender, receiver) = if output {
                (controller, drive_mac)
            } else {
                (drive_mac, controller)
            };
            let mut drives = Vec::new();
            for api in &request.apis {
                for object in &api.data {
                    let length = asked.data_length(api.api, object.slot, object.subslot, output);
                    let telegram = asked.telegram(drive, object.slot);
                    if length >= 2 && (api.api == PROFIDRIVE || telegram.is_some()) {
                        drives.push(DriveData {
                            slot: object.slot,
                            subslot: object.subslot,
                            offset: object.offset.into(),
                            length,
                            telegram,
                            word: None,
                            speed: Speed::default(),
                            channel: Channel::default(),
                            provider: None,
                        });
                    }
                }
            }
            self.streams
                .retain(|stream| !stream.is_between(sender, receiver, frame_id));
            if self.streams.len() >= MAX_STREAMS {
                self.streams.remove(0);
            }
            let data_length = request.data_length.into();
            self.streams.push(Stream {
                sender,
                receiver,
                frame_id,
                output,
                data_length,
                device,
                drives,
                status: None,
                ar: ar.ar_uuid,
                closed: false,
            });
        }
    }

    /// A connection to a device was released.
    pub fn close(&mut self, device: Ipv4Addr, ar: Uuid) {
        for stream in &mut self.streams {
            stream.closed |= (stream.device, stream.ar) == (device, ar);
        }
    }

    /// Looks at a cyclic frame; false if it belongs to no known connection.
    pub fn cyclic(&mut self, frame: &Frame<'_>, names: &mut Names, sink: &mut Sink<'_>) -> bool {
        let known = |stream: &Stream| stream.is_between(frame.source, frame.destination, frame.frame_id.0);
        let Some(at) = self.streams.iter().position(known) else {
            return false;
        };
        // the stream and what is sent to the station it comes from
        let (before, rest) = self.streams.split_at_mut(at);
        let Some((stream, after)) = rest.split_first_mut() else {
            return false;
        };
        let opposite = before
            .iter()
            .chain(&*after)
            .find(|other| other.output && other.receiver == frame.source && !other.closed);
        if stream.closed {
            return true;
        }
        let Some(cyclic) = Cyclic::parse(frame.payload, stream.data_length) else {
            return false;
        };
        let status = cyclic.trailer.data_status;
        if stream.status.is_none_or(|before| before != status) {
            note_status(stream.status, status, sink);
            stream.status = Some(status);
        }
        let drive = names.drives.at(stream.device);
        for data in &mut stream.drives {
            let same = |sent: &&DriveData| (sent.slot, sent.subslot) == (data.slot, data.subslot);
            let sent = opposite
                .and_then(|other| other.drives.iter().find(same))
                .map_or_else(Sent::default, |sent| Sent {
                    word: sent.word,
                    pkw: sent.channel.last,
                });
            data.look(drive, cyclic.data, stream.output, sent, sink);
        }
        true
    }
}

impl Stream {
    fn is_between(&self, sender: MacAddress, receiver: MacAddress, frame_id: u16) -> bool {
        (self.sender, self.receiver, self.frame_id) == (sender, receiver, frame_id)
    }
}

fn note_status(before: Option<DataStatus>, status: DataStatus, sink: &mut Sink<'_>) {
    let weight = if status.is_valid() && status.is_run() && !status.has_problem() {
        Weight::Normal
    } else {
        Weight::Warning
    };
    let text = format!(
        "{} cyclic data: {}, {}{}",
        if before.is_none() { "first" } else { "now" },
        if status.is_run() { "RUN" } else { "STOP" },
        if status.is_valid() { "valid" } else { "not valid" },
        if status.has_problem() {
            ", station reports a problem"
        } else {
            ""
        },
    );
    sink.note(weight, "cyclic", text);
}

impl DriveData {
    fn look(&mut self, drive: &mut JobDrive, data: &[u8], output: bool, sent: Sent, sink: &mut Sink<'_>) {
        let Some(rest) = data.get(self.offset..) else {
            return;
        };
        let provider = rest.get(self.length).map(|&octet| Iops(octet));
        if provider != self.provider {
            if let Some(provider) = provider.filter(|provider| !provider.is_good()) {
                sink.note(
                    Weight::Warning,
                    "cyclic",
                    format!("slot {}: data marked bad ({provider})", self.slot),
                );
            } else if self.provider.is_some() {
                sink.note(Weight::Normal, "cyclic", format!("slot {}: data good", self.slot));
            }
            self.provider = provider;
        }
        let Some(data) = rest.get(..self.length) else {
            return;
        };
        if !provider.is_none_or(Iops::is_good) {
            return;
        }
        let half = Half {
            drive,
            telegram: self.telegram,
            output,
        };
        let pkw = half.pkw(data);
        self.tell_word(half, data, sent, sink);
        if let Some(pkw) = pkw {
            self.channel.look(drive, pkw, output, sent.pkw, sink);
        }
    }

    fn tell_word(&mut self, half: Half<'_>, data: &[u8], sent: Sent, sink: &mut Sink<'_>) {
        let speed = half.speed(data);
        let step = speed.and_then(|speed| self.speed.look(speed));
        let Some(word) = half.word(data) else { return };
        // a new speed is told with the next word; a setpoint also when it leaves one that stayed, and, after a ramp of
        // many, once it stays again
        let tell_speed = speed.filter(|speed| self.speed.told.unwrap_or(0) != *speed);
        let words = tell_speed.map(|speed| format!("{} {}", half.speed_name(), half.speed_text(speed)));
        if self.word != Some(word) {
            let first = self.word.is_none();
            let (weight, text) = half.word_text(word, sent.word);
            let mut text = format!("{} {text}", change(half.word_name(), self.word, word));
            if let Some(words) = words {
                text = format!("{text}; {words}");
                self.speed.told = speed;
            }
            if let Some(assumed) = half.drive.assumed_words(self.telegram).filter(|_| first) {
                text = format!("{text}; the names of the bits are right if {assumed}");
            }
            sink.note(weight, "drive", text);
            self.word = Some(word);
        } else if let (Some(words), Some(step)) = (words.filter(|_| half.output), step) {
            let text = match step {
                SpeedStep::Left => words,
                SpeedStep::Settled => format!("{words}, the same for {SETTLED} frames"),
            };
            sink.note(Weight::Normal, "drive", text);
            self.speed.told = speed;
        }
    }
}

impl Speed {
    /// What this frame is to the speed, where it is worth a line.
    const fn look(&mut self, speed: i64) -> Option<SpeedStep> {
        let stayed = self.frames >= SETTLED;
        if speed != self.now {
            self.now = speed;
            self.frames = 1;
            return if stayed { Some(SpeedStep::Left) } else { None };
        }
        self.frames = self.frames.saturating_add(1);
        if self.frames == SETTLED {
            Some(SpeedStep::Settled)
        } else {
            None
        }
    }
}

fn change(name: &str, before: Option<u16>, word: u16) -> String {
    before.map_or_else(
        || format!("{name} {}", hex16(word)),
        |before| format!("{name} {} -> {}", hex16(before), hex16(word)),
    )
}

impl Asked {
    /// Octets of a submodule in one direction.
    fn data_length(&self, api: u32, slot: u16, subslot: u16, output: bool) -> usize {
        let modules = self
            .modules
            .iter()
            .filter(|module| module.api == api && module.slot == slot);
        let submodule = modules
            .flat_map(|module| &module.submodules)
            .find(|submodule| submodule.subslot == subslot);
        submodule.map_or(0, |found| {
            if output {
                found.output_length()
            } else {
                found.input_length()
            }
            .into()
        })
    }

    /// The telegram of a slot.
    fn telegram(&self, drive: &JobDrive, slot: u16) -> Option<&'static Telegram> {
        let mut modules = self.modules.iter().filter(|module| module.slot == slot);
        modules.find_map(|module| connect::telegram(drive, module))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTROLLER: MacAddress = MacAddress([2, 0, 0, 0, 0, 1]);

    fn device(last: u8) -> (MacAddress, Ipv4Addr) {
        (MacAddress([2, 0, 0, 0, 0, last]), Ipv4Addr::new(10, 0, 0, last))
    }

    /// Inputs of a device with the identifiers that every device of this controller has.
    fn stream(last: u8) -> Stream {
        let (sender, device) = device(last);
        Stream {
            sender,
            receiver: CONTROLLER,
            frame_id: 0x8000,
            output: false,
            data_length: 40,
            device,
            drives: Vec::new(),
            status: None,
            ar: Uuid([7; 16]),
            closed: false,
        }
    }

    #[test]
    fn a_setpoint_is_told_in_the_frame_that_changes_it() {
        let mut speed = Speed::default();
        let steps: Vec<_> = [0, 0, 0, 164, 164, 164, 164, 170, 180, 190, 190, 190]
            .into_iter()
            .map(|now| speed.look(now))
            .collect();
        let (left, settled) = (Some(SpeedStep::Left), Some(SpeedStep::Settled));
        let ramp = [left, None, None, None, settled];
        assert_eq!(steps[..7], [None, None, settled, left, None, settled, None]);
        assert_eq!(steps[7..], ramp);
    }

    #[test]
    fn frames_belong_to_their_sender_and_to_nobody_after_the_release() {
        let mut relations = Relations {
            streams: vec![stream(2), stream(3)],
        };
        let mut names = Names::default();
        let mut payload = [0; 44];
        payload[42] = DataStatus::GOOD.0;
        let mut look = |relations: &mut Relations, last: u8| {
            let mut notes = Vec::new();
            let mut sink = Sink {
                at: std::time::Duration::ZERO,
                from: String::new(),
                to: String::new(),
                notes: &mut notes,
            };
            let frame = Frame {
                destination: CONTROLLER,
                source: device(last).0,
                tag: None,
                frame_id: profinet::wire::ethernet::FrameId(0x8000),
                payload: &payload,
            };
            let known = relations.cyclic(&frame, &mut names, &mut sink);
            (known, notes.len())
        };
        assert_eq!(look(&mut relations, 3), (true, 1), "its first data");
        assert_eq!(
            look(&mut relations, 2),
            (true, 1),
            "they are not those of the other"
        );
        assert_eq!(
            look(&mut relations, 4),
            (false, 0),
            "of nobody that was connected"
        );
        relations.close(device(2).1, Uuid([7; 16]));
        let closed = relations.streams.iter().map(|stream| stream.closed);
        assert_eq!(
            closed.collect::<Vec<_>>(),
            [true, false],
            "the same identifier, another device"
        );
        relations.streams[0].status = None;
        assert_eq!(look(&mut relations, 2), (true, 0));
    }
}
