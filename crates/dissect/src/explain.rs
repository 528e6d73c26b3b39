//! One number explained: a control or status word, a state, a fault, an error, a format.

use profile::catalogue::{Catalogue, VLT};
use profile::model::{self, Model};
use profile::state::bits::{self as state_bits, Bit};
use profile::state::{Mode, Profile};
use profile::telegram::DANFOSS;
use profinet::wire::status::PnioStatus;

use crate::job::{self, JobDrive};
use crate::meaning::{AlarmBit, FaultMeaning, Meaning, WordBits, WordInMode};
use crate::{hex16, states, words};

/// What a number to explain is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Control word 1.
    Stw1,
    /// Status word 1.
    Zsw1,
    /// State of the drive, from status word 1 or by its name.
    State,
    /// Fault number (PNU 947) of the model; where none is given, of each model.
    Fault,
    /// Error number of a refused parameter.
    Error,
    /// Format code of a parameter value.
    Format,
    /// PNIO status: ErrorCode, ErrorDecode, ErrorCode1, ErrorCode2.
    Pnio,
    /// Control word of a VLT with FC profile (8-10).
    CtwFc,
    /// Status word of a VLT with FC profile.
    StwFc,
    /// Control word of a VLT with PROFIdrive profile.
    CtwVlt,
    /// Status word of a VLT with PROFIdrive profile.
    StwVlt,
    /// Control word of a VLT 2800 or FCD 300 with PROFIdrive profile.
    CtwVlt2800,
    /// Status word of a VLT 2800 or FCD 300 with PROFIdrive profile.
    StwVlt2800,
    /// Control word of a Vacon in telegrams 148 to 150.
    CtwVacon,
    /// Status word of a Vacon in telegrams 148 to 150.
    StwVacon,
    /// PKE of a parameter channel: request or reply, and parameter number.
    Pke,
    /// Alarm word of a VLT (16-90).
    AlarmWord,
    /// Alarm word 2 of a VLT (16-91).
    AlarmWord2,
    /// Warning word of a VLT (16-92).
    WarningWord,
    /// Warning word 2 of a VLT (16-93).
    WarningWord2,
}

/// Every kind by its name, and what it is.
pub const KINDS: [(&str, &str, Kind); 20] = [
    ("stw1", "Control word 1", Kind::Stw1),
    ("zsw1", "Status word 1", Kind::Zsw1),
    (
        "state",
        "State of the drive, from status word 1 or by its name",
        Kind::State,
    ),
    (
        "fault",
        "Fault number (PNU 947) of the model; without one of each model",
        Kind::Fault,
    ),
    ("error", "Error number of a refused parameter", Kind::Error),
    ("format", "Format code of a parameter value", Kind::Format),
    (
        "pnio",
        "PNIO status: ErrorCode, ErrorDecode, ErrorCode1, ErrorCode2",
        Kind::Pnio,
    ),
    (
        "ctw-fc",
        "Control word of a VLT with FC profile (8-10)",
        Kind::CtwFc,
    ),
    ("stw-fc", "Status word of a VLT with FC profile", Kind::StwFc),
    (
        "ctw-vlt",
        "Control word of a VLT with PROFIdrive profile",
        Kind::CtwVlt,
    ),
    (
        "stw-vlt",
        "Status word of a VLT with PROFIdrive profile",
        Kind::StwVlt,
    ),
    (
        "ctw-vlt2800",
        "Control word of a VLT 2800 or FCD 300 with PROFIdrive profile",
        Kind::CtwVlt2800,
    ),
    (
        "stw-vlt2800",
        "Status word of a VLT 2800 or FCD 300 with PROFIdrive profile",
        Kind::StwVlt2800,
    ),
    (
        "ctw-vacon",
        "Control word of a Vacon in telegrams 148 to 150",
        Kind::CtwVacon,
    ),
    (
        "stw-vacon",
        "Status word of a Vacon in telegrams 148 to 150",
        Kind::StwVacon,
    ),
    (
        "pke",
        "PKE of a parameter channel: request or reply, and parameter number",
        Kind::Pke,
    ),
    ("alarm-word", "Alarm word of a VLT (16-90)", Kind::AlarmWord),
    ("alarm-word2", "Alarm word 2 of a VLT (16-91)", Kind::AlarmWord2),
    ("warning-word", "Warning word of a VLT (16-92)", Kind::WarningWord),
    (
        "warning-word2",
        "Warning word 2 of a VLT (16-93)",
        Kind::WarningWord2,
    ),
];

/// The modes that decide over the bits of STW1 and ZSW1, by name.
pub const MODES: [(&str, &str, Mode); 2] = [
    ("velocity", "Velocity mode (PNU 930 = 1)", Mode::Velocity),
    ("position", "Position mode (PNU 930 = 2)", Mode::Position),
];

impl Kind {
    /// Returns what a text is that can be nothing else: a state by its name (`S4`), a fault as a drive displays it (`F439`, `n602`;
    /// a VLT: `A13`, `W34`).
    ///
    /// ```
    /// use profidrive_dissect::explain::Kind;
    /// assert_eq!(Kind::of("W34"), Some(Kind::Fault));
    /// assert_eq!(Kind::of("0x047F"), None);
    /// ```
    #[must_use]
    pub fn of(text: &str) -> Option<Self> {
        if !states::named(text).is_empty() {
            return Some(Self::State);
        }
        let (letter, digits) = displayed(text);
        let is_number = !digits.is_empty() && digits.bytes().all(|octet| octet.is_ascii_digit());
        (letter.is_some() && is_number).then_some(Self::Fault)
    }

    /// Returns true for words whose bits depend on the mode of the drive.
    #[must_use]
    pub const fn has_modes(self) -> bool {
        matches!(self, Self::Stw1 | Self::Zsw1)
    }
}

/// Text that is nothing of the kind that it was taken for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct NotExplained {
    /// What is wrong.
    pub message: String,
    /// Valid spelling, where the message does not contain it.
    pub hint: Option<&'static str>,
}

impl NotExplained {
    fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            hint: None,
        }
    }
}

/// Something explained.
#[derive(Debug, Clone, PartialEq)]
pub struct Explained {
    /// In words.
    pub lines: Vec<String>,
    /// For programs.
    pub meaning: Meaning,
}

/// Explains the number in `text`: hexadecimal with 0x, binary with 0b, else decimal; a state also by its name.
///
/// `mode` is for words whose bits depend on it ([`Kind::has_modes`]): without it both modes are shown. Faults, errors and
/// formats are those of the model; without one, of each model.
///
/// ```
/// use profidrive_dissect::explain::{Kind, explain};
/// let explained = explain("0x047F", Kind::Stw1, None, None)?;
/// assert_eq!(explained.lines[0], "STW1 0x047F   0000 0100 0111 1111");
/// # Ok::<(), profidrive_dissect::explain::NotExplained>(())
/// ```
///
/// # Errors
/// When the text is nothing of this kind.
pub fn explain(
    text: &str,
    kind: Kind,
    mode: Option<Mode>,
    model: Option<Model>,
) -> Result<Explained, NotExplained> {
    let (lines, meaning) = match kind {
        Kind::Stw1 => in_modes(
            "STW1",
            "stw1",
            word(text)?,
            mode,
            state_bits::stw1,
            |mode, word| words::stw1_meaning_in(mode, word).to_owned(),
        ),
        Kind::Zsw1 => in_modes("ZSW1", "zsw1", word(text)?, mode, state_bits::zsw1, |_, word| {
            words::state(word, None)
        }),
        Kind::CtwFc => control(Profile::DanfossFc, "ctw-fc", text)?,
        Kind::CtwVlt => control(Profile::DanfossProfidrive, "ctw-vlt", text)?,
        Kind::CtwVlt2800 => control(Profile::Vlt2800Profidrive, "ctw-vlt2800", text)?,
        Kind::CtwVacon => control(Profile::VaconPpo, "ctw-vacon", text)?,
        Kind::StwFc => status(Profile::DanfossFc, "stw-fc", text)?,
        Kind::StwVlt => status(Profile::DanfossProfidrive, "stw-vlt", text)?,
        Kind::StwVlt2800 => status(Profile::Vlt2800Profidrive, "stw-vlt2800", text)?,
        Kind::StwVacon => status(Profile::VaconPpo, "stw-vacon", text)?,
        Kind::Pke => {
            let pke = word(text)?;
            let drive = model.map_or_else(|| JobDrive::of(DANFOSS, 1), JobDrive::new);
            job::pkw::pke(&drive, pke)
        }
        Kind::AlarmWord => bits(text, "alarm-word", 1690, false, 0)?,
        Kind::AlarmWord2 => bits(text, "alarm-word2", 1691, false, 32)?,
        Kind::WarningWord => bits(text, "warning-word", 1692, true, 0)?,
        Kind::WarningWord2 => bits(text, "warning-word2", 1693, true, 32)?,
        Kind::State if !states::named(text).is_empty() => {
            let meant = states::named(text);
            let states = meant.iter().map(|state| states::meaning(*state)).collect();
            let lines = meant.into_iter().flat_map(states::lines).collect();
            let r#as = "state";
            (lines, Meaning::States { r#as, states })
        }
        Kind::State => {
            let word = word(text).map_err(|error| NotExplained {
                hint: Some("a state by its name, S1 to S5, or the status word that encodes it"),
                ..error
            })?;
            let state = words::state(word, None);
            let lines = vec![format!("ZSW1 {}: {state}", hex16(word))];
            let meaning = Meaning::State {
                r#as: "state",
                raw: word,
                state: words::state_number(word, None),
                meaning: state,
            };
            (lines, meaning)
        }
        Kind::Fault => fault(text, model)?,
        Kind::Pnio => pnio(text)?,
        Kind::Error => {
            let mut lines = Vec::new();
            let meaning = job::explain_error(word(text)?, model, &mut lines);
            (lines, meaning)
        }
        Kind::Format => {
            let code = u8::try_from(word(text)?)
                .map_err(|_| NotExplained::new(format!("`{text}`: format codes have one octet")))?;
            let mut lines = Vec::new();
            let meaning = job::explain_format(code, model, &mut lines);
            (lines, meaning)
        }
    };
    Ok(Explained { lines, meaning })
}

/// Lines for people, and the same for programs.
type Parts = (Vec<String>, Meaning);

/// STW1 or ZSW1 in the mode that is named; without one in velocity mode, then what differs in position mode.
fn in_modes(
    title: &str,
    kind: &'static str,
    word: u16,
    mode: Option<Mode>,
    table: fn(Mode) -> &'static [Bit; 16],
    means: fn(Mode, u16) -> String,
) -> Parts {
    let one = |mode: Mode| WordInMode {
        mode: mode.name(),
        meaning: means(mode, word),
        word: words::word_bits(table(mode), word),
    };
    let mut lines = vec![words::word_title(title, word)];
    if let Some(mode) = mode {
        let only = one(mode);
        lines.extend(words::bit_lines(
            table(mode),
            table(mode).iter(),
            word,
            &only.meaning,
        ));
        let meaning = Meaning::ModeWord {
            r#as: kind,
            word: only,
            position: None,
        };
        return (lines, meaning);
    }
    let (velocity, position) = (table(Mode::Velocity), table(Mode::Position));
    let first = one(Mode::Velocity);
    lines.push("in velocity mode".into());
    lines.extend(words::bit_lines(velocity, velocity.iter(), word, &first.meaning));
    let second = one(Mode::Position);
    lines.push("in position mode (PNU 930 = 2); the other bits as above".into());
    let differing = position
        .iter()
        .zip(velocity)
        .filter(|(position, velocity)| position != velocity)
        .map(|(position, _)| position);
    lines.extend(words::bit_lines(position, differing, word, &second.meaning));
    let meaning = Meaning::ModeWord {
        r#as: kind,
        word: first,
        position: Some(second),
    };
    (lines, meaning)
}

fn control(profile: Profile, kind: &'static str, text: &str) -> Result<Parts, NotExplained> {
    let word = word(text)?;
    let mode = Mode::default();
    let table = profile.control_bits(mode);
    let means = words::control_meaning(profile, mode, word);
    let lines = words::word_lines(&format!("{} control word", profile.name()), table, word, &means);
    Ok((
        lines,
        vendor_word(profile, kind, means, words::word_bits(table, word)),
    ))
}

fn status(profile: Profile, kind: &'static str, text: &str) -> Result<Parts, NotExplained> {
    let word = word(text)?;
    let table = profile.status_bits(Mode::default());
    let means = words::status_meaning(profile, word, None);
    let lines = words::word_lines(&format!("{} status word", profile.name()), table, word, &means);
    Ok((
        lines,
        vendor_word(profile, kind, means, words::word_bits(table, word)),
    ))
}

fn vendor_word(profile: Profile, kind: &'static str, meaning: String, word: WordBits) -> Meaning {
    Meaning::Word {
        r#as: kind,
        profile: profile.name(),
        meaning,
        word,
    }
}

/// Alarm and warning words of a VLT: each bit is a fault of the table. `first` is the number of bit 0 in the table.
fn bits(text: &str, kind: &'static str, pnu: u16, warning: bool, first: u8) -> Result<Parts, NotExplained> {
    let value = number(text, 32)?;
    let name = VLT.by_pnu(pnu).map_or("", |parameter| parameter.name);
    let letter = if warning { 'n' } else { 'F' };
    let mut lines = vec![format!(
        "VLT {name} ({}-{:02}) 0x{value:08X}",
        pnu / 100,
        pnu % 100
    )];
    let mut set = Vec::new();
    for bit in (0..32_u8).filter(|bit| value >> bit & 1 == 1) {
        let fault = VLT
            .faults
            .iter()
            .find(|fault| fault.warning == warning && fault.bit == Some(first + bit));
        let meaning = fault.map_or("not in the table", |fault| fault.meaning);
        let number = fault.map_or_else(|| "-".into(), |fault| format!("{letter}{}", fault.number));
        lines.push(format!("  bit {bit:>2}  {number:<4}  {meaning}"));
        set.push(AlarmBit {
            bit,
            number: fault.map(|fault| fault.number),
            meaning,
            remedy: fault.map(|fault| fault.remedy),
            recalled: fault.map(|fault| fault.recalled),
        });
    }
    if set.is_empty() {
        lines.push(format!("  no {}", if warning { "warning" } else { "alarm" }));
    }
    let meaning = Meaning::AlarmWord {
        r#as: kind,
        raw: value,
        hex: format!("0x{value:08X}"),
        set,
    };
    Ok((lines, meaning))
}

/// Letters before the number of a fault in displays: F and n of an AKD, A (alarm) and W (warning) of a VLT, F and A (alarm, which is
/// a warning) of a Vacon.
const LETTERS: [char; 4] = ['F', 'N', 'A', 'W'];

/// Returns the letter before a number, in upper case, and the number.
fn displayed(text: &str) -> (Option<char>, &str) {
    let text = text.trim();
    let letter = text.chars().next().map(|letter| letter.to_ascii_uppercase());
    match letter.filter(|letter| LETTERS.contains(letter)) {
        Some(letter) => (Some(letter), text.get(1..).unwrap_or_default().trim_start()),
        None => (None, text),
    }
}

fn fault(text: &str, model: Option<Model>) -> Result<Parts, NotExplained> {
    let (letter, digits) = displayed(text);
    let number = word(digits).or_else(|_| word(text))?;
    let of_vlt = matches!(letter, Some('A' | 'W'));
    let warning = match letter {
        Some('N' | 'W') => true,
        // of the models that display it, only a VLT trips with an alarm
        Some('A') => {
            model.is_some_and(|model| model.catalogue.is_some_and(|tables| tables.model != VLT.model))
        }
        _ => false,
    };
    let all: Vec<&Catalogue> = match model {
        Some(model) => model.catalogue.into_iter().collect(),
        None if of_vlt => vec![&VLT],
        None => model::ALL
            .into_iter()
            .filter_map(|model| model.catalogue)
            .collect(),
    };
    if all.is_empty() {
        let message = "the profile has no fault numbers of its own: each model has others";
        return Err(NotExplained::new(message));
    }
    let mut lines = Vec::new();
    let faults = all.into_iter();
    let faults = faults.map(|tables| fault_of(tables, number, warning, &mut lines));
    let meaning = Meaning::Fault {
        r#as: "fault",
        number,
        warning,
        models: faults.collect(),
    };
    Ok((lines, meaning))
}

/// What a number means in a drive with these tables.
fn fault_of(tables: &Catalogue, number: u16, warning: bool, lines: &mut Vec<String>) -> FaultMeaning {
    let letter = if warning { 'n' } else { 'F' };
    let known = tables.fault(number, warning);
    let name = tables.model;
    let meaning = known.map_or_else(
        || format!("not in the table of the {name}"),
        |fault| fault.meaning.into(),
    );
    lines.push(format!("{name} {letter}{number}: {meaning}"));
    if let Some(fault) = known {
        lines.push(format!("  reaction {}", fault.reaction));
        lines.push(format!("  do       {}", fault.remedy));
        lines.push(format!("  cleared  {}", tables.clearing(fault.cleared)));
        let assumed = if fault.assumed.is_empty() {
            String::new()
        } else {
            format!(" (not in this source, assumed: {})", fault.assumed)
        };
        lines.push(format!("  source   {}{assumed}", fault.source));
    }
    FaultMeaning {
        model: name.to_ascii_lowercase(),
        meaning: known.map(|fault| fault.meaning),
        reaction: known.map(|fault| fault.reaction.text()),
        remedy: known.map(|fault| fault.remedy),
        cleared: known.map(|fault| tables.clearing(fault.cleared)),
        source: known.map(|fault| fault.source),
        recalled: known.map(|fault| fault.recalled),
    }
}

fn pnio(text: &str) -> Result<Parts, NotExplained> {
    let compact: String = text
        .chars()
        .filter(|c| !c.is_whitespace() && !matches!(c, '_' | ':'))
        .collect();
    let digits = compact
        .strip_prefix("0x")
        .or_else(|| compact.strip_prefix("0X"))
        .unwrap_or(&compact);
    let value = (digits.len() == 8)
        .then(|| u32::from_str_radix(digits, 16).ok())
        .flatten()
        .ok_or_else(|| {
            NotExplained::new(format!(
                "`{text}`: a PNIO status has four octets in hexadecimal, for example DE80B500"
            ))
        })?;
    let status = PnioStatus::from_u32(value);
    let lines = vec![
        format!("PNIO status {status}"),
        format!(
            "  ErrorCode 0x{:02X}, ErrorDecode 0x{:02X}, ErrorCode1 0x{:02X}, ErrorCode2 0x{:02X}",
            status.code, status.decode, status.code1, status.code2
        ),
    ];
    let meaning = Meaning::Pnio {
        r#as: "pnio",
        raw: value,
        hex: format!("{value:08X}"),
        meaning: status.to_string(),
        error_code: status.code,
        error_decode: status.decode,
        error_code1: status.code1,
        error_code2: status.code2,
    };
    Ok((lines, meaning))
}

/// Returns a 16-bit number: hexadecimal with 0x, binary with 0b, else decimal.
fn word(text: &str) -> Result<u16, NotExplained> {
    number(text, 16).map(|number| number as u16)
}

/// Returns a number of so many bits, up to 32.
fn number(text: &str, bits: u32) -> Result<u32, NotExplained> {
    let compact: String = text.trim().chars().filter(|c| *c != '_' && *c != ' ').collect();
    let lower = compact.to_ascii_lowercase();
    let parsed = if let Some(hex) = lower.strip_prefix("0x") {
        u32::from_str_radix(hex, 16)
    } else if let Some(binary) = lower.strip_prefix("0b") {
        u32::from_str_radix(binary, 2)
    } else {
        lower.parse()
    };
    parsed
        .ok()
        .filter(|number| u64::from(*number) < 1 << bits)
        .ok_or_else(|| {
            NotExplained::new(format!(
                "`{text}` is not a {bits}-bit number: write 0x047F, 1151 or 0b0000_0100_0111_1111"
            ))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str, kind: Kind) -> String {
        explain(text, kind, None, None).unwrap().lines.join("\n")
    }

    #[test]
    fn faults_of_the_named_model() {
        let explained = explain("13", Kind::Fault, None, Model::by_name("vlt")).unwrap();
        assert!(
            explained.lines[0].starts_with("VLT F13: "),
            "{:?}",
            explained.lines
        );
        assert!(!explained.lines.join("\n").contains("AKD"));
        let profile_alone = explain("13", Kind::Fault, None, Model::by_name("standard"));
        assert!(profile_alone.is_err(), "{profile_alone:?}");
    }

    #[test]
    fn without_a_model_a_fault_is_explained_for_each() {
        let text = lines("13", Kind::Fault);
        for name in ["AKD F13: ", "VLT F13: ", "VACON F13: "] {
            assert!(text.contains(name), "{text}");
        }
        let explained = explain("F439", Kind::Fault, None, None).unwrap();
        assert!(
            explained.lines[0].starts_with("AKD F439: Following error"),
            "{:?}",
            explained.lines
        );
        let others = "VLT F439: not in the table of the VLT";
        assert!(
            explained.lines.iter().any(|line| line == others),
            "{:?}",
            explained.lines
        );
        let Meaning::Fault { number, models, .. } = explained.meaning else {
            panic!("{:?}", explained.meaning);
        };
        let known: Vec<(&str, bool)> = models
            .iter()
            .map(|fault| (fault.model.as_str(), fault.meaning.is_some()))
            .collect();
        assert_eq!(
            (number, known),
            (439, vec![("akd", true), ("vlt", false), ("vacon", false)])
        );
    }

    /// As the displays write them.
    #[test]
    fn faults_are_named_by_the_letters_of_the_drives() {
        for (text, model, begin) in [
            ("W34", None, "VLT n34: "),
            ("A13", None, "VLT F13: "),
            ("a 13", None, "VLT F13: "),
            ("F 30", Some("vacon"), "VACON F30: "),
            ("A10", Some("vacon"), "VACON n10: "),
            ("n602", Some("akd"), "AKD n602: "),
        ] {
            assert_eq!(Kind::of(text), Some(Kind::Fault), "{text}");
            let model = model.and_then(Model::by_name);
            let lines = explain(text, Kind::Fault, None, model).unwrap().lines;
            assert!(lines[0].starts_with(begin), "{text}: {lines:?}");
        }
        for text in ["34", "0x34", "W", "F0x13", "DE80B500", "A1G", "", "Ä1"] {
            assert_eq!(Kind::of(text), None, "{text}");
        }
    }

    #[test]
    fn numbers_and_formats_of_the_named_model() {
        let explained = |text, kind, model: &str| {
            explain(text, kind, None, Model::by_name(model))
                .unwrap()
                .lines
                .join("\n")
        };
        let refused = explained("130", Kind::Error, "vlt");
        assert!(
            refused.contains("in a parameter channel (PKW) of Danfoss: "),
            "{refused}"
        );
        let own = explained("0x66", Kind::Error, "vlt");
        assert!(own.starts_with("parameter error 0x66 unknown service"), "{own}");
        assert!(
            !own.contains("Vacon") && lines("0x66", Kind::Error).contains("Vacon"),
            "{own}"
        );
        assert!(
            explained("33", Kind::Format, "vlt")
                .starts_with("format 0x21: N2\n  in PROFIdrive V4: OctetString8")
        );
        assert!(lines("33", Kind::Format).starts_with("format 0x21: OctetString8"));
    }

    #[test]
    fn control_word_with_names_and_nibbles() {
        let text = lines("0x047F", Kind::Stw1);
        assert!(text.starts_with("STW1 0x047F   0000 0100 0111 1111\n"), "{text}");
        assert!(
            text.contains("set    ON, EN_OP, EN_RAMP, UNFREEZE, EN_SETPOINT, CTRL_PLC\n"),
            "{text}"
        );
        assert!(
            text.contains("stops  OFF2 not active, OFF3 not active\n"),
            "{text}"
        );
        assert_eq!(lines("1151", Kind::Stw1), text);
        assert_eq!(lines("0b0000_0100_0111_1111", Kind::Stw1), text);
    }

    #[test]
    fn faults_states_and_statuses() {
        assert!(lines("F702", Kind::Fault).starts_with("AKD F702: "));
        assert!(lines("702", Kind::Fault).starts_with("AKD F702: "));
        let following = lines("n439", Kind::Fault);
        assert!(
            following.contains("\n  reaction none\n  do       look for"),
            "{following}"
        );
        assert!(following.contains("\n  cleared  by itself"), "{following}");
        assert!(lines("9", Kind::Fault).contains("not in the table"));
        assert_eq!(lines("0x0237", Kind::State), "ZSW1 0x0237: S4 operation");
        assert!(lines("S4", Kind::State).starts_with("S4 operation\n"));
        let both = explain("s5", Kind::State, None, None).unwrap().meaning;
        assert!(matches!(both, Meaning::States { states, .. } if states.len() == 2));
        assert!(lines("DE80B500", Kind::Pnio).contains("state conflict"));
    }

    /// AKD PROFINET manual 5.15, 6.4 and 8.1: causes in its meaning, remedies in what to do.
    #[test]
    fn fault_702_has_all_its_causes_and_remedies() {
        let text = lines("702", Kind::Fault);
        let (meaning, rest) = text.split_once('\n').unwrap();
        for cause in [
            "watchdog elapsed (network, controller or drive overloaded)",
            "connection released while the drive was enabled",
            "controller from RUN to STOP with FBUS.PARAM02 bit 0 = 1",
        ] {
            assert!(meaning.contains(cause), "{cause}: {meaning}");
        }
        for remedy in [
            "a subnet of its own",
            "a PROFINET switch",
            "shorten the run time of the PLC program",
            "longer watchdog time (PN.TIMEOUTFTHRESH, PNU 3022",
            "disable device discovery",
            "FBUS.PARAM02 bit 0 = 0",
        ] {
            assert!(rest.contains(remedy), "{remedy}: {rest}");
        }
    }

    #[test]
    fn wrong_numbers_are_refused() {
        for (text, kind) in [
            ("0x10000", Kind::Stw1),
            ("fast", Kind::State),
            ("DE80", Kind::Pnio),
            ("", Kind::Fault),
        ] {
            assert!(explain(text, kind, None, None).is_err(), "{text}");
        }
    }

    #[test]
    fn words_of_the_vendors() {
        let text = lines("0x047C", Kind::CtwFc);
        assert!(
            text.starts_with("Danfoss FC control word 0x047C   0000 0100 0111 1100\n"),
            "{text}"
        );
        assert!(text.contains("means  run: follows the setpoint\n"), "{text}");
        for (word, kind, means) in [
            ("0x043C", Kind::CtwFc, "ready: OFF, ramp stop if turning (OFF1)"),
            ("0x0478", Kind::CtwFc, "stop with direct current (DC brake)"),
            ("0x846C", Kind::CtwFc, "quick stop (OFF3), reverse"),
            ("0x0474", Kind::CtwFc, "coast stop (OFF2)"),
            (
                "0x007C",
                Kind::CtwFc,
                "no control by the PLC: the drive ignores the word",
            ),
            ("0x047F", Kind::CtwVlt, "run: follows the setpoint"),
            ("0x045F", Kind::CtwVlt, "holds the speed"),
            ("0x047F", Kind::CtwVacon, "run: follows the setpoint"),
            ("0x0F07", Kind::StwFc, "S4 operation"),
            ("0x0608", Kind::StwVlt, "S1 switching on inhibited, with a fault"),
        ] {
            let text = lines(word, kind);
            assert!(
                text.contains(&format!("means  {means}\n")),
                "{word} {kind:?}: {text}"
            );
        }
        for (_, _, kind) in KINDS.into_iter().filter(|(.., kind)| *kind != Kind::Pnio) {
            let explained = explain("0x80000000", kind, None, None);
            assert_eq!(
                explained.is_ok(),
                matches!(
                    kind,
                    Kind::AlarmWord | Kind::AlarmWord2 | Kind::WarningWord | Kind::WarningWord2
                ),
                "{kind:?}"
            );
        }
    }

    #[test]
    fn alarm_words_name_their_faults() {
        let first = VLT
            .faults
            .iter()
            .find(|fault| !fault.warning && fault.bit.is_some_and(|bit| bit < 32))
            .unwrap();
        let text = lines(&format!("0x{:X}", 1_u64 << first.bit.unwrap()), Kind::AlarmWord);
        assert!(
            text.contains(&format!("F{}", first.number)) && text.contains(first.meaning),
            "{text}"
        );
        assert!(lines("0", Kind::WarningWord).contains("no warning"));
    }

    #[test]
    fn pke_from_both_sides() {
        let text = lines("0x15FA", Kind::Pke);
        assert!(
            text.contains("15-30") && text.contains("AK 1 request value"),
            "{text}"
        );
    }
}
