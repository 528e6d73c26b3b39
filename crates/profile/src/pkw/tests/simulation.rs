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

/// Parameters. The top octet of every value identifies its parameter, so that a mix-up is detected: 1 to 3 hold the
/// last written value, 4 is an actual value that contains the time, 5 has two elements. There is no 9.
struct Named {
    now: u64,
    values: [u32; 3],
    written: Vec<u32>,
}

impl ParameterAccess for Named {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        let facts = Attributes::simple(Format::UNSIGNED32, 4, pnu < 4);
        (1..=5).contains(&pnu).then_some(Attributes {
            elements: if pnu == 5 { 2 } else { 0 },
            ..facts
        })
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        Ok(match pnu {
            1..=3 => self.values[usize::from(pnu) - 1].into(),
            _ => u64::from(pnu + subindex) << 24 | self.now,
        })
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
    refused: u32,
    failed: u32,
    /// Answers that were another's.
    wrong: u32,
    /// Answers from before the question: the reply to an older request like this one.
    old: u32,
    /// Jobs that took longer than they may.
    late: u32,
    /// Values written more than once although the slave never started again.
    twice: u32,
}

/// What a run is like.
#[derive(Debug, Clone, Copy)]
struct Run {
    seed: u64,
    /// Telegrams in a hundred that are lost.
    loss: u64,
    /// Either side stops, starts again, or loses the connection.
    stops: bool,
    dialect: PkwDialect,
    timing: ClientTiming,
    millis: u64,
}

/// A job under way.
#[derive(Debug, Clone, Copy)]
struct Asked {
    begun: u64,
    pnu: u16,
    element: Option<u8>,
    written: Option<u32>,
}

impl Asked {
    fn new(dice: &mut Dice, begun: u64, serial: u32) -> Self {
        let pnu = [1, 2, 3, 4, 4, 5, 5, 9][dice.roll(8) as usize];
        Self {
            begun,
            pnu,
            element: (pnu == 5).then_some(dice.roll(2) as u8),
            written: (pnu < 4 && dice.chance(50)).then_some(u32::from(pnu) << 24 | serial),
        }
    }

    fn job(self) -> Job<'static> {
        let Self { pnu, element, .. } = self;
        match self.written {
            Some(value) => Job::Change {
                pnu,
                element,
                value: PkwValue::DoubleWord(value),
                memory: Memory::Ram,
            },
            None => Job::Read { pnu, element },
        }
    }

    fn judge(self, outcome: Outcome, drive: &Named, result: &mut Tally) {
        match outcome {
            Ok(Answer::Value(PkwValue::DoubleWord(value))) => {
                result.answered += 1;
                let name = self.pnu + u16::from(self.element.unwrap_or(0));
                let right = match self.pnu {
                    1..=3 => {
                        value == drive.values[usize::from(self.pnu) - 1]
                            && self.written.is_none_or(|written| written == value)
                    }
                    4 | 5 => value >> 24 == u32::from(name),
                    _ => false,
                };
                result.wrong += u32::from(!right);
                result.old += u32::from(self.pnu > 3 && u64::from(value & 0x00FF_FFFF) < self.begun);
            }
            Err(JobError::Refused(number)) => {
                result.refused += 1;
                result.wrong += u32::from(self.pnu != 9 || number != PkwErrorNumber::UNKNOWN_PARAMETER);
            }
            Err(_) => result.failed += 1,
            Ok(other) => panic!("{other:?}"),
        }
    }
}

fn run(run: Run) -> Tally {
    let Run {
        dialect,
        timing,
        stops,
        ..
    } = run;
    let mut dice = Dice(run.seed | 1);
    let mut drive = Named {
        now: 0,
        values: [0x0100_0000, 0x0200_0000, 0x0300_0000],
        written: Vec::new(),
    };
    let way = || Way {
        under_way: VecDeque::new(),
        loss: run.loss,
    };
    let (mut there, mut back) = (way(), way());
    let (mut server, mut client) = (Server::new(dialect), Client::new(dialect, timing));
    let mut result = Tally::default();
    let (mut restarts, mut serial) = (0, 0_u32);
    let mut asked: Option<Asked> = None;
    let (mut slave_stops, mut master_stops) = (0_u64, 0_u64);
    for now in (0..run.millis).step_by(CYCLE as usize) {
        let time = Duration::from_millis(now);
        drive.now = now;
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
            if dice.chance(30) {
                // another program takes over and drops the old job
                master_stops = now + timing.round_trip.as_millis() as u64 + dice.roll(1000);
                client = Client::new(dialect, timing);
                asked = None;
            }
        }
        // the slave: only the last request in its image counts
        let mut image = None;
        while let Some(octets) = there.arrived(now) {
            image = Some(octets);
        }
        if let Some(octets) = image.filter(|_| slave_runs) {
            let mut reply = server.handle(octets, &mut drive);
            if !dialect.refusal_names_pnu && reply[0] >> 4 == 7 {
                // as some drives do
                (reply[0], reply[1]) = (0x70, 0);
            }
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
            let asked = asked.take().unwrap();
            let limit = 2 * (timing.reply + timing.round_trip).as_millis() as u64;
            // a stopped master looks later
            result.late += u32::from(!stops && now - asked.begun > limit + CYCLE);
            asked.judge(outcome, &drive, &mut result);
        }
        if asked.is_none() && dice.chance(30) {
            serial += 1;
            let next = Asked::new(&mut dice, now, serial);
            client.start(time, next.job()).unwrap();
            asked = Some(next);
        }
        let request = client.request(time).try_into().unwrap();
        there.send(&mut dice, now, request);
    }
    if let Some(asked) = asked {
        result.late += u32::from(run.millis - asked.begun > 20_000);
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

const DIALECTS: [PkwDialect; 3] = [
    PkwDialect::DANFOSS_PPO,
    PkwDialect::STANDARD,
    PkwDialect::SIEMENS_PPO,
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1200))]

    #[test]
    fn every_client_gets_its_own_value_and_no_call_hangs(seed in any::<u64>(), loss in 0..80_u64, stops in any::<bool>(),
                                                    dialect in prop::sample::select(&DIALECTS[..])) {
        let result = run(Run { seed, loss, stops, dialect, timing: TIMING, millis: 25_000 });
        prop_assert_eq!((result.wrong, result.old, result.late, result.twice), (0, 0, 0, 0), "{:?}", result);
        if loss < 40 && !stops {
            prop_assert!(result.answered > 10 && result.failed == 0, "{result:?}");
        }
    }
}

/// The simulation is strict enough to see the faults that the rests are against: at the beginning, between like requests
/// and after a time-out.
#[test]
fn without_the_rest_values_are_mixed_up() {
    let hasty = ClientTiming {
        reply: Duration::from_millis(60),
        round_trip: Duration::ZERO,
    };
    let (mut wrong, mut old) = (0, 0);
    for seed in 1..60 {
        let result = run(Run {
            seed,
            loss: 20,
            stops: true,
            dialect: PkwDialect::STANDARD,
            timing: hasty,
            millis: 60_000,
        });
        wrong += result.wrong;
        old += result.old;
    }
    assert!(wrong > 0 && old > 0, "{wrong} wrong, {old} old");
}
