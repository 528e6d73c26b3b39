//! Saving, comparing and restoring against virtual drives, in virtual time: interrupted at every point, never a wrong claim.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::unwrap_used, clippy::panic)]

mod tasks;

use profidrive_client::Wait;
use std::time::Duration;

use network::segment::Conditions;
use profidrive_client::Error;
use profidrive_client::backup::{Backup, compare};
use profidrive_client::change::{Choice, Saved, Step};
use profile::catalogue::{AKD, Phase, Role, Size};
use profile::fault::Counting;
use profile::parameter::{Keep, ParameterAccess};
use proptest::prelude::*;
use testbench::watched::{Bench, Claims, Wire, bench};
use virtual_drive::station::AnswerFault;

/// Settings that differ from those as delivered, of every phase, with numbers that fit.
const OTHER: [(u16, u64); 14] = [
    (3065, 1000),      // PN.ACCSCALING
    (1006, 328),       // Jog Acc
    (2135, 0),         // DRV.OPMODE
    (2439, 2_500_000), // VL.LIMITP_32
    (2231, 5_000),     // IL.LIMITP
    (2261, 4_000),     // MOTOR.VMAX
    (2108, 5_000_000), // DRV.ACC
    (2115, 6_000_000), // DRV.DEC
    (2497, 1),         // USER.INT1
    (2498, 0xFFFF_FFFF),
    (2499, 3),
    (2500, 4),
    (2382, 3), // SWLS.EN
    (2117, 1), // DRV.DIR, which the drive does not save
];

/// Jog Dec too has another number: it is scaled by PN.ACCSCALING.
const CHANGES: usize = OTHER.len() + 1;

/// What the drive would say if its settings were those.
fn other() -> Backup {
    let mut bench = bench();
    for (pnu, raw) in OTHER {
        bench.set(pnu, raw);
    }
    bench.backup()
}

/// Restores `wanted` while `meddle` happens; checks every claim at every moment; then undoes it with what was kept.
fn meddled(
    wanted: &Backup,
    mut meddle: impl FnMut(usize, &mut Wire<'_>) + Send + 'static,
    interrupt: Option<usize>,
) -> (Result<(), Error>, usize) {
    let mut bench = bench();
    let before = bench.backup();
    let mut journal = bench.journal(wanted, &Choice::default());
    let claims = Claims::watch(&mut bench, &journal);
    let seen = claims.clone();
    bench.on_each_step(move |step, wire| {
        meddle(step, wire);
        seen.check(wire);
    });
    let steps = bench.steps.clone();
    bench
        .session
        .interrupt_with(move || interrupt.is_some_and(|at| steps.get() >= at));
    let kept = claims.kept.clone();
    journal.save(&bench.drive).unwrap();
    let result = bench
        .session
        .apply_kept(&mut bench.drive, &mut journal, &mut |journal| {
            *kept.borrow_mut() = journal.to_string();
            Ok(())
        })
        .wait();
    // what is still on its way may arrive now
    bench.session.interrupt_with(|| false);
    let took = bench.steps.get();
    let _ = bench.session.close().wait();
    claims.check(&mut bench.wire());
    assert_eq!(result.is_ok(), journal.is_complete());

    // the cable is back, the drive is in order: the way back brings everything back
    bench.on_each_step(|_, _| {});
    let mut wire = bench.wire();
    let id = wire.id;
    wire.segment.uncut(id);
    wire.segment.set_all_conditions(Conditions::default());
    drop(wire);
    bench.wire().station().set_answer_fault(AnswerFault::None);
    let text = claims.kept.borrow().clone();
    if !text.is_empty() {
        let back = Backup::read(&text).unwrap();
        let mut journal = bench.journal(&back, &Choice::default());
        bench.restore(&mut journal, false).0.unwrap();
        assert!(journal.is_done());
    }
    assert_eq!(bench.backup().to_string(), before.to_string());
    (result, took)
}

#[test]
fn a_whole_drive_is_saved_in_a_few_requests_and_twice_the_same() {
    let mut bench = bench();
    let sent = bench.wire().segment.statistics().sent;
    let backup = bench.backup();
    let frames = bench.wire().segment.statistics().sent - sent;
    // each of the 128 motion tasks is loaded, then read
    assert!(frames < 300 + 128 * 8, "{frames} frames");
    assert!(backup.refused().is_empty(), "{:?}", backup.refused());
    let settings = AKD
        .parameters
        .iter()
        .filter(|parameter| parameter.size != Size::Command)
        .filter(|parameter| parameter.access == profile::catalogue::Access::ReadWrite)
        .filter(|parameter| matches!(AKD.backup_rule(parameter.pnu).role, Role::Setting | Role::Network));
    let elements: usize = settings.map(|parameter| usize::from(parameter.elements)).sum();
    assert_eq!(backup.readings().len(), elements);
    assert_eq!(backup.header.order_id, AKD.device.order_id);
    let text = backup.to_string();
    assert_eq!(bench.backup().to_string(), text);
    assert_eq!(Backup::read(&text).unwrap(), backup);
}

#[test]
fn restored_read_back_and_saved() {
    let wanted = other();
    let mut bench = bench();
    let mut journal = bench.journal(&wanted, &Choice::default());
    assert_eq!(journal.total(), CHANGES);
    let (result, kept) = bench.restore(&mut journal, true);
    result.unwrap();
    assert!(journal.is_done() && journal.is_complete());
    assert_eq!(journal.saved(), Saved::Yes);
    assert!(
        kept.contains("# complete: 15 of 15 written and read back\n"),
        "{kept}"
    );
    assert!(kept.contains("# saved in the drive\n"), "{kept}");
    for (pnu, raw) in OTHER {
        assert_eq!(bench.wire().truth(pnu), raw, "{pnu}");
    }
    assert_eq!(bench.backup().to_string(), wanted.to_string());
    assert!(compare(&bench.backup(), &wanted).is_empty());
    // nothing is left to do
    assert!(bench.journal(&wanted, &Choice::default()).changes().is_empty());
}

/// 64-bit values have two numbers; a backup that keeps one half would bring another value back.
#[test]
fn both_halves_of_a_value_come_back() {
    let mut bench = bench();
    let stop = AKD.by_name("SWLS.LIMIT1").unwrap();
    let high = stop.high().unwrap();
    bench.set(high, 0x10);
    bench.set(stop.pnu, 5);
    let saved = bench.backup();
    assert!(
        saved
            .to_string()
            .contains("p2385 SWLS.LIMIT1 = 68719476741 counts "),
        "{saved}"
    );
    bench.set(stop.pnu, 7);
    assert_eq!(bench.backup().reading(stop.pnu, None).unwrap().raw(), Some(7));
    let mut journal = bench.journal(&saved, &Choice::default());
    let (result, kept) = bench.restore(&mut journal, false);
    result.unwrap();
    assert!(journal.is_done(), "{kept}");
    assert_eq!(bench.backup().to_string(), saved.to_string());
    let low = bench.wire().truth(stop.pnu);
    let high = bench.wire().station().drive_mut().read(high, 0).unwrap();
    assert_eq!((high, low), (0x10, 5));
}

#[test]
fn interrupted_at_every_point() {
    let wanted = other();
    let (result, all) = meddled(&wanted, |_, _| {}, None);
    result.unwrap();
    let mut interrupted = 0;
    for at in 0..=all + 1 {
        let (result, _) = meddled(&wanted, |_, _| {}, Some(at));
        match result {
            Err(Error::Interrupted) => interrupted += 1,
            other => other.unwrap(),
        }
    }
    assert!(interrupted > all / 2, "{interrupted} of {all}");
}

#[test]
fn the_cable_pulled_at_every_point() {
    let wanted = other();
    let (_, all) = meddled(&wanted, |_, _| {}, None);
    let mut lost = 0;
    for at in (1..=all).step_by(3) {
        let pull = move |step, wire: &mut Wire<'_>| {
            if step == at {
                wire.segment.cut(wire.id);
            }
        };
        let (result, _) = meddled(&wanted, pull, None);
        lost += usize::from(result.is_err());
    }
    assert!(lost * 3 > all / 2, "{lost} of {all}");
}

/// The parameter manager goes lame in the midst of it.
#[test]
fn a_lame_drive_at_many_points() {
    let wanted = other();
    let (_, all) = meddled(&wanted, |_, _| {}, None);
    for fault in [
        AnswerFault::Silent,
        AnswerFault::Reference,
        AnswerFault::Cut,
        AnswerFault::Error(0x11),
        AnswerFault::Late(Duration::from_millis(700)),
    ] {
        for at in (1..=all).step_by(7) {
            let lame = move |step, wire: &mut Wire<'_>| {
                if step == at {
                    wire.station().set_answer_fault(fault);
                }
            };
            let (result, _) = meddled(&wanted, lame, None);
            if let AnswerFault::Late(_) = fault {
                result.unwrap();
            }
        }
    }
}

#[test]
fn a_bad_cable_changes_nothing_but_the_time() {
    let wanted = other();
    for seed in 1..6_u32 {
        let bad = move |step, wire: &mut Wire<'_>| {
            if step == 1 {
                wire.segment.set_all_conditions(Conditions {
                    loss: 0.02 * f64::from(seed),
                    duplicate: 0.1,
                    reorder: 0.1,
                    ..Conditions::default()
                });
            }
        };
        let (result, _) = meddled(&wanted, bad, None);
        result.unwrap();
    }
}

#[test]
fn nothing_is_written_while_the_power_stage_is_on() {
    let wanted = other();
    let mut bench = bench();
    let mut journal = bench.journal(&wanted, &Choice::default());
    bench.set(2113, 0); // DRV.CMDSOURCE: the service channel commands
    bench.set(2127, 1); // DRV.EN
    let now = bench.session.now();
    bench.session.pass(Duration::from_millis(100)).wait().unwrap();
    assert!(bench.wire().station().drive().is_enabled(), "since {now:?}");
    assert_eq!(
        bench.session.is_enabled(&mut bench.drive).wait().unwrap(),
        Some(true)
    );
    let (result, kept) = bench.restore(&mut journal, true);
    assert!(matches!(result, Err(Error::NotAtRest { .. })), "{result:?}");
    assert_eq!(journal.count(|step| *step == Step::NotWritten), CHANGES);
    assert!(
        kept.contains("ended early: akd-1: the power stage is on, nothing is written"),
        "{kept}"
    );
    assert_eq!(bench.wire().truth(2108), 3_000_000);
}

#[test]
fn switched_on_in_the_midst_of_it() {
    let wanted = other();
    let (_, all) = meddled(&wanted, |_, _| {}, None);
    let mut stopped = 0;
    for at in (1..all).step_by(5) {
        let mut bench = bench();
        let mut journal = bench.journal(&wanted, &Choice::default());
        bench.on_each_step(move |step, wire| {
            if step == at {
                let drive = wire.station().drive_mut();
                drive.write(2113, 0, 0, Keep::Volatile).unwrap();
                drive.write(2127, 0, 1, Keep::Volatile).unwrap();
            }
        });
        let (result, _) = bench.restore(&mut journal, false);
        if matches!(result, Err(Error::NotAtRest { .. })) {
            stopped += 1;
            assert!(!journal.is_complete());
        }
    }
    assert!(stopped > 3, "{stopped}");
}

/// A drive that changes a value itself: it is reported, and not saved.
#[test]
fn a_value_that_reads_back_differently_is_reported_and_not_saved() {
    let wanted = other();
    let mut bench = bench();
    let mut journal = bench.journal(&wanted, &Choice::default());
    bench.on_each_step(|_, wire| {
        let drive = wire.station().drive_mut();
        if drive.read(2108, 0).unwrap() > 4_000_000 {
            drive.write(2108, 0, 4_000_000, Keep::Volatile).unwrap();
        }
    });
    let (result, kept) = bench.restore(&mut journal, true);
    result.unwrap();
    assert!(journal.is_complete() && !journal.is_done());
    assert_eq!(journal.saved(), Saved::No);
    assert_eq!(journal.count(|step| *step == Step::Differs), 1);
    assert!(
        kept.contains("14 of 15 written and read back, 1 read back another value"),
        "{kept}"
    );
    assert!(kept.contains("p2108 DRV.ACC = 3000 rpm/s"), "{kept}");
    assert!(
        kept.contains("# -> 5000 rpm/s: written, but reads back another value"),
        "{kept}"
    );
}

#[test]
fn refused_values_are_reported_and_the_rest_is_written() {
    let mut bench = bench();
    let text = bench.backup().to_string();
    let text = text
        .replace("p2439 VL.LIMITP_32 = 3000 rpm", "p2439 VL.LIMITP_32 = 12001 rpm")
        .replace("p2108 DRV.ACC = 3000 rpm/s", "p2108 DRV.ACC = 4000 rpm/s");
    let wanted = Backup::read(&text).unwrap();
    assert_eq!(bench.journal(&wanted, &Choice::default()).total(), 1);
    let beyond = Choice {
        beyond_limits: true,
        ..Choice::default()
    };
    let mut journal = bench.journal(&wanted, &beyond);
    let (result, kept) = bench.restore(&mut journal, true);
    result.unwrap();
    assert_eq!(journal.changes()[0].phase(), Phase::Limit);
    assert!(journal.changes()[0].step.is_refused() && journal.changes()[1].step == Step::ReadBack);
    assert_eq!(journal.saved(), Saved::No);
    assert!(kept.contains("# -> 12001 rpm: refused: 0x02 "), "{kept}");
    assert_eq!(bench.wire().truth(2108), 4_000_000);
}

/// When the way back cannot be written, nothing else is.
#[test]
fn without_a_way_back_nothing_is_written() {
    let wanted = other();
    for fails_at in 0..8 {
        let mut bench = bench();
        let mut journal = bench.journal(&wanted, &Choice::default());
        let claims = Claims::watch(&mut bench, &journal);
        let (mut calls, kept) = (0, claims.kept.clone());
        let result = bench
            .session
            .apply_kept(&mut bench.drive, &mut journal, &mut |journal| {
                calls += 1;
                if calls > fails_at {
                    return Err("the disk is full".into());
                }
                *kept.borrow_mut() = journal.to_string();
                Ok(())
            })
            .wait();
        let error = result.unwrap_err();
        assert!(matches!(error, Error::Journal { .. }), "{error}");
        // what was kept last holds anyway
        claims.check(&mut bench.wire());
    }
}

/// A drive without a built-in catalogue: by number, from its own lists and descriptions.
#[test]
fn a_drive_without_tables() {
    let mut bench = bench();
    bench.drive.station.vendor_id = 0x1234;
    bench.drive.model.catalogue = None;
    bench.drive.model.name = "PROFIdrive";
    bench.drive.parameters.catalogue = None;
    bench.set(1004, 0xFF00);
    let backup = bench.backup();
    let text = backup.to_string();
    assert!(
        text.contains("vendor: 0x1234\n") && text.contains("\n1004 = 0xFF00 "),
        "{text}"
    );
    assert!(!text.contains("\n944 = "), "read-only is not in it");
    assert_eq!(Backup::read(&text).unwrap(), backup);
    let wanted = Backup::read(text.replace("\n1004 = 0xFF00", "\n1004 = 0x0064")).unwrap();
    let choice = Choice {
        only: vec!["1004".parse().unwrap(), "922".parse().unwrap()],
        ..Choice::default()
    };
    let plan = bench
        .session
        .plan(&mut bench.drive, &wanted, &choice)
        .wait()
        .unwrap();
    assert_eq!((plan.set.changes().len(), plan.skipped.len()), (1, 1));
    let mut journal = plan.set;
    // no known parameter reports whether it is switched on
    let (result, _) = bench.restore(&mut journal, false);
    assert!(matches!(result, Err(Error::NotAtRest { .. })), "{result:?}");
    assert_eq!(bench.wire().truth(1004), 0xFF00);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Save, change, restore, save again: equal files. And the way back leads to the changed drive again.
    #[test]
    fn there_and_back(picks in prop::collection::vec((0_usize..2000, any::<u32>()), 1..60)) {
        let mut bench = bench();
        let first = bench.backup();
        let settings: Vec<u16> = first
            .readings()
            .iter()
            .map(|reading| reading.pnu)
            .filter(|&pnu| AKD.backup_rule(pnu).role == Role::Setting)
            .collect();
        for (pick, value) in picks {
            let pnu = settings[pick % settings.len()];
            let parameter = AKD.by_pnu(pnu).unwrap();
            let (low, high) = parameter.raw_limits(&bench.drive.parameters.scaling);
            let span = i128::from(high) - i128::from(low) + 1;
            let raw = (i128::from(low) + i128::from(value) % span) as i64;
            let bits = 8 * parameter.size.octets();
            let raw = raw.cast_unsigned() & (u64::MAX >> (64 - bits));
            let mut wire = bench.wire();
            let drive = wire.station().drive_mut();
            // some say no, in this state or with that neighbour: that is not a setting then
            if let Some(high) = parameter.high() {
                let _ = drive.write(high, 0, value.into(), Keep::Volatile).and_then(|()| drive.write(pnu, 0, u64::from(!value), Keep::Volatile));
            } else {
                let _ = drive.write(pnu, 0, raw, Keep::Volatile);
            }
        }
        let changed = bench.backup();
        let mut journal = bench.journal(&first, &Choice::default());
        let (result, kept) = bench.restore(&mut journal, false);
        prop_assert!(result.is_ok(), "{:?}", result);
        prop_assert!(journal.is_done(), "{}", kept);
        prop_assert_eq!(bench.backup().to_string(), first.to_string());
        let back = Backup::read(&kept).unwrap();
        let plan = bench.session.plan(&mut bench.drive, &back, &Choice::default()).wait().unwrap();
        // a unit that was chosen last can leave a number beyond its limits: the way back says so, and brings all others
        let refused: Vec<u16> = plan
            .skipped
            .iter()
            .filter(|skipped| skipped.why.is_refusal())
            .map(|skipped| skipped.reading.pnu)
            .collect();
        let mut journal = plan.set;
        bench.restore(&mut journal, false).0.unwrap();
        for difference in compare(&bench.backup(), &changed) {
            let pnu = difference.reading().map(|reading| reading.pnu);
            prop_assert!(pnu.is_some_and(|pnu| refused.contains(&pnu)), "{:?}", difference);
        }
    }
}

#[test]
fn faults_situation_by_situation_of_one_moment() {
    let mut bench = bench();
    let raise = |bench: &mut Bench, number| bench.wire().station().drive_mut().inject_fault(number, false);
    raise(&mut bench, 439);
    bench.session.pass(Duration::from_millis(50)).wait().unwrap();
    bench.set(2111, 1); // DRV.CLRFAULTS
    raise(&mut bench, 702);
    raise(&mut bench, 302);
    let report = bench.session.fault_report(&mut bench.drive).wait().unwrap();
    let seen: Vec<(u8, u8, u16)> = report
        .faults
        .iter()
        .map(|fault| (fault.situation, fault.position, fault.number))
        .collect();
    assert_eq!(seen, [(0, 0, 702), (0, 1, 302), (1, 0, 439)]);
    assert_eq!(report.present().count(), 2);
    assert_eq!((report.counter, report.counting), (2, Counting::Situations));
    let lost = &report.faults[0];
    assert!(
        lost.meaning
            .is_some_and(|text| text.to_lowercase().contains("fieldbus"))
    );
    assert_eq!(lost.reaction.map(|reaction| reaction.text()), Some("quick stop"));
    assert!(lost.remedy.is_some() && lost.cleared.is_some());
    assert_eq!(report.warnings, Some(Vec::new()));

    // a fault for every step: never one moment, so no report
    let mut number = 500;
    bench.on_each_step(move |_, wire| {
        number += 1;
        let now = wire.segment.now();
        let drive = wire.station().drive_mut();
        drive.inject_fault(number, false);
        drive.tick(now, None, &mut []);
        drive.write(2111, 0, 1, Keep::Volatile).unwrap();
    });
    let error = bench.session.fault_report(&mut bench.drive).wait().unwrap_err();
    assert!(matches!(error, Error::Changing { attempts: 3, .. }), "{error}");
}
