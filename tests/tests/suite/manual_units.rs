//! Units and scalings of the AKD PROFINET manual (5.12 and 6) through the network: records and cyclic data.

use system_tests::bus::Bus;

const HOME_P: u16 = 2205;
/// PL.MODP1, which is saved.
const MODULO_END: u16 = 2303;
const POSITION_SCALE: u16 = 3014;
const VELOCITY_SCALING: u16 = 1009;
/// VL.CMD_32 in thousandths of rpm.
const SPEED_COMMAND: u16 = 2425;
const RAMPS: [u16; 2] = [2108, 2115];

fn words(control: u16, setpoint: i16) -> [u8; 4] {
    let mut data = [0; 4];
    data[..2].copy_from_slice(&control.to_be_bytes());
    data[2..].copy_from_slice(&setpoint.to_be_bytes());
    data
}

/// Returns a parameter as word or double word; the error number where it is refused.
fn write(bus: &mut Bus, pnu: u16, format: u8, value: u32) -> Option<u8> {
    let [high, low] = pnu.to_be_bytes();
    let mut request = vec![1, 2, 0, 1, 0x10, 1, high, low, 0, 0, format, 1];
    let octets = value.to_be_bytes();
    request.extend(match format {
        0x41 => &octets[3..],
        0x42 => &octets[2..],
        _ => &octets[..],
    });
    let answer = bus.job(&request);
    (answer[1] == 0x82).then(|| answer[7])
}

fn rpm(bus: &mut Bus) -> f64 {
    f64::from(bus.read(SPEED_COMMAND, 0) as i32) / 1000.0
}

/// Manual 6.5: NSOLL_A and NIST_A and nothing else. A jog that runs keeps its speed, a new one has it too.
#[test]
fn velocity_scaling_applies_only_to_nsoll_and_nist() {
    let mut bus = Bus::new();
    bus.connect(1);
    for ramp in RAMPS {
        assert_eq!(write(&mut bus, ramp, 0x43, 50_000_000), None);
    }
    assert_eq!(write(&mut bus, 1006, 0x42, 60), None);
    assert_eq!(write(&mut bus, 1007, 0x42, 60), None);
    assert_eq!(write(&mut bus, 1004, 0x42, 2731), None);
    let jog = 2731.0 * 12_000.0 / 32_768.0;
    bus.send(&words(0x047E, 0), 5);
    bus.send(&words(0x040F, 0), 5);
    bus.send(&words(0x050F, 0), 20);
    assert!((rpm(&mut bus) - jog).abs() < 0.5, "{} {jog}", rpm(&mut bus));
    assert_eq!(write(&mut bus, VELOCITY_SCALING, 0x42, 819), None);
    bus.send(&words(0x050F, 0), 20);
    assert!((rpm(&mut bus) - jog).abs() < 0.5, "{} {jog}", rpm(&mut bus));
    assert_eq!(bus.read(1004, 0), 2731);
    // the signals have the new steps
    let actual = bus.send(&words(0x050F, 0), 20);
    let step = 819.0 * 960_000.0 / 4_294_967_296.0;
    let speed = f64::from(i16::from_be_bytes([actual[2], actual[3]])) * step;
    assert!((speed - jog).abs() < 5.0, "{speed} {jog}");
    bus.send(&words(0x040F, 0), 20);
    bus.send(&words(0x047F, 2731), 40);
    let speed = 2731.0 * step;
    assert!((rpm(&mut bus) - speed).abs() < 0.5, "{} {speed}", rpm(&mut bus));
}

/// Manual 6.2: PNU value = parameter / PN.POSSCALE. Another scale changes the number that is read and no position.
#[test]
fn position_scale_changes_what_is_read_and_no_position() {
    let mut bus = Bus::new();
    bus.connect(9);
    assert_eq!(write(&mut bus, HOME_P, 0x43, 1_234_567), None);
    assert_eq!(write(&mut bus, 2209, 0x42, 1), None); // HOME.SET: the axis is there
    assert_eq!(bus.read(2294, 0), 1_234_567);
    for (scale, number) in [
        (1, 1_234_567_000),
        (1_000_000, 1235),
        (500, 2_469_134),
        (1000, 1_234_567),
    ] {
        assert_eq!(write(&mut bus, POSITION_SCALE, 0x43, scale), None);
        assert_eq!(
            (bus.read(HOME_P, 0), bus.read(2294, 0)),
            (number, number),
            "{scale}"
        );
        assert_eq!(write(&mut bus, 2209, 0x42, 1), None);
    }
    // what is written is a number in the scale of that moment
    assert_eq!(write(&mut bus, POSITION_SCALE, 0x43, 1), None);
    assert_eq!(write(&mut bus, HOME_P, 0x43, 2_000_500), None);
    assert_eq!(write(&mut bus, POSITION_SCALE, 0x43, 1_000_000), None);
    assert_eq!(bus.read(HOME_P, 0), 2);
    // saved and fetched again under another scale: the position stays
    assert_eq!(write(&mut bus, POSITION_SCALE, 0x43, 1), None);
    assert_eq!(write(&mut bus, MODULO_END, 0x43, 2_000_500), None);
    assert_eq!(write(&mut bus, POSITION_SCALE, 0x43, 1_000_000), None);
    assert_eq!(write(&mut bus, 2469, 0x42, 1), None); // DRV.NVSAVE
    assert_eq!(write(&mut bus, MODULO_END, 0x43, 7), None);
    assert_eq!(write(&mut bus, 2788, 0x42, 1), None); // DRV.NVLOAD
    assert_eq!(write(&mut bus, POSITION_SCALE, 0x43, 1), None);
    assert_eq!(bus.read(MODULO_END, 0), 2_000_500);
}

/// Manual 5.12.3 against 6.1: PN.ACCSCALING (PNU 1008) scales MDI_ACC and MDI_DEC too.
#[test]
fn acceleration_scaling_is_for_mdi_too() {
    let mut bus = Bus::new();
    bus.connect(9);
    assert_eq!(write(&mut bus, 930, 0x42, 2), None);
    let mut words = [0; 20];
    words[10..14].copy_from_slice(&(1_u32 << 30).to_be_bytes()); // 3000 rpm
    words[14..18].copy_from_slice(&[0, 20, 0, 20]);
    let mut send = |bus: &mut Bus, control: u16, cycles: u32| {
        words[..2].copy_from_slice(&control.to_be_bytes());
        bus.send(&words, cycles);
        rpm(bus)
    };
    let mut speed_after = |bus: &mut Bus| {
        for control in [0x0430, 0x0436, 0x0437, 0x043F] {
            send(bus, control, 10);
        }
        // real-time jogging along MDI_ACC for 5 cycles of 16 ms
        let speed = send(bus, 0x143F, 5);
        send(bus, 0x043F, 200);
        speed
    };
    let before = speed_after(&mut bus);
    assert_eq!(write(&mut bus, 1008, 0x42, 1526), None);
    let after = speed_after(&mut bus);
    assert!(
        before > 500.0 && (after / before - 2.0).abs() < 0.1,
        "{before} {after}"
    );
}
