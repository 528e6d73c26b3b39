//! Our controller and our drive on a bad segment in virtual time: one hour, then a cable that is pulled.

use std::time::Duration;

use client::modules_of;
use network::host::Host;
use network::segment::{Conditions, Segment, StationId};
use profile::catalogue::AKD;
use profile::parameter::{
    Answer, Dialect, Format, NewValue, ParameterAddress, RequestId, Response, encode_change, encode_read,
};
use profinet::controller::{
    ArId, CallId, ConnectConfig, Controller, ControllerConfig, Event, RecordAddress, Resolve, Target,
};
use profinet::cyclic::Timing;
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress};
use system_tests::{compare, judge, memory};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

const CYCLE: Duration = Duration::from_millis(16);
const SEED: u64 = 20_261_121;

fn ip(last: u8) -> IpSuite {
    IpSuite {
        address: [10, 0, 0, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    }
}

/// Numbers that repeat with the seed.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % sides
    }
}

/// What the application wants of the drive.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Want {
    Ready,
    Run(i16),
}

/// A parameter job that is under way.
struct Job {
    call: CallId,
    request: RequestId,
    reference: u8,
    value: u32,
}

struct World {
    segment: Segment,
    controller: StationId,
    drive: StationId,
    target: Target,
    ar: Option<ArId>,
    running: bool,
    lost: Vec<String>,
    want: Want,
    ticks: u64,
    /// DataHoldFactor.
    hold: u16,
    job: Option<Job>,
    reference: u8,
    started: usize,
    right: usize,
    errors: Vec<String>,
    /// What the parameter may hold: one value, or more after a change without an answer.
    possible: Vec<u32>,
    dice: Dice,
}

const PARAMETER: &str = "DRV.ACC";

impl World {
    fn new(seed: u64) -> Self {
        println!("seed {seed}");
        let mut segment = Segment::new(seed);
        let mac = MacAddress([2, 0x50, 0x4E, 0, 0, 1]);
        let mut config = StationConfig::new(&model::AKD, mac);
        config.network = Stored {
            name: "akd-1".into(),
            ip: ip(1),
            ..Stored::default()
        };
        let drive = segment.attach(Box::new(Host::new(Station::new(config))));
        let own = MacAddress([2, 0x50, 0x4E, 0, 0, 2]);
        let controller = Controller::new(ControllerConfig::new(own, ip(2), "plc", seed));
        let controller = segment.attach(Box::new(Host::new(controller)));
        let device = &AKD.device;
        let target = Target {
            name: "akd-1".into(),
            mac: None,
            ip: IpSuite::NONE,
            vendor_id: device.vendor_id,
            device_id: device.device_id,
            instance: 1,
        };
        Self {
            segment,
            controller,
            drive,
            target,
            ar: None,
            running: false,
            lost: Vec::new(),
            want: Want::Ready,
            ticks: 0,
            hold: 3,
            job: None,
            reference: 0,
            started: 0,
            right: 0,
            errors: Vec::new(),
            possible: Vec::new(),
            dice: Dice(seed),
        }
    }

    fn controller(&mut self) -> (Instant, &mut Controller) {
        let now = self.segment.now();
        (
            now,
            self.segment
                .station_mut::<Host<Controller>>(self.controller)
                .unwrap()
                .endpoint_mut(),
        )
    }

    fn station(&self) -> &Station {
        self.segment
            .station::<Host<Station>>(self.drive)
            .unwrap()
            .endpoint()
    }

    fn connect(&mut self) {
        let device = &AKD.device;
        let modules = modules_of(device, device.telegram(1).unwrap());
        let mut config = ConnectConfig::new(modules, Timing::for_interval(CYCLE).unwrap());
        config.resolve = Resolve::Check;
        config.watchdog_factor = self.hold;
        config.data_hold_factor = self.hold;
        let target = self.target.clone();
        let (now, controller) = self.controller();
        self.ar = Some(controller.connect(now, target, config).unwrap());
        self.running = false;
    }

    /// One look every 50 ms: events, connection, control word, jobs.
    fn tick(&mut self, jobs: bool) {
        self.ticks += 1;
        let until = self.segment.now() + Duration::from_millis(50);
        self.segment.run_until(until);
        while let Some(event) = self.controller().1.poll_event() {
            self.take(event);
        }
        if let Some(host) = self.segment.station_mut::<Host<Station>>(self.drive) {
            while host.endpoint_mut().poll_event().is_some() {}
        }
        match self.ar {
            None => self.connect(),
            Some(ar) if self.running => {
                self.control(ar);
                if jobs && self.job.is_none() && self.ticks.is_multiple_of(2) {
                    self.start_job(ar);
                }
            }
            Some(_) => {}
        }
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Running { ar } if self.ar == Some(ar) => self.running = true,
            Event::Lost { ar, cause } if self.ar == Some(ar) => {
                self.lost.push(cause.to_string());
                self.ar = None;
                self.running = false;
            }
            Event::RecordDone { call, result } => {
                if let Some(job) = self.job.take_if(|job| job.call == call) {
                    match result {
                        Ok(data) => self.finish_job(&job, &data),
                        Err(error) => self.errors.push(error.to_string()),
                    }
                }
            }
            _ => {}
        }
    }

    /// STW1 that leads from where the drive is to where it is wanted.
    fn control(&mut self, ar: ArId) {
        let want = self.want;
        let toggle = self.ticks % 4 < 2;
        let (_, controller) = self.controller();
        let Some((&[high, low, ..], _)) = controller.input(ar, 1, 1) else {
            return;
        };
        let zsw1 = u16::from_be_bytes([high, low]);
        let ready = zsw1 & 0x0041 == 0x0001;
        let (word, speed) = match want {
            // a fault: acknowledge by an edge of bit 7
            _ if zsw1 & 0x0008 != 0 => (if toggle { 0x04FE } else { 0x047E }, 0),
            Want::Ready => (0x047E, 0),
            Want::Run(_) if !ready => (0x047E, 0),
            Want::Run(speed) => (0x047F, speed),
        };
        let [a, b] = u16::to_be_bytes(word);
        let [c, d] = speed.to_be_bytes();
        controller.set_output(ar, 1, 1, &[a, b, c, d]).unwrap();
    }

    fn address(&self) -> ParameterAddress {
        ParameterAddress::value(AKD.by_name(PARAMETER).unwrap().pnu, 0)
    }

    fn start_job(&mut self, ar: ArId) {
        self.reference = self.reference % 255 + 1;
        let reference = self.reference;
        let address = self.address();
        let mut bytes = [0; 240];
        let change = !self.possible.is_empty() && self.dice.roll(2) == 0;
        let value = 2_000_000 + u32::try_from(self.dice.roll(1_000_000)).unwrap();
        let (request, length) = if change {
            let data = value.to_be_bytes();
            let value = NewValue {
                address,
                format: Format::DOUBLE_WORD,
                count: 1,
                data: &data,
            };
            (
                RequestId::Change,
                encode_change(reference, &Dialect::AKD, &[value], &mut bytes),
            )
        } else {
            (
                RequestId::Read,
                encode_read(reference, &Dialect::AKD, &[address], &mut bytes),
            )
        };
        let at = RecordAddress {
            api: 0x3A00,
            slot: 1,
            subslot: 1,
            index: 0xB02E,
        };
        let data = bytes[..length.unwrap()].to_vec();
        let (now, controller) = self.controller();
        let call = controller.parameter_job(now, ar, at, &data).unwrap();
        if change {
            // until the answer says so, both are possible
            self.possible.push(value);
        }
        self.started += 1;
        self.job = Some(Job {
            call,
            request,
            reference,
            value,
        });
    }

    fn finish_job(&mut self, job: &Job, data: &[u8]) {
        let addresses = [self.address()];
        let response = Response::parse(data, job.request, job.reference, &addresses, &Dialect::AKD).unwrap();
        match response.answers().next().unwrap() {
            Answer::Written => self.possible = vec![job.value],
            Answer::Values(block) => {
                let found = u32::try_from(block.raw(0).unwrap()).unwrap();
                assert!(
                    self.possible.is_empty() || self.possible.contains(&found),
                    "read {found}, possible were {:?}",
                    self.possible
                );
                self.possible = vec![found];
            }
            Answer::Error(error) => panic!("refused: {error}"),
        }
        self.right += 1;
    }

    fn until(&mut self, what: &str, seconds: u64, mut done: impl FnMut(&mut Self) -> bool) {
        let until = self.segment.now() + Duration::from_secs(seconds);
        while !done(self) {
            assert!(
                self.segment.now() < until,
                "{what}: not within {seconds} s; lost: {:?}",
                self.lost
            );
            self.tick(false);
        }
    }

    fn speed(&self) -> f64 {
        self.station().drive().axis().speed()
    }
}

#[test]
fn one_hour_at_one_percent_loss_duplication_and_reordering() {
    for seed in [1, 2] {
        one_hour(&mut bad_world(seed));
    }
}

/// Returns a world with one percent of everything bad.
fn bad_world(seed: u64) -> World {
    let mut world = World::new(seed);
    // With jitter the third frame after the last one may come just behind three intervals, so a factor of 3 survives one
    // lost frame for sure; 4 survives two.
    world.hold = 4;
    let bad = Conditions {
        loss: 0.01,
        duplicate: 0.01,
        reorder: 0.01,
        reorder_by: Duration::from_millis(20),
        jitter: Duration::from_micros(200),
        ..Conditions::default()
    };
    world.segment.set_all_conditions(bad);
    world
}

fn run_until(world: &mut World, end: Instant) {
    while world.segment.now() < end {
        // a new speed every ten seconds
        let phase = world.ticks / 200 % 3;
        world.want = [Want::Run(164), Want::Run(-164), Want::Ready][usize::try_from(phase).unwrap()];
        world.tick(true);
    }
}

/// Every frame of an hour, and of a connection lost and found after it, is read by the dissector: half a million frames in
/// one capture.
#[test]
fn the_dissector_accepts_every_frame_of_the_hour() {
    let mut world = bad_world(SEED);
    let traffic = memory::listen(&mut world.segment);
    one_hour(&mut world);
    world.segment.cut(world.drive);
    let before = world.lost.len();
    world.until("the controller notices", 1, |world| world.lost.len() > before);
    world.segment.uncut(world.drive);
    world.until("connected again", 60, |world| world.running);
    let file = memory::save("bad-segment.pcapng", &traffic.lock().unwrap());
    let sent = traffic.lock().unwrap().len();
    assert!(sent > 500_000, "{sent} frames");
    let verdict = judge::judge(&file);
    verdict.clean().saw("pn_dcp", 4).saw("pn_io", 400_000);
    assert_eq!(verdict.frames, sent, "the dissector read all of them");
    // the dissector sees each job even if its frames come twice or not at all
    let jobs = compare::parameter_frames(&file, &Dialect::AKD).len();
    assert!(jobs > 2 * world.right, "{jobs} of {}", world.right);
}

fn one_hour(world: &mut World) {
    run_until(world, Instant::from_millis(3_600_000));
    world.until("last job", 60, |world| world.job.is_none());
    let statistics = world.segment.statistics();
    println!(
        "{} jobs, {} right, errors {:?}",
        world.started, world.right, world.errors
    );
    println!("connections lost: {:?}; {statistics:?}", world.lost);
    // each job ended, right or with a clear error
    assert_eq!(world.started, world.right + world.errors.len());
    assert!(world.started > 15_000, "{}", world.started);
    assert!(world.errors.len() * 200 < world.started, "{:?}", world.errors);
    // One frame in a hundred is lost, another comes more than a cycle late and is ignored: three in a row are expected
    // about four times among 450,000 frames.
    assert!(world.lost.len() <= 15, "{:?}", world.lost);
    // and it still runs
    world.want = Want::Run(164);
    world.until("at speed", 30, |world| (world.speed() - 60.0).abs() < 2.0);
}

#[test]
fn a_pulled_cable_stops_both_sides_and_both_recover() {
    for round in 0..5 {
        let mut world = World::new(SEED + round);
        world.want = Want::Run(164);
        world.until("at speed", 30, |world| (world.speed() - 60.0).abs() < 2.0);
        let before = world.lost.len();
        world
            .segment
            .run_until(world.segment.now() + Duration::from_millis(round * 7));
        world.segment.cut(world.drive);
        world.until("the controller notices", 1, |world| world.lost.len() > before);
        assert!(
            world.lost[before].contains("no cyclic data for 48 ms"),
            "{:?}",
            world.lost
        );
        let drive = world.station().drive();
        assert!(drive.has_fault());
        assert_eq!(drive.fault_number(0), 702);
        // the axis stops without a command
        world.until("standstill", 10, |world| world.speed().abs() < 0.5);
        assert!(!world.station().drive().is_enabled());
        world.segment.uncut(world.drive);
        // found again, connected, fault acknowledged, running
        world.until("at speed again", 60, |world| (world.speed() - 60.0).abs() < 2.0);
        assert!(!world.station().drive().has_fault());
    }
}
