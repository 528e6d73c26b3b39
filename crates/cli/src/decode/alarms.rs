//! Alarms in words.

use profinet::wire::DecodeError;
use profinet::wire::alarm::{Alarm, DiagnosisItem, Priority, RtaPdu, RtaType};
use profinet::wire::ethernet::Frame;
use profinet::wire::status::abort;

use super::{Sink, Weight, records};

pub fn pdu(frame: &Frame<'_>, sink: &mut Sink<'_>) -> Result<(), DecodeError> {
    let pdu = RtaPdu::parse(frame.payload)?;
    match pdu.kind {
        RtaType::Data => match pdu.alarm()? {
            Alarm::Notification(alarm) => {
                let priority = if alarm.priority == Priority::High {
                    "high"
                } else {
                    "low"
                };
                let place = records::place(alarm.api, alarm.slot, alarm.subslot);
                let mut text = format!("alarm ({priority}): {} at {place}", alarm.alarm_type);
                for item in alarm.items() {
                    match item? {
                        DiagnosisItem::Channel(channel) => {
                            let words = channel.error_words().unwrap_or("error of the maker");
                            text = format!("{text}; {words} (0x{:04X})", channel.error_type);
                        }
                        DiagnosisItem::Maintenance(_) => text.push_str("; maintenance"),
                        DiagnosisItem::Other { usi, data } => {
                            text = format!("{text}; 0x{usi:04X} {}", records::content(data));
                        }
                    }
                }
                sink.note(Weight::Warning, "alarm", text);
            }
            Alarm::Ack(ack) if ack.status.is_ok() => {
                sink.note(
                    Weight::Normal,
                    "alarm",
                    format!("alarm acknowledged: {}", ack.alarm_type),
                );
            }
            Alarm::Ack(ack) => {
                sink.note(
                    Weight::Error,
                    "alarm",
                    format!("alarm {} refused: {}", ack.alarm_type, ack.status),
                );
            }
        },
        RtaType::Err => {
            let status = pdu.error()?;
            let (weight, how) = match status.code2 {
                abort::RELEASED => (Weight::Normal, "connection ended"),
                _ => (Weight::Error, "connection ended by an error"),
            };
            sink.note(weight, "alarm", format!("{how}: {status}"));
        }
        RtaType::Nack => sink.note(Weight::Warning, "alarm", "alarm sequence not expected (NACK)"),
        RtaType::Ack => {}
        RtaType::Other(kind) => sink.note(Weight::Warning, "alarm", format!("unknown RTA type {kind}")),
    }
    Ok(())
}
