//! Cyclic connections: only what changes, what is missing, and how regular the frames are.

use std::collections::BTreeMap;
use std::net::Ipv4Addr;
use std::time::Duration;

use profile::telegram::Telegram;
use profinet::MacAddress;
use profinet::wire::Uuid;
use profinet::wire::block::{ConnectResponse, IocrRequest, IocrType};
use profinet::wire::ethernet::Frame;
use profinet::wire::rt::{self, DataStatus};

use super::connect::{self, Asked};
use super::drive_data::{DriveData, DriveWords, Sent};
use super::drives::Drives;
use super::event::{Connect, Cyclic, Detail, Origin, Sink, Trouble};
use super::names::{Names, seconds};
use super::timing::{Step, Timing};
use crate::Weight;
use crate::job::JobDrive;

/// Topic of the events.
const TOPIC: &str = "cyclic";
/// Most directions of connections followed at a time.
const MAX_STREAMS: usize = 1024;
/// Most of them that began before the capture.
const MAX_EARLIER: usize = 256;
/// Most parts of the data of a connection that are stored: each has at least one octet of it.
const MAX_OBJECTS: usize = 1440;
/// Silence after which one of those makes room for another.
const GONE: Duration = Duration::from_secs(10);
/// The API of the drive profile.
const PROFIDRIVE: u32 = 0x3A00;
/// Frames after which a connection that began before the capture is described: its cycle is known then.
const DESCRIBE_AFTER: u64 = 3;
/// Interval of the check for streams that have stopped.
const LOOK: Duration = Duration::from_millis(20);
/// Least time between two reports of lost frames of a stream.
const REPORT: Duration = Duration::from_secs(1);
/// Silence of a connection whose watchdog is not known.
const SILENCE: Duration = Duration::from_millis(100);

/// The cyclic connections of a capture.
#[derive(Debug, Default)]
pub struct CyclicArs {
    streams: Vec<Stream>,
    /// Of connects that are not answered yet: devices send inputs before their answer is on the wire.
    announced: Vec<Stream>,
    tracks: BTreeMap<TrackKey, Track>,
    devices: BTreeMap<MacAddress, Device>,
    next_look: Duration,
}

/// Sender, receiver, and which one of the streams between them.
type TrackKey = (MacAddress, MacAddress, usize);

/// The frames of one direction, over all connects.
#[derive(Debug, Clone, Default)]
pub struct Track {
    /// From the controller to the device; `None` where no connect shows it.
    pub output: Option<bool>,
    /// The device; of a connection that began before the capture the sender.
    pub device: MacAddress,
    pub timing: Timing,
}

/// The connections of one device.
#[derive(Debug, Clone, Copy, Default)]
pub struct Device {
    /// Cyclic connections that were accepted.
    pub connects: u32,
    /// It had one when the capture began.
    pub earlier: bool,
    /// Times that its connection was silent for longer than the watchdog, or ended by an error PDU.
    pub losses: u32,
}

impl Device {
    /// Connections after the first one.
    pub const fn restarts(&self) -> u32 {
        (self.connects + self.earlier as u32).saturating_sub(1)
    }
}

/// To which connection a cyclic frame belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Belongs {
    /// Its connect is in the capture.
    Known,
    /// It began before the capture.
    Earlier,
}

/// A part of cyclic data: data of a submodule and its IOPS, or an IOCS.
#[derive(Debug, Clone, Copy)]
pub struct Object {
    pub slot: u16,
    pub subslot: u16,
    offset: usize,
    /// Octets of data in front of the status; 0 for an IOCS.
    pub length: usize,
    /// It is an IOCS.
    pub consumer: bool,
}

impl Object {
    /// Returns its octets in the data, the status included.
    pub const fn octets(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.length + 1
    }
}

/// One direction of one connection.
#[derive(Debug)]
pub struct Stream {
    sender: MacAddress,
    receiver: MacAddress,
    frame_id: u16,
    /// True from controller to device.
    output: bool,
    /// Octets of data; `None` for a connection that began before the capture.
    data_length: Option<usize>,
    cycle: Duration,
    watchdog: Duration,
    /// Address of the device.
    device: Ipv4Addr,
    /// Drive telegrams in it.
    drives: Vec<DriveData>,
    status: Option<DataStatus>,
    ar: Uuid,
    /// What is in the data.
    objects: Vec<Object>,
    /// Released: what still comes has no meaning.
    closed: bool,
    /// Its silence was reported, or its end by an error PDU.
    silent: bool,
    track: TrackKey,
    frames: u64,
    last: Origin,
    /// Frames lost and not reported, and when they were reported last.
    lost: u64,
    reported: Option<Duration>,
}

impl CyclicArs {
    /// Expects the cyclic data of a connect request.
    pub fn announce(&mut self, asked: &Asked, mac: MacAddress, device: Ipv4Addr, drive: &JobDrive) {
        let Some(ar) = &asked.ar else { return };
        self.announced.retain(|stream| stream.ar != ar.ar_uuid);
        for (nth, request) in asked.iocrs.iter().enumerate() {
            if self.announced.len() >= MAX_STREAMS {
                self.announced.remove(0);
            }
            let stream = Stream::new(asked, request, nth, request.frame_id, (mac, device), drive);
            self.announced.extend(stream);
        }
    }

    /// A connect was refused.
    pub fn withdraw(&mut self, ar: Uuid) {
        self.announced.retain(|stream| stream.ar != ar);
        self.streams.retain(|stream| stream.ar != ar);
    }

    /// Stores the cyclic data of an accepted connect.
    pub fn open(&mut self, asked: &Asked, response: &ConnectResponse, device: Ipv4Addr, drive: &JobDrive) {
        let Some(ar) = &asked.ar else { return };
        self.announced.retain(|stream| stream.ar != ar.ar_uuid);
        let mac = response.ar.responder_mac;
        if !asked.iocrs.is_empty() && (self.devices.len() < MAX_STREAMS || self.devices.contains_key(&mac)) {
            self.devices.entry(mac).or_default().connects += 1;
        }
        for (nth, request) in asked.iocrs.iter().enumerate() {
            let chosen = response
                .iocrs
                .iter()
                .find(|answer| answer.reference == request.reference);
            let frame_id = chosen
                .or_else(|| response.iocrs.get(nth))
                .map_or(request.frame_id, |row| row.frame_id);
            let Some(stream) = Stream::new(asked, request, nth, frame_id, (mac, device), drive) else {
                continue;
            };
            let same = |other: &Stream| other.is_between(stream.sender, stream.receiver, stream.frame_id);
            // its frames came before the answer
            if self
                .streams
                .iter()
                .any(|other| same(other) && other.ar == stream.ar)
            {
                continue;
            }
            self.streams.retain(|other| !same(other));
            self.push(stream);
        }
    }

    fn push(&mut self, stream: Stream) {
        if self.streams.len() >= MAX_STREAMS {
            let earlier = self
                .streams
                .iter()
                .position(|stream| stream.data_length.is_none());
            self.streams.remove(earlier.unwrap_or(0));
        }
        if self.tracks.len() < MAX_STREAMS || self.tracks.contains_key(&stream.track) {
            let track = self.tracks.entry(stream.track).or_default();
            if stream.data_length.is_some() {
                track.output = Some(stream.output);
            }
            track.device = stream.device_mac();
            track.timing.begin(stream.cycle);
        }
        self.streams.push(stream);
    }

    /// A connection to a device was released.
    pub fn close(&mut self, device: Ipv4Addr, ar: Uuid) {
        for stream in &mut self.streams {
            stream.closed |= (stream.device, stream.ar) == (device, ar);
        }
    }

    /// An error PDU ended the connection between two stations: it is lost, or it was released.
    pub fn aborted(&mut self, from: MacAddress, to: MacAddress, lost: bool) {
        for at in 0..self.streams.len() {
            let Some(stream) = self.streams.get_mut(at) else {
                break;
            };
            let between = [(from, to), (to, from)].contains(&(stream.sender, stream.receiver));
            if between && !stream.closed && !stream.silent {
                stream.silent = true;
                if lost {
                    self.count_loss(at);
                }
            }
        }
    }

    /// Counts the loss of a connection, once for all of its streams.
    fn count_loss(&mut self, at: usize) {
        let Some(stream) = self.streams.get(at) else {
            return;
        };
        let device = stream.device_mac();
        let mut others = self.streams.iter().enumerate().filter(|(other, _)| *other != at);
        let known =
            others.any(|(_, other)| other.silent && (other.ar, other.device_mac()) == (stream.ar, device));
        if let Some(device) = self.devices.get_mut(&device).filter(|_| !known) {
            device.losses += 1;
        }
    }

    /// Looks at a cyclic frame. `None` if there is no room for its connection.
    pub fn cyclic(&mut self, frame: &Frame<'_>, names: &mut Names, sink: &mut Sink<'_>) -> Option<Belongs> {
        let at = self.find(frame, sink.at)?;
        if self.streams.get_mut(at)?.note_gap(sink) {
            self.count_loss(at);
        }
        // the stream and what is sent to the station it comes from
        let (before, rest) = self.streams.split_at_mut(at);
        let (stream, after) = rest.split_first_mut()?;
        if stream.closed {
            return Some(Belongs::Known);
        }
        let (data, trailer) = match stream.data_length {
            Some(length) => rt::Cyclic::parse(frame.payload, length),
            None => rt::Cyclic::parse_to_end(frame.payload),
        }
        .map(|cyclic| (cyclic.data, cyclic.trailer))?;
        let step = match self.tracks.get_mut(&stream.track) {
            Some(track) => {
                let step = track.timing.add(sink.at, trailer.cycle_counter);
                stream.cycle = track.timing.cycle;
                step
            }
            None => Step::default(),
        };
        stream.frames += 1;
        stream.note_step(step, sink);
        stream.last = sink.origin();
        if stream.data_length.is_none() {
            if stream.frames == DESCRIBE_AFTER {
                stream.describe(data.len(), trailer.data_status, sink);
                stream.status = Some(trailer.data_status);
                if self.devices.len() < MAX_STREAMS {
                    self.devices.entry(stream.sender).or_default().earlier = true;
                }
            }
            if stream.frames < DESCRIBE_AFTER {
                return Some(Belongs::Earlier);
            }
        }
        let status = trailer.data_status;
        if stream.status != Some(status) {
            note_status(stream.status, status, sink);
            stream.status = Some(status);
        }
        if stream.data_length.is_none() {
            return Some(Belongs::Earlier);
        }
        let opposite = before
            .iter()
            .chain(&*after)
            .find(|other| other.output && other.receiver == frame.source && !other.closed);
        let drive = names.drives.at(stream.device);
        for data_of in &mut stream.drives {
            let same = |sent: &&DriveData| (sent.slot, sent.subslot) == (data_of.slot, data_of.subslot);
            let sent = opposite
                .and_then(|other| other.drives.iter().find(same))
                .map_or_else(Sent::default, DriveData::sent);
            data_of.look(drive, data, stream.output, sent, sink);
        }
        Some(Belongs::Known)
    }

    /// Returns the place of the stream of a frame: one that is open, one whose connect is not answered yet, one that
    /// was released, or a new one that began before the capture.
    fn find(&mut self, frame: &Frame<'_>, now: Duration) -> Option<usize> {
        let (source, destination, id) = (frame.source, frame.destination, frame.frame_id.0);
        let between = |stream: &Stream| stream.is_between(source, destination, id);
        let mut closed = None;
        for (at, stream) in self.streams.iter().enumerate() {
            if between(stream) {
                if !stream.closed {
                    return Some(at);
                }
                closed = Some(at);
            }
        }
        if let Some(at) = self.announced.iter().position(between) {
            let stream = self.announced.remove(at);
            self.streams.retain(|stream| !between(stream));
            self.push(stream);
            return Some(self.streams.len() - 1);
        }
        if closed.is_some() {
            return closed;
        }
        let is_earlier = |stream: &Stream| stream.data_length.is_none();
        if self.streams.iter().filter(|stream| is_earlier(stream)).count() >= MAX_EARLIER {
            let gone = |stream: &Stream| is_earlier(stream) && now.saturating_sub(stream.last.at) > GONE;
            let gone = self.streams.iter().position(gone)?;
            self.streams.remove(gone);
        }
        let same = |stream: &&Stream| {
            is_earlier(stream) && (stream.sender, stream.receiver) == (source, destination)
        };
        let nth = self.streams.iter().filter(same).count();
        let stream = Stream::earlier(source, destination, id, nth);
        self.push(stream);
        Some(self.streams.len() - 1)
    }

    /// Reports the streams without a frame for longer than their watchdog.
    pub fn look(&mut self, sink: &mut Sink<'_>) {
        if sink.at < self.next_look {
            return;
        }
        self.next_look = sink.at + LOOK;
        for at in 0..self.streams.len() {
            let Some(stream) = self.streams.get_mut(at) else {
                break;
            };
            let gap = sink.at.saturating_sub(stream.last.at);
            let described = stream.data_length.is_some() || stream.frames >= DESCRIBE_AFTER;
            if stream.frames > 0
                && described
                && !stream.silent
                && !stream.closed
                && gap > stream.silence_limit()
            {
                stream.note_silence(gap, sink);
                self.count_loss(at);
            }
        }
    }

    /// The same at the end of a capture.
    pub fn end(&mut self, sink: &mut Sink<'_>) {
        self.next_look = Duration::ZERO;
        self.look(sink);
    }

    /// Returns the stream of a frame that was looked at.
    pub fn stream(&self, frame: &Frame<'_>) -> Option<&Stream> {
        let (source, destination, id) = (frame.source, frame.destination, frame.frame_id.0);
        let mut of_frame = self
            .streams
            .iter()
            .filter(|stream| stream.is_between(source, destination, id));
        let first = of_frame.next()?;
        Some(of_frame.find(|_| first.closed).unwrap_or(first))
    }

    /// Returns the words of the first drive of a device, as its cyclic frames had them last; `None` without a connection.
    pub fn words(&self, device: MacAddress, drives: &Drives) -> Option<DriveWords> {
        let of_device = |stream: &&Stream| {
            stream.device_mac() == device && !stream.closed && !stream.silent && stream.frames > 0
        };
        let mut words: Option<DriveWords> = None;
        for stream in self.streams.iter().filter(of_device) {
            let Some(data_of) = stream.drives.first() else {
                continue;
            };
            let drive = drives.known(stream.device);
            let telegram = data_of.telegram();
            let words = words.get_or_insert_with(|| DriveWords {
                telegram: telegram.map(|telegram| telegram.number),
                profile: drive.words(telegram),
                mode: drive.mode_in(telegram),
                control: None,
                status: None,
            });
            let word = data_of.sent().word();
            if stream.output {
                words.control = word;
            } else {
                words.status = word;
            }
        }
        words
    }

    /// Returns the timing of the frames of each direction.
    pub fn tracks(&self) -> impl Iterator<Item = (&TrackKey, &Track)> {
        self.tracks.iter().filter(|(_, track)| track.timing.frames > 0)
    }

    /// Returns the connections of a device.
    pub fn device(&self, mac: MacAddress) -> Device {
        self.devices.get(&mac).copied().unwrap_or_default()
    }

    /// Frames before this time were not seen: that none came is not concluded from them.
    pub fn skip_to(&mut self, at: Duration) {
        for track in self.tracks.values_mut() {
            track.timing.skip();
        }
        for stream in &mut self.streams {
            stream.last.at = stream.last.at.max(at);
        }
    }

    /// Resets the measurements and keeps the connections.
    pub fn restart(&mut self) {
        for track in self.tracks.values_mut() {
            track.timing.reset();
        }
        for device in self.devices.values_mut() {
            device.earlier |= device.connects > 0;
            device.connects = 0;
            device.losses = 0;
        }
    }
}

impl Stream {
    /// One direction of a connect; `None` without an application relationship.
    fn new(
        asked: &Asked,
        request: &IocrRequest,
        nth: usize,
        frame_id: u16,
        (mac, device): (MacAddress, Ipv4Addr),
        drive: &JobDrive,
    ) -> Option<Self> {
        let ar = asked.ar.as_ref()?;
        let output = request.iocr_type == IocrType::OUTPUT;
        let (sender, receiver) = if output {
            (ar.initiator_mac, mac)
        } else {
            (mac, ar.initiator_mac)
        };
        let (mut drives, mut objects) = (Vec::new(), Vec::new());
        for api in &request.apis {
            let consumed = api.status.iter().map(|object| (object, true));
            let parts = api.data.iter().map(|object| (object, false)).chain(consumed);
            for (object, consumer) in parts.take(MAX_OBJECTS.saturating_sub(objects.len())) {
                let length = asked.data_length(api.api, object.slot, object.subslot, output);
                objects.push(Object {
                    slot: object.slot,
                    subslot: object.subslot,
                    offset: object.offset.into(),
                    length: if consumer { 0 } else { length },
                    consumer,
                });
            }
            for object in &api.data {
                let length = asked.data_length(api.api, object.slot, object.subslot, output);
                let telegram = asked.telegram(drive, object.slot);
                if length >= 2 && (api.api == PROFIDRIVE || telegram.is_some()) {
                    let place = (object.slot, object.subslot);
                    drives.push(DriveData::new(place, object.offset, length, telegram));
                }
            }
        }
        let cycle = connect::cycle(request);
        let before = asked.iocrs.iter().take(nth);
        let nth = before
            .filter(|other| other.iocr_type == request.iocr_type)
            .count();
        Some(Self {
            output,
            data_length: Some(request.data_length.into()),
            cycle,
            watchdog: cycle * u32::from(request.watchdog_factor),
            device,
            drives,
            objects,
            ar: ar.ar_uuid,
            ..Self::earlier(sender, receiver, frame_id, nth)
        })
    }

    /// Creates a stream of which only the frames are known.
    fn earlier(sender: MacAddress, receiver: MacAddress, frame_id: u16, nth: usize) -> Self {
        Self {
            sender,
            receiver,
            frame_id,
            output: false,
            data_length: None,
            cycle: Duration::ZERO,
            watchdog: Duration::ZERO,
            device: Ipv4Addr::UNSPECIFIED,
            drives: Vec::new(),
            status: None,
            ar: Uuid::NIL,
            objects: Vec::new(),
            closed: false,
            silent: false,
            track: (sender, receiver, nth),
            frames: 0,
            last: Origin::default(),
            lost: 0,
            reported: None,
        }
    }

    /// Returns the octets of data; `None` for a connection that began before the capture.
    pub const fn data_length(&self) -> Option<usize> {
        self.data_length
    }

    /// Returns what is in the data.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// Returns the address of the device.
    pub const fn device(&self) -> Ipv4Addr {
        self.device
    }

    /// Returns true from controller to device.
    pub const fn is_output(&self) -> bool {
        self.output
    }

    /// Returns the telegrams of drives in this data, each with its octets.
    pub fn telegrams<'d>(
        &self,
        data: &'d [u8],
    ) -> impl Iterator<Item = (Option<&'static Telegram>, &'d [u8])> {
        self.drives
            .iter()
            .filter_map(|drive| Some((drive.telegram(), data.get(drive.octets())?)))
    }

    /// Returns the device; of a connection that began before the capture the sender.
    const fn device_mac(&self) -> MacAddress {
        if self.output { self.receiver } else { self.sender }
    }

    fn is_between(&self, sender: MacAddress, receiver: MacAddress, frame_id: u16) -> bool {
        (self.sender, self.receiver, self.frame_id) == (sender, receiver, frame_id)
    }

    /// Returns the time without a frame that is reported.
    fn silence_limit(&self) -> Duration {
        if self.watchdog.is_zero() {
            SILENCE.max(3 * self.cycle)
        } else {
            self.watchdog
        }
    }

    /// Reports that this frame comes after the watchdog has expired, unless that was reported. True if it was not.
    fn note_gap(&mut self, sink: &mut Sink<'_>) -> bool {
        let gap = sink.at.saturating_sub(self.last.at);
        let late = self.frames > 0 && !self.cycle.is_zero() && gap > self.silence_limit();
        if !late || self.silent || self.closed {
            return false;
        }
        self.note_silence(gap, sink);
        true
    }

    /// Reports what is missing before a frame.
    fn note_step(&mut self, step: Step, sink: &mut Sink<'_>) {
        if std::mem::take(&mut self.silent) {
            self.lost = 0;
            return;
        }
        self.lost += step.lost;
        let recent = |before: Duration| sink.at.saturating_sub(before) < REPORT;
        if self.lost > 0 && !self.reported.is_some_and(recent) {
            let frames = std::mem::take(&mut self.lost);
            self.reported = Some(sink.at);
            let text = format!("{frames} cyclic frame{} lost", if frames == 1 { "" } else { "s" });
            sink.report(
                Weight::Warning,
                TOPIC,
                text,
                Detail::Trouble(Trouble::Lost { frames }),
            );
        }
    }

    fn note_silence(&mut self, gap: Duration, sink: &mut Sink<'_>) {
        self.silent = true;
        let limit = if self.watchdog.is_zero() {
            String::new()
        } else {
            format!(", watchdog {}", seconds(self.watchdog))
        };
        let text = format!(
            "no cyclic data for {} since frame {}{limit}",
            seconds(gap),
            self.last.frame
        );
        let trouble = Trouble::Silent {
            gap,
            watchdog: self.watchdog,
        };
        sink.report_of(self.last, Weight::Error, TOPIC, text, Detail::Trouble(trouble));
    }

    /// Describes a connection that began before the capture by its frames.
    fn describe(&self, octets: usize, status: DataStatus, sink: &mut Sink<'_>) {
        let text = format!(
            "connection that began before the capture: FrameID 0x{:04X}, at most {octets} octets of data every {}; {}",
            self.frame_id,
            seconds(self.cycle),
            status_words(status)
        );
        let detail = Connect {
            step: "earlier",
            frame_id: Some(self.frame_id),
            octets: u16::try_from(octets).ok(),
            cycle: Some(self.cycle.as_secs_f64()),
            ..Connect::default()
        };
        sink.report(status_weight(status), TOPIC, text, Detail::Connect(detail));
    }
}

/// Returns an IOPS or IOCS in words.
pub fn iops(octet: &[u8]) -> String {
    octet
        .first()
        .map_or_else(String::new, |octet| rt::Iops(*octet).to_string())
}

const fn status_weight(status: DataStatus) -> Weight {
    if status.is_valid() && status.is_run() && !status.has_problem() {
        Weight::Normal
    } else {
        Weight::Warning
    }
}

fn status_words(status: DataStatus) -> String {
    format!(
        "{}, {}{}",
        if status.is_run() { "RUN" } else { "STOP" },
        if status.is_valid() { "valid" } else { "not valid" },
        if status.has_problem() {
            ", station reports a problem"
        } else {
            ""
        },
    )
}

fn note_status(before: Option<DataStatus>, status: DataStatus, sink: &mut Sink<'_>) {
    let text = format!(
        "{} cyclic data: {}",
        if before.is_none() { "first" } else { "now" },
        status_words(status)
    );
    let detail = Cyclic {
        status: Some(status.0),
        run: Some(status.is_run()),
        valid: Some(status.is_valid()),
        problem: Some(status.has_problem()),
        ..Cyclic::default()
    };
    sink.report(status_weight(status), TOPIC, text, Detail::Cyclic(detail));
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

    /// Returns the telegram of a slot.
    fn telegram(&self, drive: &JobDrive, slot: u16) -> Option<&'static Telegram> {
        let mut modules = self.modules.iter().filter(|module| module.slot == slot);
        modules.find_map(|module| connect::telegram(drive, module))
    }
}

#[cfg(test)]
mod tests;
