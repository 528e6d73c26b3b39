//! A change that is to be saved is acknowledged when the owner has stored it, and refused when the owner could not.

use std::time::Duration;

use profile::parameter::ParameterAccess;
use profinet::controller::{Event, RecordAddress};

use super::channel::Channels;
use super::tests::Plant;
use super::*;
use crate::model::{AKD, VACON, VLT};

const NOW: Instant = Instant::ZERO;
const NOT_READY: PnioStatus = PnioStatus::read(code1::STATE_CONFLICT);
/// DRV.NVSAVE.
const SAVE: [u8; 14] = [3, 2, 0, 1, 0x10, 1, 0x09, 0xA5, 0, 0, 0x42, 1, 0, 1];

/// Returns the image that is to be stored.
fn save_of(drive: &mut Drive) -> (String, SaveId) {
    core::iter::from_fn(|| drive.poll_event())
        .find_map(|event| match event {
            crate::drive::Event::Save { text, save, .. } => Some((text, save)),
            _ => None,
        })
        .expect("a save")
}

/// Answers to a request before and after the report of its save.
fn asked(model: &'static Model, request: &[u8], stored: bool) -> Vec<u8> {
    let mut drive = Drive::new(model);
    drive.confirm_saves();
    let mut channels = Channels::default();
    channels.write(NOW, 1, request, &mut drive).unwrap();
    let (_, save) = save_of(&mut drive);
    channels.settle(&drive);
    assert_eq!(channels.read(NOW, Some(1), 240), Err(NOT_READY), "not stored yet");
    let busy = PnioStatus::write(code1::STATE_CONFLICT);
    assert_eq!(channels.write(NOW, 1, request, &mut drive), Err(busy));
    drive.report_save(save, stored);
    channels.settle(&drive);
    channels.read(NOW, Some(1), 240).unwrap()
}

#[test]
fn each_dialect_answers_a_save_when_it_is_stored_or_refused() {
    assert_eq!(asked(&AKD, &SAVE, true), [3, 2, 0, 1, 0, 0]);
    assert_eq!(asked(&AKD, &SAVE, false), [3, 0x82, 0, 1, 0x44, 1, 0, 0x11]);
    // VLT: 3-41 and 65534, which does not exist, both permanently
    let vlt = [
        5, 0x42, 0, 2, 0x10, 1, 0x01, 0x55, 0, 0, 0x10, 1, 0xFF, 0xFE, 0, 0, 7, 1, 0, 0, 1, 0xF4, 7, 1, 0, 0,
        0, 1,
    ];
    let unknown = [0x44, 1, 0, 0];
    assert_eq!(
        asked(&VLT, &vlt, true),
        [&[5, 0x82, 0, 2, 0x40, 0][..], &unknown].concat()
    );
    assert_eq!(
        asked(&VLT, &vlt, false),
        [&[5, 0x82, 0, 2, 0x44, 1, 0, 0x11][..], &unknown].concat()
    );
    // Vacon: ID 103 and 104
    let vacon = [
        6, 2, 1, 2, 0x10, 1, 0x27, 0x11, 0, 103, 0x10, 1, 0x27, 0x11, 0, 104, 0x42, 1, 0, 51, 0x42, 1, 0, 60,
    ];
    assert_eq!(asked(&VACON, &vacon, true), [6, 2, 1, 2]);
    assert_eq!(
        asked(&VACON, &vacon, false),
        [6, 0x82, 1, 2, 0x44, 1, 0, 0x6E, 0x44, 1, 0, 0x6E]
    );
}

#[test]
fn what_is_not_saved_is_answered_at_once() {
    let mut drive = Drive::new(&VLT);
    drive.confirm_saves();
    let mut channels = Channels::default();
    let volatile = [5, 2, 0, 1, 0x10, 1, 0x01, 0x55, 0, 0, 7, 1, 0, 0, 1, 0xF4];
    channels.write(NOW, 1, &volatile, &mut drive).unwrap();
    assert_eq!(channels.read(NOW, Some(1), 240), Ok(vec![5, 2, 0, 1]));
    // and without an owner that stores there is nothing to wait for
    let mut drive = Drive::new(&AKD);
    channels.write(NOW, 1, &SAVE, &mut drive).unwrap();
    assert_eq!(channels.read(NOW, Some(1), 240), Ok(vec![3, 2, 0, 1, 0, 0]));
}

/// One report counts for the saves before it; the values stored last are those that come back.
#[test]
fn after_a_save_that_failed_the_values_stored_before_are_the_saved_ones() {
    let mut drive = Drive::new(&AKD);
    drive.confirm_saves();
    let [save, load, acc] = ["DRV.NVSAVE", "DRV.NVLOAD", "DRV.ACC"].map(|name| {
        let parameter = AKD.catalogue.by_name(name).unwrap();
        parameter.pnu
    });
    let change = |drive: &mut Drive, pnu, raw| drive.write(pnu, 0, raw, Default::default());
    let mut images = Vec::new();
    for raw in [1_000_000, 2_000_000, 3_000_000] {
        change(&mut drive, acc, raw).unwrap();
        change(&mut drive, save, 1).unwrap();
        images.push(save_of(&mut drive));
    }
    drive.report_save(images[1].1, true);
    assert_eq!(drive.save_state(images[0].1), SaveState::Stored);
    assert_eq!(drive.save_state(images[2].1), SaveState::Pending);
    drive.report_save(images[2].1, false);
    assert_eq!(drive.save_state(images[2].1), SaveState::Failed);
    assert_eq!(drive.save_state(images[0].1), SaveState::Stored);
    change(&mut drive, load, 1).unwrap();
    assert_eq!(drive.read(acc, 0), Ok(2_000_000));
    // a report that is late or of no save changes nothing
    drive.report_save(images[0].1, false);
    drive.report_save(SaveId(99), false);
    assert_eq!(drive.save_state(images[1].1), SaveState::Stored);
}

#[test]
fn a_disk_that_takes_its_time_does_not_stop_the_cyclic_data() {
    for (stored, expected) in [
        (true, vec![3, 2, 0, 1, 0, 0]),
        (false, vec![3, 0x82, 0, 1, 0x44, 1, 0, 0x11]),
    ] {
        let mut plant = Plant::new();
        plant.station.confirm_saves();
        let ar = plant.connect(1);
        plant.send(ar, 0x047E, 0, 0.2);
        plant.send(ar, 0x047F, 164, 2.0);
        let at = RecordAddress {
            api: 0x3A00,
            slot: 1,
            subslot: 1,
            index: 0xB02E,
        };
        plant.controller.parameter_job(plant.now, ar, at, &SAVE).unwrap();
        let (status, speed) = plant.send(ar, 0x047F, 82, 3.0);
        assert_eq!(status & 0x077F, 0x0737, "{status:#06x}");
        assert!((78..=86).contains(&speed), "{speed}");
        let answer = |plant: &Plant| {
            plant.events.iter().find_map(|event| match event {
                Event::RecordDone { result, .. } => Some(result.clone().unwrap()),
                _ => None,
            })
        };
        assert_eq!(answer(&plant), None);
        let save = plant.saves().pop().expect("a save");
        plant.station.report_save(plant.now, save, stored);
        plant.seconds(0.5);
        assert_eq!(answer(&plant), Some(expected));
    }
}

/// A record that is a parameter of a Vacon: its write is answered when the value is stored.
#[test]
fn a_record_of_a_vacon_is_acknowledged_when_it_is_stored() {
    for stored in [true, false] {
        let mut plant = Plant::of(&VACON);
        plant.station.confirm_saves();
        let ar = plant.connect(1);
        let at = RecordAddress {
            api: 0x3A00,
            slot: 1,
            subslot: 1,
            index: 102,
        };
        plant.events.clear();
        plant.controller.write(plant.now, ar, at, &[0x0B, 0xB8]).unwrap();
        plant.run(Duration::from_millis(500));
        let done = |plant: &Plant| {
            plant.events.iter().find_map(|event| match event {
                Event::RecordDone { result, .. } => Some(result.is_ok()),
                _ => None,
            })
        };
        assert_eq!(done(&plant), None);
        let save = plant.saves().pop().expect("a save");
        plant.station.report_save(plant.now, save, stored);
        plant.run(Duration::from_millis(500));
        assert_eq!(done(&plant), Some(stored));
    }
}

/// A record write that waits for its save gets no answer after a restart: an earlier save acknowledges no write of the
/// next connection.
#[test]
fn a_restart_forgets_the_writes_that_wait_for_a_save() {
    let mut plant = Plant::of(&VACON);
    plant.station.confirm_saves();
    let at = RecordAddress {
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        index: 102,
    };
    let mut saves = Vec::new();
    for value in [[0x0B, 0xB8], [0x0B, 0xB9]] {
        let ar = plant.connect(1);
        plant.events.clear();
        plant.controller.write(plant.now, ar, at, &value).unwrap();
        plant.run(Duration::from_millis(500));
        saves.push(plant.saves().pop().expect("a save"));
        if saves.len() == 1 {
            plant.station.restart();
            plant.seconds(2.0);
        }
    }
    let done = |plant: &Plant| {
        let mut events = plant.events.iter();
        events.any(|event| matches!(event, Event::RecordDone { result: Ok(_), .. }))
    };
    plant.station.report_save(plant.now, saves[0], true);
    plant.run(Duration::from_millis(500));
    assert!(!done(&plant), "the save of before the restart");
    plant.station.report_save(plant.now, saves[1], true);
    plant.run(Duration::from_millis(500));
    assert!(done(&plant));
}

/// A disk that takes nothing any more: a write that the device has refused in its place is not kept.
#[test]
fn writes_that_wait_too_long_for_a_save_are_forgotten() {
    let mut plant = Plant::of(&VACON);
    plant.station.confirm_saves();
    let at = RecordAddress {
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        index: 102,
    };
    let ar = plant.connect(1);
    for value in 0xB8..0xBB {
        plant.events.clear();
        plant.controller.write(plant.now, ar, at, &[0x0B, value]).unwrap();
        plant.seconds(31.0);
        let mut events = plant.events.iter();
        assert!(events.any(|event| matches!(event, Event::RecordDone { result: Err(_), .. })));
        assert_eq!(plant.station.unanswered.len(), 1);
    }
}

/// A value that stands in an image which is not stored yet: a second write of it waits for that image too.
#[test]
fn the_same_value_again_is_acknowledged_when_it_is_stored() {
    for stored in [true, false] {
        let mut drive = Drive::new(&VLT);
        drive.confirm_saves();
        let permanent = |drive: &mut Drive| drive.write(341, 0, 500, profile::parameter::Keep::Permanent);
        permanent(&mut drive).unwrap();
        let first = drive.started_save().expect("a save");
        permanent(&mut drive).unwrap();
        let again = drive.started_save().expect("waits too");
        assert_eq!(drive.save_state(again), SaveState::Pending);
        let (_, save) = save_of(&mut drive);
        permanent(&mut drive).unwrap();
        assert_eq!(drive.started_save(), Some(again), "under way");
        drive.report_save(save, stored);
        let expected = if stored {
            SaveState::Stored
        } else {
            SaveState::Failed
        };
        assert_eq!([first, again].map(|save| drive.save_state(save)), [expected; 2]);
        // stored there is nothing to wait for; after a failure it is saved again
        permanent(&mut drive).unwrap();
        assert_eq!(drive.started_save().is_none(), stored);
    }
}

/// The answer to a name waits for its own save, and a name that is not stored is not that of the next start.
#[test]
fn a_name_by_dcp_counts_when_it_is_stored() {
    let drive = MacAddress([2, 0, 0, 0, 0, 1]);
    let mut plant = Plant::new();
    plant.station.confirm_saves();
    let mut earlier = SaveId(0);
    for (name, stored) in [("first", true), ("second", false), ("second", true)] {
        plant.events.clear();
        plant
            .controller
            .dcp_set_name(plant.now, drive, name, true)
            .unwrap();
        plant.run(Duration::from_millis(500));
        let done = |plant: &Plant| {
            plant.events.iter().find_map(|event| match event {
                Event::DcpDone { result, .. } => Some(result.is_ok()),
                _ => None,
            })
        };
        let save = plant.network_saves().pop();
        plant.station.report_network(plant.now, earlier, true);
        plant.run(Duration::from_millis(10));
        assert_eq!(done(&plant), None, "{name}: not stored yet");
        earlier = save.expect("a save");
        plant.station.report_network(plant.now, earlier, stored);
        plant.run(Duration::from_millis(500));
        assert_eq!(done(&plant), Some(stored), "{name}");
        let expected = if stored { name } else { "first" };
        assert_eq!(plant.station.name(), expected);
        plant.station.restart();
        assert_eq!(plant.station.name(), expected);
        // another client is served after 3 s, and this one too
        plant.seconds(4.0);
    }
}

/// A disk takes nothing until the simulation ends: what was saved last is with the owner then.
#[test]
fn a_station_that_is_switched_off_gives_its_newest_image_although_none_was_reported() {
    for model in [&AKD, &VLT] {
        let mut plant = Plant::of(model);
        plant.station.confirm_saves();
        for _ in 0..100 {
            plant.station.drive_mut().reset_to_delivery();
            plant.run(Duration::from_millis(20));
        }
        let before = plant.saves();
        assert!((1..100).contains(&before.len()), "{before:?}");
        plant.station.switch_off();
        plant.run(Duration::ZERO);
        let last = plant.saves().pop();
        assert!(
            last > before.last().copied() && last >= Some(SaveId(100)),
            "{last:?}"
        );
    }
}
