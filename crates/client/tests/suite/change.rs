//! Changes planned, written, verified and undone against a virtual AKD, in virtual time.

use proptest::prelude::*;

use profidrive_client::change::{ChangeSet, Condition, Saved, Step};
use profidrive_client::{Error, Wait};
use profile::parameter::ParameterAccess;
use profile::value::Assignment;
use testbench::watched::{Bench, bench};

fn assignments(text: &str) -> Vec<Assignment> {
    text.split(' ')
        .map(|one| one.parse().expect("an assignment"))
        .collect()
}

fn plan(bench: &mut Bench, text: &str, save: bool) -> ChangeSet {
    let assignments = assignments(text);
    let plan = bench.session.plan_write(&mut bench.drive, &assignments, save);
    plan.wait().expect("a plan")
}

fn steps(set: &ChangeSet) -> Vec<Step> {
    set.changes().iter().map(|change| change.step).collect()
}

/// Frames that the segment carries while `work` is done.
fn frames(bench: &mut Bench, work: impl FnOnce(&mut Bench)) -> u64 {
    let before = bench.wire().segment.statistics().sent;
    work(bench);
    bench.wire().segment.statistics().sent - before
}

/// Reading the old value, writing and reading back are all that a write does; what is so already is only read.
#[test]
fn a_write_is_three_jobs_and_one_where_nothing_is_new() {
    let mut bench = bench();
    plan(&mut bench, "DRV.ACC=3000", false);
    let job = frames(&mut bench, |bench| {
        let selection = bench.drive.select("DRV.ACC").expect("known");
        bench
            .session
            .read_one(&mut bench.drive, &selection)
            .wait()
            .expect("read");
    });
    let mut write = |text: &str, expected: Step| {
        frames(&mut bench, |bench| {
            let mut set = plan(bench, text, false);
            bench
                .session
                .apply(&mut bench.drive, &mut set)
                .wait()
                .expect("written");
            assert_eq!(steps(&set), [expected]);
        })
    };
    assert_eq!(write("DRV.ACC=5000", Step::ReadBack), 3 * job);
    assert_eq!(write("DRV.ACC=5000", Step::Same), job);
}

#[test]
fn a_plan_writes_nothing_and_says_what_it_would_do() {
    let mut bench = bench();
    let set = plan(
        &mut bench,
        "DRV.ACC=5000.0004 DRV.DEC=3000 DRV.DIS=1 DRV.DIR=1",
        true,
    );
    assert_eq!(steps(&set), [Step::NotWritten; 4]);
    assert_eq!(set.condition(), Condition::OffToScale);
    let [acceleration, deceleration, command, direction] = set.changes() else {
        panic!("{set:?}");
    };
    assert_eq!(acceleration.new.raw(), Some(5_000_000));
    assert!(
        acceleration
            .rounding
            .is_some_and(|value| value.asked == 5000.0004)
    );
    assert!(deceleration.is_same() && command.acts && command.old.is_none());
    assert_eq!(
        (acceleration.storable, direction.storable),
        (Some(true), Some(false))
    );
    let command = set.save_command().expect("an AKD saves by a command");
    assert_eq!((command.selection.pnu, command.step), (2469, Step::NotWritten));
    assert_eq!(bench.wire().truth(2108), 3_000_000);
    let unsaved = plan(&mut bench, "DRV.ACC=5000 DRV.DEC=3000", false);
    assert_eq!(steps(&unsaved), [Step::NotWritten, Step::Same]);
}

/// What follows a command or another telegram is written whatever the drive has at that moment.
#[test]
fn nothing_is_left_out_behind_what_may_change_it() {
    let mut bench = bench();
    let set = plan(
        &mut bench,
        "DRV.DEC=3000 930=1 DRV.CLRFAULTS=1 DRV.ACC=3000",
        false,
    );
    assert_eq!(
        steps(&set),
        [Step::Same, Step::Same, Step::NotWritten, Step::NotWritten]
    );
    let number = |bench: &mut Bench| bench.wire().station().drive_mut().read(922, 0).unwrap();
    let present = number(&mut bench);
    let set = plan(&mut bench, &format!("922={present} DRV.ACC=3000"), false);
    assert_eq!(steps(&set), [Step::Same, Step::Same]);
    let other = if present == 1 { 7 } else { 1 };
    let set = plan(&mut bench, &format!("922={other} DRV.ACC=3000"), false);
    assert_eq!(steps(&set), [Step::NotWritten, Step::NotWritten]);
}

#[test]
fn what_is_refused_in_the_middle_is_neither_saved_nor_undone() {
    let mut bench = bench();
    let before = bench.backup().to_string();
    // the mapping of a telegram that is not free cannot be written
    let mut set = plan(&mut bench, "DRV.ACC=5000 915[0]=2 DRV.DEC=4000", true);
    bench
        .session
        .apply(&mut bench.drive, &mut set)
        .wait()
        .expect("carried out");
    assert!(matches!(
        steps(&set)[..],
        [Step::ReadBack, Step::Refused(_), Step::ReadBack]
    ));
    assert!(set.is_complete() && !set.is_done());
    assert!(matches!(set.accepted(), Err(Error::Refused { .. })));
    assert_eq!(set.saved(), Saved::No);
    assert_eq!(
        set.save_command().map(|command| command.step),
        Some(Step::NotWritten)
    );
    let back = bench.session.undo(&mut bench.drive, &set).wait().expect("undone");
    let names: Vec<_> = back
        .changes()
        .iter()
        .filter_map(|change| change.new.name)
        .collect();
    assert_eq!(names, ["DRV.DEC", "DRV.ACC"], "the last one first");
    assert!(back.is_done(), "{back}");
    assert_eq!(bench.backup().to_string(), before);
}

/// The values before were saved too: after a power cycle the drive has them again.
#[test]
fn what_was_saved_is_undone_for_good() {
    let mut bench = bench();
    let mut set = plan(&mut bench, "DRV.ACC=5000", true);
    bench
        .session
        .apply(&mut bench.drive, &mut set)
        .wait()
        .expect("saved");
    assert!(set.saved() == Saved::Yes && set.is_saved(&set.changes()[0]));
    let back = bench.session.undo(&mut bench.drive, &set).wait().expect("undone");
    assert_eq!((back.saved(), steps(&back)), (Saved::Yes, vec![Step::ReadBack]));
}

/// Another client set another value meanwhile, or the old one: undo looks before it writes.
#[test]
fn undo_writes_only_what_is_not_as_before() {
    let mut bench = bench();
    let mut set = plan(&mut bench, "DRV.ACC=5000 DRV.DEC=4000", false);
    bench
        .session
        .apply(&mut bench.drive, &mut set)
        .wait()
        .expect("written");
    bench.set(2108, 3_000_000);
    let back = bench.session.undo(&mut bench.drive, &set).wait().expect("undone");
    assert_eq!(steps(&back), [Step::ReadBack, Step::Same]);
}

#[test]
fn an_undo_is_not_interrupted() {
    let mut bench = bench();
    let mut set = plan(&mut bench, "DRV.ACC=5000", false);
    bench
        .session
        .apply(&mut bench.drive, &mut set)
        .wait()
        .expect("written");
    bench.session.interrupt_with(|| true);
    let again = bench
        .session
        .plan_write(&mut bench.drive, &assignments("DRV.DEC=1000"), false)
        .wait();
    assert!(matches!(again, Err(Error::Interrupted)), "{again:?}");
    bench.session.undo(&mut bench.drive, &set).wait().expect("undone");
    assert_eq!(bench.wire().truth(2108), 3_000_000);
}

const NAMES: [(&str, u16); 5] = [
    ("DRV.ACC", 2108),
    ("DRV.DEC", 2115),
    ("VL.LIMITP_32", 2439),
    ("USER.INT1", 2497),
    ("SWLS.EN", 2382),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// However far a set came before the cable was pulled: each step says what the drive has, and undo brings everything back.
    #[test]
    fn a_set_that_lost_its_drive_says_how_far_it_came_and_is_undone(
        values in proptest::collection::vec((0..NAMES.len(), 2_u16..=3), 1..6),
        cut in 0_usize..60,
        save: bool,
    ) {
        let mut bench = bench();
        let before = bench.backup();
        let mut texts: Vec<String> = Vec::new();
        for (at, value) in values {
            let name = NAMES[at].0;
            if !texts.iter().any(|text| text.starts_with(name)) {
                texts.push(format!("{name}={value}"));
            }
        }
        let mut set = plan(&mut bench, &texts.join(" "), save);
        bench.on_each_step(move |step, wire| {
            if step == cut {
                wire.segment.cut(wire.id);
            }
        });
        let result = bench.session.apply(&mut bench.drive, &mut set).wait();
        prop_assert_eq!(result.is_ok(), set.is_complete());
        // what is still on its way may arrive now
        let _ = bench.session.close().wait();
        let wanted: Vec<(Step, u16, u64, u64)> = set.changes().iter().map(|change| {
            let number = |octets: &[u8]| octets.iter().fold(0, |sum, octet| sum << 8 | u64::from(*octet));
            let old = change.old.as_ref().unwrap().as_ref().unwrap();
            (change.step, change.new.pnu, number(&old.octets), number(&change.new.octets))
        }).collect();
        for (step, pnu, old, new) in wanted {
            let has = bench.wire().truth(pnu);
            let right = match step {
                Step::Same | Step::ReadBack | Step::Written => has == new,
                Step::NotWritten => has == old,
                Step::InDoubt => has == old || has == new,
                other => panic!("{other}"),
            };
            prop_assert!(right, "{}: {} has {}, before {}, wanted {}", step, pnu, has, old, new);
        }
        bench.on_each_step(|_, _| {});
        let mut wire = bench.wire();
        let id = wire.id;
        wire.segment.uncut(id);
        drop(wire);
        let back = bench.session.undo(&mut bench.drive, &set).wait();
        prop_assert!(back.as_ref().is_ok_and(ChangeSet::is_done), "{:?}", back);
        prop_assert_eq!(bench.backup().to_string(), before.to_string());
        // the journal is the same way back, as a file
        let text = set.to_string();
        let parsed = profidrive_client::backup::Backup::read(&text);
        prop_assert!(parsed.is_ok_and(|parsed| parsed == set.way_back()), "{}", text);
    }
}
