//! Velocity mode word by word: ramp generator, freeze, setpoint enable, jog, and the bits of ZSW1 in every cycle.

use super::tests::Bench;
use super::*;

/// ZSW1 bits 8 and 10.
const IN_RANGE: u16 = 0x0100;
const REACHED: u16 = 0x0400;

impl Bench {
    /// One cycle; then bits 8 and 10 must be what the speeds that read as parameters make them.
    fn truth(&mut self, control: u16, setpoint: i16, target: f64) {
        self.send(control, setpoint, 1);
        let command = self.read("VL.CMD_32") as f64 / 1000.0;
        let measured = self.read("VL.FB_32") as f64 / 1000.0;
        let in_operation = self.status & 0x0004 != 0;
        for (bit, wanted) in [(IN_RANGE, command), (REACHED, target)] {
            let limit = (0.005 * wanted.abs()).max(1.0);
            let error = (wanted - measured).abs();
            if (error - limit).abs() > 0.002 {
                let expected = in_operation && error < limit;
                assert_eq!(
                    self.status & bit != 0,
                    expected,
                    "bit {bit:#06x}: {wanted} {measured} {:#06x}",
                    self.status
                );
            }
        }
    }

    fn truths(&mut self, control: u16, setpoint: i16, target: f64, cycles: usize) {
        (0..cycles).for_each(|_| self.truth(control, setpoint, target));
    }

    fn has(&self, bit: u16) -> bool {
        self.status & bit != 0
    }
}

#[test]
fn the_status_word_matches_the_axis_every_cycle() {
    let mut bench = Bench::new();
    let rpm = |raw: i16| f64::from(raw) * 1638.0 * 960_000.0 / 4_294_967_296.0;
    bench.truths(0x047E, 0, 0.0, 5);
    bench.truth(0x047F, 1638, rpm(1638));
    assert!(!bench.has(REACHED), "just begun");
    bench.truths(0x047F, 1638, rpm(1638), 40);
    assert!(bench.has(REACHED) && bench.has(IN_RANGE));
    bench.truths(0x047F, -5000, rpm(-5000), 30);
    assert!(
        !bench.has(REACHED) && bench.has(IN_RANGE),
        "on the ramp it follows: {:#06x}",
        bench.status
    );
    // More load than the current can hold: it does not follow any more.
    bench.write("IL.LIMITP", 1000).unwrap();
    bench.write("IL.LIMITN", -1000).unwrap();
    bench.drive.set_load(-1.2);
    bench.truths(0x047F, -1000, rpm(-1000), 10);
    assert!(
        !bench.has(IN_RANGE) && !bench.has(REACHED),
        "{:#06x}",
        bench.status
    );
    bench.drive.set_load(0.0);
    bench.write("IL.LIMITP", 9000).unwrap();
    bench.write("IL.LIMITN", -9000).unwrap();
    bench.truths(0x047F, -1000, rpm(-1000), 60);
    assert!(bench.has(IN_RANGE) && bench.has(REACHED));
    // Setpoint off: the target is 0; frozen: the target is still the setpoint.
    bench.truths(0x043F, -1000, 0.0, 30);
    assert!(bench.has(REACHED));
    bench.truths(0x047F, 1638, rpm(1638), 5);
    bench.truths(0x045F, 1638, rpm(1638), 5);
    assert!(
        !bench.has(REACHED) && bench.has(IN_RANGE),
        "{:#06x}",
        bench.status
    );
    bench.truths(0x047E, 0, 0.0, 1);
    assert_eq!(bench.status & (IN_RANGE | REACHED), 0, "in S4 only");
}

#[test]
fn jog_speeds_and_ramps_are_pnu_1004_to_1007() {
    for pnu in [1006, 1007] {
        let described = crate::model::AKD.catalogue.by_pnu(pnu).unwrap().description;
        assert!(!described.contains("velocity"), "{described}");
    }
    let mut bench = Bench::new();
    bench.write("Jog v1", 273).unwrap(); // 99.95 rpm
    bench.write("Jog v2", -546).unwrap();
    bench.write("Jog Acc", 1).unwrap(); // 763 rpm/s
    bench.write("Jog Dec", 2).unwrap(); // 1526 rpm/s
    bench.write("DRV.ACC", 50_000_000).unwrap(); // not these
    bench.write("DRV.DEC", 50_000_000).unwrap();
    bench.send(0x047E, 0, 3);
    bench.send(0x040F, 5000, 5);
    let near = |bench: &Bench, rpm: f64| {
        let speed = bench.read("VL.CMD_32") as f64 / 1000.0;
        assert!((speed - rpm).abs() < 0.01, "{speed} {rpm}");
    };
    bench.send(0x050F, 5000, 5);
    near(&bench, 5.0 * 0.016 * 763.0);
    assert!(!bench.has(REACHED));
    bench.send(0x050F, 5000, 60);
    near(&bench, 273.0 * 12_000.0 / 32_768.0);
    assert!(bench.has(REACHED) && bench.has(IN_RANGE));
    let from = bench.read("VL.CMD_32") as f64 / 1000.0;
    bench.send(0x040F, 5000, 2);
    near(&bench, from - 2.0 * 0.016 * 1526.0);
    bench.send(0x040F, 5000, 60);
    near(&bench, 0.0);
    bench.send(0x060F, 5000, 8);
    near(&bench, -8.0 * 0.016 * 763.0);
    bench.send(0x060F, 5000, 60);
    near(&bench, -546.0 * 12_000.0 / 32_768.0);
    // The ramps are scaled as the signals are, the speeds never (manual 6.1 and 6.5).
    bench.send(0x040F, 5000, 60);
    bench.write("PN.ACCSCALING", 100).unwrap();
    bench.write("PN.VELSCALING", 819).unwrap();
    bench.send(0x050F, 5000, 10);
    near(&bench, 10.0 * 0.016 * 100.0);
    bench.send(0x050F, 5000, 60);
    near(&bench, 273.0 * 12_000.0 / 32_768.0);
}

#[test]
fn ramp_enable_freeze_and_setpoint_enable() {
    let mut bench = Bench::new();
    bench.run(0);
    bench.write("DRV.ACC", 1_000_000).unwrap();
    bench.write("DRV.DEC", 500_000).unwrap();
    let command = |bench: &Bench| bench.read("VL.CMD_32") as f64 / 1000.0;
    bench.send(0x047F, 5000, 20);
    assert!((command(&bench) - 320.0).abs() < 0.1, "{}", command(&bench));
    // Bit 5: the drive stays at its velocity, whatever the setpoint does.
    bench.send(0x045F, 0, 20);
    assert!((command(&bench) - 320.0).abs() < 0.1);
    bench.send(0x045F, 5000, 1);
    // Bit 6: velocity 0, along DRV.DEC.
    bench.send(0x043F, 5000, 10);
    assert!(
        (command(&bench) - (320.0 - 80.0)).abs() < 0.1,
        "{}",
        command(&bench)
    );
    // Bit 5 counts before bit 6, bit 4 before both.
    bench.send(0x041F, 5000, 10);
    assert!((command(&bench) - 240.0).abs() < 0.1);
    bench.send(0x040F, 5000, 1);
    assert_eq!(command(&bench), 0.0, "at the limits of the drive");
    assert_eq!(bench.drive.state(), State::S4);
    // And up again along DRV.ACC.
    bench.send(0x047F, 5000, 40);
    let before = command(&bench);
    bench.send(0x047F, 5000, 10);
    assert!(
        (command(&bench) - before - 160.0).abs() < 0.1,
        "{before} {}",
        command(&bench)
    );
}

/// 5.4 bit 3: without it the drive goes from S4 to S3 and the axis coasts; with it again the drive takes over at that speed.
#[test]
fn without_operation_enabled_the_axis_coasts_in_s3() {
    let mut bench = Bench::new();
    bench.run(1638);
    bench.write("DRV.DEC", 10_000_000).unwrap(); // a ramp stop would take one cycle
    let zsw1 = bench.send(0x0477, 1638, 5);
    assert_eq!((bench.drive.state(), zsw1 & 0x0277), (State::S3, 0x0233));
    assert!(bench.read("VL.FB_32") > 300_000, "{}", bench.read("VL.FB_32"));
    bench.send(0x047F, 1638, 1);
    assert_eq!(bench.drive.state(), State::S4);
    assert!(bench.read("VL.FB_32") > 300_000, "{}", bench.read("VL.FB_32"));
}

#[test]
fn in_current_mode_the_setpoint_is_il_cmd_fieldbus() {
    let mut drive = Drive::new(&crate::model::AKD);
    let set = |drive: &mut Drive, pnu: u16, word: u16, raw: i64| {
        let position = drive.model().catalogue.position(pnu).unwrap();
        drive.set_element(position, word, raw)
    };
    set(&mut drive, 922, 0, 400).unwrap();
    set(&mut drive, 915, 1, 102).unwrap();
    set(&mut drive, 915, 2, 5).unwrap();
    set(&mut drive, 2135, 0, 0).unwrap();
    drive.connect(400, Duration::from_millis(48)).unwrap();
    let mut now = Instant::ZERO;
    let mut inputs = [0; 24];
    let mut send = |drive: &mut Drive, control: u16, current: i16, speed: i16, cycles: usize| {
        let [a, b] = control.to_be_bytes();
        let [c, d] = current.to_be_bytes();
        let [e, f] = speed.to_be_bytes();
        for _ in 0..cycles {
            now += Duration::from_millis(16);
            drive.tick(now, Some(&[a, b, c, d, e, f]), &mut inputs);
        }
        (u16::from_be_bytes([inputs[0], inputs[1]]), drive.axis().current())
    };
    send(&mut drive, 0x047E, 0, 0, 3);
    send(&mut drive, 0x047F, 0, 5000, 10);
    assert_eq!(drive.axis().speed(), 0.0, "NSOLL_A is no setpoint of this mode");
    let (status, current) = send(&mut drive, 0x047F, 910, 5000, 10);
    assert!((current - 910.0 * 9.0 / 16_384.0).abs() < 1e-9, "{current}"); // 2^14 is DRV.IPEAK, 9 A
    assert_eq!(status & (IN_RANGE | REACHED), 0);
    assert!(drive.axis().speed() > 100.0, "it accelerates");
    let (_, held) = send(&mut drive, 0x045F, 0, 0, 5);
    assert_eq!(held, current, "frozen");
    for closed in [0x043F, 0x046F, 0x040F, 0x050F] {
        assert_eq!(send(&mut drive, closed, 910, 0, 1).1, 0.0, "{closed:#06x}");
    }
    let (_, negative) = send(&mut drive, 0x047F, -910, 0, 1);
    assert_eq!(negative, -current);
    // OFF1 ends it at standstill as in every mode.
    send(&mut drive, 0x047E, 910, 0, 200);
    assert_eq!(drive.state(), State::S2);
    // In the other modes the signal does nothing.
    for mode in [1, 2] {
        set(&mut drive, 2135, 0, mode).unwrap();
        send(&mut drive, 0x047F, 910, 0, 40);
        assert_eq!(drive.state(), State::S4);
        assert!(drive.axis().speed().abs() < 0.1, "{}", drive.axis().speed());
        send(&mut drive, 0x047E, 910, 0, 40);
    }
}

#[test]
fn a_hardware_limit_switch_stops_the_axis_and_lets_it_out_again() {
    const TURN: i64 = 1 << 32;
    for sign in [1_i64, -1] {
        let mut bench = Bench::new();
        let mut plant = crate::model::AKD.plant;
        plant.travel = Some(crate::axis::Travel {
            positive_switch: 3 * TURN,
            negative_switch: -3 * TURN,
            ..crate::axis::Travel::FREE
        });
        bench.drive.set_plant(plant);
        let (state, warning) = if sign > 0 {
            ("HWLS.POSSTATE", 107)
        } else {
            ("HWLS.NEGSTATE", 108)
        };
        let turns = |bench: &Bench| bench.drive.axis().position() as f64 / TURN as f64 * sign as f64;
        bench.run(0);
        let speed = 1638 * sign as i16; // 600 rpm
        bench.send(0x047F, speed, 200);
        // 600 rpm at 3000 rpm/s takes 1 revolution, and a cycle 0.16.
        assert!((3.9..4.2).contains(&turns(&bench)), "{}", turns(&bench));
        assert_eq!(bench.read("VL.FB_32"), 0);
        assert_eq!((bench.read(state), bench.read("DRV.WARNING1")), (1, warning));
        assert!(!bench.has(REACHED) && bench.has(0x0004), "{:#06x}", bench.status);
        // Neither a frozen ramp nor a jog leads farther in.
        let before = turns(&bench);
        bench.send(0x045F, speed, 50);
        bench.send(0x047F, speed, 50);
        assert!((turns(&bench) - before).abs() < 0.01);
        // Out: fine, and there it runs as ever.
        bench.send(0x047F, -speed, 40);
        assert_eq!(bench.read(state), 0);
        assert!(bench.has(REACHED) && turns(&bench) < 3.0);
    }
}

#[test]
fn a_switch_that_is_touched_on_a_frozen_ramp_stops_the_axis() {
    let mut bench = Bench::new();
    bench.run(1638);
    bench.send(0x045F, 1638, 20);
    assert!(bench.read("VL.FB_32") > 500_000);
    bench.drive.inject("limit+=on".parse().unwrap());
    bench.send(0x045F, 1638, 20);
    assert_eq!(bench.read("VL.FB_32"), 0);
    bench.drive.inject("limit+=auto".parse().unwrap());
    bench.send(0x047F, 1638, 60);
    assert!(bench.read("VL.FB_32") > 500_000);
}

/// Jog is a level, not an edge: it begins as soon as the axis is in S4 and stands with bits 4 to 6 at 0.
#[test]
fn jog_begins_by_the_level_of_its_bit() {
    let mut bench = Bench::new();
    bench.write("Jog v1", 273).unwrap(); // 100 rpm
    bench.send(0x047E, 0, 3);
    bench.send(0x050F, 0, 40);
    assert!((i32::from(bench.speed) - 273).abs() < 5, "{}", bench.speed);
    bench.send(0x040F, 0, 40);
    // While the axis turns by NSOLL_A it brakes first.
    bench.send(0x047F, -5000, 40);
    let before = bench.speed;
    bench.send(0x050F, -5000, 1);
    assert!(before < -4000 && bench.speed > before && bench.read("VL.CMD_32") <= 0);
    bench.send(0x050F, -5000, 80);
    assert!((i32::from(bench.speed) - 273).abs() < 5, "{}", bench.speed);
}
