//! What an explained number means, for programs.

use serde::Serialize;

/// What a number means. `as` says what it was explained as.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Meaning {
    /// A control or status word whose bits depend on the mode of the drive.
    ModeWord {
        /// `stw1` or `zsw1`.
        r#as: &'static str,
        /// The word in the mode that was named, else in velocity mode.
        #[serde(flatten)]
        word: WordInMode,
        /// The same in position mode, where no mode was named.
        position: Option<WordInMode>,
    },
    /// A control or status word of a vendor.
    Word {
        /// `ctw-fc`, `stw-vacon`, ..
        r#as: &'static str,
        /// Whose word it is.
        profile: &'static str,
        /// What the whole word commands or reports.
        meaning: String,
        /// Its bits.
        word: WordBits,
    },
    /// An alarm or warning word: each bit is a fault or a warning.
    AlarmWord {
        /// `alarm-word`, `warning-word2`, ..
        r#as: &'static str,
        /// The number.
        raw: u32,
        /// The same in hexadecimal.
        hex: String,
        /// The bits that are set.
        set: Vec<AlarmBit>,
    },
    /// States by their name.
    States {
        /// `state`.
        r#as: &'static str,
        /// The states that have this name.
        states: Vec<StateMeaning>,
    },
    /// The state that a status word reports.
    State {
        /// `state`.
        r#as: &'static str,
        /// The word.
        raw: u16,
        /// The state: `S4`.
        state: &'static str,
        /// The state in words.
        meaning: String,
    },
    /// A fault or a warning.
    Fault {
        /// `fault`.
        r#as: &'static str,
        /// The vendor's number.
        number: u16,
        /// Whether it is a warning.
        warning: bool,
        /// What it means in a drive of the model that was named; where none was, in a drive of each.
        models: Vec<FaultMeaning>,
    },
    /// A PNIO status.
    Pnio {
        /// `pnio`.
        r#as: &'static str,
        /// The number.
        raw: u32,
        /// The same in hexadecimal.
        hex: String,
        /// What it means.
        meaning: String,
        /// ErrorCode.
        error_code: u8,
        /// ErrorDecode.
        error_decode: u8,
        /// ErrorCode1.
        error_code1: u8,
        /// ErrorCode2.
        error_code2: u8,
    },
    /// An error number of a refused parameter.
    Error {
        /// `error`.
        r#as: &'static str,
        /// The number.
        raw: u16,
        /// What it means.
        meaning: String,
        /// What to do.
        remedy: Option<&'static str>,
        /// What it means in a drive of Danfoss, where no model was named.
        danfoss: Option<&'static str>,
        /// What it means in a drive of Vacon, where no model was named.
        vacon: Option<&'static str>,
        /// What the same number means in a parameter channel (PKW).
        channel: Option<&'static str>,
    },
    /// A format code.
    Format {
        /// `format`.
        r#as: &'static str,
        /// The code.
        raw: u8,
        /// Its name in PROFIdrive V4.
        v4: Option<&'static str>,
        /// Its name in older drives.
        v3: Option<&'static str>,
    },
    /// PKE of a parameter channel.
    Pke {
        /// `pke`.
        r#as: &'static str,
        /// The word.
        raw: u16,
        /// Kind of request or reply (AK).
        ak: u8,
        /// Parameter number over the FC protocol and USS.
        pnu: u16,
        /// Parameter number in a PPO.
        pnu_ppo: u16,
        /// What it requests.
        request: &'static str,
        /// What it replies.
        reply: &'static str,
    },
}

/// What the number of a fault or a warning means in a drive of one model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FaultMeaning {
    /// The model.
    pub model: String,
    /// What it means; null with the rest where it is not in the table.
    pub meaning: Option<&'static str>,
    /// What the drive does about it.
    pub reaction: Option<&'static str>,
    /// What to do.
    pub remedy: Option<&'static str>,
    /// What ends it once the cause is gone.
    pub cleared: Option<String>,
    /// Where this is written.
    pub source: Option<&'static str>,
    /// Whether it is from memory: there is no document at hand.
    pub recalled: Option<bool>,
}

/// A word in one mode of the drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WordInMode {
    /// `velocity` or `position`.
    pub mode: &'static str,
    /// What the whole word commands or reports.
    pub meaning: String,
    /// Its bits.
    pub word: WordBits,
}

/// A word with all of its bits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WordBits {
    /// The word.
    pub number: u16,
    /// The same in hexadecimal.
    pub hex: String,
    /// The same in binary.
    pub binary: String,
    /// Its bits, the lowest first.
    pub bits: Vec<WordBit>,
}

/// A bit of a word.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WordBit {
    /// Its number.
    pub bit: u8,
    /// Its name.
    pub name: &'static str,
    /// Whether it is set.
    pub set: bool,
    /// What that means.
    pub meaning: &'static str,
}

/// A fault or a warning behind a bit of an alarm or warning word.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlarmBit {
    /// The bit.
    pub bit: u8,
    /// The vendor's number; null where the bit is not in the table.
    pub number: Option<u16>,
    /// What it means.
    pub meaning: &'static str,
    /// What to do.
    pub remedy: Option<&'static str>,
    /// Whether it is from memory: there is no document at hand.
    pub recalled: Option<bool>,
}

/// A state of the general state machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateMeaning {
    /// `S4`.
    pub state: String,
    /// `operation`.
    pub name: &'static str,
    /// Whether the power stage switches.
    pub pulses: bool,
    /// What the motor does.
    pub motor: &'static str,
    /// How it is left.
    pub left_to: Vec<StateWay>,
    /// How it is reached.
    pub reached_from: Vec<StateWay>,
}

/// A transition between states.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateWay {
    /// The other state.
    pub state: String,
    /// What leads there.
    pub by: String,
}
