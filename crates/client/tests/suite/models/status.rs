//! What keeps a drive of each model from running: faults, warnings, words.

use super::*;
use profidrive_client::Wait;

/// Whatever keeps a drive from running is reported with what to do, in the parameters and words of its model.
#[test]
fn causes_that_prevent_running_are_reported_with_a_remedy() {
    type Row = (
        &'static str,
        [&'static str; 3],
        [&'static str; 3],
        [&'static str; 3],
    );
    // what happens; the cause of it; words of the sentence; words of the advice
    let rows: [Row; 3] = [
        (
            "sto=on",
            ["sto", "fault", "fault"],
            [
                "STO.STATE",
                "F68 is present: Safe stop",
                "F30 is present: Safe torque off",
            ],
            ["safety circuit", "terminal 37", "safety circuit"],
        ),
        (
            "mains=off",
            ["no-power"; 3],
            ["its DC bus has"; 3],
            ["VBUS.VALUE", "16-30", "ID7"],
        ),
        (
            "limit+=on",
            ["no-controller"; 3],
            ["no controller is connected"; 3],
            ["HWLS.POSSTATE", "", ""],
        ),
    ];
    for (event, causes, sentences, advices) in rows {
        let models = model::ALL.iter().zip(NAMES).zip(1..);
        let stations = models.map(|((model, name), last)| station_of(model, name, last, None));
        let (mut session, ids) = bench_of(stations.collect());
        for (at, name) in NAMES.into_iter().enumerate() {
            let mut drive = find(&mut session, name).expect("there");
            let waits = diagnose(&session.status(&mut drive).wait().expect("a status"));
            assert!(
                waits.cause.id() == "no-controller" && waits.notes.is_empty(),
                "{name}: {waits:?}"
            );
            with_drive(&session, ids[at], |drive| {
                drive.inject(event.parse().expect("an injection"));
            });
            session.pass(Duration::from_secs(60)).wait().expect("time passes");
            let found = diagnose(&session.status(&mut drive).wait().expect("a status"));
            let context = format!("{name}, {event}: {found:?}");
            assert_eq!(found.cause.id(), causes[at], "{context}");
            assert!(found.sentence.contains(sentences[at]), "{context}");
            let advice = format!("{:?} {:?}", found.next, found.notes);
            assert!(advice.contains(advices[at]), "{context}");
            if name != "akd-1" {
                for group in [
                    "DRV.",
                    "VBUS.",
                    "HWLS.",
                    "SWLS.",
                    "IL.",
                    "VL.",
                    "STO.STATE",
                    "MOTOR.",
                ] {
                    assert!(!context.contains(group), "{context}");
                }
            }
        }
    }
}

/// A situation of the buffer has eight places, and a drive may have more faults than that.
#[test]
fn faults_beyond_the_buffer_are_reported_too() {
    let (mut session, ids) = bench_of(vec![station_of(&model::AKD, "akd-1", 1, None)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let numbers = [439, 301, 302, 501, 502, 535, 307, 408, 130, 131];
    for number in numbers {
        with_drive(&session, ids[0], |drive| drive.inject_fault(number, false));
        session
            .pass(Duration::from_millis(50))
            .wait()
            .expect("time passes");
    }
    let report = session.fault_report(&mut drive).wait().expect("answered");
    let present: Vec<u16> = report.present().map(|fault| fault.number).collect();
    assert_eq!(present, numbers);
    assert!(
        report
            .present()
            .all(|fault| fault.meaning.is_some() && fault.situation == 0)
    );
}

/// Warnings come with their remedy, beside the sentence.
#[test]
fn a_warning_of_each_model_is_reported_with_its_remedy() {
    let models = model::ALL.iter().zip(NAMES).zip(1..);
    let stations = models.map(|((model, name), last)| station_of(model, name, last, None));
    let (mut session, ids) = bench_of(stations.collect());
    for ((name, number), id) in NAMES.into_iter().zip([304, 59, 14]).zip(ids) {
        let mut drive = find(&mut session, name).expect("there");
        with_drive(&session, id, |drive| {
            drive.inject(format!("warning={number}").parse().expect("an injection"));
        });
        session.pass(Duration::from_secs(1)).wait().expect("time passes");
        let found = diagnose(&session.status(&mut drive).wait().expect("a status"));
        let note = found.notes.first().unwrap_or_else(|| panic!("{name}: {found:?}"));
        assert_eq!(note.id, "warning", "{name}: {note:?}");
        let tables = drive.model.catalogue.expect("tables");
        let mut numbers = [Part::Warning, Part::WarningWord]
            .iter()
            .flat_map(|&part| tables.parts_of(part));
        if numbers.next().is_none() {
            // a Vacon reports that there is one, not which
            assert!(note.sentence.contains("ZSW1 bit 7"), "{name}: {note:?}");
            continue;
        }
        assert!(note.sentence.contains(&format!("n{number} ")), "{name}: {note:?}");
        let row = tables.fault(number, true);
        assert_eq!(note.next, row.map(|row| row.remedy.into()), "{name}");
    }
}

#[test]
fn control_and_status_words_are_shown_with_the_bits_of_the_model() {
    let mut session = all_models();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    let status = session.status(&mut drive).wait().expect("a status");
    assert_eq!(status.profile, Profile::DanfossProfidrive);
    assert!(status.zsw1.is_some() && status.status_word.is_some());
    let mut drive = find(&mut session, "vacon-1").expect("there");
    assert_eq!(
        session.status(&mut drive).wait().expect("a status").profile,
        Profile::Profidrive
    );
}

#[test]
fn a_fault_of_each_model_is_reported_with_its_meaning_and_acknowledged() {
    let stations = model::ALL.iter().zip(NAMES).zip(1..);
    let stations = stations.map(|((model, name), last)| station_of(model, name, last, None));
    let (mut session, ids) = bench_of(stations.collect());
    for (((name, id), model), number) in NAMES.into_iter().zip(ids).zip(model::ALL).zip([439, 9, 1]) {
        let mut drive = find(&mut session, name).expect("there");
        for telegram in [None, Some(104), Some(149)] {
            let has = |number: &u16| model.catalogue.device.telegram(*number).is_some();
            if telegram.is_some_and(|number| !has(&number)) {
                continue;
            }
            let row = model.catalogue.fault(number, false).expect("a fault");
            with_drive(&session, id, |drive| drive.inject_fault(row.number, false));
            session
                .pass(Duration::from_millis(200))
                .wait()
                .expect("time passes");
            let report = session.fault_report(&mut drive).wait().expect("answered");
            let present: Vec<_> = report.present().collect();
            assert_eq!(present.len(), 1, "{name}: {present:?}");
            let fault = present.first().expect("one");
            assert_eq!(
                (fault.number, fault.meaning, fault.remedy),
                (row.number, Some(row.meaning), Some(row.remedy)),
                "{name}"
            );
            assert!(
                report.zsw1.is_some_and(|word| word & 8 != 0),
                "{name}: {:04X?}",
                report.zsw1
            );
            let status = session.status(&mut drive).wait().expect("a status");
            let diagnosis = diagnose(&status);
            assert_eq!(diagnosis.cause.id(), "fault", "{name}: {diagnosis:?}");
            assert!(diagnosis.sentence.contains(row.meaning), "{name}: {diagnosis:?}");
            let settings = AxisSettings {
                telegram,
                ..AxisSettings::for_purpose(Purpose::Control)
            };
            let mut axis = session.take_axis(&mut drive, settings).wait().expect("free");
            axis.ready_or_fault().wait().expect("connected");
            axis.acknowledge()
                .wait()
                .unwrap_or_else(|error| panic!("{name} {telegram:?}: {error}"));
            axis.release().wait().expect("released");
            let report = session.fault_report(&mut drive).wait().expect("answered");
            assert_eq!(report.present().count(), 0, "{name} {telegram:?}: {report:?}");
            assert!(
                report.zsw1.is_some_and(|word| word & 8 == 0),
                "{name}: {:04X?}",
                report.zsw1
            );
            // its cause is still reported
            let before = report.faults.iter().map(|fault| (fault.number, fault.meaning));
            let mut all = before.chain(report.log.iter().map(|fault| (fault.number, fault.meaning)));
            assert!(
                all.any(|one| one == (row.number, Some(row.meaning))),
                "{name}: {report:?}"
            );
            let after = diagnose(&session.status(&mut drive).wait().expect("a status"));
            assert_ne!(after.cause.id(), "fault", "{name}: {after:?}");
        }
    }
}

/// What only an AKD has is in no text about another model.
#[test]
fn motion_facts_come_from_the_parameters_of_the_model() {
    let mut session = all_models();
    let limits = [
        (
            "vlt-1",
            Some(Part::Reference),
            Some((0.0, Some(Part::ReferenceRange))),
        ),
        (
            "vacon-1",
            Some(Part::Reference),
            Some((1500.0, Some(Part::Reference))),
        ),
    ];
    for (name, forward, backward) in limits {
        let mut drive = find(&mut session, name).expect("there");
        let facts = session.motion_facts(&mut drive).wait().expect("facts");
        assert_eq!(
            (facts.forward_limit.map(f64::round), facts.forward_by),
            (Some(1500.0), forward),
            "{name}"
        );
        let found = facts
            .backward_limit
            .map(|limit| (limit.round(), facts.backward_by));
        assert_eq!(found, backward, "{name}");
        let backup = session.backup(&mut drive, &mut |_, _| {}).wait().expect("saved");
        assert_eq!(backup.lacks(&drive.model), 0, "{name}");
        let text = backup.to_string();
        for foreign in ["scaling:", "units:", "MOTOR.TYPE"] {
            assert!(!text.contains(foreign), "{name}: {foreign}");
        }
        let error = Error::SpeedNotReached {
            drive: name.into(),
            wanted: 1.0,
            unit: "rpm",
            highest: None,
            limit: Duration::ZERO,
        };
        let hint = error.advice_for(&drive).expect("advice").to_string();
        assert!(!hint.contains("DRV.") && !hint.contains("VL."), "{hint}");
        assert!(
            hint.contains(if name == "vlt-1" { "3-03" } else { "ID102" }),
            "{hint}"
        );
    }
}
