//! A master and its slaves on one line in virtual time: every station receives every octet.

use proptest::prelude::*;

use super::*;

/// A small generator: the run follows from its seed.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, below: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) % below
    }
}

/// What the line does to octets, in tenths of a percent.
#[derive(Clone, Copy)]
struct Faults {
    lost: u64,
    flipped: u64,
    noise: u64,
    /// The master receives its own telegrams.
    echo: bool,
}

const CLEAN: Faults = Faults {
    lost: 0,
    flipped: 0,
    noise: 0,
    echo: false,
};

struct Line {
    master: Master,
    slaves: Vec<Slave>,
    ids: Vec<SlaveId>,
    /// Octets on the wire: when they are there, from whom (0 the master).
    wire: Vec<(Duration, usize, u8)>,
    now: Duration,
    dice: Dice,
    faults: Faults,
    /// Requests that each slave received, and how many.
    broadcasts: Vec<Vec<u8>>,
    /// Replies received and losses reported, per slave.
    replies: Vec<u32>,
    losses: Vec<u32>,
    /// Present request to each slave, and a number for the next.
    asked: Vec<[u8; 4]>,
    serial: u8,
    /// Replies of a slave to other data than the present.
    wrong: u32,
    /// Replies that no slave ever gave: a strange octet in the place of a lost one stays undetected one time in 256.
    spoiled: u32,
}

/// Returns the answer of slave number `slave` to data.
fn answer(slave: usize, data: &[u8]) -> Vec<u8> {
    data.iter().map(|octet| octet ^ (slave as u8 + 1)).collect()
}

impl Line {
    fn new(numbers: &[u8], seed: u64, faults: Faults) -> Self {
        let config = MasterConfig {
            round: Duration::from_millis(10),
            ..MasterConfig::fc(19_200)
        };
        let mut master = Master::new(config);
        let mut ids = Vec::new();
        let mut slaves = Vec::new();
        for &number in numbers {
            ids.push(master.add(Address::fc(number).unwrap(), &[0, 1, 2, 3]).unwrap());
            slaves.push(Slave::new(SlaveConfig::fc(number, 19_200)));
        }
        Self {
            master,
            ids,
            wire: Vec::new(),
            now: Duration::from_secs(1),
            dice: Dice(seed | 1),
            faults,
            broadcasts: alloc::vec![Vec::new(); slaves.len()],
            replies: alloc::vec![0; slaves.len()],
            losses: alloc::vec![0; slaves.len()],
            asked: alloc::vec![[0, 1, 2, 3]; slaves.len()],
            slaves,
            serial: 0,
            wrong: 0,
            spoiled: 0,
        }
    }

    fn send(&mut self, from: usize, octets: &[u8]) {
        let character = Timing::fc(19_200).character;
        let mut at = self.now;
        for &octet in octets {
            at += character;
            if self.dice.roll(1000) < self.faults.lost {
                continue;
            }
            let flip = self.dice.roll(1000) < self.faults.flipped;
            let octet = octet ^ (u8::from(flip) << self.dice.roll(8));
            self.wire.push((at, from, octet));
        }
        if self.dice.roll(1000) < self.faults.noise {
            let after = character * self.dice.roll(60) as u32;
            let octet = self.dice.roll(256) as u8;
            self.wire.push((at + after, usize::MAX, octet));
        }
        self.wire.sort_by_key(|octet| octet.0);
    }

    /// Runs the line for a while; `alive` returns which slaves are switched on.
    fn run(&mut self, time: Duration, alive: impl Fn(usize) -> bool) {
        let end = self.now + time;
        let mut out = [0; MAX_TELEGRAM];
        for _ in 0..200_000 {
            while let Some(length) = self.master.poll_transmit(self.now, &mut out) {
                self.send(0, &out[..length]);
            }
            for slave in 0..self.slaves.len() {
                let request = self.slaves[slave].poll_request();
                if let Some((data, broadcast)) = request.map(|r| (r.data.to_vec(), r.broadcast)) {
                    if broadcast {
                        self.broadcasts[slave].extend(&data);
                    } else if alive(slave) {
                        self.slaves[slave].respond(&answer(slave, &data)).unwrap();
                    }
                }
                if let Some(length) = self.slaves[slave].poll_transmit(self.now, &mut out) {
                    self.send(slave + 1, &out[..length]);
                }
            }
            let wire = self.wire.first().map(|octet| octet.0);
            let deadlines = self.slaves.iter().filter_map(Slave::poll_timeout);
            let next = deadlines
                .chain(self.master.poll_timeout())
                .chain(wire)
                .min()
                .unwrap();
            if next > end {
                self.now = end;
                return;
            }
            self.now = self.now.max(next);
            let due = self.wire.iter().take_while(|octet| octet.0 <= self.now).count();
            for (at, from, octet) in self.wire.drain(..due) {
                if from != 0 || self.faults.echo {
                    self.master.handle_octets(at, &[octet]);
                }
                for (number, slave) in self.slaves.iter_mut().enumerate() {
                    if from != number + 1 {
                        slave.handle_octets(at, &[octet]);
                    }
                }
            }
            self.master.handle_timeout(self.now);
            for slave in &mut self.slaves {
                slave.handle_timeout(self.now);
            }
            while let Some(event) = self.master.poll_event() {
                self.take(event);
            }
        }
        panic!("the line does not come to the end of its time: {:?}", self.now);
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Reply(id) => {
                let slave = self.ids.iter().position(|known| *known == id).unwrap();
                self.replies[slave] += 1;
                let expected = answer(slave, &self.asked[slave]);
                let reply = self.master.reply(id);
                let genuine = |number| {
                    let data = answer(number, reply);
                    data == [0, 1, 2, 3] || matches!(data[..], [_, 0x55, 0xAA, _])
                };
                if reply != expected {
                    let other = (0..self.slaves.len()).any(genuine);
                    *(if other { &mut self.wrong } else { &mut self.spoiled }) += 1;
                }
                // other data each time, so that a reply to those before is seen
                self.serial = self.serial.wrapping_add(1);
                self.asked[slave] = [slave as u8, 0x55, 0xAA, self.serial];
                self.master.set_data(id, &self.asked[slave]).unwrap();
            }
            Event::Lost(id) => {
                let slave = self.ids.iter().position(|known| *known == id).unwrap();
                self.losses[slave] += 1;
            }
        }
    }
}

#[test]
fn a_round_of_several_slaves() {
    let mut line = Line::new(&[1, 2, 126], 1, CLEAN);
    line.run(Duration::from_secs(2), |_| true);
    let [a, b, c] = line.replies[..] else { panic!() };
    assert!(
        a > 30 && a.abs_diff(b) <= 1 && a.abs_diff(c) <= 1,
        "{:?}",
        line.replies
    );
    assert_eq!((line.losses.iter().sum::<u32>(), line.wrong), (0, 0));
    for id in &line.ids {
        let seen = line.master.statistics(*id);
        assert_eq!((seen.timeouts, seen.repeated), (0, 0));
    }
}

/// Rounds keep their distance, slaves of one round follow one another.
#[test]
fn rounds_keep_their_distance() {
    for round in [0, 300] {
        let config = MasterConfig {
            round: Duration::from_millis(round),
            ..MasterConfig::fc(19_200)
        };
        let mut line = Line::new(&[1, 2], 6, CLEAN);
        line.master = Master::new(config);
        for number in [1, 2] {
            line.master
                .add(Address::fc(number).unwrap(), &[0, 1, 2, 3])
                .unwrap();
        }
        line.run(Duration::from_millis(1450), |_| true);
        if round == 0 {
            assert!(line.replies[0] > 50, "{:?}", line.replies);
        } else {
            assert_eq!(line.replies, [5, 5]);
        }
    }
}

#[test]
fn a_dead_slave_is_reported_once_and_delays_the_others_little() {
    let mut line = Line::new(&[1, 2, 3], 2, CLEAN);
    line.run(Duration::from_secs(2), |slave| slave != 1);
    assert_eq!(line.losses, [0, 1, 0]);
    assert_eq!(line.replies[1], 0);
    assert!(line.replies[0] > 10 && line.replies[2] > 10, "{:?}", line.replies);
    let seen = line.master.statistics(line.ids[1]);
    assert_eq!(seen.repeated, 2, "repeated at first, then asked once a round");
    assert!(seen.timeouts > 10);
    // it comes back by itself, and its next loss is reported again
    line.run(Duration::from_secs(1), |_| true);
    assert!(line.replies[1] > 5);
    line.run(Duration::from_secs(1), |slave| slave != 1);
    assert_eq!(line.losses, [0, 2, 0]);
}

#[test]
fn a_broadcast_reaches_all_and_none_answers() {
    for address in [Address::FC_BROADCAST, Address::BROADCAST] {
        let mut line = Line::new(&[1, 2, 3], 3, CLEAN);
        line.run(Duration::from_millis(100), |_| true);
        line.master.broadcast(address, &[0x04, 0x3C, 0, 0]).unwrap();
        line.run(Duration::from_millis(500), |_| true);
        assert_eq!(line.broadcasts, alloc::vec![alloc::vec![0x04, 0x3C, 0, 0]; 3]);
        assert_eq!(line.losses, [0, 0, 0]);
        assert!(
            line.ids
                .iter()
                .all(|id| line.master.statistics(*id).timeouts == 0)
        );
    }
}

#[test]
fn a_line_that_echoes() {
    let mut line = Line::new(&[1, 2], 4, Faults { echo: true, ..CLEAN });
    line.run(Duration::from_secs(1), |_| true);
    assert!(line.master.hears_itself());
    assert!(line.replies.iter().all(|replies| *replies > 10));
    assert_eq!((line.wrong, line.losses.iter().sum::<u32>()), (0, 0));
    // its own telegram is never the reply of a lost slave, not even before an echo was distinguished from a reply
    for alive in [true, false] {
        let mut line = Line::new(&[1], 5, Faults { echo: true, ..CLEAN });
        line.run(Duration::from_millis(200), |_| alive);
        let replies = line.replies[0];
        line.run(Duration::from_secs(1), |_| false);
        assert!(line.replies[0] - replies <= 1 && line.losses[0] == 1);
    }
}

/// An adapter that is late with the echo of one try hands it over during the next: neither is the reply. And a reply that
/// comes before the echo of what was sent is one to an earlier try.
#[test]
fn late_echoes_and_what_comes_before_them() {
    let mut master = Master::new(MasterConfig::fc(9600));
    let id = master
        .add(
            Address::fc(1).unwrap(),
            &hex("15 FA 00 01 00 00 00 00 04 7C 00 00"),
        )
        .unwrap();
    let mut out = [0; MAX_TELEGRAM];
    let mut now = Duration::from_secs(1);
    let length = master.poll_transmit(now, &mut out).unwrap();
    let sent = out[..length].to_vec();
    // nothing in time; the same again
    now = master.poll_timeout().unwrap();
    master.handle_timeout(now);
    assert_eq!(master.poll_event(), None);
    now = master.poll_timeout().unwrap();
    assert_eq!(master.poll_transmit(now, &mut out), Some(length));
    let receive = |master: &mut Master, octets: &[u8]| {
        now += Duration::from_millis(20);
        master.handle_octets(now, octets);
        now = master.poll_timeout().unwrap();
        master.handle_timeout(now);
        master.poll_event()
    };
    let mut receive = receive;
    // both echoes, and then the reply
    assert_eq!(receive(&mut master, &sent), None);
    assert_eq!(receive(&mut master, &sent), None);
    assert!(master.hears_itself());
    let reply = telegram(Address(0x81), &hex("15 FA 00 01 00 00 00 0E 06 03 00 00"));
    assert_eq!(receive(&mut master, &reply), Some(Event::Reply(id)));
    assert_eq!(master.reply(id)[7], 0x0E);
    // the next: what comes before its echo is not taken, what comes behind it is
    master
        .set_data(id, &hex("15 FA 00 02 00 00 00 00 04 7C 00 00"))
        .unwrap();
    let begin = master.poll_timeout().unwrap();
    let length = master.poll_transmit(begin, &mut out).unwrap();
    let sent = out[..length].to_vec();
    assert_eq!(receive(&mut master, &reply), None);
    assert_eq!(receive(&mut master, &sent), None);
    let own = telegram(Address(0x81), &hex("15 FA 00 02 00 00 00 0F 06 03 00 00"));
    assert_eq!(receive(&mut master, &own), Some(Event::Reply(id)));
    // an adapter that stops echoing is borne
    let mut taken = 0;
    for _ in 0..8 {
        let due = master.poll_timeout().unwrap();
        master.handle_timeout(due);
        if master.poll_transmit(due, &mut out).is_some() {
            taken += u32::from(receive(&mut master, &own) == Some(Event::Reply(id)));
        }
    }
    assert!(taken > 2 && !master.hears_itself(), "{taken}");
}

/// Zero telegrams may be answered alike, mirror telegrams have to be.
#[test]
fn replies_like_their_requests() {
    let now = Duration::from_secs(1);
    for (address, data, reply) in [
        (Address::uss(3).unwrap(), [0; 12], true),
        (Address::uss(3).unwrap(), [1; 12], false),
        (Address::uss(3).unwrap().mirror(), [1; 12], true),
    ] {
        let mut master = Master::new(MasterConfig::uss(9600));
        let id = master.add(address, &data).unwrap();
        let mut out = [0; MAX_TELEGRAM];
        let length = master.poll_transmit(now, &mut out).unwrap();
        master.handle_octets(now + Duration::from_millis(25), &out[..length]);
        for _ in 0..10 {
            let Some(due) = master.poll_timeout() else { break };
            master.handle_timeout(due);
            if let Some(event) = master.poll_event() {
                assert_eq!(event, Event::Reply(id));
                assert!(reply, "{data:?}");
                break;
            }
        }
        let seen = master.statistics(id);
        assert_eq!(
            (seen.replies, seen.timeouts),
            (u64::from(reply), u64::from(!reply))
        );
    }
}

/// A strange octet in the place of a lost one, and the exclusive or matches: no protocol of this kind detects that.
#[test]
fn an_octet_in_the_place_of_another() {
    let faults = Faults {
        lost: 9,
        noise: 54,
        ..CLEAN
    };
    let mut line = Line::new(&[1, 2, 126], 1_612_314_581_664_443_538, faults);
    line.run(Duration::from_secs(4), |_| true);
    assert_eq!((line.wrong, line.spoiled), (0, 1));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Lost, flipped and strange octets: the line never stops, and no reply is taken for another's.
    #[test]
    fn a_bad_line(seed in any::<u64>(), lost in 0..20_u64, noise in 0..300_u64, echo in any::<bool>()) {
        let mut line = Line::new(&[1, 2, 126], seed, Faults { lost, flipped: 0, noise, echo });
        line.run(Duration::from_secs(4), |_| true);
        prop_assert_eq!(line.wrong, 0);
        let seldom = if lost > 0 && noise > 0 { 2 } else { 0 };
        prop_assert!(line.spoiled <= seldom, "{}", line.spoiled);
        prop_assert!(line.replies.iter().all(|replies| *replies > 5), "{:?}", line.replies);
        // and is well as soon as the line is
        line.faults = Faults { echo, ..CLEAN };
        line.run(Duration::from_millis(500), |_| true);
        let before = line.replies.clone();
        line.run(Duration::from_secs(1), |_| true);
        for (slave, replies) in before.iter().enumerate() {
            prop_assert!(line.replies[slave] > replies + 5);
        }
    }

    /// Flipped bits get past an exclusive or when they come in pairs; then too the line goes on.
    #[test]
    fn a_line_with_flipped_bits(seed in any::<u64>(), flipped in 0..40_u64) {
        let mut line = Line::new(&[1, 2], seed, Faults { flipped, noise: 100, ..CLEAN });
        line.run(Duration::from_secs(3), |_| true);
        line.faults = CLEAN;
        let before = line.replies.clone();
        line.run(Duration::from_secs(1), |_| true);
        for (slave, replies) in before.iter().enumerate() {
            prop_assert!(line.replies[slave] > replies + 5);
        }
    }
}
