//! The sequences of position mode of the AKD PROFINET manual, byte for byte, through the network: 5.10.1 with telegram 7,
//! 5.10.2 with telegram 9 and the handshake of its figure, 5.10.3.
//!
//! The manual prints no octets of the status word here but describes it bit by bit; the words below are those bits.

use system_tests::bus::{Bus, CONTROLLER, DRIVE};
use system_tests::traffic::{Content, content};

/// Data of the cyclic frames: (from the drive, telegram).
fn telegrams(frames: &[Vec<u8>], outputs: usize, inputs: usize) -> Vec<(bool, Vec<u8>)> {
    let mut found = Vec::new();
    for bytes in frames {
        if let Content::Profinet(frame) = content(bytes)
            && frame.frame_id.is_cyclic()
        {
            let drive = frame.source == DRIVE;
            assert!(drive || frame.source == CONTROLLER);
            // Behind VLAN tag, EtherType and frame ID: the states of slot 0, then the telegram.
            let data = &bytes[20..];
            found.push((
                drive,
                if drive {
                    data[3..3 + inputs].to_vec()
                } else {
                    data[4..4 + outputs].to_vec()
                },
            ));
        }
    }
    found
}

/// A controller's program: sends, and keeps each telegram that went to and fro.
struct Program {
    bus: Bus,
    outputs: usize,
    inputs: usize,
}

impl Program {
    /// Connected in position mode (5.10: PNU 930 = 2).
    fn new(telegram: u16, outputs: usize, inputs: usize) -> Self {
        let mut bus = Bus::new();
        bus.connect(telegram);
        let request = [
            0x05, 0x02, 0x00, 0x01, 0x10, 0x01, 0x03, 0xA2, 0x00, 0x00, 0x42, 0x01, 0x00, 0x02,
        ];
        assert_eq!(bus.job(&request), [0x05, 0x02, 0x00, 0x01, 0x00, 0x00]);
        Self { bus, outputs, inputs }
    }

    /// Sends this for some cycles; the answers of the drive, with what stood in the frames compared.
    fn send(&mut self, words: &[u8], cycles: u32) -> Vec<Vec<u8>> {
        let _ = self.bus.frames();
        self.bus.send(words, cycles);
        let seen = telegrams(&self.bus.frames(), self.outputs, self.inputs);
        let sent: Vec<_> = seen.iter().filter(|(drive, _)| !drive).collect();
        assert!(
            sent.iter().all(|(_, data)| data[..] == *words),
            "{words:02X?} {sent:02X?}"
        );
        seen.into_iter()
            .filter(|(drive, _)| *drive)
            .map(|(_, data)| data)
            .collect()
    }

    /// Sends this until the status word, under the mask, has a value; all answers.
    fn until(&mut self, words: &[u8], mask: u16, value: u16) -> Vec<Vec<u8>> {
        let mut all = Vec::new();
        for _ in 0..500 {
            all.extend(self.send(words, 1));
            if all.last().is_some_and(|last| word(last) & mask == value) {
                return all;
            }
        }
        panic!("{mask:04X} {value:04X}: {:02X?}", all.last());
    }

    /// To S4 as in 5.9, without bit 6: 0x0430, 0x0436, 0x0437, 0x043F.
    fn enable(&mut self) {
        let mut words = vec![0; self.outputs];
        for (step, state) in [(0x30, 0x40), (0x36, 0x31), (0x37, 0x33), (0x3F, 0x37)] {
            words[..2].copy_from_slice(&[0x04, step]);
            let answers = self.send(&words, 4);
            assert_eq!(answers.last().unwrap()[1], state, "{step:02X}: {answers:02X?}");
        }
    }

    /// A parameter as double word or word.
    fn write(&mut self, pnu: u16, value: u32, double: bool) {
        let [a, b] = pnu.to_be_bytes();
        let mut request = vec![
            1,
            2,
            0,
            1,
            0x10,
            1,
            a,
            b,
            0,
            0,
            if double { 0x43 } else { 0x42 },
            1,
        ];
        let bytes = value.to_be_bytes();
        request.extend(if double { &bytes[..] } else { &bytes[2..] });
        assert_eq!(self.bus.job(&request), [1, 2, 0, 1, 0, 0], "PNU {pnu}");
    }
}

fn word(data: &[u8]) -> u16 {
    u16::from_be_bytes([data[0], data[1]])
}

/// Returns the words that followed each other, each once.
fn course(answers: &[Vec<u8>], mask: u16) -> Vec<u16> {
    let mut course: Vec<u16> = answers.iter().map(|data| word(data) & mask).collect();
    course.dedup();
    course
}

/// 5.10.3, by STW1 bit 11, to the next index pulse: bits 10, 11 and 13 are 0 while it runs and 1 when it is done.
fn home(program: &mut Program, mode: u32, words: &mut [u8]) {
    program.write(2203, mode, false); // HOME.MODE
    words[..2].copy_from_slice(&[0x04, 0x3F]);
    program.send(words, 2);
    words[..2].copy_from_slice(&[0x0C, 0x3F]);
    let answers = program.until(words, 0x2C00, 0x2C00);
    let course = course(&answers, 0x2C00);
    // The frame that was on its way still has what was before.
    let running = course.iter().position(|bits| *bits == 0).expect("it runs");
    assert_eq!(course[running..], [0x0000, 0x2C00], "{course:04X?}");
    words[..2].copy_from_slice(&[0x04, 0x3F]);
    let answers = program.send(words, 3);
    assert_eq!(word(answers.last().unwrap()), 0x2F37, "{answers:02X?}");
}

#[test]
fn program_mode_5_10_1() {
    let mut program = Program::new(7, 4, 4);
    program.enable();
    let mut words = [0x04, 0x3F, 0, 0];
    let before = program.send(&words, 2);
    assert_eq!(word(before.last().unwrap()), 0x2337, "not homed");
    home(&mut program, 0, &mut words);
    // A motion task needs to be configured: task 12, 5 revolutions, 600 rpm, 6000 rpm/s.
    for (pnu, value, double) in [
        (2274, 12, false),        // MT.NUM is a byte: see below
        (2275, 5 * 65_536, true), // MT.P
        (2283, 600_000, true),    // MT.V
        (2263, 6_000_000, true),  // MT.ACC
        (2268, 6_000_000, true),  // MT.DEC
        (2266, 0, true),          // MT.CNTL
    ] {
        if pnu == 2274 {
            let request = [1, 2, 0, 1, 0x10, 1, 0x08, 0xE2, 0, 0, 0x41, 1, value as u8, 0];
            assert_eq!(program.bus.job(&request), [1, 2, 0, 1, 0, 0]);
        } else {
            program.write(pnu, value, double);
        }
    }
    program.write(2277, 1, false); // MT.SET
    // SATZANW to the number, bits 4 and 5 true, bit 6 from 0 to 1.
    let answers = program.send(&[0x04, 0x3F, 0x00, 0x0C], 3);
    assert_eq!(answers.last().unwrap()[..], [0x2F, 0x37, 0x00, 0x00]);
    let answers = program.until(&[0x04, 0x7F, 0x00, 0x0C], 0x1400, 0x1400);
    // Bit 13 goes from one to zero when the axis starts moving; bit 10 is set after the target is reached.
    let course = course(&answers, 0xFFFF);
    let started = course.iter().position(|bits| bits & 0x4000 != 0).unwrap();
    assert_eq!(course[started..], [0x5B37, 0x3F37], "{course:04X?}");
    assert!(
        answers[2..answers.len() - 1]
            .iter()
            .all(|data| data[2..] == [0x00, 0x0C])
    );
    assert_eq!(answers.last().unwrap()[..], [0x3F, 0x37, 0x00, 0x00]);
    let turns = program.bus.station().drive().axis().position() as f64 / 4_294_967_296.0;
    assert!((turns - 5.0).abs() < 0.01, "{turns}");
    program.bus.judged("manual-5-10-1");
}

#[test]
fn an_intermediate_stop_goes_on_through_bit_5_5_10_1() {
    let mut program = Program::new(7, 4, 4);
    program.enable();
    let mut words = [0x04, 0x3F, 0, 0];
    home(&mut program, 0, &mut words);
    let request = [1, 2, 0, 1, 0x10, 1, 0x08, 0xE2, 0, 0, 0x41, 1, 1, 0];
    assert_eq!(program.bus.job(&request), [1, 2, 0, 1, 0, 0]);
    for (pnu, value) in [
        (2275, 20 * 65_536),
        (2283, 600_000),
        (2263, 6_000_000),
        (2268, 6_000_000),
    ] {
        program.write(pnu, value, true);
    }
    program.write(2277, 1, false);
    program.send(&[0x04, 0x7F, 0, 1], 10);
    let answers = program.until(&[0x04, 0x5F, 0, 1], 0x2000, 0x2000);
    assert_eq!(course(&answers, 0x7400), [0x5000, 0x7000], "stays active");
    assert_eq!(answers.last().unwrap()[2..], [0, 1]);
    let answers = program.until(&[0x04, 0x7F, 0, 1], 0x0400, 0x0400);
    assert!(
        course(&answers, 0x7400).ends_with(&[0x5000, 0x3400]),
        "{answers:02X?}"
    );
    program.bus.judged("manual-5-10-1-pause");
}

/// STW1 and SATZANW with bit 15, STW2, MDI_TARPOS, MDI_VELOCITY, MDI_ACC, MDI_DEC, MDI_MOD.
fn mdi(control: u16, position: i32, velocity: u32, ramp: u16, mode: u16) -> Vec<u8> {
    let mut words = Vec::new();
    words.extend(control.to_be_bytes());
    words.extend([0x80, 0x00, 0x00, 0x00]);
    words.extend(position.to_be_bytes());
    words.extend(velocity.to_be_bytes());
    words.extend(ramp.to_be_bytes());
    words.extend(ramp.to_be_bytes());
    words.extend(mode.to_be_bytes());
    words
}

#[test]
fn mdi_with_the_handshake_of_the_figure_5_10_2() {
    let mut program = Program::new(9, 20, 10);
    program.enable();
    let mut words = mdi(0x043F, 0, 0, 0, 0);
    home(&mut program, 0, &mut words);
    // 300 rpm is 2^32 / 40; 4 steps of 763 rpm/s; 2.5 revolutions, absolute.
    let velocity = 0x0666_6666;
    let to = |control, position| mdi(control, position, velocity, 4, 1);
    let first = 0x0002_8000;
    assert_eq!(
        to(0x043F, first),
        [
            4, 0x3F, 0x80, 0, 0, 0, 0, 2, 0x80, 0, 6, 0x66, 0x66, 0x66, 0, 4, 0, 4, 0, 1
        ]
    );
    // 1: values are valid, bit 6 is 0, bit 12 is 0.
    let answers = program.send(&to(0x043F, first), 4);
    assert_eq!(word(answers.last().unwrap()), 0x2F37);
    // 2, 3: the edge; the drive acknowledges when the task starts.
    let answers = program.until(&to(0x047F, first), 0x1000, 0x1000);
    assert_eq!(word(answers.last().unwrap()) & 0xFCFF, 0x5837, "{answers:02X?}");
    assert_eq!(answers.last().unwrap()[2..4], [0x80, 0x00]);
    // 4, 5: the controller clears bit 6, the drive bit 12; the task goes on.
    let answers = program.until(&to(0x043F, first), 0x1000, 0);
    assert_eq!(word(answers.last().unwrap()) & 0x7C00, 0x4800);
    // 6: another one before it is done, on the fly: back by one revolution from there.
    let second = 0x0000_8000;
    let answers = program.until(&to(0x047F, second), 0x1000, 0x1000);
    assert_eq!(word(answers.last().unwrap()) & 0x7C00, 0x5800);
    let answers = program.until(&to(0x043F, second), 0x1400, 0x0400);
    assert!(
        answers
            .iter()
            .all(|data| word(data) & 0x2000 == 0 || word(data) & 0x0400 != 0),
        "bit 13 while it moves: {answers:02X?}"
    );
    let answers = program.send(&to(0x043F, second), 10);
    let last = answers.last().unwrap();
    assert_eq!(last[..4], [0x2F, 0x37, 0x00, 0x00], "{last:02X?}");
    let position = i32::from_be_bytes([last[6], last[7], last[8], last[9]]);
    assert!((position - second).abs() < 100, "XIST_A {position:#x}");
    // A task that cannot run is not acknowledged: the speed is 0. The warning says why.
    let answers = program.send(&mdi(0x047F, first, 0, 4, 1), 20);
    assert_eq!(course(&answers[3..], 0x1080), [0x0080], "{answers:02X?}");
    assert_eq!(program.bus.read(2791, 0), 159);
    assert_ne!(program.bus.read(2134, 0) & 1 << 10, 0);
    program.bus.judged("manual-5-10-2");
}

#[test]
fn homing_5_10_3_and_its_abort() {
    let mut program = Program::new(9, 20, 10);
    program.enable();
    let mut words = mdi(0x043F, 0, 0, 0, 0);
    // To the next index pulse; DRV.MOTIONSTAT shows it too.
    home(&mut program, 11, &mut words);
    assert_eq!(program.bus.read(2134, 0) & 0b11110, 0b00110);
    assert_eq!(
        program.bus.read(2294, 0).cast_signed().abs() / 100,
        0,
        "PL.FB at HOME.P"
    );
    // Abort: clear bit 11 while it runs. The home position stays cleared.
    program.write(2203, 12, false);
    words[..2].copy_from_slice(&[0x0C, 0x3F]);
    let answers = program.send(&words, 20);
    assert_eq!(word(answers.last().unwrap()) & 0x2C00, 0);
    words[..2].copy_from_slice(&[0x04, 0x3F]);
    let answers = program.until(&words, 0x2000, 0x2000);
    assert_eq!(word(answers.last().unwrap()) & 0x2C00, 0x2000);
    // Without a home position no task runs.
    let answers = program.send(&mdi(0x047F, 65_536, 0x0666_6666, 4, 1), 10);
    assert_eq!(word(answers.last().unwrap()) & 0x5000, 0);
    program.bus.judged("manual-5-10-3");
}

/// 5.10.3 "STW1 Bit 11 set to one": an edge in S4. A word that enables the axis with bit 11 already set moves nothing.
#[test]
fn homing_begins_with_an_edge_of_bit_11_in_s4() {
    let mut program = Program::new(9, 20, 10);
    program.write(2203, 11, false); // HOME.MODE: to the next index pulse
    let mut words = mdi(0x0436, 0, 0, 0, 0);
    program.send(&words, 4);
    let place = program.bus.station().drive().axis().position();
    words[..2].copy_from_slice(&[0x0C, 0x3F]);
    let answers = program.send(&words, 60);
    assert_eq!(word(answers.last().unwrap()), 0x2337, "{answers:02X?}");
    let moved = program.bus.station().drive().axis().position() - place;
    assert!(moved.abs() < 1 << 20, "{moved}");
    words[..2].copy_from_slice(&[0x04, 0x3F]);
    program.send(&words, 2);
    words[..2].copy_from_slice(&[0x0C, 0x3F]);
    program.until(&words, 0x2C00, 0x2C00);
    // still 1 when homing is done: it does not begin again
    let answers = program.send(&words, 60);
    assert_eq!(course(&answers, 0x2C00), [0x2C00]);
    program.bus.judged("manual-5-10-3-edge");
}
