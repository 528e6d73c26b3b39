use super::*;
use crate::model;
use profile::parameter::{Keep, ParameterAccess};
use profile::pkw::{Answer, Client, ClientTiming, Job, Memory, PkwValue};
use profile::state::State;
use uss::{Address, Event, Master as LineMaster, MasterConfig, SlaveId};

/// A master and some drives on one line, in virtual time.
struct Bench {
    now: Instant,
    master: LineMaster,
    layout: Layout,
    drives: Vec<SerialStation>,
    /// Nothing that the master sends arrives.
    cut: bool,
}

impl Bench {
    fn fc(numbers: &[u8]) -> Self {
        let config = |&number| SerialConfig::new(&model::AKD, SlaveConfig::fc(number, 9600));
        Self {
            now: Instant::from_millis(1000),
            master: LineMaster::new(MasterConfig::fc(9600)),
            layout: Layout::FC,
            drives: numbers.iter().map(config).map(SerialStation::new).collect(),
            cut: false,
        }
    }

    fn run(&mut self, limit: Duration) -> Vec<Event> {
        let end = self.now + limit;
        let mut events = Vec::new();
        let mut buffer = [0; uss::MAX_TELEGRAM];
        for _ in 0..1_000_000 {
            if let Some(length) = self.master.poll_transmit(time(self.now), &mut buffer) {
                // the telegram has arrived when its last octet has
                let arrived = self.now + Duration::from_micros(1146) * u32::try_from(length).unwrap();
                for drive in self.drives.iter_mut().filter(|_| !self.cut) {
                    drive.handle_octets(arrived, &buffer[..length]);
                }
                self.now = arrived;
            }
            for from in 0..self.drives.len() {
                while let Some(length) = self.drives[from].poll_transmit(self.now, &mut buffer) {
                    for to in (0..self.drives.len()).filter(|&to| to != from) {
                        self.drives[to].handle_octets(self.now, &buffer[..length]);
                    }
                    self.master.handle_octets(time(self.now), &buffer[..length]);
                }
            }
            while let Some(event) = self.master.poll_event() {
                events.push(event);
            }
            let due = self.drives.iter().filter_map(SerialStation::poll_timeout);
            let master = self.master.poll_timeout().map(|due| Instant::ZERO + due);
            let next = due
                .chain(master)
                .min()
                .unwrap_or(end)
                .max(self.now + Duration::from_micros(100));
            if next > end {
                break;
            }
            self.now = next;
            self.master.handle_timeout(time(self.now));
            for drive in &mut self.drives {
                drive.handle_timeout(self.now);
            }
        }
        self.now = end;
        events
    }

    fn words(&mut self, slave: SlaveId, control: u16, setpoint: u16) {
        let [a, b] = control.to_be_bytes();
        let [c, d] = setpoint.to_be_bytes();
        self.master.set_data(slave, &[a, b, c, d]).unwrap();
    }

    fn job(&mut self, slave: SlaveId, client: &mut Client, job: Job<'_>) -> profile::pkw::Outcome {
        client.start(time(self.now), job).unwrap();
        for _ in 0..100 {
            let mut data = [0; MAX_DATA];
            let now = time(self.now);
            let parts = Parts {
                pkw: client.request(now),
                pzd: &[0; PROCESS],
            };
            let length = self.layout.join(parts, &mut data).unwrap();
            self.master.set_data(slave, &data[..length]).unwrap();
            let events = self.run(Duration::from_millis(60));
            if events.contains(&Event::Reply(slave)) {
                let reply = self.layout.split(self.master.reply(slave)).unwrap();
                if let Some(outcome) = client.handle(time(self.now), reply.pkw) {
                    return outcome;
                }
            }
        }
        panic!("no outcome")
    }
}

const SECOND: Duration = Duration::from_secs(1);

#[test]
fn the_drive_runs_by_its_process_data_and_stops_when_the_master_falls_silent() {
    let mut bench = Bench::fc(&[1]);
    let drive = bench.master.add(Address::fc(1).unwrap(), &[0; 4]).unwrap();
    bench.words(drive, 0x047E, 0);
    bench.run(SECOND / 2);
    bench.words(drive, 0x047F, 0x0199);
    bench.run(SECOND);
    assert_eq!(bench.drives[0].drive().state(), State::S4);
    let [_, _, high, low] = bench.master.reply(drive) else {
        panic!()
    };
    let speed = i16::from_be_bytes([*high, *low]);
    assert!((390..430).contains(&speed), "{speed}");
    bench.cut = true;
    bench.run(SECOND * 4);
    let station = &mut bench.drives[0];
    assert_ne!(station.drive().state(), State::S4);
    assert!(station.drive().axis().is_at_rest());
    let events: Vec<StationEvent> = std::iter::from_fn(|| station.poll_event()).collect();
    assert!(events.contains(&StationEvent::MasterTook), "{events:?}");
    assert!(
        events.contains(&StationEvent::MasterGone { lost: true }),
        "{events:?}"
    );
    assert!(
        events.contains(&StationEvent::Fault { number: 702 }),
        "{events:?}"
    );
}

#[test]
fn a_master_that_only_reads_commands_nothing_and_its_leaving_is_no_fault() {
    let mut bench = Bench::fc(&[1]);
    let drive = bench.master.add(Address::fc(1).unwrap(), &[0; 4]).unwrap();
    // everything but control
    bench.words(drive, 0x007F, 0x2000);
    bench.run(SECOND);
    assert_eq!(bench.drives[0].drive().state(), State::S1);
    bench.cut = true;
    bench.run(SECOND * 2);
    let station = &mut bench.drives[0];
    let events: Vec<StationEvent> = std::iter::from_fn(|| station.poll_event()).collect();
    assert_eq!(events, []);
    // and one that gave control back in time
    bench.cut = false;
    bench.words(drive, 0x047E, 0);
    bench.run(SECOND / 2);
    bench.words(drive, 0, 0);
    bench.run(SECOND / 2);
    bench.cut = true;
    bench.run(SECOND * 2);
    let station = &mut bench.drives[0];
    let events: Vec<StationEvent> = std::iter::from_fn(|| station.poll_event()).collect();
    assert!(
        events.contains(&StationEvent::MasterGone { lost: false }),
        "{events:?}"
    );
    assert!(
        !events
            .iter()
            .any(|event| matches!(event, StationEvent::Fault { .. })),
        "{events:?}"
    );
}

#[test]
fn two_drives_answer_each_for_itself_and_a_broadcast_is_executed_and_not_answered() {
    let mut bench = Bench::fc(&[1, 2]);
    let first = bench.master.add(Address::fc(1).unwrap(), &[0; 4]).unwrap();
    let second = bench.master.add(Address::fc(2).unwrap(), &[0; 4]).unwrap();
    let mut channel = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
    let change = Job::Change {
        pnu: 930,
        element: None,
        value: PkwValue::Word(2),
        memory: Memory::Ram,
    };
    let written = bench.job(second, &mut channel, change);
    assert_eq!(written, Ok(Answer::Value(PkwValue::Word(2))));
    let mut channel = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
    let read = Job::Read {
        pnu: 930,
        element: None,
    };
    assert_eq!(
        bench.job(first, &mut channel, read),
        Ok(Answer::Value(PkwValue::Word(1)))
    );
    bench.words(first, 0, 0);
    bench.words(second, 0, 0);
    let replies = |bench: &Bench| {
        bench
            .drives
            .iter()
            .map(|drive| drive.counters().replies)
            .sum::<u64>()
    };
    let before = replies(&bench);
    // both are sent READY with control in one telegram
    bench
        .master
        .broadcast(Address::FC_BROADCAST, &[0x04, 0x7E, 0, 0])
        .unwrap();
    bench.run(Duration::from_millis(400));
    assert!(bench.drives.iter().all(|drive| drive.counters().broadcasts == 1));
    for station in &mut bench.drives {
        let events: Vec<StationEvent> = std::iter::from_fn(|| station.poll_event()).collect();
        assert!(events.contains(&StationEvent::MasterTook), "{events:?}");
    }
    let (sent, answered) = (bench.master.statistics(first), replies(&bench) - before);
    assert!(sent.timeouts == 0 && answered > 0);
}

#[test]
fn what_is_damaged_on_the_way_is_neither_executed_nor_answered() {
    let mut station = SerialStation::new(SerialConfig::new(&model::AKD, SlaveConfig::fc(1, 9600)));
    let mut out = [0; uss::MAX_TELEGRAM];
    let telegram = [0x02, 0x06, 0x81, 0x04, 0x7E, 0x00, 0x00, 0xFF];
    for place in 0..telegram.len() {
        let mut now = Instant::from_millis(1000 * (place as u64 + 1));
        let mut damaged = telegram;
        damaged[place] ^= 0x10;
        station.handle_octets(now, &damaged);
        for _ in 0..10 {
            now += Duration::from_millis(10);
            station.handle_timeout(now);
            assert_eq!(station.poll_transmit(now, &mut out), None, "octet {place}");
        }
        assert_eq!(station.poll_event(), None);
    }
    for length in 0..telegram.len() {
        let mut now = Instant::from_millis(100_000 + 1000 * length as u64);
        station.handle_octets(now, &telegram[..length]);
        for _ in 0..10 {
            now += Duration::from_millis(10);
            station.handle_timeout(now);
            assert_eq!(station.poll_transmit(now, &mut out), None, "{length} octets");
        }
        assert_eq!(station.poll_event(), None);
    }
}

#[test]
fn a_vlt_watches_its_control_word_as_eight_three_and_eight_four_say() {
    // 8-03 in 0.1 s, 8-04, seconds of silence, still runs, fault 17
    for (time, function, silence, runs, trips) in [
        (10, 0, 30, true, false),
        (50, 5, 4, true, false),
        (50, 5, 20, false, true),
        (10, 2, 20, false, false),
    ] {
        let mut bench = Bench::fc(&[]);
        let config = SerialConfig::new(&model::VLT, SlaveConfig::fc(1, 9600));
        bench.drives.push(SerialStation::new(config));
        let slave = bench.master.add(Address::fc(1).unwrap(), &[0; 4]).unwrap();
        let drive = bench.drives[0].drive_mut();
        drive.write(803, 0, time, Keep::Volatile).unwrap();
        drive.write(804, 0, function, Keep::Volatile).unwrap();
        bench.words(slave, 0x043C, 0);
        bench.run(SECOND / 2);
        bench.words(slave, 0x047C, 0x2000);
        bench.run(SECOND * 6);
        assert!((bench.drives[0].drive().axis().speed() - 750.0).abs() < 30.0);
        bench.cut = true;
        bench.run(SECOND * silence);
        let drive = bench.drives[0].drive();
        let row = format!("8-03 {time}, 8-04 {function}, {silence} s");
        assert_eq!(drive.is_enabled(), runs, "{row}");
        assert_eq!(drive.has_fault(), trips, "{row}");
        assert_eq!(drive.fault_number(0), if trips { 17 } else { 0 }, "{row}");
        // no word of a field bus that is not there
        assert_ne!(drive.warning_number(0), 34, "{row}");
    }
}

/// 9-22 is of the network: at a line it is kept, and the line keeps its words.
#[test]
fn a_telegram_chosen_at_the_line_does_not_change_its_words() {
    let mut bench = Bench::fc(&[1]);
    let config = SerialConfig::new(&model::VLT, SlaveConfig::fc(1, 9600));
    bench.drives = vec![SerialStation::new(config.clone())];
    let drive = bench.master.add(Address::fc(1).unwrap(), &[0; 4]).unwrap();
    let mut client = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
    let read = Job::Read {
        pnu: 922,
        element: None,
    };
    let before = bench.job(drive, &mut client, read).unwrap();
    assert_eq!(before, Answer::Value(PkwValue::Word(1)));
    let write = |number| Job::Change {
        pnu: 922,
        element: None,
        value: PkwValue::Word(number),
        memory: Memory::Eeprom,
    };
    for number in [101, 1, 108] {
        bench.job(drive, &mut client, write(number)).unwrap();
        let answer = bench.job(drive, &mut client, read).unwrap();
        assert_eq!(answer, Answer::Value(PkwValue::Word(number)));
        bench.words(drive, 0x043C, 0);
        bench.run(SECOND);
        bench.words(drive, 0x047C, 0x2000);
        bench.run(SECOND * 4);
        let station = &bench.drives[0];
        assert_eq!(station.drive().state(), State::S4, "{number}");
        assert!((station.drive().axis().speed() - 750.0).abs() < 40.0, "{number}");
        let reply = bench.master.reply(drive);
        let status = u16::from_be_bytes([reply[reply.len() - 4], reply[reply.len() - 3]]);
        assert_eq!(status, 0x0F07, "{number}");
    }
    assert!(bench.job(drive, &mut client, write(999)).is_err());
    bench.words(drive, 0x043C, 0);
    bench.run(SECOND * 4);
    // it survives the power, and the line is the same
    let station = &mut bench.drives[0];
    station.switch_off();
    let saved = std::iter::from_fn(|| station.poll_event()).filter_map(|event| match event {
        StationEvent::PersistParameters { text, .. } => Some(text),
        _ => None,
    });
    let saved = saved.last().map(String::into_bytes);
    bench.drives = vec![SerialStation::new(SerialConfig {
        parameters: saved,
        ..config
    })];
    let mut client = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
    let answer = bench.job(drive, &mut client, read).unwrap();
    assert_eq!(answer, Answer::Value(PkwValue::Word(108)));
    bench.words(drive, 0x047C, 0x2000);
    bench.run(SECOND * 4);
    assert_eq!(bench.drives[0].drive().state(), State::S4);
}

/// Whose channel it is does not depend on the protocol that carries it.
#[test]
fn the_parameter_channel_is_vendor_specific() {
    let station = |model, slave| SerialStation::new(SerialConfig::new(model, slave));
    for (model, slave, name) in [
        (&model::VLT, SlaveConfig::fc(1, 9600), "Danfoss FC protocol"),
        (&model::VLT, SlaveConfig::uss(1, 9600), "Danfoss FC in four words"),
        (&model::AKD, SlaveConfig::uss(1, 9600), "Siemens USS"),
        (&model::VACON, SlaveConfig::fc(1, 9600), "Danfoss FC protocol"),
    ] {
        assert_eq!(station(model, slave).server.dialect().name, name);
    }
}

/// AK 0 until the value is stored; the telegrams go on meanwhile.
#[test]
fn a_permanent_write_over_fc_is_answered_when_it_is_stored() {
    for stored in [true, false] {
        let mut bench = Bench::fc(&[1]);
        bench.drives = vec![SerialStation::new(SerialConfig::new(
            &model::VLT,
            SlaveConfig::fc(1, 9600),
        ))];
        bench.drives[0].confirm_saves();
        let drive = bench.master.add(Address::fc(1).unwrap(), &[0; 12]).unwrap();
        let mut client = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
        let write = Job::Change {
            pnu: 341,
            element: None,
            value: PkwValue::DoubleWord(500),
            memory: Memory::Eeprom,
        };
        client.start(time(bench.now), write).unwrap();
        let mut outcome = None;
        let mut replies = 0;
        // one reply at most in a turn: after the refusal the same telegram is a new request
        for turn in 0..120 {
            let mut data = [0; MAX_DATA];
            let parts = Parts {
                pkw: client.request(time(bench.now)),
                pzd: &[0; PROCESS],
            };
            let length = bench.layout.join(parts, &mut data).unwrap();
            bench.master.set_data(drive, &data[..length]).unwrap();
            let events = bench.run(Duration::from_millis(20));
            if turn == 60 {
                assert_eq!(outcome, None, "not stored yet");
                let station = &mut bench.drives[0];
                let saves: Vec<SaveId> = std::iter::from_fn(|| station.poll_event())
                    .filter_map(|event| match event {
                        StationEvent::PersistParameters {
                            save, asked: true, ..
                        } => Some(save),
                        _ => None,
                    })
                    .collect();
                station.report_save(*saves.last().expect("a save"), stored);
            }
            if events.contains(&Event::Reply(drive)) {
                replies += 1;
                let reply = bench.layout.split(bench.master.reply(drive)).unwrap();
                outcome = outcome.or(client.handle(time(bench.now), reply.pkw));
            }
        }
        assert!(replies > 30, "{replies}");
        match outcome.expect("an answer") {
            Ok(answer) => assert!(stored && answer == Answer::Value(PkwValue::DoubleWord(500))),
            Err(error) => assert!(!stored && error.to_string().contains("17"), "{error}"),
        }
    }
}

/// A change that is refused while the motor runs is carried out when the same telegram comes after the stop.
#[test]
fn the_same_request_after_a_refusal_is_a_new_one_at_a_line() {
    const NOTHING: [u8; 8] = [0; 8];
    // AK 3, 1-20 = 12
    const CHANGE: [u8; 8] = [0x30, 0x78, 0, 0, 0, 0, 0, 12];
    const RUN: [u8; 4] = [0x04, 0x7C, 0x10, 0];
    const STOP: [u8; 4] = [0x04, 0x3C, 0, 0];
    let config = SerialConfig::new(&model::VLT, SlaveConfig::fc(1, 9600));
    let mut station = SerialStation::new(config);
    let mut now = Instant::from_millis(1000);
    let mut exchange = |pkw: [u8; 8], words: [u8; 4]| -> Vec<u8> {
        let data = [&pkw[..], &words].concat();
        let mut telegram = [0_u8; uss::MAX_TELEGRAM];
        let address = Address::fc(1).unwrap();
        let length = uss::Telegram { address, data: &data }
            .encode(&mut telegram)
            .unwrap();
        station.handle_octets(now, &telegram[..length]);
        let mut reply = [0; uss::MAX_TELEGRAM];
        for _ in 0..10_000 {
            now += Duration::from_millis(1);
            station.handle_timeout(now);
            if let Some(length) = station.poll_transmit(now, &mut reply) {
                return reply[3..length - 1].to_vec();
            }
        }
        panic!("no reply")
    };
    for _ in 0..50 {
        exchange(NOTHING, RUN);
    }
    for _ in 0..2 {
        let refused = exchange(CHANGE, RUN);
        assert_eq!((refused[0] >> 4, refused[7]), (7, 17), "runs: {refused:02X?}");
    }
    let carried_out = (0..1000).any(|_| exchange(CHANGE, STOP)[0] >> 4 == 2);
    assert!(carried_out, "the axis is at rest");
}

/// 9-72 over FC: answered, then values as saved. PNU 922 is a setting of the network and stays one.
#[test]
fn a_vlt_restarts_by_9_72_at_the_line_too() {
    let mut bench = Bench::fc(&[1]);
    bench.drives = vec![SerialStation::new(SerialConfig::new(
        &model::VLT,
        SlaveConfig::fc(1, 9600),
    ))];
    let drive = bench.master.add(Address::fc(1).unwrap(), &[0; 12]).unwrap();
    let mut client = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
    let write = |pnu, value, memory| Job::Change {
        pnu,
        element: None,
        value,
        memory,
    };
    let time = PkwValue::DoubleWord;
    for job in [
        write(341, time(500), Memory::Eeprom),
        write(342, time(600), Memory::Ram),
        write(972, PkwValue::Word(1), Memory::Ram),
    ] {
        assert!(bench.job(drive, &mut client, job).is_ok());
    }
    bench.run(SECOND);
    let mut read = |pnu| {
        let job = Job::Read { pnu, element: None };
        match bench.job(drive, &mut client, job) {
            Ok(Answer::Value(value)) => value.raw(),
            other => panic!("{pnu}: {other:?}"),
        }
    };
    assert_eq!([341, 342, 972, 922].map(&mut read), [500, 300, 0, 1]);
    let station = &mut bench.drives[0];
    let restarts = std::iter::from_fn(|| station.poll_event());
    let restarts = restarts.filter(|event| *event == StationEvent::Restarting);
    assert_eq!(restarts.count(), 1);
    // and it follows its master again
    bench.words(drive, 0x047C, 0x2000);
    bench.run(SECOND * 4);
    assert_eq!(bench.drives[0].drive().state(), State::S4);
}

#[test]
fn events_that_nobody_takes_are_bounded_and_the_oldest_go() {
    let mut station = SerialStation::new(SerialConfig::new(&model::AKD, SlaveConfig::fc(1, 9600)));
    let exchanging = |telegram| StationEvent::Exchanging { telegram };
    for telegram in 0..300 {
        station.emit(exchanging(telegram));
    }
    let events: Vec<StationEvent> = core::iter::from_fn(|| station.poll_event()).collect();
    assert_eq!(events, (44..300).map(exchanging).collect::<Vec<_>>());
}
