//! Cyclic data: only what changes.

use profidrive::catalogue::AKD;
use profinet::MacAddress;
use profinet::wire::block::{ConnectResponse, IocrType};
use profinet::wire::ethernet::Frame;
use profinet::wire::rt::{Cyclic, DataStatus, Iops};

use super::connect::Asked;
use super::{Sink, Weight};
use crate::render::{hex16, words};

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
    receiver: MacAddress,
    frame_id: u16,
    /// True from controller to device.
    output: bool,
    data_length: usize,
    /// Drive telegrams in it.
    drives: Vec<DriveData>,
    status: Option<DataStatus>,
}

/// Where the first word of a telegram is, and what it was.
#[derive(Debug)]
struct DriveData {
    slot: u16,
    offset: usize,
    length: usize,
    word: Option<u16>,
    provider: Option<Iops>,
}

impl Relations {
    /// Remembers the cyclic data of a connect that was accepted.
    pub fn open(&mut self, asked: &Asked, response: &ConnectResponse) {
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
            let receiver = if output {
                response.ar.responder_mac
            } else {
                ar.initiator_mac
            };
            let mut drives = Vec::new();
            for api in &request.apis {
                for object in &api.data {
                    let length = asked.data_length(api.api, object.slot, object.subslot, output);
                    if length >= 2 && (api.api == PROFIDRIVE || asked.is_telegram(object.slot)) {
                        let offset = object.offset.into();
                        drives.push(DriveData {
                            slot: object.slot,
                            offset,
                            length,
                            word: None,
                            provider: None,
                        });
                    }
                }
            }
            self.streams
                .retain(|stream| stream.receiver != receiver || stream.frame_id != frame_id);
            if self.streams.len() >= MAX_STREAMS {
                self.streams.remove(0);
            }
            let data_length = request.data_length.into();
            self.streams.push(Stream {
                receiver,
                frame_id,
                output,
                data_length,
                drives,
                status: None,
            });
        }
    }

    /// Looks at a cyclic frame; false if it belongs to no known connection.
    pub fn cyclic(&mut self, frame: &Frame<'_>, sink: &mut Sink<'_>) -> bool {
        let known =
            |stream: &Stream| stream.receiver == frame.destination && stream.frame_id == frame.frame_id.0;
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
            .find(|other| other.output && other.receiver == frame.source);
        let Some(cyclic) = Cyclic::parse(frame.payload, stream.data_length) else {
            return false;
        };
        let status = cyclic.trailer.data_status;
        if stream.status.is_none_or(|before| before != status) {
            note_status(stream.status, status, sink);
            stream.status = Some(status);
        }
        for drive in &mut stream.drives {
            let sent = opposite
                .and_then(|other| other.drives.iter().find(|sent| sent.slot == drive.slot))
                .and_then(|sent| sent.word);
            drive.look(cyclic.data, stream.output, sent, sink);
        }
        true
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
    /// `sent` is the control word on the way to the same slot.
    fn look(&mut self, data: &[u8], output: bool, sent: Option<u16>, sink: &mut Sink<'_>) {
        let Some([high, low]) = data.get(self.offset..).and_then(|rest| rest.first_chunk::<2>()) else {
            return;
        };
        let provider = data.get(self.offset + self.length).map(|&octet| Iops(octet));
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
        let word = u16::from_be_bytes([*high, *low]);
        if self.word != Some(word) && provider.is_none_or(Iops::is_good) {
            let (text, weight) = if output {
                stw1(self.word, word)
            } else {
                zsw1(self.word, word, sent)
            };
            sink.note(weight, "drive", text);
            self.word = Some(word);
        }
    }
}

fn change(name: &str, before: Option<u16>, word: u16) -> String {
    before.map_or_else(
        || format!("{name} {}", hex16(word)),
        |before| format!("{name} {} -> {}", hex16(before), hex16(word)),
    )
}

fn stw1(before: Option<u16>, word: u16) -> (String, Weight) {
    let set = words::set(words::stw1_bits(), word);
    (
        format!(
            "{} {} {set}",
            change("STW1", before, word),
            words::stw1_meaning(word)
        ),
        Weight::Normal,
    )
}

fn zsw1(before: Option<u16>, word: u16, sent: Option<u16>) -> (String, Weight) {
    let set = words::set(words::zsw1_bits(), word);
    let weight = match word {
        fault if words::has_fault(fault) => Weight::Error,
        warning if words::has_warning(warning) => Weight::Warning,
        _ => Weight::Normal,
    };
    (
        format!(
            "{} {} {set}",
            change("ZSW1", before, word),
            words::state(word, sent)
        ),
        weight,
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

    /// True when the module of a slot is a drive telegram that is known here.
    fn is_telegram(&self, slot: u16) -> bool {
        let mut modules = self
            .modules
            .iter()
            .filter(|module| module.slot == slot && slot > 0);
        modules.any(|module| AKD.device.telegram_of_module(module.ident).is_some())
    }
}
