//! Alarms and their diagnosis.

use std::borrow::Cow;

use profinet::wire::alarm::{
    AlarmAck, AlarmSpecifier, AlarmType, ChannelDiagnosis, Notification, Priority, RtaPdu, RtaType,
};

use super::*;

fn alarm(alarm_type: AlarmType, diagnosis: &ChannelDiagnosis) -> Notification<'static> {
    let mut data = Vec::new();
    diagnosis.encode(&mut data);
    Notification {
        priority: Priority::Low,
        alarm_type,
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        module_ident: 1,
        submodule_ident: 1,
        specifier: AlarmSpecifier(3),
        usi: Some(diagnosis.usi()),
        data: Cow::Owned(data),
    }
}

fn pdu(from: u8, to: u8, sequence: u16, data: &[u8]) -> Vec<u8> {
    let mut payload = Vec::new();
    RtaPdu {
        destination: 1,
        source: 1,
        kind: RtaType::Data,
        version: 1,
        flags: RtaPdu::FLAGS_DATA,
        send_sequence: sequence,
        ack_sequence: 0xFFFE,
        data,
    }
    .encode(&mut payload);
    frame(from, mac(to), FrameId::ALARM_LOW, &payload)
}

fn notification(alarm: &Notification<'_>, sequence: u16) -> Vec<u8> {
    let mut data = Vec::new();
    alarm.encode(&mut data);
    pdu(DRIVE, PLC, sequence, &data)
}

fn ack(alarm: &Notification<'_>) -> Vec<u8> {
    let mut data = Vec::new();
    AlarmAck::to(alarm, PnioStatus::OK).encode(&mut data);
    pdu(PLC, DRIVE, 0xFFFF, &data)
}

const fn diagnosis(channel: u16, properties: u16, extended: Option<(u16, u32)>) -> ChannelDiagnosis {
    ChannelDiagnosis {
        channel,
        properties,
        error_type: 6,
        extended,
        qualifier: None,
    }
}

/// Every specifier is read, not only "appears"; channel and extended error are shown.
#[test]
fn the_specifier_of_a_diagnosis_is_decoded() {
    let extended = Some((0x8001, 5));
    for (properties, weight, words) in [
        (
            0x2801,
            Weight::Warning,
            "input channel 3: wire break (0x0006) appears",
        ),
        (
            0x3001,
            Weight::Normal,
            "input channel 3: wire break (0x0006) disappears",
        ),
        (
            0x3801,
            Weight::Warning,
            "input channel 3: wire break (0x0006) disappears, others remain",
        ),
        (
            0x2001,
            Weight::Normal,
            "input channel 3: wire break (0x0006) all disappear",
        ),
        (
            0x0A01,
            Weight::Warning,
            "channel 3: maintenance required, wire break (0x0006) appears",
        ),
    ] {
        let alarm = alarm(AlarmType::DIAGNOSIS, &diagnosis(3, properties, extended));
        let mut capture = Capture::default();
        let texts = capture.at(0, &notification(&alarm, 0xFFFF));
        let expected = format!(
            "alarm (low): diagnosis at slot 1/1 API 0x3A00; {words}, extended error 0x8001, value 0x00000005"
        );
        assert_eq!(texts, [expected]);
        assert_eq!(capture.last().weight, weight, "{words}");
        let Detail::Alarm(found) = &capture.last().detail else {
            panic!("{:?}", capture.last());
        };
        let numbers = &found.diagnosis[0];
        assert_eq!(
            (numbers.channel, numbers.ext_error_type, numbers.add_value),
            (Some(3), Some(0x8001), Some(5))
        );
    }
    let whole = alarm(AlarmType::DIAGNOSIS, &diagnosis(0x8000, 0x0800, None));
    let texts = Capture::default().at(0, &notification(&whole, 0xFFFF));
    assert!(
        texts[0].ends_with("; whole submodule: wire break (0x0006) appears"),
        "{texts:?}"
    );
}

#[test]
fn alarms_without_acknowledgement_and_acknowledgements_without_alarm() {
    let alarm = alarm(AlarmType::DIAGNOSIS, &diagnosis(3, 0x0800, None));
    let mut capture = Capture::default();
    capture.at(0, &notification(&alarm, 0xFFFF));
    assert_eq!(
        capture.at(10, &ack(&alarm)),
        ["alarm acknowledged: diagnosis appears"]
    );
    assert_eq!(capture.wait(9000), [""; 0]);
    capture.at(10_000, &notification(&alarm, 0));
    assert_eq!(
        capture.at(10_100, &notification(&alarm, 0)),
        ["alarm PDU 0x0000 sent again: it was not confirmed (ACK)"]
    );
    assert_eq!(
        capture.wait(15_000),
        ["alarm diagnosis at slot 1/1 API 0x3A00: not acknowledged within 5 s"]
    );
    assert_eq!(capture.last().frame, 4, "the frame of the alarm");

    let mut capture = Capture::default();
    let texts = capture.at(0, &ack(&alarm));
    assert_eq!(
        texts[1],
        "acknowledgement of an alarm diagnosis appears that is not in the capture"
    );
}

#[test]
fn stations_with_alarms_are_bounded() {
    let alarm = alarm(AlarmType::DIAGNOSIS, &diagnosis(3, 0x0800, None));
    let mut frame = notification(&alarm, 0xFFFF);
    let mut capture = Capture::default();
    for number in 0..4100 {
        sent_by(number, &mut frame);
        capture.walker.frame(Duration::ZERO, &frame);
    }
    assert_eq!(capture.walker.incidents.len(), MAX_STATIONS);
    // the repetition of a PDU is noticed where the one before is stored
    for (number, noticed) in [(0, true), (4095, true), (4096, false)] {
        sent_by(number, &mut frame);
        let texts = capture.at(0, &frame);
        assert_eq!(texts[0].contains("sent again"), noticed, "{number}: {texts:?}");
    }
}
