//! The modules of a converter: PPO type 1 in slot 1, the parameter channel alone in slot 2, PPO type 2 in slot 3. The
//! parameter channel is answered out of printed examples: nothing here knows the rules of it.

use std::time::{Duration, Instant};

use pnio::api::{ApiError, IoDevice};
use pnio::config::{DeviceConfigBuilder, Slot};
use pnio::data::FieldType;

/// Words of the parameter channel: PKE, IND, PWE high, PWE low.
type Pkw = [u16; 4];

/// How long the answer to a new request takes; the one before stands as long.
const DELAY: Duration = Duration::from_millis(30);
/// Slot, whether it has a parameter channel, words of process data.
const MODULES: [(Slot, usize); 3] = [(Slot(1), 2), (Slot(2), 0), (Slot(3), 6)];

pub fn modules(mut builder: DeviceConfigBuilder) -> DeviceConfigBuilder {
    for (slot, process) in MODULES {
        let words = vec![FieldType::Word; 4 + process];
        builder = builder.submodule(slot, &format!("ppo{}", slot.0), &words, &words);
    }
    builder
}

/// What one channel was asked and says.
#[derive(Default, Clone, Copy)]
struct Channel {
    asked: Pkw,
    since: Option<Instant>,
    answer: Pkw,
    /// Parameter 207.
    long: u32,
}

pub struct Converter {
    channels: [Channel; 3],
    started: Instant,
}

impl Converter {
    pub fn new() -> Self {
        let channel = Channel {
            long: 1000,
            ..Channel::default()
        };
        Self {
            channels: [channel; 3],
            started: Instant::now(),
        }
    }

    /// One look at the outputs, and the inputs that follow.
    pub fn work(&mut self, device: &IoDevice) -> Result<(), ApiError> {
        for ((slot, process), channel) in MODULES.into_iter().zip(&mut self.channels) {
            let output = device.outputs(slot)?;
            let mut asked = [0; 4];
            for (at, word) in asked.iter_mut().enumerate() {
                *word = output.word(at)?;
            }
            let mut data = vec![0; process];
            for (at, word) in data.iter_mut().enumerate() {
                *word = output.word(4 + at)?;
            }
            let runs = data.first() == Some(&0x047C);
            if asked != channel.asked {
                channel.asked = asked;
                channel.since = Some(Instant::now());
            }
            if channel.since.is_some_and(|since| since.elapsed() >= DELAY) {
                channel.since = None;
                channel.answer = channel.answered(runs);
            }
            if channel.since.is_none() && asked[0] == 0x164D {
                // an actual value: tenths of a second
                channel.answer[3] = (self.started.elapsed().as_millis() / 100) as u16;
            }
            let answer = channel.answer;
            device.with_inputs(slot, |input| -> Result<(), ApiError> {
                for (at, word) in answer.into_iter().enumerate() {
                    input.word(at, word)?;
                }
                if process > 0 {
                    // status word and actual value as printed for 50 %
                    input.word(4, if runs { 0x0F07 } else { 0x0603 })?;
                    input.word(5, if runs { data[1] } else { 0 })?;
                }
                for (at, word) in data.iter().enumerate().skip(2) {
                    input.word(4 + at, *word)?;
                }
                Ok(())
            })?;
        }
        Ok(())
    }
}

impl Channel {
    fn answered(&mut self, runs: bool) -> Pkw {
        let [pke, ind, high, low] = self.asked;
        let double = |value: u32| [(value >> 16) as u16, value as u16];
        match (pke, ind) {
            (0, _) => [0; 4],
            // parameter 207, a double word
            (0x10CF | 0x30CF, 0) => {
                if pke == 0x30CF {
                    self.long = u32::from(high) << 16 | u32::from(low);
                }
                let [high, low] = double(self.long);
                [0x20CF, 0, high, low]
            }
            // operation mode: not while it runs
            (0x33A2, 0) if runs => [0x73A2, 0, 0, 0x11],
            (0x33A2, 0) => [0x23A2, 0, high, low],
            // element 1 of 15-30, whose subindex is the first octet of IND
            (0x65FA, 0x0100) => [0x45FA, 0x0100, 0, 14],
            // an actual value
            (0x164D, 0) => [0x164D, 0, 0, 0],
            // above the limit; printed without the number of the parameter
            (0x219E, 0) if low > 1320 => [0x7000, 0, 0, 2],
            (0x219E, 0) => [0x119E, 0, 0, low],
            _ => [0x7000 | pke & 0x07FF, ind, 0, 0],
        }
    }
}
