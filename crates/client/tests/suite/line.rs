//! The session over a serial line: virtual drives behind slaves, in virtual time, with everything a line does to octets.

use std::time::Duration;

use profidrive_client::axis::Purpose;
use profidrive_client::{Drive, Error, StopWay, Wait, WriteMode};
use profile::model::Model;
use profile::notation::ParameterReference;
use profile::pkw::PkwErrorNumber;
use profile::state::State;
use profile::value::Selection;
use testbench::line::{AtLine, Bench, Line, bench, bench_of, find};
use testbench::running_on;
use uss::{Protocol, SlaveConfig};
use virtual_drive::model;
use virtual_drive::serial::{SerialConfig, SerialStation};
use virtual_drive::station::StationEvent;

fn select(drive: &Drive, text: &str) -> Selection {
    let reference: ParameterReference = text.parse().expect("a parameter");
    drive.parameters.select(&reference).expect("known")
}

const SECOND: Duration = Duration::from_secs(1);

#[test]
fn every_kind_of_value_comes_as_over_a_network() {
    for (protocol, name) in [
        (Protocol::Fc, "fc:/dev/ttyX/3"),
        (Protocol::Uss, "uss:/dev/ttyX/3"),
    ] {
        let (mut session, bus) = bench(protocol, &[3], Line::default());
        let mut drive = find(&mut session, name).unwrap();
        assert_eq!(drive.model.name, "AKD");
        // word, byte, double word, 64 bits, an element, a list, text in octets
        let wanted: Vec<Selection> = [
            "930",
            "DRV.OPMODE",
            "1004",
            "DRV.ACC",
            "947[0..7]",
            "964[0]",
            "NIST_A",
        ]
        .iter()
        .filter_map(|text| drive.parameters.select(&text.parse().unwrap()).ok())
        .collect();
        let readings = session.read(&mut drive, &wanted).wait().unwrap();
        let numbers: Vec<Option<f64>> = readings.iter().map(|one| one.as_ref().ok()?.number()).collect();
        assert!(numbers.iter().all(Option::is_some), "{protocol:?} {readings:?}");
        assert_eq!(numbers[0], Some(1.0));
        assert_eq!(numbers[3], Some(3000.0), "{:?}", readings[3]);
        // nothing was commanded by looking
        assert!(
            bus.0.borrow().words.iter().all(|words| words == &[0; 4]),
            "{:?}",
            bus.0.borrow().words
        );
    }
}

#[test]
fn a_write_is_verified_and_refusals_are_reported() {
    let (mut session, bus) = bench(Protocol::Fc, &[1, 2], Line::default());
    let mut drive = find(&mut session, "fc:/dev/ttyX/2").unwrap();
    let outcomes = session
        .write(
            &mut drive,
            &["DRV.ACC=5000".parse().unwrap(), "930=9".parse().unwrap()],
            WriteMode::Write,
        )
        .wait()
        .unwrap();
    assert!(outcomes.changes()[0].is_done(), "{outcomes:?}");
    assert!(outcomes.changes()[1].refusal().is_some(), "{outcomes:?}");
    let replies: Vec<u64> = bus
        .0
        .borrow()
        .drives
        .iter()
        .map(|drive| drive.counters().replies)
        .collect();
    assert_eq!(replies[0], 0, "the other drive was not asked");
    let missing = find(&mut session, "fc:/dev/ttyX/9").unwrap_err();
    assert_eq!(
        missing.to_string(),
        "no answer from fc:/dev/ttyX/9; others answer on this line"
    );
}

#[test]
fn an_axis_runs_and_is_brought_to_rest() {
    for (protocol, name) in [
        (Protocol::Fc, "fc:/dev/ttyX/1"),
        (Protocol::Uss, "uss:/dev/ttyX/1"),
    ] {
        let (mut session, bus) = bench(protocol, &[1], Line::default());
        let mut drive = find(&mut session, name).unwrap();
        let settings = running_on(Purpose::Speed);
        let mut axis = session.take_axis(&mut drive, settings).wait().unwrap();
        let mut enabled = axis.enable().wait().unwrap();
        enabled.run(150.0).wait().unwrap();
        enabled.hold(SECOND).wait().unwrap();
        let speed = bus.0.borrow().drives[0].drive().axis().speed();
        assert!((145.0..155.0).contains(&speed), "{speed}");
        drop(enabled);
        axis.release().wait().unwrap();
        let bus = bus.0.borrow();
        assert_eq!(bus.drives[0].drive().state(), State::S2);
        assert_eq!(
            bus.words.last(),
            Some(&vec![0, 0, 0, 0]),
            "control was given back"
        );
    }
}

#[test]
fn telegrams_for_moves_are_not_on_a_line() {
    let (mut session, _bus) = bench(Protocol::Fc, &[1], Line::default());
    let mut drive = find(&mut session, "fc:/dev/ttyX/1").unwrap();
    session
        .write(&mut drive, &["930=2".parse().unwrap()], WriteMode::Write)
        .wait()
        .unwrap();
    let error = session
        .take_axis(&mut drive, running_on(Purpose::Move))
        .wait()
        .unwrap_err();
    assert!(matches!(error, Error::Telegram { .. }), "{error}");
}

#[test]
fn noise_halves_and_echo_change_no_value() {
    let line = Line {
        echo: true,
        halved: 2,
        changed: 2,
        noisy: 2,
        ..Line::default()
    };
    let (mut session, bus) = bench(Protocol::Fc, &[1, 2], line);
    let mut drive = find(&mut session, "fc:/dev/ttyX/1").unwrap();
    let wanted: Vec<Selection> = [
        "930",
        "964[0]",
        "964[1]",
        "964[2]",
        "DRV.ACC",
        "DRV.DEC",
        "DRV.OPMODE",
    ]
    .iter()
    .map(|text| select(&drive, text))
    .collect();
    let clean = {
        let before = std::mem::take(&mut bus.0.borrow_mut().line);
        let clean = session.read(&mut drive, &wanted).wait().unwrap();
        bus.0.borrow_mut().line = before;
        clean
    };
    for turn in 0..40 {
        assert_eq!(
            session.read(&mut drive, &wanted).wait().unwrap(),
            clean,
            "turn {turn}"
        );
    }
    let counters = session.line_counters().unwrap();
    assert!(
        counters.checksums + counters.broken + counters.noise > 10,
        "{counters:?}"
    );
    // and an axis stays under control
    let mut axis = session
        .take_axis(&mut drive, running_on(Purpose::Speed))
        .wait()
        .unwrap();
    let mut enabled = axis.enable().wait().unwrap();
    enabled.run(100.0).wait().unwrap();
    enabled.hold(SECOND * 5).wait().unwrap();
    drop(enabled);
    axis.release().wait().unwrap();
    assert!(bus.0.borrow().drives[0].drive().axis().is_at_rest());
}

#[test]
fn a_cut_line_is_reported_soon_and_the_drive_stops() {
    let (mut session, bus) = bench(Protocol::Fc, &[1], Line::default());
    let mut drive = find(&mut session, "fc:/dev/ttyX/1").unwrap();
    let mut axis = session
        .take_axis(&mut drive, running_on(Purpose::Speed))
        .wait()
        .unwrap();
    let mut enabled = axis.enable().wait().unwrap();
    enabled.run(100.0).wait().unwrap();
    bus.0.borrow_mut().line.cut = true;
    let before = bus.0.borrow().now;
    let error = enabled.hold(SECOND * 60).wait().unwrap_err();
    assert!(matches!(error, Error::LineSilent { .. }), "{error}");
    assert!(bus.0.borrow().now - before < SECOND);
    drop(enabled);
    drop(axis);
    session.settle();
    assert!(bus.0.borrow().now - before < SECOND * 6);
    assert!(!bus.0.borrow().drives[0].drive().is_enabled());
    let selection = select(&drive, "930");
    let error = session.read(&mut drive, &[selection]).wait().unwrap_err();
    assert!(
        matches!(error, Error::LineSilent { .. } | Error::Channel { .. }),
        "{error}"
    );
    // and it is reached again as soon as the line is whole
    bus.0.borrow_mut().line.cut = false;
    assert_eq!(
        session.read(&mut drive, &[selection]).wait().unwrap()[0]
            .as_ref()
            .unwrap()
            .raw(),
        Some(1)
    );
}

#[test]
fn a_stop_reaches_a_drive_that_missed_frames() {
    let (mut session, bus) = bench(Protocol::Fc, &[1], Line::default());
    // a drive whose time-out is not set runs on by itself
    {
        let mut bus = bus.0.borrow_mut();
        let mut config = SerialConfig::new(&model::AKD, SlaveConfig::fc(1, 9600));
        config.timeout = SECOND * 1000;
        bus.drives[0] = SerialStation::new(config);
    }
    let mut drive = find(&mut session, "fc:/dev/ttyX/1").unwrap();
    let mut axis = session
        .take_axis(&mut drive, running_on(Purpose::Speed))
        .wait()
        .unwrap();
    let mut enabled = axis.enable().wait().unwrap();
    enabled.run(100.0).wait().unwrap();
    bus.0.borrow_mut().line.cut = true;
    assert!(enabled.hold(SECOND * 60).wait().is_err());
    bus.0.borrow_mut().line.cut = false;
    drop(enabled);
    drop(axis);
    session.settle();
    let bus = bus.0.borrow();
    assert!(!bus.drives[0].drive().is_enabled() && bus.drives[0].drive().axis().is_at_rest());
}

#[test]
fn a_vlt_reports_numbers_texts_and_refusals_over_the_fc_protocol() {
    let (mut session, bus) = bench_of(&model::VLT, Protocol::Fc, &[1], Line::default());
    let mut drive = find(&mut session, "fc:/dev/ttyX/1").unwrap();
    assert_eq!(drive.model.name, "VLT");
    let wanted: Vec<Selection> = ["8-10", "1-20", "3-41", "15-40", "16-03"]
        .iter()
        .map(|text| select(&drive, text))
        .collect();
    let readings = session.read(&mut drive, &wanted).wait().unwrap();
    let texts: Vec<String> = readings
        .iter()
        .map(|reading| format!("{:?}", reading.as_ref().unwrap().content))
        .collect();
    assert!(texts[3].starts_with("Text("), "{texts:?}");
    let number = |text: &str, session: &mut Bench, drive: &mut Drive| {
        let selection = select(drive, text);
        session.read(drive, &[selection]).wait().unwrap()[0]
            .as_ref()
            .unwrap()
            .number()
            .unwrap()
    };
    let outcomes = session
        .write(
            &mut drive,
            &["3-41=5s".parse().unwrap(), "16-03=1".parse().unwrap()],
            WriteMode::DryRun,
        )
        .wait()
        .map(|_| ())
        .unwrap_err();
    assert!(
        outcomes.to_string().contains("read"),
        "a status word cannot be written: {outcomes}"
    );
    let outcomes = session
        .write(&mut drive, &["3-41=5s".parse().unwrap()], WriteMode::Write)
        .wait()
        .unwrap();
    assert!(outcomes.changes()[0].step.is_written(), "{outcomes:?}");
    assert_eq!(number("3-41", &mut session, &mut drive), 5.0);
    let saved = || {
        let mut bus = bus.0.borrow_mut();
        let events: Vec<StationEvent> = std::iter::from_fn(|| bus.drives[0].poll_event()).collect();
        events
            .iter()
            .any(|event| matches!(event, StationEvent::PersistParameters { asked: true, .. }))
    };
    assert!(!saved(), "a change goes to the RAM");
}

#[test]
fn strings_travel_over_fc_with_tables_and_without() {
    let (mut session, bus) = bench_of(&model::VLT, Protocol::Fc, &[1], Line::default());
    let mut drive = find(&mut session, "fc:/dev/ttyX/1").unwrap();
    let outcomes = session
        .write(&mut drive, &["0-37=HELLO".parse().unwrap()], WriteMode::Save)
        .wait()
        .unwrap();
    assert!(outcomes.is_done(), "{outcomes:?}");
    let events: Vec<StationEvent> =
        std::iter::from_fn(|| bus.0.borrow_mut().drives[0].poll_event()).collect();
    let is_saved = |event: &StationEvent| matches!(event, StationEvent::PersistParameters { text, .. } if text.contains("\n0-37 = HELLO\n"));
    assert!(events.iter().any(is_saved), "{events:?}");
    // a drive without tables reports numbers as words and text as text
    drive.model = Model::by_name("standard").unwrap();
    drive.parameters.catalogue = None;
    for (number, expected) in [("37", "Text(\"HELLO\")"), ("1540", "Text(\"FC-302\")")] {
        let selection = select(&drive, number);
        let reading = session.read_one(&mut drive, &selection).wait().unwrap();
        assert_eq!(format!("{:?}", reading.content), expected);
    }
    let selection = select(&drive, "1");
    assert_eq!(
        session.read_one(&mut drive, &selection).wait().unwrap().number(),
        Some(0.0)
    );
}

#[test]
fn a_vlt_runs_by_the_words_that_8_10_chooses() {
    for (choice, stopped) in [(0, 0x043C), (1, 0x047E)] {
        let (mut session, bus) = bench_of(&model::VLT, Protocol::Fc, &[1], Line::default());
        let mut drive = find(&mut session, "fc:/dev/ttyX/1").unwrap();
        let chosen = format!("8-10={choice}").parse().unwrap();
        session
            .write(&mut drive, &[chosen], WriteMode::Write)
            .wait()
            .unwrap();
        let settings = running_on(Purpose::Speed);
        let mut axis = session.take_axis(&mut drive, settings).wait().unwrap();
        let mut enabled = axis.enable().wait().unwrap();
        enabled.run(300.0).wait().unwrap();
        enabled.hold(SECOND * 6).wait().unwrap();
        let speed = bus.0.borrow().drives[0].drive().axis().speed();
        assert!((270.0..315.0).contains(&speed), "8-10 = {choice}: {speed}");
        drop(enabled);
        axis.release().wait().unwrap();
        let bus = bus.0.borrow();
        assert!(bus.drives[0].drive().axis().is_at_rest());
        let words: Vec<u16> = bus
            .words
            .iter()
            .map(|data| u16::from_be_bytes([data[0], data[1]]))
            .collect();
        assert!(words.contains(&stopped), "8-10 = {choice}: {words:04X?}");
        assert_eq!(
            words.last().map(|word| word & 0x0400),
            Some(0),
            "control was given back"
        );
    }
}

/// A master that is gone has left the drive turning; the next one stops it and acknowledges by control word.
#[test]
fn converters_at_a_line_are_stopped_and_acknowledged_by_control_word() {
    for (model, protocol, name) in [
        (&model::VLT, Protocol::Fc, "fc:/dev/ttyX/1"),
        (&model::VLT, Protocol::Uss, "uss:/dev/ttyX/1"),
    ] {
        let (mut session, bus) = bench_of(model, protocol, &[1], Line::default());
        let found = find(&mut session, name).unwrap();
        let mut drive = found.as_model(Model::by_name(model.catalogue.model).unwrap());
        let settings = running_on(Purpose::Speed);
        let mut axis = session.take_axis(&mut drive, settings).wait().unwrap();
        let mut enabled = axis.enable().wait().unwrap();
        enabled.run(300.0).wait().unwrap();
        enabled.hold(SECOND * 6).wait().unwrap();
        std::mem::forget(enabled);
        std::mem::forget(axis);
        assert!(bus.0.borrow().drives[0].drive().is_enabled(), "{name}");
        let outcome = session
            .stop_drive(&mut drive, StopWay::Stop, SECOND * 10)
            .wait()
            .unwrap();
        assert!(outcome.sent && outcome.at_rest, "{name}: {outcome:?}");
        assert!(
            outcome.speed_before.is_some_and(|speed| speed > 200.0),
            "{name}: {outcome:?}"
        );
        assert_eq!(StopWay::Stop.command(&drive), "OFF1 (control word)");
        assert!(bus.0.borrow().drives[0].drive().axis().is_at_rest(), "{name}");
        // nothing is sent to one that stands
        let outcome = session
            .stop_drive(&mut drive, StopWay::Stop, SECOND)
            .wait()
            .unwrap();
        assert!(!outcome.sent && outcome.at_rest, "{name}: {outcome:?}");

        let number = 9;
        bus.0.borrow_mut().drives[0]
            .drive_mut()
            .inject_fault(number, false);
        let present = |session: &mut Bench, drive: &mut Drive| -> Vec<u16> {
            let report = session.fault_report(drive).wait().unwrap();
            report.present().map(|fault| fault.number).collect()
        };
        assert_eq!(present(&mut session, &mut drive), [number], "{name}");
        let settings = running_on(Purpose::Control);
        let mut axis = session.take_axis(&mut drive, settings).wait().unwrap();
        axis.ready_or_fault().wait().unwrap();
        axis.acknowledge().wait().unwrap();
        axis.release().wait().unwrap();
        assert!(present(&mut session, &mut drive).is_empty(), "{name}");
    }
}

/// Refuses every request of the first drive with this number of the channel, or none any more.
fn refuse(bus: &AtLine, number: Option<u16>) {
    let number = number.map(PkwErrorNumber);
    bus.0.borrow_mut().drives[0].refuse_all(number);
}

#[test]
fn numbers_of_the_channel_come_as_received() {
    for (protocol, name) in [
        (Protocol::Fc, "fc:/dev/ttyX/1"),
        (Protocol::Uss, "uss:/dev/ttyX/1"),
    ] {
        let (mut session, bus) = bench_of(&model::VLT, protocol, &[1], Line::default());
        let mut drive = find(&mut session, name).unwrap();
        let ramp = select(&drive, "3-41");
        let change = |session: &mut Bench, drive: &mut Drive| {
            let new = ["3-41=5s".parse().unwrap()];
            let outcomes = session.write(drive, &new, WriteMode::Write).wait().unwrap();
            *outcomes.changes()[0].refusal().unwrap()
        };
        // the factory set-up is edited: the drive itself says 131
        let edit = ["0-11=0".parse().unwrap()];
        session.write(&mut drive, &edit, WriteMode::Write).wait().unwrap();
        let refusal = change(&mut session, &mut drive);
        let factory = "writing Ramp 1 Ramp up Time (3-41) refused: 131 change not possible, the factory setup is selected";
        assert_eq!(refusal.to_string(), factory, "{name}");
        assert_eq!(refusal.received(), Some(131));
        let remedy = refusal.remedy().unwrap().to_string();
        assert!(remedy.contains("select another setup"), "{remedy}");
        assert_eq!(refusal.channel.unwrap().protocol, protocol);
        for (number, words) in [
            (130, "130 no bus access to the parameter"),
            (131, "131 change not possible, the factory setup is selected"),
            (17, "17 not possible in the present mode of the drive"),
            (999, "999 (vendor-specific number)"),
        ] {
            refuse(&bus, Some(number));
            let read = session.read(&mut drive, &[ramp]).wait().unwrap()[0]
                .clone()
                .unwrap_err();
            refuse(&bus, Some(number));
            for refusal in [read, change(&mut session, &mut drive)] {
                assert_eq!((refusal.received(), refusal.is_unsent()), (Some(number), false));
                let shown = refusal.to_string();
                assert!(shown.ends_with(&format!("refused: {words}")), "{name}: {shown}");
            }
            refuse(&bus, None);
            assert!(
                session.read(&mut drive, &[ramp]).wait().unwrap()[0].is_ok(),
                "{name}"
            );
        }
    }
}

#[test]
fn what_the_channel_cannot_carry_is_not_called_refused() {
    let (fc, uss) = ("fc:/dev/ttyX/1", "uss:/dev/ttyX/1");
    let collects = "it has no request for the parameters that number 10001 collects";
    for (model, protocol, name, parameter, why) in [
        (&model::VACON, Protocol::Fc, fc, "ID103", collects),
        (&model::VACON, Protocol::Uss, uss, "ID103", collects),
        (&model::VACON, Protocol::Uss, uss, "ID1702", collects),
        (
            &model::VLT,
            Protocol::Uss,
            uss,
            "0-37",
            "it has no request for text",
        ),
        (
            &model::VLT,
            Protocol::Fc,
            fc,
            "5000",
            "it has no room for parameter number 5000",
        ),
        (
            &model::VLT,
            Protocol::Fc,
            fc,
            "3000[300]",
            "it has no room for element 300",
        ),
    ] {
        let (mut session, bus) = bench_of(model, protocol, &[1], Line::default());
        let found = find(&mut session, name).unwrap();
        let mut drive = found.as_model(Model::by_name(model.catalogue.model).unwrap());
        let selection = select(&drive, parameter);
        let sent = |bus: &AtLine| bus.0.borrow().drives[0].counters().replies;
        let before = sent(&bus);
        let readings = session.read(&mut drive, &[selection]).wait().unwrap();
        assert_eq!(sent(&bus), before, "{name}: nothing was sent");
        let refusal = readings[0].clone().unwrap_err();
        assert!(refusal.is_unsent() && refusal.received().is_none(), "{refusal:?}");
        let shown = refusal.to_string();
        let words = format!("cannot be carried by this channel: {why}");
        assert!(shown.ends_with(&words) && !shown.contains("refused"), "{shown}");
    }
}
