//! Alarms in words, their acknowledgements matched with them.

use std::collections::HashMap;
use std::time::Duration;

use profinet::MacAddress;
use profinet::wire::DecodeError;
use profinet::wire::alarm::{Alarm, AlarmAck, AlarmType, Notification, Priority, RtaPdu, RtaType};
use profinet::wire::ethernet::Frame;
use profinet::wire::status::abort;

use super::event::{self, Detail, Origin, Sink, Trouble};
use super::names::seconds;
use super::pending::{CUT_OFF, Pending};
use super::{diagnosis, records};
use crate::Weight;

/// Topic of the events.
const TOPIC: &str = "alarm";
/// Time for the acknowledgement of an alarm, longer than any controller takes.
const ACK_TIMEOUT: Duration = Duration::from_secs(5);
/// Most pairs of stations whose last PDU is stored.
const MAX_PAIRS: usize = 4096;

/// Device, controller, and what an acknowledgement repeats of its alarm.
type Key = (MacAddress, MacAddress, u16, u32, u16, u16, u16);

/// The alarms of a capture that may still be acknowledged.
#[derive(Debug, Default)]
pub struct Alarms {
    open: Pending<Key, Waiting>,
    /// Sequence number of the last data PDU of a sender to a receiver, with its FrameID and endpoint.
    last: HashMap<(MacAddress, MacAddress, u16, u16), u16>,
}

#[derive(Debug, Default)]
struct Waiting {
    origin: Origin,
    what: String,
}

impl Alarms {
    /// Looks at one PDU.
    pub fn pdu(&mut self, frame: &Frame<'_>, sink: &mut Sink<'_>) -> Result<(), DecodeError> {
        let pdu = RtaPdu::parse(frame.payload)?;
        match pdu.kind {
            RtaType::Data => {
                if self.is_repeated(frame, &pdu) {
                    let sequence = pdu.send_sequence;
                    let text = format!("alarm PDU 0x{sequence:04X} sent again: it was not confirmed (ACK)");
                    let trouble = Trouble::Repeated { sequence };
                    sink.report(Weight::Warning, TOPIC, text, Detail::Trouble(trouble));
                    return Ok(());
                }
                match pdu.alarm()? {
                    Alarm::Notification(alarm) => self.notification(frame, &alarm, sink)?,
                    Alarm::Ack(ack) => self.ack(frame, &ack, sink),
                }
            }
            RtaType::Err => {
                self.last.retain(|&(from, to, ..), _| {
                    ![(from, to), (to, from)].contains(&(frame.source, frame.destination))
                });
                let status = pdu.error()?;
                let (weight, how) = match status.code2 {
                    abort::RELEASED => (Weight::Normal, "connection ended"),
                    _ => (Weight::Error, "connection ended by an error"),
                };
                let detail = event::Alarm {
                    step: "abort",
                    status: Some(records::number(status)),
                    ..event::Alarm::default()
                };
                sink.report(weight, TOPIC, format!("{how}: {status}"), Detail::Alarm(detail));
            }
            RtaType::Nack => {
                let detail = event::Alarm {
                    step: "nack",
                    sequence: Some(pdu.ack_sequence),
                    ..event::Alarm::default()
                };
                let text = "alarm sequence not expected (NACK)";
                sink.report(Weight::Warning, TOPIC, text, Detail::Alarm(detail));
            }
            RtaType::Ack => {}
            RtaType::Other(kind) => {
                let text = format!("unknown RTA type {kind}");
                let trouble = Trouble::Unknown { service: kind.into() };
                sink.report(Weight::Warning, TOPIC, text, Detail::Trouble(trouble));
            }
        }
        Ok(())
    }

    /// Reports the alarms that stayed unacknowledged until `now`.
    pub fn give_up(&mut self, now: Duration, sink: &mut Sink<'_>) {
        while let Some((deadline, waiting)) = self.open.due(now) {
            let waited = deadline.min(sink.at).saturating_sub(waiting.origin.at);
            if waited < CUT_OFF {
                continue;
            }
            let text = format!("{}: not acknowledged within {}", waiting.what, seconds(waited));
            let trouble = Trouble::Unanswered {
                what: waiting.what,
                sent: 1,
                waited,
            };
            sink.report_of(
                waiting.origin,
                Weight::Warning,
                TOPIC,
                text,
                Detail::Trouble(trouble),
            );
        }
    }

    fn is_repeated(&mut self, frame: &Frame<'_>, pdu: &RtaPdu<'_>) -> bool {
        let pair = (frame.source, frame.destination, frame.frame_id.0, pdu.destination);
        if self.last.len() >= MAX_PAIRS && !self.last.contains_key(&pair) {
            return false;
        }
        self.last.insert(pair, pdu.send_sequence) == Some(pdu.send_sequence)
    }

    fn notification(
        &mut self,
        frame: &Frame<'_>,
        alarm: &Notification<'_>,
        sink: &mut Sink<'_>,
    ) -> Result<(), DecodeError> {
        let priority = priority(alarm.priority);
        let place = records::place(alarm.api, alarm.slot, alarm.subslot);
        let mut weight = Weight::Normal;
        let mut texts = String::new();
        let mut found = Vec::new();
        for item in alarm.items() {
            let item = diagnosis::item(&item?);
            weight = weight.max(item.weight);
            texts = format!("{texts}; {}", item.text);
            found.extend(item.numbers);
        }
        let is_diagnosis = matches!(
            alarm.alarm_type,
            AlarmType::DIAGNOSIS | AlarmType::DIAGNOSIS_DISAPPEARS
        );
        // what appears and what goes is in the specifier of each item
        let what = if is_diagnosis && !found.is_empty() {
            "diagnosis".to_owned()
        } else {
            weight = Weight::Warning;
            alarm.alarm_type.to_string()
        };
        let text = format!("alarm ({priority}): {what} at {place}{texts}");
        let detail = event::Alarm {
            step: "notification",
            alarm_type: Some(alarm.alarm_type.0),
            priority: Some(priority),
            api: Some(alarm.api),
            slot: Some(alarm.slot),
            subslot: Some(alarm.subslot),
            sequence: Some(alarm.specifier.sequence()),
            diagnosis: found,
            status: None,
        };
        sink.report(weight, TOPIC, text, Detail::Alarm(detail));
        let waiting = Waiting {
            origin: sink.origin(),
            what: format!("alarm {what} at {place}"),
        };
        let key = (
            frame.source,
            frame.destination,
            alarm.alarm_type.0,
            alarm.api,
            alarm.slot,
            alarm.subslot,
            alarm.specifier.sequence(),
        );
        self.open.insert(key, sink.at + ACK_TIMEOUT, waiting);
        Ok(())
    }

    fn ack(&mut self, frame: &Frame<'_>, ack: &AlarmAck, sink: &mut Sink<'_>) {
        let key = (
            frame.destination,
            frame.source,
            ack.alarm_type.0,
            ack.api,
            ack.slot,
            ack.subslot,
            ack.specifier.sequence(),
        );
        let (weight, text) = if ack.status.is_ok() {
            (Weight::Normal, format!("alarm acknowledged: {}", ack.alarm_type))
        } else {
            let text = format!("alarm {} refused: {}", ack.alarm_type, ack.status);
            (Weight::Error, text)
        };
        let detail = event::Alarm {
            step: "acknowledgement",
            alarm_type: Some(ack.alarm_type.0),
            priority: Some(priority(ack.priority)),
            api: Some(ack.api),
            slot: Some(ack.slot),
            subslot: Some(ack.subslot),
            sequence: Some(ack.specifier.sequence()),
            diagnosis: Vec::new(),
            status: Some(records::number(ack.status)),
        };
        sink.report(weight, TOPIC, text, Detail::Alarm(detail));
        if self.open.remove(&key).is_none() {
            let what = format!("alarm {}", ack.alarm_type);
            let text = format!("acknowledgement of an {what} that is not in the capture");
            sink.report(
                Weight::Warning,
                TOPIC,
                text,
                Detail::Trouble(Trouble::Unasked { what }),
            );
        }
    }
}

const fn priority(priority: Priority) -> &'static str {
    match priority {
        Priority::High => "high",
        Priority::Low => "low",
    }
}
