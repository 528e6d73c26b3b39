//! Plans and their steps, without a drive.

use profile::catalogue::{AKD, Phase, Role, Scaling};
use profile::unit::UnitChoice;
use proptest::prelude::*;

use super::*;
use crate::backup::tests::{drive, file, with_head};
use crate::backup::{Backup, rule};

/// Name of the parameter of a change.
fn name(change: &Change) -> &'static str {
    change.new.name.unwrap()
}

/// Value before, which could be read.
fn old(change: &Change) -> &Reading {
    change.old.as_ref().unwrap().as_ref().unwrap()
}

#[test]
fn a_plan_says_what_it_leaves_out_and_why() {
    let present = drive(Scaling::default(), &[]);
    let wanted = file(
        "p2108 = 5000 rpm/s\np2115 = 3000 rpm/s\np922 = 353\nDRV.CMDSOURCE = 0\nIP.MODE = 0\np930 = 2\nNSOLL_A = 5 rpm\nMOTOR.BRAKERLS = 1\n\
         MT.P = 5 counts\nDRV.ACTIVE = 1\nDRV.NVSAVE = 1\nVL.LIMITP_32 = 12001 rpm\nDRV.DIR = 1\nFB1.INITPSAVED = 3",
    );
    let plan = Plan::new(&wanted, &present, &Choice::default());
    let changed: Vec<&str> = plan.set.changes.iter().map(name).collect();
    assert_eq!(changed, ["DRV.DIR", "DRV.ACC"]);
    assert_eq!(
        (
            old(&plan.set.changes[1]).number(),
            plan.set.changes[1].new.number(),
            plan.set.changes[1].storable
        ),
        (Some(3000.0), Some(5000.0), Some(true))
    );
    let skipped: Vec<String> = plan
        .skipped
        .iter()
        .map(|skipped| format!("{} {}", skipped.reading.name.unwrap(), skipped.why))
        .collect();
    assert_eq!(
        skipped,
        [
            "NSOLL_A a setpoint",
            "Telegram selection belongs to the connection: the controller decides it when it connects",
            "Operating mode the same as DRV.OPMODE",
            "DRV.ACTIVE read-only",
            "DRV.CMDSOURCE belongs to the connection: the telegram decides it",
            "DRV.DEC same value",
            "MOTOR.BRAKERLS writing it does something: it releases the brake",
            "MT.P shows one row of a table of the drive",
            "VL.LIMITP_32 outside 0 to 12000 rpm",
            "DRV.NVSAVE writing it does something",
            "IP.MODE belongs to the connection: the address of the drive depends on it",
            "FB1.INITPSAVED the drive itself writes it",
        ]
    );
    assert_eq!(plan.left_out(), 11);
    let back = plan.set.way_back();
    assert_eq!(back.readings().len(), 2);
    assert_eq!(back.reading(2108, None).unwrap().number(), Some(3000.0));

    let choice = Choice {
        network: true,
        saved_only: true,
        beyond_limits: true,
        only: vec![
            "DRV.*".parse().unwrap(),
            "p922".parse().unwrap(),
            "vl.*".parse().unwrap(),
        ],
    };
    let plan = Plan::new(&wanted, &present, &choice);
    let changed: Vec<&str> = plan.set.changes.iter().map(name).collect();
    assert_eq!(changed, ["DRV.CMDSOURCE", "VL.LIMITP_32", "DRV.ACC"]);
    assert!(
        plan.skipped
            .iter()
            .any(|one| one.reading.pnu == 922 && one.why == Skip::NotSaved)
    );
    assert!(
        plan.skipped
            .iter()
            .any(|one| one.reading.name == Some("DRV.DIR") && one.why == Skip::NotSaved)
    );
}

#[test]
fn scalings_go_first_and_what_they_scale_follows_in_its_unit() {
    let present = drive(Scaling::default(), &[("Jog Acc", 10)]);
    // as the file was made, the drive had coarser steps
    let text = with_head(
        "p1006 Jog Acc = 7630 rpm/s\np3065 PN.ACCSCALING = 109\np2382 SWLS.EN = 3\np2439 = 2000 rpm",
    );
    let plan = Plan::new(&Backup::read(&text).unwrap(), &present, &Choice::default());
    let order: Vec<(&str, Phase)> = plan
        .set
        .changes
        .iter()
        .map(|change| (name(change), change.phase()))
        .collect();
    assert_eq!(
        order,
        [
            ("PN.ACCSCALING", Phase::Scaling),
            ("VL.LIMITP_32", Phase::Limit),
            ("Jog Acc", Phase::Value),
            ("SWLS.EN", Phase::Enable)
        ]
    );
    // 7630 rpm/s in steps of 109 rpm/s
    assert_eq!(plan.set.changes[2].new.raw(), Some(70));
    // without the scaling the number of the drive stays what it is
    let choice = Choice {
        only: vec!["Jog*".parse().unwrap()],
        ..Choice::default()
    };
    let plan = Plan::new(&Backup::read(&text).unwrap(), &present, &choice);
    assert_eq!(plan.set.changes.len(), 0);
    assert_eq!(plan.skipped[0].why, Skip::Same);
}

#[test]
fn what_the_drive_cannot_have_is_counted() {
    let present = drive(Scaling::default(), &[]);
    let wanted =
        file("p2108 = 5000 rpm/s\np2439 = 100000 rpm\np2403 VBUS.VALUE = 12 V\np922 = 9\np5 = 100 rpm");
    let plan = Plan::new(&wanted, &present, &Choice::default());
    // the setpoint and the telegram are left out by rule, the limit and the measured value are refused
    assert_eq!(
        (plan.set.changes.len(), plan.left_out(), plan.refused()),
        (1, 4, 2)
    );
    let choice = Choice {
        only: vec!["DRV.*".parse().unwrap()],
        ..Choice::default()
    };
    assert_eq!(Plan::new(&wanted, &present, &choice).refused(), 0);
}

#[test]
fn old_and_new_values_are_each_in_the_unit_of_their_time() {
    let degrees = UnitChoice {
        rotary_unit: 2,
        ..Scaling::default().unit
    };
    let there = drive(
        Scaling {
            unit: degrees,
            ..Scaling::default()
        },
        &[("UNIT.PROTARY", 2)],
    );
    let wanted = Backup::read(there.to_string()).unwrap();
    let present = drive(Scaling::default(), &[]);
    let plan = Plan::new(&wanted, &present, &Choice::default());
    assert_ne!(
        plan.set.parameters().scaling.unit,
        plan.set.parameters_after().scaling.unit
    );
    let mut seen = 0;
    for change in &plan.set.changes {
        let Some(parameter) = change.new.name.and_then(|name| AKD.by_name(name)) else {
            continue;
        };
        if old(change).unit == change.new.unit {
            continue;
        }
        seen += 1;
        assert_eq!(
            (old(change).unit, change.new.unit),
            ("counts", "deg"),
            "{}",
            change.label()
        );
        assert_eq!(
            plan.set.limits(change),
            Some(plan.set.parameters_after().limits(parameter)),
            "{}",
            change.label()
        );
    }
    assert!(seen > 3, "{seen}");
}

#[test]
fn a_journal_is_a_backup_of_the_old_values() {
    let present = drive(Scaling::default(), &[]);
    let wanted = file("p2108 = 5000 rpm/s\np2115 = 5000 rpm/s\np2439 = 1000 rpm");
    let mut set = Plan::new(&wanted, &present, &Choice::default()).set;
    set.set(0, Step::ReadBack);
    set.set(1, Step::InDoubt);
    set.end(Some("the cable\nwas pulled".into()));
    let text = set.to_string();
    assert!(
        text.contains("\n# not complete: 1 of 3 written and read back, 1 in doubt, 1 not written\n"),
        "{text}"
    );
    assert!(text.contains("\n# ended early: the cable was pulled\n"), "{text}");
    assert!(
        text.contains("p2439 VL.LIMITP_32 = 3000 rpm           # -> 1000 rpm: written, read back"),
        "{text}"
    );
    assert!(
        text.contains("# -> 5000 rpm/s: in doubt: sent, not answered"),
        "{text}"
    );
    assert!(text.contains("# -> 5000 rpm/s: not written"), "{text}");
    assert_eq!(Backup::read(&text).unwrap(), set.way_back());
}

/// The drive says what kind of value it is.
#[test]
fn values_without_tables_have_the_size_and_format_of_the_drive() {
    let of = |value: &str| {
        let head = "profidrive backup 1\nmodel: PROFIdrive\nvendor: 0x1234\ndevice: 0x0000\n";
        Backup::read(format!("{head}1200 = {value}\n")).unwrap()
    };
    let plan = Plan::new(&of("0x0005"), &of("0xFFFE"), &Choice::default());
    let change = &plan.set.changes[0];
    assert_eq!(
        (change.new.raw(), change.new.format),
        (Some(5), old(change).format)
    );
    let plan = Plan::new(&of("0x05"), &of("0xFFFE"), &Choice::default());
    assert!(matches!(plan.skipped[0].why, Skip::Size { drive: 2, file: 1 }));
}

proptest! {
    /// A plan is carried out in its order and undone by its way back, whatever differs.
    #[test]
    fn a_plan_leads_there_and_back(from: [u16; 6], to: [u16; 6]) {
        let names = ["DRV.ACC", "DRV.DEC", "PN.VELSCALING", "Jog v1", "SWLS.EN", "VL.LIMITP_32"];
        let limit = |name: &str, value: u16| -> i64 {
            let parameter = AKD.by_name(name).unwrap();
            let (low, high) = parameter.raw_limits(&Scaling::default());
            i64::from(value).clamp(low.max(1), high)
        };
        let state = |values: [u16; 6]| {
            let set: Vec<(&str, i64)> = names.iter().zip(values).map(|(name, value)| (*name, limit(name, value))).collect();
            let scaling = Scaling { velocity: set[2].1 as u16, ..Scaling::default() };
            drive(scaling, &set)
        };
        let (present, wanted) = (state(from), state(to));
        let plan = Plan::new(&wanted, &present, &Choice::default());
        prop_assert!(plan.set.changes.is_sorted_by_key(|change| change.phase()));
        for change in &plan.set.changes {
            prop_assert_eq!(rule(present.parameters(), change.new.pnu, None).role, Role::Setting);
            let target = wanted.reading(change.new.pnu, None).unwrap();
            prop_assert_eq!(change.new.raw(), target.raw());
            let back = plan.set.way_back();
            prop_assert_eq!(back.reading(change.new.pnu, None), present.reading(change.new.pnu, None));
        }
        for skipped in &plan.skipped {
            prop_assert!(matches!(skipped.why, Skip::Same | Skip::Network(_)), "{:?}", skipped);
        }
    }
}

/// A journal is read back whatever its values are, and a cut one never.
#[test]
fn a_journal_reads_back_and_a_cut_one_is_refused() {
    let present = drive(Scaling::default(), &[]);
    let wanted = file("p2108 = 5000 rpm/s\np1004 = 90 rpm\np2106 = 1\nDRV.DIR = 1");
    let mut set = Plan::new(&wanted, &present, &Choice::default()).set;
    assert!(set.changes.len() > 2);
    set.changes[0].step = Step::InDoubt;
    set.changes[1].step = Step::ReadBack;
    let text = set.journal();
    let back = ChangeSet::from_journal(&text).unwrap();
    let mut changes: Vec<&Change> = set.changes.iter().collect();
    changes.sort_by_key(|change| change.new.pnu);
    assert_eq!(back.changes.len(), changes.len());
    for (read, noted) in back.changes.iter().zip(changes) {
        assert_eq!(
            (old(read).raw(), read.new.raw()),
            (old(noted).raw(), noted.new.raw())
        );
        assert_eq!(read.step.may_have_changed(), noted.step.may_have_changed());
    }
    // it is a backup of the old values too
    assert_eq!(Backup::read(&text).unwrap(), set.way_back());
    for end in 0..text.len() {
        assert!(ChangeSet::from_journal(&text[..end]).is_err(), "cut at {end}");
    }
    assert!(ChangeSet::from_journal(set.to_string()).is_err(), "no checksum");
}

#[test]
fn a_journal_of_any_model_reads_back() {
    for (text, jog, raw) in [
        (
            include_str!("../../tests/data/vlt.backup"),
            ("8-90 Bus Jog 1 Speed = 100 rpm", "8-90 = 250 rpm"),
            (100, 250),
        ),
        (
            include_str!("../../tests/data/vacon.backup"),
            ("ID 124 Jogging frequency = 5 Hz", "ID 124 = 2.5 Hz"),
            (500, 250),
        ),
    ] {
        let present = Backup::read(text).unwrap();
        let wanted = Backup::read(text.replace(jog.0, jog.1)).unwrap();
        let mut set = Plan::new(&wanted, &present, &Choice::default()).set;
        set.changes[0].step = Step::InDoubt;
        let back = ChangeSet::from_journal(set.journal()).unwrap();
        let [change] = back.changes() else { panic!("{set}") };
        assert_eq!(
            (old(change).raw(), change.new.raw(), change.step),
            (Some(raw.0), Some(raw.1), Step::InDoubt)
        );
    }
}

/// What scales other values, and motion tasks, are not values that are read back one by one.
#[test]
fn a_journal_of_scalings_is_refused() {
    let present = drive(Scaling::default(), &[]);
    let wanted = file("PN.VELSCALING = 1000\np1004 = 90 rpm");
    let set = Plan::new(&wanted, &present, &Choice::default()).set;
    let error = ChangeSet::from_journal(set.journal()).unwrap_err();
    assert!(!error.problems.is_empty(), "{error}");
}
