//! Motion tasks in backups: read through their window, which is left as it was, and written back.

use profidrive_client::Wait;
use profidrive_client::backup::{Task, TaskCoverage, compare_tasks};
use testbench::shared::Shared;

use super::*;

const NUM: u16 = 2274;
const SET: u16 = 2277;
const CLEAR: u16 = 2265;
/// MT.NUM, P, V, ACC, DEC, CNTL, MTNEXT, TNEXT, TNUM.
const WINDOW: [u16; 9] = [NUM, 2275, 2283, 2263, 2268, 2266, 2273, 2278, 2279];

/// The window of the motion tasks, set and looked up in the drive itself.
trait Tasks {
    fn show(&mut self, values: [u64; 9]);
    fn task(&mut self, number: u64, position: i32, speed: u64);
    fn window(&mut self) -> [u64; 9];
}

impl Tasks for Bench {
    fn show(&mut self, values: [u64; 9]) {
        for (pnu, raw) in WINDOW.into_iter().zip(values) {
            self.set(pnu, raw);
        }
    }

    fn task(&mut self, number: u64, position: i32, speed: u64) {
        let position = u64::from(position.cast_unsigned());
        self.show([number, position, speed, 3_000_000, 2_000_000, 0x10, 6, 250, 0]);
        self.set(SET, 1);
    }

    fn window(&mut self) -> [u64; 9] {
        WINDOW.map(|pnu| self.wire().truth(pnu))
    }
}

/// Three tasks, and a window that shows none of them.
fn with_tasks() -> Bench {
    let mut bench = bench();
    bench.task(1, 196_608, 300_000);
    bench.task(5, -65_536, 1_000);
    bench.task(128, 7, 12_000_000);
    bench.show([77, 4_294_967_290, 5, 1_860, 1_861, 0x2000, 128, 65_535, 7]);
    bench
}

#[test]
fn they_are_in_the_backup_and_their_window_is_as_it_was() {
    let mut bench = with_tasks();
    let before = bench.window();
    let backup = bench.backup();
    assert_eq!(bench.window(), before);
    assert_eq!(backup.header.tasks, TaskCoverage::All);
    assert_eq!(backup.task_count(), 3);
    let text = backup.to_string();
    let line = "\nMT[1] = P 196608 counts, V 300 rpm, ACC 3000 rpm/s, DEC 2000 rpm/s, CNTL 0x00000010, MTNEXT 6, TNEXT 250 ms, TNUM 0\n";
    assert!(
        text.contains(line) && text.contains("\nMT[5] = P -65536 counts, V 1 rpm,"),
        "{text}"
    );
    assert_eq!(Backup::read(&text).unwrap(), backup);
    assert_eq!(bench.backup().to_string(), text);
}

#[test]
fn a_window_that_shows_an_empty_task_shows_it_again() {
    let mut bench = with_tasks();
    bench.set(NUM, 9);
    bench.set(2271, 1); // MT.LOAD: zeros, which cannot be written
    let before = bench.window();
    assert_eq!(before[3], 0);
    assert_eq!(bench.backup().task_count(), 3);
    assert_eq!(bench.window(), before);
}

#[test]
fn a_drive_that_is_switched_on_is_not_restored() {
    let mut bench = with_tasks();
    bench.set(2113, 0); // DRV.CMDSOURCE
    bench.set(2127, 1); // DRV.EN
    bench.session.pass(Duration::from_millis(500)).wait().unwrap();
    assert_eq!(bench.wire().truth(2110), 1);
    let before = bench.window();
    let windows = Shared::new(0);
    let other = windows.clone();
    bench.on_each_step(move |_, wire| {
        let now = WINDOW.map(|pnu| wire.truth(pnu));
        other.set(other.get() + usize::from(now != before));
    });
    let backup = bench.backup();
    assert_eq!(windows.get(), 0);
    let text = backup.to_string();
    assert!(
        text.contains("\ntasks: left out, the power stage is on\n") && !text.contains("MT["),
        "{text}"
    );
    assert_eq!(Backup::read(&text).unwrap(), backup);
}

#[test]
fn another_client_of_the_task_window_is_not_disturbed() {
    let mut bench = with_tasks();
    let mut seen = 0;
    bench.on_each_step(move |_, wire| {
        if wire.truth(NUM) == 40 && seen == 0 {
            seen = 1;
            wire.station()
                .drive_mut()
                .write(NUM, 0, 3, Keep::Volatile)
                .unwrap();
        }
    });
    let backup = bench.backup();
    assert_eq!(
        backup.header.tasks,
        TaskCoverage::LeftOut("another client uses MT.NUM".into())
    );
}

#[test]
fn changed_compared_restored_and_the_way_back() {
    let mut bench = with_tasks();
    let wanted = bench.backup();
    bench.set(CLEAR, 1);
    bench.task(5, 65_536, 1_000);
    bench.task(9, 1, 1_000);
    bench.show([3, 1, 2, 3_000, 4_000, 0, 0, 0, 0]);
    let window = bench.window();
    let changed = bench.backup();
    let numbers = |a: &Backup, b: &Backup| {
        compare_tasks(a, b)
            .iter()
            .map(|one| one.number)
            .collect::<Vec<_>>()
    };
    assert_eq!(numbers(&wanted, &changed), [1, 5, 9]);
    let mut journal = bench.journal(&wanted, &Choice::default());
    assert_eq!((journal.changes().len(), journal.tasks().len()), (0, 3));
    assert_eq!(
        numbers(&changed, &bench.backup()),
        [] as [u16; 0],
        "a plan writes nothing"
    );
    let (result, kept) = bench.restore(&mut journal, true);
    result.unwrap();
    assert!(journal.is_done() && journal.saved() == Saved::Yes, "{kept}");
    assert!(journal.summary().starts_with("3 of 3 written and read back"));
    assert_eq!(bench.window(), window);
    assert_eq!(bench.backup().to_string(), wanted.to_string());
    assert!(
        kept.contains("\nMT[1] = empty                           # -> another task: written, read back\n"),
        "{kept}"
    );
    let back = Backup::read(&kept).unwrap();
    assert_eq!(back.task(9).map(|task| *task == Task::Empty), Some(false));
    let mut journal = bench.journal(&back, &Choice::default());
    bench.restore(&mut journal, false).0.unwrap();
    assert_eq!(bench.backup().to_string(), changed.to_string());
    // only one of them
    let choice = Choice {
        only: vec!["MT[9]".parse().unwrap()],
        ..Choice::default()
    };
    let plan = bench
        .session
        .plan(&mut bench.drive, &wanted, &choice)
        .wait()
        .unwrap();
    assert_eq!(
        (
            plan.set.tasks().len(),
            plan.set.tasks()[0].number,
            plan.set.changes().len()
        ),
        (1, 9, 0)
    );
}

#[test]
fn interrupted_at_every_point_nothing_wrong_is_claimed_and_the_window_is_as_it_was() {
    let wanted = with_tasks().backup();
    for at in 1.. {
        let mut bench = bench();
        bench.show([77, 1, 5, 1_860, 1_861, 0x2000, 128, 65_535, 7]);
        let window = bench.window();
        let empty = bench.backup();
        let mut journal = bench.journal(&wanted, &Choice::default());
        assert_eq!(journal.tasks().len(), 3);
        bench.on_each_step(|_, _| {});
        let steps = bench.steps.clone();
        bench.session.interrupt_with(move || steps.get() >= at);
        let (result, kept) = bench.restore(&mut journal, false);
        bench.session.interrupt_with(|| false);
        assert_eq!(bench.window(), window, "{at}");
        let now = bench.backup();
        for change in journal.tasks() {
            let has = now.task(change.number).unwrap();
            match change.step {
                Step::NotWritten => assert_eq!(*has, Task::Empty, "{at}"),
                Step::ReadBack => assert_eq!(*has, change.new, "{at}"),
                Step::InDoubt => assert!(*has == Task::Empty || *has == change.new, "{at}"),
                other => panic!("{at}: {other}"),
            }
        }
        if !kept.is_empty() {
            let mut back = bench.journal(&Backup::read(&kept).unwrap(), &Choice::default());
            bench.restore(&mut back, false).0.unwrap();
            assert_eq!(bench.backup().to_string(), empty.to_string());
        }
        if result.is_ok() {
            assert!(journal.is_done() && at > 20, "{at}");
            break;
        }
    }
}

#[test]
fn positions_are_in_the_unit_that_the_drive_has() {
    const UNIT: u16 = 2393; // UNIT.PROTARY
    const LIMIT: u16 = 2385; // SWLS.LIMIT1
    let mut bench = bench();
    bench.task(1, 196_608, 300_000);
    bench.set(LIMIT, 131_072);
    let counts = bench.backup();
    assert!(counts.to_string().contains("UNIT.PROTARY 4, "), "{counts}");
    bench.set(UNIT, 2);
    bench.set(LIMIT, 720);
    let degrees = bench.backup();
    let text = degrees.to_string();
    assert!(
        text.contains("# positions in deg, 360 per revolution\n"),
        "{text}"
    );
    assert!(text.contains("\np2385 SWLS.LIMIT1 = 720 deg "), "{text}");
    assert!(text.contains("\nMT[1] = P 1080 deg, "), "{text}");
    assert_eq!(Backup::read(&text).unwrap(), degrees);
    // the same place is the same place
    let differences: Vec<_> = compare(&counts, &degrees);
    let names: Vec<_> = differences.iter().filter_map(|one| one.name()).collect();
    assert!(
        names.contains(&"UNIT.PROTARY") && !names.contains(&"SWLS.LIMIT1"),
        "{names:?}"
    );
    assert!(compare_tasks(&counts, &degrees).is_empty());
    // a part of the file without its unit: the drive keeps its own
    let choice = Choice {
        only: vec!["SWLS.LIMIT1".parse().unwrap(), "MT*".parse().unwrap()],
        ..Choice::default()
    };
    bench.set(LIMIT, 360);
    bench.set(CLEAR, 1);
    let mut journal = bench.journal(&counts, &choice);
    bench.restore(&mut journal, false).0.unwrap();
    assert_eq!(bench.backup().to_string(), text);
    // all of it
    let mut journal = bench.journal(&counts, &Choice::default());
    bench.restore(&mut journal, false).0.unwrap();
    assert!(journal.is_done(), "{}", journal.summary());
    assert_eq!(bench.backup().to_string(), counts.to_string());
}
