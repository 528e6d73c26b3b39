//! Both sides in virtual time over a channel that loses, repeats and delays telegrams, with stops and new starts of
//! either side. Telegrams keep their order, as frames with a cycle counter and a serial line do.

use alloc::collections::VecDeque;
use core::time::Duration;

use proptest::prelude::*;

use super::*;

/// Longest way of a telegram, one direction.
const WAY: u64 = 100;
const CYCLE: u64 = 8;

/// A small generator: the run follows from its seed.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, below: u64) -> u64 {
        // xorshift64*
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) % below
    }

    fn chance(&mut self, percent: u64) -> bool {
        self.roll(100) < percent
    }
}

/// One direction: telegrams with the time at which they arrive.
struct Way {
    under_way: VecDeque<(u64, [u8; 8])>,
    loss: u64,
}

impl Way {
    fn send(&mut self, dice: &mut Dice, now: u64, octets: [u8; 8]) {
        if dice.chance(self.loss) {
            return;
        }
        for _ in 0..1 + u64::from(dice.chance(10)) {
            let earliest = self.under_way.back().map_or(0, |last| last.0);
            let arrives = (now + dice.roll(WAY)).max(earliest);
            self.under_way.push_back((arrives, octets));
        }
    }

    fn arrived(&mut self, now: u64) -> Option<[u8; 8]> {
        let &(time, octets) = self.under_way.front()?;
        (time <= now).then(|| {
            self.under_way.pop_front();
            octets
        })
    }
}

/// Three parameters, each a value of its own; notes what was written.
struct Three {
    values: [u32; 3],
    written: Vec<u32>,
}

impl ParameterAccess for Three {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        (1..=3)
            .contains(&pnu)
            .then_some(Attributes::simple(Format::UNSIGNED32, 4, true))
    }

    fn read(&mut self, pnu: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(self.values[usize::from(pnu) - 1].into())
    }

    fn write(&mut self, pnu: u16, _: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
        self.values[usize::from(pnu) - 1] = raw as u32;
        self.written.push(raw as u32);
        Ok(())
    }
}

#[derive(Debug, Default, PartialEq)]
struct Tally {
    answered: u32,
    failed: u32,
    /// Answers that were another's.
    wrong: u32,
    /// Jobs that took longer than they may.
    late: u32,
    /// Values written more than once although the slave never started anew.
    twice: u32,
}

fn run(seed: u64, loss: u64, stops: bool, dialect: PkwDialect, timing: ClientTiming) -> Tally {
    let mut dice = Dice(seed | 1);
    let mut drive = Three {
        values: [0x0100_0000, 0x0200_0000, 0x0300_0000],
        written: Vec::new(),
    };
    let way = || Way {
        under_way: VecDeque::new(),
        loss,
    };
    let (mut there, mut back) = (way(), way());
    let (mut server, mut client) = (Server::new(dialect), Client::new(dialect, timing));
    let mut result = Tally::default();
    let (mut restarts, mut serial) = (0, 0_u32);
    let mut job: Option<(u64, u16, Option<u32>)> = None;
    let (mut slave_stops, mut master_stops) = (0_u64, 0_u64);
    for now in (0..120_000_u64).step_by(CYCLE as usize) {
        let time = Duration::from_millis(now);
        let slave_runs = now >= slave_stops;
        if stops && slave_runs && dice.roll(400) == 0 {
            slave_stops = now + dice.roll(6000);
            if dice.chance(50) {
                server.reset();
                restarts += 1;
            }
        }
        if stops && now >= master_stops && dice.roll(600) == 0 {
            master_stops = now + dice.roll(1000);
        }
        // the slave: only the last request in its image counts
        let mut image = None;
        while let Some(octets) = there.arrived(now) {
            image = Some(octets);
        }
        if let Some(octets) = image.filter(|_| slave_runs) {
            let reply = server.handle(octets, &mut drive);
            back.send(&mut dice, now, reply);
        }
        // the master
        let mut outcome = None;
        while let Some(octets) = back.arrived(now) {
            if now >= master_stops && outcome.is_none() {
                outcome = client.handle(time, &octets);
            }
        }
        if now < master_stops {
            continue;
        }
        if stops && dice.roll(2000) == 0 {
            outcome = outcome.or(client.lost());
        }
        if let Some(outcome) = outcome.or_else(|| client.handle_timeout(time)) {
            let (begun, pnu, written) = job.take().unwrap();
            let limit = 2 * (timing.reply + timing.round_trip).as_millis() as u64;
            // a stopped master looks later
            result.late += u32::from(!stops && now - begun > limit + CYCLE);
            match outcome {
                Ok(Answer::Value(PkwValue::DoubleWord(value))) => {
                    result.answered += 1;
                    let expected = drive.values[usize::from(pnu) - 1];
                    let own = written.is_none_or(|written| written == value);
                    result.wrong += u32::from(value != expected || !own);
                }
                Ok(other) => panic!("{other:?}"),
                Err(_) => result.failed += 1,
            }
        }
        if job.is_none() && dice.chance(30) {
            let pnu = 1 + dice.roll(3) as u16;
            serial += 1;
            let written = dice.chance(50).then_some(u32::from(pnu) << 24 | serial);
            let next = match written {
                Some(value) => Job::Change {
                    pnu,
                    element: None,
                    value: PkwValue::DoubleWord(value),
                    memory: Memory::Ram,
                },
                None => Job::Read { pnu, element: None },
            };
            client.start(time, next).unwrap();
            job = Some((now, pnu, written));
        }
        let request = client.request(time).try_into().unwrap();
        there.send(&mut dice, now, request);
    }
    if let Some((begun, ..)) = job {
        result.late += u32::from(120_000 - begun > 20_000);
    }
    if restarts == 0 {
        let mut seen = drive.written.clone();
        seen.sort_unstable();
        seen.dedup();
        result.twice = (drive.written.len() - seen.len()) as u32;
    }
    result
}

const TIMING: ClientTiming = ClientTiming {
    reply: Duration::from_millis(1000),
    round_trip: Duration::from_millis(2 * WAY + 4 * CYCLE),
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn nobody_gets_anothers_value_and_nothing_hangs(seed in any::<u64>(), loss in 0..80_u64, stops in any::<bool>(),
                                                    ppo in any::<bool>()) {
        let dialect = if ppo { PkwDialect::DANFOSS_PPO } else { PkwDialect::STANDARD };
        let result = run(seed, loss, stops, dialect, TIMING);
        prop_assert_eq!((result.wrong, result.late, result.twice), (0, 0, 0), "{:?}", result);
        if loss < 50 && !stops {
            prop_assert!(result.answered > 50 && result.failed == 0, "{result:?}");
        }
    }
}

/// The simulation is strict enough to see the fault that the rest after a time-out is against.
#[test]
fn without_the_rest_values_are_mixed_up() {
    let hasty = ClientTiming {
        reply: Duration::from_millis(60),
        round_trip: Duration::ZERO,
    };
    let wrong: u32 = (1..40)
        .map(|seed| run(seed, 20, true, PkwDialect::STANDARD, hasty).wrong)
        .sum();
    assert!(wrong > 0);
}
