//! What a front end hands on to other programs as it is. Types with ids are their ids, times are seconds.

use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};

use crate::axis::{Sample, SpeedUnit};
use crate::status::{Cause, Verdict};
use crate::{Action, Advice, AdvicePart, Choice, ErrorKind, Rest};

/// Types that are one of a few, by their stable names.
macro_rules! by_id {
    ($($type:ty => $id:expr),+ $(,)?) => {
        $(impl Serialize for $type {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let id: fn(&Self) -> &'static str = $id;
                serializer.serialize_str(id(self))
            }
        })+
    };
}

by_id! {
    ErrorKind => |kind| kind.id(),
    Rest => |rest| rest.id(),
    Cause => |cause| cause.id(),
    Choice => |choice| choice.id(),
    SpeedUnit => |unit| unit.symbol(),
    Verdict => |verdict| verdict.id(),
}

/// As [`Action::id`] and [`Action::arguments`].
impl Serialize for Action {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut action = serializer.serialize_struct("Action", 2)?;
        action.serialize_field("action", self.id())?;
        action.serialize_field("arguments", &self.arguments())?;
        action.end()
    }
}

/// A list of texts and actions in their order.
impl Serialize for Advice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.parts())
    }
}

impl Serialize for AdvicePart {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Text(text) => text.serialize(serializer),
            Self::Action(action) => action.serialize(serializer),
        }
    }
}

/// With its words as numbers; the octets are lists.
impl Serialize for Sample {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut sample = serializer.serialize_struct("Sample", 10)?;
        let time = self.at - profinet::Instant::ZERO;
        sample.serialize_field("time", &time.as_secs_f64())?;
        sample.serialize_field("number", &self.number)?;
        sample.serialize_field("missed", &self.missed)?;
        sample.serialize_field("stw1", &self.command.stw1.0)?;
        sample.serialize_field("zsw1", &self.seen.zsw1.0)?;
        sample.serialize_field("status_word", &self.seen.word)?;
        sample.serialize_field("nist_a", &self.seen.nist_a)?;
        sample.serialize_field("xist_a", &self.seen.xist_a)?;
        sample.serialize_field("inputs", &*self.inputs)?;
        sample.serialize_field("outputs", &*self.outputs)?;
        sample.end()
    }
}
