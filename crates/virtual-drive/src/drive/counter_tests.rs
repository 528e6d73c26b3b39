//! Operating hours, energy, power-ups, the fault log and the historic log of the virtual FC 302.

use super::bench::Bench;
use super::*;
use crate::model::{AKD, VACON, VLT};

/// Texts that the drive emits for saving, and whether a client requested the save.
fn texts(drive: &mut Drive) -> Vec<(String, bool)> {
    let events = std::iter::from_fn(|| drive.poll_event());
    let texts = events.filter_map(|event| match event {
        Event::Save { text, asked, .. } => Some((text, asked)),
        _ => None,
    });
    texts.collect()
}

fn restarted(text: &str) -> Bench {
    let mut bench = Bench::new(&VLT, 1);
    bench.drive = Drive::new(&VLT);
    assert_eq!(bench.drive.start_with(text.as_bytes()), Ok(0));
    bench.drive.connect(1, Duration::from_secs(1)).unwrap();
    bench
}

const HOUR: usize = 3_600_000;

#[test]
fn a_drive_has_not_been_on_since_the_origin_of_the_clock() {
    let mut drive = Drive::new(&VLT);
    for seconds in 0..7200_u64 {
        let now = Instant::from_millis(1000 * (1_000_000 + seconds));
        drive.tick(now, None, &mut []);
    }
    assert_eq!(drive.parameter(1500), Some(2)); // h
}

#[test]
fn counters_and_log_survive_and_what_was_not_saved_does_not() {
    let mut bench = Bench::new(&VLT, 1);
    assert_eq!(bench.read(1503), 1);
    bench.write(341, 777).unwrap();
    bench.send(0x047E, 0, 40);
    bench.drive.inject(Injection::Load(3.0));
    let mut all = Vec::new();
    for _ in 0..36 {
        bench.send(0x047F, 0x4000, HOUR / 12);
        all.extend(texts(&mut bench.drive));
    }
    bench.drive.inject_fault(29, false);
    bench.drive.inject_fault(7, false);
    bench.send(0x047E, 0, HOUR);
    let before = [1500, 1501, 1502, 1503, 1504, 1505].map(|number| bench.read(number));
    let [on, running, energy, power_ups, hot, over] = before;
    assert_eq!((on, running, power_ups, hot, over), (4, 3, 1, 1, 1));
    assert!((1..=2).contains(&energy), "{energy}");
    bench.drive.switch_off();
    all.extend(texts(&mut bench.drive));
    assert!(all.iter().all(|(_, asked)| !asked));
    // the first one, one in ten minutes, one at the end
    assert_eq!(all.len(), 1 + 17 + 1);
    let (text, _) = all.last().unwrap();
    let mut again = restarted(text);
    assert_eq!(again.read(341), 300, "not saved");
    let after = [1500, 1501, 1502, 1503, 1504, 1505].map(|number| again.read(number));
    assert_eq!(after, [on, running, energy, 2, hot, over]);
    let log = [1, 1, 0, 1, 0x10, 3, 0x05, 0xFA, 0, 0];
    assert_eq!(again.ask(&log), [1, 1, 0, 1, 5, 3, 7, 29, 0, 0]);
    let times = [1, 1, 0, 1, 0x10, 1, 0x05, 0xFC, 0, 0];
    let seconds = &again.ask(&times)[6..];
    assert_eq!(u32::from_be_bytes(seconds.try_into().unwrap()), 10_800);
    // resets are kept too; those of the drive's delivery leave the hours
    again.write(1506, 1).unwrap();
    again.write(1507, 1).unwrap();
    again.drive.reset_to_delivery();
    again.drive.switch_off();
    let (text, _) = texts(&mut again.drive).pop().unwrap();
    let mut third = restarted(&text);
    assert_eq!(
        [1500, 1501, 1502, 1503].map(|number| third.read(number)),
        [4, 0, 0, 3]
    );
}

#[test]
fn a_requested_save_includes_the_counters_in_one_event() {
    let mut bench = Bench::new(&VLT, 1);
    bench.send(0x047E, 0, 400);
    assert_eq!(texts(&mut bench.drive), [], "not in the first second");
    bench.write(341, 777).unwrap();
    bench.write(971, 1).unwrap();
    let all = texts(&mut bench.drive);
    let [(text, true)] = &all[..] else {
        panic!("{all:?}")
    };
    assert!(text.contains("\ncounter power-ups = 1\n") && text.contains("\n3-41 = 7.77"));
    // what came of itself later leaves the saved values alone
    bench.write(341, 888).unwrap();
    bench.drive.inject_fault(9, false);
    let (text, asked) = texts(&mut bench.drive).pop().unwrap();
    assert!(!asked && text.contains("\n3-41 = 7.77") && text.contains("\nfault log 0 = 9 at 0s\n"));
}

#[test]
fn drives_without_counters_keep_nothing_by_themselves() {
    for model in [&AKD, &VACON] {
        let mut bench = Bench::new(model, 1);
        bench.send(0x047E, 0, 4000);
        bench.drive.inject_fault(model.connection_lost_fault, false);
        bench.drive.switch_off();
        assert_eq!(texts(&mut bench.drive), []);
    }
}

#[test]
fn strange_lines_do_no_harm() {
    let mut image = crate::store::Image::new("VLT");
    for (name, text) in [
        ("counter power on", "-1s"),
        ("counter running", "1"),
        ("counter energy", "infWs"),
        ("counter power-ups", "4294967296"),
        ("fault log 0", "9"),
        ("fault log x", "9 at 1s"),
    ] {
        image.push_text(name, text);
    }
    image.push_text("counter power-ups", "4294967295");
    image.push_text("fault log 4000000000", "9 at 1s");
    let mut drive = Drive::new(&VLT);
    assert_eq!(drive.start_with(image.encode().as_bytes()), Ok(6));
    assert_eq!(drive.parameter(1503), Some(0xFFFF_FFFF));
}

#[test]
fn the_historic_log_has_the_changes_of_the_words() {
    let mut bench = Bench::new(&VLT, 1);
    bench.send(0x0400, 0, 8);
    bench.send(0x047E, 0, 40);
    let entry = |bench: &mut Bench, place: u8| {
        let mut number = |pnu: u16, width: usize| {
            let [high, low] = pnu.to_be_bytes();
            let answer = bench.ask(&[1, 1, 0, 1, 0x10, 1, high, low, 0, place]);
            let octets = &answer[6..6 + width];
            octets
                .iter()
                .fold(0_u32, |value, octet| value << 8 | u32::from(*octet))
        };
        (number(1520, 1), number(1521, 4), number(1522, 4))
    };
    // control word, then the status word that came of it
    assert_eq!(entry(&mut bench, 0).0, 6);
    assert_eq!(entry(&mut bench, 0).1, 0x047E);
    let (event, value, at) = entry(&mut bench, 1);
    assert_eq!((event, value & 0x77, at), (5, 0x31, 12));
    assert_eq!(entry(&mut bench, 2), (0, 0, 0));
    // an alarm and the end of it
    bench.drive.inject_fault(9, false);
    bench.ticks(1);
    let some: Vec<(u32, u32)> = (0..6)
        .map(|place| entry(&mut bench, place))
        .map(|(event, value, _)| (event, value))
        .collect();
    assert!(some.contains(&(4, bench.read(1690) as u32)), "{some:?}");
    // fifty of them, the oldest goes
    for _ in 0..60 {
        bench.send(0x047E, 0, 4);
        bench.send(0x0476, 0, 4);
    }
    let all: Vec<u32> = (0..50).map(|place| entry(&mut bench, place).2).collect();
    assert!(
        all.windows(2).all(|pair| pair[0] >= pair[1]) && all[49] > 0,
        "{all:?}"
    );
    assert_eq!(entry(&mut bench, 0).1, 0x0476);
    assert_eq!(bench.ask(&[1, 1, 0, 1, 0x10, 1, 0x05, 0xF0, 0, 50])[1], 0x81);
}
