//! The drive through its process data and its parameters, without any field bus.

use super::*;
use crate::model::AKD;
use profile::parameter::ErrorNumber;

/// ZSW1 bits 0, 1, 2, 4, 5, 6.
const MASK: u16 = 0x0077;

pub(crate) struct Bench {
    pub drive: Drive,
    pub now: Instant,
    pub status: u16,
    pub speed: i16,
}

impl Bench {
    pub fn new() -> Self {
        let mut drive = Drive::new(&AKD);
        drive.connect(1, Duration::from_millis(48)).unwrap();
        Self {
            drive,
            now: Instant::ZERO,
            status: 0,
            speed: 0,
        }
    }

    pub fn tick(&mut self, outputs: Option<[u8; 4]>) {
        self.now += Duration::from_millis(16);
        let mut inputs = [0; 4];
        self.drive
            .tick(self.now, outputs.as_ref().map(|octets| &octets[..]), &mut inputs);
        self.status = u16::from_be_bytes([inputs[0], inputs[1]]);
        self.speed = i16::from_be_bytes([inputs[2], inputs[3]]);
    }

    /// Sends STW1 and NSOLL_A for some cycles; the last status word.
    pub fn send(&mut self, control: u16, speed: i16, cycles: usize) -> u16 {
        let [a, b] = control.to_be_bytes();
        let [c, d] = speed.to_be_bytes();
        for _ in 0..cycles {
            self.tick(Some([a, b, c, d]));
        }
        self.status
    }

    pub fn read(&self, name: &str) -> i64 {
        self.element(name, 0)
    }

    pub fn element(&self, name: &str, element: u16) -> i64 {
        let pnu = name
            .parse()
            .unwrap_or_else(|_| AKD.catalogue.by_name(name).unwrap().pnu);
        self.drive
            .element(AKD.catalogue.position(pnu).unwrap(), element)
            .unwrap()
    }

    pub fn write(&mut self, name: &str, raw: i64) -> Result<(), ErrorNumber> {
        let pnu = name
            .parse()
            .unwrap_or_else(|_| AKD.catalogue.by_name(name).unwrap().pnu);
        self.drive
            .set_element(AKD.catalogue.position(pnu).unwrap(), 0, raw)
    }

    pub fn run(&mut self, speed: i16) {
        self.send(0x047E, 0, 3);
        self.send(0x047F, speed, 100);
        assert_eq!(self.drive.state(), State::S4);
    }

    pub fn events(&mut self) -> Vec<Event> {
        core::iter::from_fn(|| self.drive.poll_event()).collect()
    }
}

#[test]
fn the_sequences_of_the_manual() {
    let mut bench = Bench::new();
    for (control, state) in [
        (0x0470, State::S1),
        (0x0476, State::S2),
        (0x0477, State::S3),
        (0x047F, State::S4),
    ] {
        bench.send(control, 0, 3);
        assert_eq!(bench.drive.state(), state, "{control:#06x}");
    }
    let mut bench = Bench::new();
    let steps = [
        (0x0400, State::S1),
        (0x0406, State::S2),
        (0x040E, State::S2),
        (0x040F, State::S4),
        (0x047F, State::S4),
    ];
    for (control, state) in steps {
        bench.send(control, 0xA3, 3);
        assert_eq!(bench.drive.state(), state, "{control:#06x}");
    }
    bench.send(0x047F, 0xA3, 60);
    assert_eq!(bench.status & 0x02FF, 0x0237, "{:#06x}", bench.status);
}

#[test]
fn sixty_rpm() {
    for setpoint in [163, 164] {
        let mut bench = Bench::new();
        bench.run(setpoint);
        let mut sum = 0;
        for _ in 0..100 {
            bench.send(0x047F, setpoint, 1);
            assert!(
                (f64::from(bench.speed) - f64::from(setpoint)).abs() <= 3.0,
                "{}",
                bench.speed
            );
            let feedback = bench.read("VL.FB_32");
            assert!((59_000..=60_800).contains(&feedback), "{feedback}");
            sum += feedback;
        }
        let mean = sum as f64 / 100_000.0;
        let wanted = f64::from(setpoint) * 1638.0 * 960_000.0 / 4_294_967_296.0;
        assert!((mean - wanted).abs() < 0.1, "{mean} {wanted}");
        assert_eq!(
            bench.status & 0x0500,
            0x0500,
            "speed in range and reached: {:#06x}",
            bench.status
        );
        assert_eq!(bench.read("DRV.ACTIVE"), 1);
        assert_eq!(bench.read("DRV.DISSOURCES"), 0);
        assert!((bench.read("NSOLL_A") - i64::from(setpoint)).abs() == 0);
    }
}

#[test]
fn ramps_follow_their_parameters_while_running() {
    let mut bench = Bench::new();
    bench.run(0);
    bench.write("DRV.ACC", 600_000).unwrap(); // 600 rpm/s
    bench.send(0x047F, 1638, 32); // setpoint 600 rpm, 0.512 s
    let speed = bench.read("VL.CMD_32");
    assert!((speed - 307_200).abs() < 12_000, "{speed}");
    bench.send(0x045F, 1638, 20); // frozen
    let held = bench.read("VL.CMD_32");
    assert_eq!(held, bench.read("VL.CMD_32"));
    assert!((held - speed).abs() < 12_000, "{held} {speed}");
    bench.send(0x047F, 1638, 60);
    assert!((bench.read("VL.FB_32") - 600_000).abs() < 2_000);
    bench.write("DRV.DEC", 1_200_000).unwrap();
    bench.send(0x043F, 1638, 16); // setpoint off: along DRV.DEC
    let slower = bench.read("VL.FB_32");
    assert!((slower - 292_800).abs() < 25_000, "{slower}");
    bench.send(0x046F, 1638, 2); // ramp generator off: as fast as the current allows
    assert!(bench.read("VL.FB_32") < 30_000, "{}", bench.read("VL.FB_32"));
    assert_eq!(bench.drive.state(), State::S4);
}

#[test]
fn jog_one_and_two() {
    let mut bench = Bench::new();
    bench.write("Jog v1", 273).unwrap(); // 100 rpm
    bench.send(0x047E, 0, 3);
    bench.send(0x040F, 500, 5);
    assert_eq!(bench.drive.state(), State::S4);
    bench.send(0x050F, 500, 40);
    assert!((i32::from(bench.speed) - 273).abs() < 5, "{}", bench.speed);
    bench.send(0x040F, 500, 40);
    assert!(bench.speed.abs() < 3);
    bench.send(0x060F, 500, 40);
    assert!((i32::from(bench.speed) + 164).abs() < 5, "{}", bench.speed);
    bench.send(0x070F, 500, 40); // both: standstill
    assert!(bench.speed.abs() < 3);
    // Not while the setpoint channel is open.
    bench.send(0x057F, 0, 40);
    assert!(bench.speed.abs() < 3, "{}", bench.speed);
    // Not while it moves: the jog has to wait for standstill.
    bench.send(0x047F, 5000, 40);
    bench.send(0x050F, 5000, 1);
    assert_eq!(bench.drive.channel.jog(), profile::state::Jog::Off);
}

#[test]
fn stops() {
    let mut bench = Bench::new();
    bench.run(1638); // 600 rpm
    bench.send(0x047E, 0, 3);
    assert_eq!(
        bench.status & 0x0042,
        0x0002,
        "ramp stop keeps bit 1, bit 6 clear"
    );
    bench.send(0x047F, 1638, 1);
    assert_eq!(bench.drive.state(), State::S4, "a ramp stop can be interrupted");
    bench.send(0x047E, 0, 30);
    assert_eq!(bench.status & MASK, 0x0031);

    bench.run(1638);
    bench.send(0x047B, 0, 2);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.send(0x047F, 1638, 40);
    assert_eq!(
        bench.drive.state(),
        State::S1,
        "a quick stop cannot be interrupted"
    );
    bench.send(0x047E, 0, 2);
    assert_eq!(bench.status & MASK, 0x0031);

    bench.run(1638);
    let fast = bench.drive.axis().speed();
    bench.send(0x047D, 0, 1);
    assert_eq!(bench.drive.state(), State::S1);
    assert!(bench.drive.axis().speed() > 0.9 * fast, "coasts");
    bench.send(0x047F, 0, 20);
    assert_eq!(bench.status & MASK, 0x0070, "inhibited until OFF");
}

#[test]
fn control_by_plc() {
    let mut bench = Bench::new();
    bench.send(0x047E, 0, 3);
    bench.send(0x007F, 500, 5);
    assert_eq!(bench.drive.state(), State::S2);
    assert_eq!(bench.read("STW1"), 0x007F);
    bench.send(0x047F, 163, 5);
    assert_eq!(bench.drive.state(), State::S4);
    bench.send(0x0000, 3000, 30);
    assert_eq!(bench.drive.state(), State::S4, "keeps the last valid words");
    assert!((i32::from(bench.speed) - 163).abs() < 4);
}

#[test]
fn faults_are_acknowledged_by_an_edge_and_the_buffer_shifts() {
    let mut bench = Bench::new();
    bench.run(163);
    let counter = bench.read("944");
    bench.drive.inject_fault(301, false);
    bench.drive.inject_fault(304, false);
    bench.drive.inject_fault(301, false);
    bench.send(0x047F, 163, 20);
    assert_eq!(bench.drive.state(), State::S1);
    assert_eq!(bench.status & 0x0008, 0x0008);
    assert_eq!(bench.read("944"), counter + 1);
    assert_eq!((bench.element("947", 0), bench.element("947", 1)), (301, 304));
    assert_eq!(
        (
            bench.read("DRV.FAULT1"),
            bench.read("DRV.FAULT2"),
            bench.read("DRV.FAULT3")
        ),
        (301, 304, 0)
    );
    assert_eq!(bench.read("DRV.DISSOURCES"), 3);
    bench.send(0x04FE, 0, 2);
    assert_eq!(bench.status & 0x0008, 0);
    assert_eq!(
        (
            bench.element("947", 0),
            bench.element("947", 8),
            bench.element("947", 9)
        ),
        (0, 301, 304)
    );
    assert_eq!(bench.read("944"), counter + 1);
    bench.send(0x047E, 0, 2);
    assert_eq!(bench.status & MASK, 0x0031);
    // Level 1 does nothing more.
    bench.send(0x04FE, 0, 2);
    bench.drive.inject_fault(301, false);
    bench.send(0x04FE, 0, 5);
    assert_eq!(bench.status & 0x0008, 0x0008);
    bench.send(0x047E, 0, 1);
    bench.send(0x04FE, 0, 1);
    assert_eq!(bench.status & 0x0008, 0);
    let events = bench.events();
    assert!(events.contains(&Event::Fault { number: 301 }) && events.contains(&Event::Acknowledged));
}

#[test]
fn a_lasting_fault_cannot_be_acknowledged() {
    let mut bench = Bench::new();
    bench.send(0x047E, 0, 3);
    bench.drive.inject_fault(501, true);
    bench.send(0x04FE, 0, 2);
    assert_eq!((bench.element("947", 0), bench.element("947", 8)), (501, 0));
    assert_eq!(bench.status & 0x0008, 0x0008);
    bench.drive.inject(Injection::ClearCause { number: 501 });
    bench.write("DRV.CLRFAULTS", 1).unwrap();
    bench.send(0x047E, 0, 2);
    assert_eq!(bench.status & MASK, 0x0031);
}

#[test]
fn a_lost_controller_stops_the_axis_with_fault_702() {
    let mut bench = Bench::new();
    bench.run(1638);
    bench.drive.disconnect(Disconnect::Lost);
    assert_eq!(bench.element("947", 0), 702);
    let mut ticks = 0;
    while let Some(next) = bench.drive.next_tick() {
        assert!(
            next <= bench.now + Duration::from_millis(4),
            "every 4 ms while it moves"
        );
        bench.now = next;
        bench.drive.tick(next, None, &mut []);
        ticks += 1;
        assert!(ticks < 1000);
    }
    assert!(ticks > 40, "it took its ramp: {ticks}");
    assert_eq!(bench.drive.state(), State::S1);
    assert!(bench.drive.axis().is_at_rest());
    // The next controller finds the fault, acknowledges and runs; running words alone do not start it.
    bench.drive.connect(1, Duration::from_millis(48)).unwrap();
    bench.send(0x047F, 163, 10);
    assert_eq!(bench.drive.state(), State::S1);
    bench.send(0x047E, 0, 2);
    bench.send(0x04FE, 0, 2);
    bench.run(163);
}

#[test]
fn a_release_is_no_fault_while_the_power_stage_is_off_and_one_while_it_is_on() {
    let mut bench = Bench::new();
    bench.send(0x047E, 0, 3);
    bench.drive.disconnect(Disconnect::Released);
    assert!(!bench.drive.has_fault());
    bench.drive.tick(bench.now, None, &mut []);
    assert_eq!(bench.drive.state(), State::S1);
    assert_eq!(bench.drive.next_tick(), None);

    let mut bench = Bench::new();
    bench.run(163);
    bench.drive.disconnect(Disconnect::Released);
    assert_eq!(bench.element("947", 0), 702);
    bench.drive.disconnect(Disconnect::Lost);
    assert_eq!(bench.element("947", 1), 0, "a connection is lost once");
}

#[test]
fn controller_stop_with_and_without_fault() {
    let mut bench = Bench::new();
    bench.run(1638);
    bench.tick(None);
    assert_eq!(bench.drive.state(), State::S5Ramp);
    for _ in 0..30 {
        bench.tick(None);
    }
    assert!(!bench.drive.has_fault() && !bench.drive.is_enabled());
    bench.send(0x047F, 1638, 5);
    assert_eq!(bench.drive.state(), State::S1, "no start without OFF and ON");

    bench.write("FBUS.PARAM02", 1).unwrap();
    bench.run(163);
    bench.tick(None);
    assert_eq!(bench.element("947", 0), 702);
    bench.tick(None);
    assert_eq!(bench.element("947", 1), 0);
}

#[test]
fn overspeed_coasts() {
    let mut bench = Bench::new();
    bench.run(2000);
    bench.write("VL.THRESH_32", 100_000).unwrap();
    bench.send(0x047F, 2000, 2);
    assert_eq!(bench.element("947", 0), 302);
    assert_eq!(bench.drive.state(), State::S1);
}

#[test]
fn operating_mode_and_its_profile_parameter_are_one() {
    let mut bench = Bench::new();
    assert_eq!((bench.read("930"), bench.read("DRV.OPMODE")), (1, 1));
    bench.write("930", 2).unwrap(); // the example of the manual, 3.6.2
    assert_eq!((bench.read("930"), bench.read("DRV.OPMODE")), (2, 2));
    bench.write("DRV.OPMODE", 0).unwrap();
    assert_eq!(bench.read("930"), 0x8000);
    assert_eq!(bench.write("930", 3), Err(ErrorNumber::VALUE));
    assert_eq!(bench.write("DRV.OPMODE", 3), Err(ErrorNumber::LIMIT));
    bench.write("DRV.OPMODE", 1).unwrap();
    bench.run(163);
    assert_eq!(bench.write("930", 2), Err(ErrorNumber::NOT_NOW));
    bench.write("930", 1).unwrap();
}

#[test]
fn scalings_have_two_numbers() {
    let mut bench = Bench::new();
    bench.write("1009", 1000).unwrap();
    assert_eq!((bench.read("PN.VELSCALING"), bench.read("1009")), (1000, 1000));
    bench.write("PN.ACCSCALING", 400).unwrap();
    assert_eq!(bench.read("1008"), 400);
    assert_eq!(bench.write("1009", 2001), Err(ErrorNumber::LIMIT));
    assert_eq!(bench.write("1008", 0), Err(ErrorNumber::LIMIT));
    bench.run(268); // 268 * 0.22352 = 59.9 rpm
    assert!(
        (bench.read("VL.FB_32") - 59_900).abs() < 900,
        "{}",
        bench.read("VL.FB_32")
    );
    bench.write("HOME.MODE", 7).unwrap();
    assert_eq!(bench.read("1001"), 7);
}

#[test]
fn service_channel() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.write("DRV.EN", 1),
        Err(ErrorNumber::NOT_NOW),
        "the field bus commands"
    );
    bench.write("DRV.CMDSOURCE", 0).unwrap();
    bench.send(0x047E, 0, 3);
    assert_eq!(
        bench.write("DRV.EN", 1),
        Err(ErrorNumber::NOT_NOW),
        "the controller has control"
    );
    bench.send(0x0000, 0, 3);
    bench.write("DRV.EN", 1).unwrap();
    bench.write("VL.CMDU_32", 100_000).unwrap();
    bench.send(0x0000, 0, 40);
    assert!(
        (bench.read("VL.FB_32") - 100_000).abs() < 1500,
        "{}",
        bench.read("VL.FB_32")
    );
    assert_eq!(bench.status & 0x0200, 0, "local: control is not requested");
    bench.write("DRV.STOP", 1).unwrap();
    bench.send(0x0000, 0, 40);
    assert!(bench.read("VL.FB_32").abs() < 1500);
    bench.write("DRV.DIS", 1).unwrap();
    bench.send(0x0000, 0, 3);
    assert!(!bench.drive.is_enabled());
    assert_eq!(bench.status & 0x0200, 0x0200);
}

#[test]
fn commands_while_the_controller_runs_it() {
    let mut bench = Bench::new();
    bench.run(1638);
    bench.write("DRV.STOP", 1).unwrap();
    bench.send(0x047F, 1638, 40);
    assert_eq!(bench.drive.state(), State::S4);
    assert!(bench.speed.abs() < 5, "{}", bench.speed);
    bench.send(0x047F, 0, 1);
    bench.send(0x047F, 1638, 40);
    assert!(bench.speed > 1600, "a new setpoint moves it again");
    assert_eq!(bench.write("DRV.RSTVAR", 1), Err(ErrorNumber::NOT_NOW));
    bench.write("DRV.DISMODE", 2).unwrap();
    bench.write("DRV.DIS", 1).unwrap();
    bench.send(0x047F, 1638, 3);
    assert_eq!(bench.drive.state(), State::S5Ramp);
    bench.send(0x047F, 1638, 30);
    assert_eq!(bench.drive.state(), State::S1, "needs OFF and ON");
    bench.run(1638);
    bench.write("DRV.DISMODE", 0).unwrap();
    bench.write("DRV.DIS", 1).unwrap();
    assert_eq!(
        bench.send(0x047F, 1638, 1) & MASK,
        0x0060,
        "OFF2 by the drive, the word has no OFF3"
    );
    assert_eq!(bench.drive.state(), State::S1);
    assert!(bench.read("VL.FB_32") > 400_000, "coasts");
    assert_eq!(bench.send(0x047F, 1638, 1) & MASK, 0x0070);
}

#[test]
fn saving_and_loading() {
    let mut bench = Bench::new();
    bench.write("DRV.NVLOAD", 1).unwrap(); // as delivered
    bench.write("DRV.ACC", 4_000_000).unwrap();
    bench.write("DRV.NVSAVE", 1).unwrap();
    bench.write("DRV.ACC", 5_000_000).unwrap();
    let Some(Event::Save { text, .. }) = bench.drive.poll_event() else {
        panic!("saved")
    };
    bench.write("DRV.NVLOAD", 1).unwrap();
    assert_eq!(bench.read("DRV.ACC"), 4_000_000);
    bench.write("DRV.RSTVAR", 1).unwrap();
    assert_eq!(bench.read("DRV.ACC"), 3_000_000);
    let mut other = Drive::new(&AKD);
    assert_eq!(other.start_with(text.as_bytes()), Ok(0));
    assert_eq!(other.values.get(2108), 4_000_000);
    assert_eq!(other.settings.ramps.acceleration, 4000.0);
    assert!(other.start_with(b"rubbish").is_err());
}

#[test]
fn other_telegrams_ride_on_the_table() {
    let mut drive = Drive::new(&AKD);
    drive.connect(351, Duration::from_millis(48)).unwrap();
    let mut now = Instant::ZERO;
    let mut inputs = [0; 10];
    for words in [0x047E_0000_u32, 0x047F_0666] {
        for _ in 0..60 {
            now += Duration::from_millis(16);
            drive.tick(now, Some(&words.to_be_bytes()), &mut inputs);
        }
    }
    let word = |place: usize| i16::from_be_bytes([inputs[place], inputs[place + 1]]);
    assert!((i32::from(word(2)) - 0x0666).abs() < 20);
    assert!(
        word(4) > 50 && word(4) < 1000,
        "friction needs some current: {}",
        word(4)
    );
    let position = i32::from_be_bytes(inputs[6..10].try_into().unwrap());
    assert_eq!(i64::from(position), (drive.axis().position() >> 16) as i32 as i64);

    let mut drive = Drive::new(&AKD);
    drive.connect(354, Duration::from_millis(48)).unwrap();
    let outputs = [0x04, 0x7E, 0, 0, 0, 2, 0, 3];
    drive.tick(Instant::from_millis(16), Some(&outputs), &mut inputs);
    assert_eq!(
        (drive.values.get(2108), drive.values.get(2115)),
        (1_526_000, 2_289_000)
    );
    assert_eq!(drive.connect(2, Duration::ZERO), Err(UnknownTelegram(2)));
}

#[test]
fn short_outputs_and_odd_inputs_are_harmless() {
    let mut drive = Drive::new(&AKD);
    drive.connect(354, Duration::from_millis(48)).unwrap();
    for length in 0..9 {
        let mut inputs = [0xAA; 5];
        drive.tick(
            Instant::from_millis(length as u64),
            Some(&[0x04; 9][..length]),
            &mut inputs[..length.min(5)],
        );
    }
}

#[test]
fn a_drive_at_rest_needs_no_ticks() {
    let mut drive = Drive::new(&AKD);
    assert_eq!(drive.next_tick(), None);
    drive.set_load(1.0);
    assert!(
        drive.next_tick().is_some(),
        "a load turns a shaft without holding torque"
    );
}

#[test]
fn events_that_nobody_takes_are_bounded_and_the_oldest_go() {
    let mut bench = Bench::new();
    bench.events();
    let ignored = |raw| Event::Ignored { pnu: 1, raw };
    for raw in 0..300 {
        bench.drive.emit(ignored(raw));
    }
    assert_eq!(bench.events(), (44..300).map(ignored).collect::<Vec<_>>());
}
