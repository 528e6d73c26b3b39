//! The telegram of a drive in cyclic data: words, speeds, parameter channel.

use std::time::Duration;

use profile::pkw::Pkw;
use profile::state::{Mode, Profile, Zsw1};
use profile::telegram::Telegram;
use profinet::wire::rt::Iops;

use super::channel::Channel;
use super::event::{Cyclic, Detail, Sample, Sink, State};
use crate::Weight;
use crate::hex16;
use crate::job::JobDrive;
use crate::job::telegram::Half;

/// How long the data at the beginning of a connection may be marked bad, as each station does until it is ready, before that is
/// trouble.
const READY: Duration = Duration::from_secs(3);
/// Number of frames with the same speed after which the speed counts as settled.
const SETTLED: u32 = 3;

/// Where a telegram is, and what it was.
#[derive(Debug)]
pub struct DriveData {
    pub slot: u16,
    pub subslot: u16,
    offset: usize,
    length: usize,
    telegram: Option<&'static Telegram>,
    word: Option<u16>,
    speed: Speed,
    channel: Channel,
    provider: Option<Iops>,
    /// When the first data came, where they have been bad since then and that was not reported.
    unready: Option<Duration>,
}

/// What goes the other way to or from the same submodule.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sent {
    word: Option<u16>,
    pkw: Pkw,
}

/// The words of a drive in its cyclic frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DriveWords {
    /// Number of the telegram, where it is known.
    pub telegram: Option<u16>,
    /// Whose words these are.
    pub profile: Profile,
    /// Mode that decides over their bits.
    pub mode: Mode,
    /// Control word that its controller sent last.
    pub control: Option<u16>,
    /// Status word that it sent last.
    pub status: Option<u16>,
}

/// What a frame is to a speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SpeedStep {
    /// The first with another one than that which stayed.
    Left,
    /// It has been the same for a while.
    Settled,
}

/// The speed as it was reported last, and for how many frames it is what it is now.
#[derive(Debug, Default)]
struct Speed {
    reported: Option<i64>,
    now: i64,
    frames: u32,
}

impl Sent {
    /// Returns the control or status word.
    pub const fn word(&self) -> Option<u16> {
        self.word
    }
}

impl DriveData {
    /// Returns the telegram of a submodule at an offset of the cyclic data.
    pub fn new(place: (u16, u16), offset: u16, length: usize, telegram: Option<&'static Telegram>) -> Self {
        Self {
            slot: place.0,
            subslot: place.1,
            offset: offset.into(),
            length,
            telegram,
            word: None,
            speed: Speed::default(),
            channel: Channel::default(),
            provider: None,
            unready: None,
        }
    }

    /// Returns its octets in the cyclic data, without the status.
    pub const fn octets(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.length
    }

    /// Returns its telegram, where it is known.
    pub const fn telegram(&self) -> Option<&'static Telegram> {
        self.telegram
    }

    /// Returns its present content.
    pub const fn sent(&self) -> Sent {
        Sent {
            word: self.word,
            pkw: self.channel.last,
        }
    }

    /// Looks at the cyclic data of a frame.
    pub fn look(&mut self, drive: &mut JobDrive, data: &[u8], output: bool, sent: Sent, sink: &mut Sink<'_>) {
        let Some(rest) = data.get(self.offset..) else {
            return;
        };
        let provider = rest.get(self.length).map(|&octet| Iops(octet));
        self.look_at_provider(provider, sink);
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
        self.note_word(half, data, sent, sink);
        if let Some(pkw) = pkw {
            self.channel.look(drive, pkw, output, sent.pkw, sink);
        }
    }

    fn look_at_provider(&mut self, provider: Option<Iops>, sink: &mut Sink<'_>) {
        let is_bad = provider.is_some_and(|provider| !provider.is_good());
        if self.provider.is_none() && is_bad {
            self.unready = Some(sink.at);
            self.provider = provider;
            return;
        }
        match self.unready {
            Some(begin) if is_bad && sink.at.saturating_sub(begin) < READY => {}
            Some(_) if is_bad => {
                self.unready = None;
                self.note_provider(provider, sink);
            }
            // it is ready now
            Some(_) => self.unready = None,
            None if provider != self.provider => self.note_provider(provider, sink),
            None => return,
        }
        self.provider = provider;
    }

    fn note_provider(&self, provider: Option<Iops>, sink: &mut Sink<'_>) {
        let detail = Detail::Cyclic(Cyclic {
            slot: Some(self.slot),
            iops: provider.map(|provider| provider.0),
            ..Cyclic::default()
        });
        if let Some(bad) = provider.filter(|provider| !provider.is_good()) {
            let text = format!("slot {}: data marked {bad}", self.slot);
            sink.report(Weight::Warning, "cyclic", text, detail);
        } else if self.provider.is_some() {
            sink.report(
                Weight::Normal,
                "cyclic",
                format!("slot {}: data good", self.slot),
                detail,
            );
        }
    }

    fn note_word(&mut self, half: Half<'_>, data: &[u8], sent: Sent, sink: &mut Sink<'_>) {
        let speed = half.speed(data);
        let step = speed.and_then(|speed| self.speed.look(speed));
        let Some(word) = half.word(data) else { return };
        // a new speed is reported with the next word; a setpoint also when it leaves one that stayed, and, after a ramp
        // of many, once it stays again
        let news = speed.filter(|speed| self.speed.reported.unwrap_or(0) != *speed);
        if self.word != Some(word) {
            self.note_change(half, word, news, sent, sink);
        } else if let (Some(raw), Some(step), true) = (news, step, half.output) {
            let words = format!("{} {}", half.speed_name(), half.speed_text(raw));
            let text = match step {
                SpeedStep::Left => words,
                SpeedStep::Settled => format!("{words}, the same for {SETTLED} frames"),
            };
            let sample = self.sample(half, raw);
            sink.report(Weight::Normal, "drive", text, Detail::Sample(sample));
            self.speed.reported = speed;
        }
    }

    fn note_change(&mut self, half: Half<'_>, word: u16, news: Option<i64>, sent: Sent, sink: &mut Sink<'_>) {
        let before = self.word;
        let (weight, text) = half.word_text(word, sent.word);
        let mut text = format!("{} {text}", change(half.word_name(), before, word));
        if let Some(raw) = news {
            text = format!("{text}; {} {}", half.speed_name(), half.speed_text(raw));
            self.speed.reported = news;
        }
        if let Some(assumed) = half
            .drive
            .assumed_words(self.telegram)
            .filter(|_| before.is_none())
        {
            text = format!("{text}; the names of the bits are right if {assumed}");
        }
        let state = State {
            slot: self.slot,
            subslot: self.subslot,
            telegram: self.telegram.map(|telegram| telegram.number),
            word: half.word_name(),
            before,
            value: word,
            speed: news.map(|raw| self.sample(half, raw)),
        };
        let has_fault = |word: u16| half.profile().zsw1(word, sent.word.unwrap_or(0)).has(Zsw1::FAULT);
        let detail = if !half.output && has_fault(word) && !before.is_some_and(has_fault) {
            Detail::Fault(state)
        } else {
            Detail::State(state)
        };
        sink.report(weight, "drive", text, detail);
        self.word = Some(word);
    }

    fn sample(&self, half: Half<'_>, raw: i64) -> Sample {
        let full = self.telegram.and_then(|telegram| telegram.full_speed);
        let (value, assumed) = half.drive.speed(raw, full);
        Sample {
            slot: self.slot,
            subslot: self.subslot,
            signal: half.speed_name(),
            raw,
            value,
            unit: "rpm",
            assumed,
        }
    }
}

impl Speed {
    /// Returns the change of speed in this frame, where it is worth a line.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setpoint_is_reported_in_the_frame_that_changes_it() {
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
}
