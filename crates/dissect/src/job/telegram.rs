//! Cyclic data of a drive in words: parameter channel, control and status word, speed, further words.

use std::ops::Range;

use profile::parameter::ParameterAddress;
use profile::pkw::{PKW_LEN, Pkw};
use profile::state::{Mode, Profile, Zsw1};
use profile::telegram::{Field, Image, Telegram, signal};
use serde_json::{Map, Value};

use super::{Decoded, JobDrive, Part, pkw};
use crate::Weight;
use crate::fields;
use crate::{hex_bytes, hex16, number, value, words};

/// One direction of the cyclic data of a drive.
#[derive(Debug, Clone, Copy)]
pub struct Half<'a> {
    /// Whose data it is.
    pub drive: &'a JobDrive,
    /// None: all that is known is that the first word is the control or status word.
    pub telegram: Option<&'static Telegram>,
    /// True from the controller to the drive.
    pub output: bool,
}

impl Half<'_> {
    fn image(&self) -> Option<&'static Image> {
        let telegram = self.telegram?;
        let image = if self.output {
            &telegram.setpoint
        } else {
            &telegram.actual
        };
        // the mapping of a free telegram is unknown
        (image.octets > 0).then_some(image)
    }

    /// Returns whose words these are.
    pub fn profile(&self) -> Profile {
        self.drive.words(self.telegram)
    }

    /// Returns the parameter channel, where there is one.
    pub fn pkw(&self, data: &[u8]) -> Option<Pkw> {
        let channel = self.telegram.is_some_and(|telegram| telegram.pkw);
        let octets = data.first_chunk().filter(|_| channel)?;
        Some(Pkw::from_octets(*octets))
    }

    /// Returns the control or status word.
    pub fn word(&self, data: &[u8]) -> Option<u16> {
        let number = if self.output { signal::STW1 } else { signal::ZSW1 };
        match self.image() {
            Some(image) => image.get(data, number).and_then(|word| u16::try_from(word).ok()),
            None => data.first_chunk().map(|octets| u16::from_be_bytes(*octets)),
        }
    }

    /// Setpoint or actual value of the speed, as it travels.
    pub fn speed(&self, data: &[u8]) -> Option<i64> {
        let number = if self.output {
            signal::NSOLL_A
        } else {
            signal::NIST_A
        };
        self.image()?.get(data, number)
    }

    /// Returns the name of the word: vendor-specific words are CTW and STW.
    pub fn word_name(&self) -> &'static str {
        match (self.profile(), self.output) {
            (Profile::Profidrive, true) => "STW1",
            (Profile::Profidrive, false) => "ZSW1",
            (_, true) => "CTW",
            (_, false) => "STW",
        }
    }

    /// Returns the name of the speed.
    pub fn speed_name(&self) -> &'static str {
        match (self.profile(), self.output) {
            (Profile::Profidrive, true) => "NSOLL_A",
            (Profile::Profidrive, false) => "NIST_A",
            (_, true) => "MRV",
            (_, false) => "MAV",
        }
    }

    /// Returns the meaning of the word. `sent` is the control word on the way to the drive.
    pub fn word_text(&self, word: u16, sent: Option<u16>) -> (Weight, String) {
        self.word_text_in(self.drive.mode_in(self.telegram), word, sent)
    }

    fn word_text_in(&self, mode: Mode, word: u16, sent: Option<u16>) -> (Weight, String) {
        let profile = self.profile();
        if self.output {
            let set = words::set(profile.control_bits(mode), word);
            let means = words::control_meaning(profile, mode, word);
            return (Weight::Normal, format!("{means} {set}"));
        }
        let set = words::set(profile.status_bits(mode), word);
        let general = profile.zsw1(word, sent.unwrap_or(0));
        let weight = if general.has(Zsw1::FAULT) {
            Weight::Error
        } else if general.has(Zsw1::WARNING) {
            Weight::Warning
        } else {
            Weight::Normal
        };
        (
            weight,
            format!("{} {set}", words::status_meaning(profile, word, sent)),
        )
    }

    /// `50 %, 750 rpm if a reference of 1500 rpm`.
    pub fn speed_text(&self, raw: i64) -> String {
        let full = self.telegram.and_then(|telegram| telegram.full_speed);
        let (rpm, assumed) = self.drive.speed(raw, full);
        let rpm = format!("{} rpm", number((rpm * 100.0).round() / 100.0));
        let percent = self.drive.percent(raw, full).map_or_else(String::new, |percent| {
            format!("{} %, ", number((percent * 100.0).round() / 100.0))
        });
        let condition = assumed.map_or_else(String::new, |assumed| format!(" if {assumed}"));
        format!("{percent}{rpm}{condition}")
    }

    /// Everything in the data, one line for each part.
    pub fn lines(&self, data: &[u8]) -> Vec<(Weight, String)> {
        let parts = self.parts(data);
        parts
            .into_iter()
            .map(|part| (part.weight, part.line(data)))
            .collect()
    }

    /// Everything in the data: parameter channel, control or status word, speed, the other signals, and what nothing is
    /// known of. A word that can be of two modes is two parts.
    pub fn parts(&self, data: &[u8]) -> Vec<Part> {
        let mut parts = Vec::new();
        if let Some(pkw) = self.pkw(data) {
            let dialect = self.drive.ppo();
            let (weight, text) = if self.output {
                pkw::request(self.drive, dialect, pkw, None)
            } else {
                pkw::reply(self.drive, dialect, pkw, None)
            };
            parts.push(Part::new("PKW", 0..PKW_LEN, text).weighing(weight));
        }
        if let Some(word) = self.word(data) {
            let number = if self.output { signal::STW1 } else { signal::ZSW1 };
            let octets = self
                .image()
                .map_or(Some(0..2), |image| image.field(number).map(place));
            let condition = self
                .drive
                .assumed_words(self.telegram)
                .map_or_else(String::new, |assumed| format!(" if {assumed}"));
            for (mode, condition) in self.modes(&condition) {
                let (weight, text) = self.word_text_in(mode, word, None);
                let text = format!("{} {text}{condition}", hex16(word));
                let octets = octets.clone().unwrap_or_default();
                parts.push(Part::new(self.word_name(), octets, text).weighing(weight));
            }
        }
        let number = if self.output {
            signal::NSOLL_A
        } else {
            signal::NIST_A
        };
        let field = self.image().and_then(|image| image.field(number));
        if let (Some(raw), Some(octets)) = (self.speed(data), field.map(place)) {
            parts.push(Part::value(self.speed_name(), octets, self.speed_text(raw)));
        }
        parts.extend(self.others(data));
        parts
    }

    /// The modes that the control or status word can be of, each with what that rests on.
    fn modes(&self, condition: &str) -> Vec<(Mode, String)> {
        let open = self
            .telegram
            .is_some_and(|telegram| self.drive.is_mode_open(telegram));
        if open && self.profile() == Profile::Profidrive {
            let modes = [(Mode::Velocity, "velocity"), (Mode::Position, "position")];
            return modes
                .map(|(mode, name)| (mode, format!(" if {name} mode")))
                .to_vec();
        }
        vec![(self.drive.mode_in(self.telegram), condition.to_owned())]
    }

    /// Returns the speed and the signals that are parameters, in units, each with the assumption that it is based on.
    fn values_json(&self, data: &[u8]) -> Vec<Value> {
        let full = self.telegram.and_then(|telegram| telegram.full_speed);
        let mut values: Vec<Value> = Vec::new();
        if let Some(raw) = self.speed(data) {
            let (rpm, assumed) = self.drive.speed(raw, full);
            let mut value = fields! { "name": self.speed_name(), "raw": raw, "value": rpm, "unit": "rpm" };
            value.extend(assumed.map(|assumed| ("assumed".to_owned(), assumed.into())));
            values.push(value.into());
        }
        let shown = [signal::STW1, signal::ZSW1, signal::NSOLL_A, signal::NIST_A];
        let fields = self.image().map_or(&[][..], |image| image.fields);
        for field in fields
            .iter()
            .filter(|field| !shown.contains(&field.signal.number))
        {
            let Some(octets) = part(data, field) else { continue };
            let Some(address) = self.address(field, octets) else {
                continue;
            };
            let mut value = value::json(&self.drive.number(address, octets));
            if let (Value::Object(fields), Some(assumed)) = (&mut value, self.drive.assumption(address)) {
                fields.insert("assumed".into(), assumed.into());
            }
            values.push(value);
        }
        values
    }

    /// Returns the parameter that a signal is, where the tables have one of this size.
    fn address(&self, field: &Field, octets: &[u8]) -> Option<ParameterAddress> {
        let address = ParameterAddress::value(field.signal.number, 0);
        let known = self.drive.parameter(address)?;
        (known.octets() == octets.len() && field.signal.vendor.is_some() || known.name == field.signal.name)
            .then_some(address)
    }

    /// Signals and words beside control word and speed.
    fn others(&self, data: &[u8]) -> Vec<Part> {
        let Some(telegram) = self.telegram else {
            return Vec::new();
        };
        let Some(image) = self.image() else {
            return unmapped(data, |octet| octet < 2);
        };
        let shown = [signal::STW1, signal::ZSW1, signal::NSOLL_A, signal::NIST_A];
        let others = image
            .fields
            .iter()
            .filter(|field| !shown.contains(&field.signal.number));
        let signals = others.filter_map(|field| {
            let text = self.signal_text(field, part(data, field)?);
            Some(Part::value(field.signal.name, place(field), text))
        });
        let words = telegram.parameter_words(image).filter_map(|(index, offset)| {
            let octets = usize::from(offset)..usize::from(offset) + 2;
            let text = format!("0x{}", joined(data.get(octets.clone())?));
            Some(Part::new(&format!("PCD {}", index + 1), octets, text))
        });
        let is_known = |octet: usize| {
            let fields = image.fields.iter().map(place);
            let words = telegram
                .parameter_words(image)
                .map(|(_, offset)| usize::from(offset));
            let mut known = fields.chain(words.map(|start| start..start + 2));
            telegram.pkw && octet < PKW_LEN || known.any(|part| part.contains(&octet))
        };
        signals.chain(words).chain(unmapped(data, is_known)).collect()
    }

    fn signal_text(&self, field: &Field, octets: &[u8]) -> String {
        if let Some(address) = self.address(field, octets) {
            let assumed = self.drive.assumption(address);
            let condition = assumed.map_or_else(String::new, |assumed| format!(" if {assumed}"));
            return value::full(&self.drive.number(address, octets)) + &condition;
        }
        field
            .signal
            .decode(octets)
            .map_or_else(String::new, |raw| raw.to_string())
    }
}

/// Words that nothing is known of, as they travel.
fn unmapped(data: &[u8], is_known: impl Fn(usize) -> bool) -> Vec<Part> {
    let words = data.chunks(2).enumerate().filter(|(at, _)| !is_known(2 * at));
    words
        .map(|(at, octets)| {
            let start = 2 * at;
            let name = format!("word {}", at + 1);
            Part::new(
                &name,
                start..start + octets.len(),
                format!("0x{}", joined(octets)),
            )
        })
        .collect()
}

/// Returns the octets of a signal in the data.
fn place(field: &Field) -> Range<usize> {
    let start = usize::from(field.offset);
    start..start + usize::from(field.signal.octets())
}

fn part<'d>(data: &'d [u8], field: &Field) -> Option<&'d [u8]> {
    data.get(place(field))
}

fn joined(octets: &[u8]) -> String {
    octets.iter().map(|octet| format!("{octet:02X}")).collect()
}

/// Cyclic data of a telegram by its number. Without a direction both are reported.
pub fn decode(drive: &JobDrive, telegram: u16, data: &[u8], output: Option<bool>) -> Result<Decoded, String> {
    let found = drive.telegram(telegram).ok_or_else(|| {
        let all = drive
            .tables()
            .map_or(&[][..], |tables| tables.device.telegrams)
            .iter()
            .map(|row| row.telegram.to_string())
            .collect::<Vec<_>>();
        format!(
            "no telegram {telegram} of {} is known; there are {}",
            drive.name(),
            all.join(", ")
        )
    })?;
    let mut lines = Vec::new();
    let mut halves = Vec::new();
    for half in halves_of(drive, found, data, output)? {
        let side = half.output;
        let from = if side {
            "from the controller"
        } else {
            "from the drive"
        };
        lines.push((
            Weight::Normal,
            format!("{} telegram {telegram} {from}", drive.name()),
        ));
        let half_lines = half.lines(data);
        let mut fields = fields! {
            "from": if side { "controller" } else { "drive" },
            "lines": half_lines.iter().map(|(_, line)| line.trim_start()).collect::<Vec<_>>(),
            "word": half.word(data), "speed": half.speed(data), "values": half.values_json(data),
        };
        let reply = half.pkw(data).filter(|_| !side);
        fields.extend(reply.and_then(|pkw| pkw::refusal_json(drive.ppo(), pkw)));
        halves.push(Value::Object(fields));
        lines.extend(half_lines);
    }
    let fields: Map<String, Value> =
        fields! { "model": drive.name(), "telegram": telegram, "hex": hex_bytes(data), "halves": halves };
    Ok(Decoded {
        lines,
        fields,
        refused: Vec::new(),
    })
}

/// Returns the directions that data of this length can have, or only that which is given.
fn halves_of<'a>(
    drive: &'a JobDrive,
    telegram: &'static Telegram,
    data: &[u8],
    output: Option<bool>,
) -> Result<Vec<Half<'a>>, String> {
    let sides = [true, false]
        .into_iter()
        .filter(|side| output.is_none_or(|wanted| wanted == *side));
    let (mut fitting, mut lengths) = (Vec::new(), Vec::new());
    for output in sides {
        let half = Half {
            drive,
            telegram: Some(telegram),
            output,
        };
        let expected = half.image().map_or(data.len(), |image| usize::from(image.octets));
        if telegram.free || data.len() == expected {
            fitting.push(half);
        }
        let from = if output { "to" } else { "from" };
        lengths.push(format!("{expected} octets {from} the drive"));
    }
    if fitting.is_empty() {
        let (number, lengths) = (telegram.number, lengths.join(" and "));
        return Err(format!(
            "telegram {number} has {lengths}, there are {}",
            data.len()
        ));
    }
    Ok(fitting)
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::parameter::{CodeSpace, ValueBlock, pnu};

    fn lines(vendor: u16, device: u16, telegram: u16, data: &[u8], output: bool) -> String {
        let drive = JobDrive::of(vendor, device);
        let decoded = decode(&drive, telegram, data, Some(output)).unwrap();
        decoded.lines.into_iter().map(|(_, line)| line + "\n").collect()
    }

    /// FCM 300 p. 29: par. 207 = 1000, status word 0F07, 50 %.
    #[test]
    fn the_worked_ppo_1() {
        let reply = [0x20, 0xCF, 0, 0, 0, 0, 3, 0xE8, 0x0F, 0x07, 0x20, 0];
        let text = lines(0x0080, 1, 101, &reply, false);
        assert!(text.contains("PKW      "), "{text}");
        assert!(text.contains("1000"), "{text}");
        assert!(text.contains("STW      0x0F07 S4 operation ["), "{text}");
        assert!(text.contains("if 8-10 FC profile"), "{text}");
        assert!(
            text.contains("MAV      50 %, 750 rpm if a reference of 1500 rpm   [20 00]"),
            "{text}"
        );
        let refused = [0x70, 0, 0, 0, 0, 0, 0, 2, 0x0F, 0x07, 0x20, 0];
        let text = lines(0x0080, 1, 101, &refused, false);
        assert!(text.contains("refused: 2 value exceeds the limits"), "{text}");
        let request = [0x10, 0x78, 0, 0, 0, 0, 0, 0, 0x04, 0x7C, 0x20, 0];
        let text = lines(0x0080, 1, 101, &request, true);
        assert!(
            text.contains("PKW      request value: Motor Power [kW] (1-20)"),
            "{text}"
        );
        assert!(
            text.contains("CTW      0x047C run: follows the setpoint ["),
            "{text}"
        );
        // words of the parameter channel and words that settings choose are known, whatever they carry
        for (telegram, octets) in [(101, 12), (102, 20), (104, 12)] {
            let text = lines(0x0080, 1, telegram, &[0; 20][..octets], true);
            assert!(!text.contains("  word "), "{telegram}: {text}");
        }
    }

    /// Without a mapping nothing but the place of STW1 is known: the rest is shown as it is.
    #[test]
    fn words_that_nothing_is_mapped_to_are_shown() {
        let device = &profile::catalogue::AKD.device;
        let akd =
            |telegram, data: &[u8], output| lines(device.vendor_id, device.device_id, telegram, data, output);
        let text = akd(0, &[0x04, 0x7F, 0x80, 0x00, 0x12], true);
        for row in [
            "STW1     0x047F run: follows the setpoint [",
            "] if velocity mode",
            "STW1     0x047F starts the traversing task [",
            "] if position mode",
            "word 2   0x8000",
            "word 3   0x12",
        ] {
            assert!(text.contains(row), "{row}: {text}");
        }
        let mut data = [0; 24];
        data[..2].copy_from_slice(&[0x04, 0x3F]);
        data[20..].copy_from_slice(&[0xAB, 0xCD, 0, 7]);
        let text = akd(400, &data, true);
        assert!(text.contains("word 11  0xABCD\n  word 12  0x0007"), "{text}");
        assert!(!text.contains("mode") && !text.contains("word 10"), "{text}");
        // a telegram whose words are all known
        let text = akd(9, &data[..20], true);
        assert!(!text.contains("word"), "{text}");
    }

    #[test]
    fn vacon_has_a_scale_and_words_of_its_own() {
        let text = lines(0x01BA, 0x0100, 148, &[0x04, 0x7F, 0x13, 0x88], true);
        assert!(
            text.contains("CTW      0x047F run: follows the setpoint ["),
            "{text}"
        );
        assert!(text.contains("MRV      50 %, 750 rpm"), "{text}");
        let text = lines(0x01BA, 0x0100, 1, &[0x04, 0x7F, 0x20, 0x00], true);
        assert!(text.contains("STW1     0x047F"), "{text}");
        assert!(text.contains("NSOLL_A  50 %, 750 rpm"), "{text}");
    }

    #[test]
    fn akd_signals_in_units() {
        let text = lines(0x0105, 1, 1, &[0x04, 0x7F, 0x00, 0xA4], true);
        assert!(
            text.contains("NSOLL_A  60.04 rpm if PN.VELSCALING 1638"),
            "{text}"
        );
        let data = [
            0x04, 0x3F, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0x12, 0x34, 0, 5, 0, 1,
        ];
        let text = lines(0x0105, 1, 9, &data, true);
        assert!(text.contains("MDI_TARPOS"), "{text}");
    }

    #[test]
    fn a_value_of_an_assumed_scale_is_marked() {
        let drive = JobDrive::of(0x0105, 1);
        let decoded = decode(&drive, 1, &[0x04, 0x7F, 0x00, 0xA4], Some(true)).unwrap();
        let value = &decoded.fields["halves"][0]["values"][0];
        assert_eq!(
            (&value["name"], &value["unit"]),
            (&"NSOLL_A".into(), &"rpm".into())
        );
        assert_eq!(value["assumed"], "PN.VELSCALING 1638");
        let data = [0; 20];
        let decoded = decode(&drive, 9, &data, Some(true)).unwrap();
        let values = decoded.fields["halves"][0]["values"].as_array().unwrap();
        let of = |name: &str| values.iter().find(|value| value["name"] == name).unwrap();
        assert!(of("MDI_VELOCITY").get("assumed").is_none(), "{values:?}");
        assert_eq!(of("MDI_TARPOS")["assumed"], "PNU 1002 16");
        assert!(of("MDI_ACC")["assumed"].is_string(), "{values:?}");
    }

    #[test]
    fn the_length_determines_the_direction() {
        let drive = JobDrive::of(0x0105, 1);
        let from = |octets: usize, output| -> Vec<String> {
            let decoded = decode(&drive, 9, &vec![0; octets], output).unwrap();
            let halves = decoded.fields["halves"].as_array().unwrap().clone();
            let sides = halves
                .iter()
                .map(|half| half["from"].as_str().unwrap().to_owned());
            sides.collect()
        };
        assert_eq!(from(20, None), ["controller"]);
        assert_eq!(from(10, None), ["drive"]);
        assert!(decode(&drive, 9, &[0; 20], Some(false)).is_err());
        let both = decode(&drive, 1, &[0; 4], None).unwrap();
        assert_eq!(both.fields["halves"].as_array().unwrap().len(), 2);
    }

    /// PNU 930 alone decides for the drive; where it was not seen, the telegram is the best there is.
    #[test]
    fn the_mode_is_that_of_930_else_of_the_telegram() {
        let names = |drive: &JobDrive, telegram, data: &[u8]| -> bool {
            let decoded = decode(drive, telegram, data, Some(true)).unwrap();
            decoded.lines.iter().any(|(_, line)| line.contains("NO_REJECT"))
        };
        let learn = |drive: &mut JobDrive, number, subindex, value: u16| {
            let address = ParameterAddress::value(number, subindex);
            let [high, low] = value.to_be_bytes();
            let block = [0x42, 1, high, low];
            let (block, _) = ValueBlock::parse(&block, 0, CodeSpace::V4).unwrap();
            drive.learn(address, &block);
        };
        let data = [&[0x04, 0x7F][..], &[0; 22]].concat();
        let mut drive = JobDrive::of(0x0105, 1);
        assert!(names(&drive, 400, &data), "as delivered it carries SATZANW");
        learn(&mut drive, pnu::SETPOINT_SIGNALS, 1, signal::NSOLL_A);
        assert!(!names(&drive, 400, &data), "and now it does not");
        assert!(names(&drive, 9, &data[..20]), "another one is not mapped");
        learn(&mut drive, pnu::SETPOINT_SIGNALS, 4, signal::SATZANW);
        assert!(names(&drive, 400, &data));
        learn(&mut drive, pnu::OPERATING_MODE, 0, 1);
        assert!(!names(&drive, 400, &data) && !names(&drive, 9, &data[..20]));
        learn(&mut drive, pnu::OPERATING_MODE, 0, 2);
        assert!(names(&drive, 1, &data[..4]));
        // telegram 0 has no mapping of its own: both modes, until 930 or the mapping is seen
        let modes = |drive: &JobDrive| {
            let decoded = decode(drive, 0, &data[..4], Some(true)).unwrap();
            let words = decoded.lines.iter().filter(|(_, line)| line.contains("STW1"));
            words.count()
        };
        assert_eq!(modes(&JobDrive::of(0x0105, 1)), 2);
        for (number, subindex, value) in [
            (pnu::OPERATING_MODE, 0, 2),
            (pnu::SETPOINT_SIGNALS, 1, signal::NSOLL_A),
        ] {
            let mut drive = JobDrive::of(0x0105, 1);
            learn(&mut drive, number, subindex, value);
            assert_eq!(modes(&drive), 1, "{number}");
        }
    }

    #[test]
    fn wrong_lengths_and_numbers_are_reported() {
        let drive = JobDrive::of(0x0080, 1);
        let error = decode(&drive, 101, &[0; 11], Some(true)).unwrap_err();
        assert_eq!(error, "telegram 101 has 12 octets to the drive, there are 11");
        let error = decode(&drive, 101, &[0; 11], None).unwrap_err();
        assert_eq!(
            error,
            "telegram 101 has 12 octets to the drive and 12 octets from the drive, there are 11"
        );
        let error = decode(&drive, 9999, &[0; 11], None).unwrap_err();
        assert!(
            error.ends_with("there are 1, 101, 102, 103, 104, 105, 106, 107, 108"),
            "{error}"
        );
    }
}
