//! Data exchange and alarms while it runs.

use super::*;
use crate::alarm::{AlarmConfig, Alarms};
use crate::wire::alarm::AlarmType;

/// Returns the controller's side of the alarm connection.
fn alarms(rig: &Rig) -> Alarms {
    let config = *rig.device.controller.as_ref().unwrap().alarms.config();
    Alarms::new(AlarmConfig {
        local: config.peer,
        peer: config.local,
        local_reference: config.peer_reference,
        peer_reference: config.local_reference,
        ..config
    })
}

/// Carries alarm frames both ways until both sides are idle; returns the events of the controller.
fn settle(rig: &mut Rig, controller: &mut Alarms) -> Vec<AlarmEvent> {
    let mut seen = Vec::new();
    let mut buffer = [0; crate::MAX_FRAME];
    for _ in 0..20 {
        for sent in rig.drain() {
            let Sent::Frame(bytes) = sent else { continue };
            if let Some(event) = controller.handle_frame(rig.now, &Frame::parse(&bytes).unwrap()) {
                if let AlarmEvent::Raised(alarm) = &event {
                    controller.acknowledge(alarm, PnioStatus::OK);
                }
                seen.push(event);
            }
        }
        while let Some(length) = controller.poll_transmit(rig.now, &mut buffer) {
            rig.device.handle_frame(rig.now, &buffer[..length]);
        }
    }
    seen
}

#[test]
fn alarms_reach_the_controller_and_come_back_acknowledged() {
    let mut rig = Rig::new(config());
    let process = AlarmType::PROCESS;
    let now = rig.now;
    assert_eq!(
        rig.device.raise_alarm(now, 1, 1, process, None, &[]),
        Err(RaiseError::NotConnected)
    );
    rig.exchange(&Wish::controller(1));
    let mut controller = alarms(&rig);
    let now = rig.now;
    let missing = RaiseError::NoSubmodule { slot: 3, subslot: 1 };
    assert_eq!(
        rig.device.raise_alarm(now, 3, 1, process, None, &[]),
        Err(missing)
    );
    assert_eq!(
        rig.device.raise_alarm(now, 1, 1, process, Some(0x10), b"data"),
        Ok(0)
    );
    assert_eq!(
        rig.device.raise_alarm(now, 1, 1, process, Some(0x10), b"more"),
        Ok(1)
    );
    let seen = settle(&mut rig, &mut controller);
    let [AlarmEvent::Raised(first), AlarmEvent::Raised(_)] = &seen[..] else {
        panic!("{seen:?}")
    };
    assert_eq!(
        (first.api, first.module_ident, first.submodule_ident),
        (DRIVE_API, TELEGRAM_1, 0x11)
    );
    let ar = rig.device.controller().unwrap();
    let done = |sequence| Event::AlarmAcknowledged {
        ar,
        alarm_type: process,
        sequence,
        status: PnioStatus::OK,
    };
    assert_eq!(rig.events(), [done(0), done(1)]);
}

#[test]
fn a_diagnosis_is_reported_by_alarm_and_data_status() {
    let mut rig = Rig::new(config());
    rig.exchange(&Wish::controller(1));
    let mut controller = alarms(&rig);
    let item = crate::wire::alarm::ChannelDiagnosis {
        channel: 0x8000,
        properties: 0,
        error_type: 9,
        extended: None,
        qualifier: None,
    };
    for (pending, alarm_type, status) in [
        (true, AlarmType::DIAGNOSIS, 0x15),
        (false, AlarmType::DIAGNOSIS_DISAPPEARS, 0x35),
    ] {
        assert!(rig.device.set_diagnosis(rig.now, 1, 1, item, pending));
        let seen = settle(&mut rig, &mut controller);
        let Some(AlarmEvent::Raised(alarm)) = seen.first() else {
            panic!("{seen:?}")
        };
        assert_eq!((alarm.alarm_type, alarm.usi), (alarm_type, Some(0x8000)));
        assert_eq!(
            rig.device.controller.as_ref().unwrap().provider.status().0,
            status
        );
    }
}

#[test]
fn a_controller_that_acknowledges_nothing_is_given_up() {
    let mut rig = Rig::new(config());
    let mut provider = rig.exchange(&Wish::controller(1));
    rig.device
        .raise_alarm(rig.now, 1, 1, AlarmType::PROCESS, None, &[])
        .unwrap();
    let mut sent = Vec::new();
    for _ in 0..60 {
        rig.device.handle_timeout(rig.now);
        sent.extend(rig.drain());
        if rig.device.controller().is_none() {
            break;
        }
        rig.output(&mut provider);
    }
    assert_eq!(last_word(&sent), Some(PnioStatus::aborted(abort::ALARM_SEND)));
}

#[test]
fn an_alarm_of_the_controller_is_refused_not_ignored() {
    let mut rig = Rig::new(config());
    rig.exchange(&Wish::controller(1));
    let mut controller = alarms(&rig);
    let alarm = Notification {
        priority: crate::wire::alarm::Priority::Low,
        alarm_type: AlarmType::PULL,
        api: 0,
        slot: 0,
        subslot: 1,
        module_ident: 1,
        submodule_ident: 1,
        specifier: crate::wire::alarm::AlarmSpecifier(0),
        usi: None,
        data: alloc::borrow::Cow::Borrowed(&[]),
    };
    controller.raise(rig.now, alarm).unwrap();
    let seen = settle(&mut rig, &mut controller);
    let [AlarmEvent::Acknowledged(ack)] = &seen[..] else {
        panic!("{seen:?}")
    };
    assert_eq!(ack.status, PnioStatus::from_u32(0xDA81_3C00));
}

#[test]
fn frames_of_others_neither_feed_nor_kill() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    let mut provider = rig.exchange(&wish);
    provider.set_data(1, 1, &[1, 2, 3, 4], Iops::GOOD);
    rig.output(&mut provider);
    let mut buffer = [0; crate::MAX_FRAME];
    let due = provider.next_send();
    let length = provider.emit(due, &mut buffer).unwrap();
    let good = buffer[..length].to_vec();
    let spoil = |at: usize, value: u8| {
        let mut frame = good.clone();
        frame[at] = value;
        frame
    };
    let (source, frame_id, data, valid, transfer) = (11, 19, 20, length - 2, length - 1);
    let bad = [
        spoil(source, 9),
        spoil(frame_id, 9),
        spoil(0, 0x06),
        spoil(valid, 0x31),
        spoil(transfer, 1),
        good[..length - 1].to_vec(),
    ];
    for frame in bad {
        rig.device.handle_frame(rig.now, &frame);
        rig.device.handle_frame(rig.now, &spoil(data, 0xFF)[..30]);
    }
    assert_eq!(rig.device.output(1, 1).unwrap().0, [1, 2, 3, 4]);
    assert!(rig.events().is_empty());
    rig.pass(47);
    assert!(rig.device.is_exchanging());
    rig.pass(1);
    assert!(!rig.device.is_exchanging());
}

#[test]
fn the_application_steps_before_the_frame_goes_out() {
    let mut rig = Rig::new(config());
    rig.exchange(&Wish::controller(1));
    rig.now = rig.device.next_cycle().unwrap();
    // the cycle is due, but nothing is sent before the time was handled
    assert!(rig.drain().is_empty());
    rig.device.set_input(1, 1, &[9, 8, 7, 6], Iops::GOOD);
    rig.device.handle_timeout(rig.now);
    let sent = rig.drain();
    let [Sent::Frame(frame)] = &sent[..] else {
        panic!("{sent:?}")
    };
    assert_eq!(Frame::parse(frame).unwrap().payload[3..8], [9, 8, 7, 6, 0x80]);
    assert_eq!(
        rig.device.next_cycle().unwrap() - rig.now,
        rig.device.send_interval().unwrap()
    );
}
