//! The rows of the conformance checklist that concern an AKD: parameter access, profile parameters, state machine.

use super::tests::Bench;
use super::*;
use crate::model::AKD;
use profile::parameter::Refusal;

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

fn ask(bench: &mut Bench, request: &[u8]) -> Result<Vec<u8>, Refusal> {
    let mut out = [0; 240];
    bench
        .drive
        .serve(request, &mut out)
        .map(|length| out[..length].to_vec())
}

fn check(bench: &mut Bench, request: &str, response: &str) {
    let answer = ask(bench, &hex(request)).unwrap();
    assert_eq!(answer, hex(response), "{request} -> {answer:02X?}");
}

#[test]
fn a_parameter_access_on_block_level() {
    let mut bench = Bench::new();
    let bench = &mut bench;
    check(bench, "01 01 00 01 10 01 03 9A 00 00", "01 01 00 01 42 01 00 01"); // 1, 4
    check(bench, "07 01 00 01 10 01 03 9A 00 05", "07 81 00 01 44 01 00 04"); // 7
    check(bench, "0A 01 00 01 50 01 03 9A 00 00", "0A 81 00 01 44 01 00 16"); // 10
    let mut forty = vec![0x0D, 1, 0, 40];
    for _ in 0..40 {
        forty.extend([0x10, 1, 0x03, 0x9A, 0, 0]);
    }
    assert!(ask(bench, &forty).is_err()); // 13
    check(
        bench,
        "10 01 00 02 10 01 03 9A 00 00 10 01 FF FE 00 00",
        "10 81 00 02 42 01 00 01 44 01 00 00",
    ); // 16
    let mut large = vec![0x13, 1, 0, 39];
    for _ in 0..39 {
        large.extend([0x10, 8, 0x03, 0xB3, 0, 0]);
    }
    let answer = ask(bench, &large).unwrap(); // 19
    assert!(answer.len() <= 240 && answer[1] == 0x81);
    assert!(answer.windows(4).any(|block| block == [0x44, 1, 0, 0x15]));
    check(
        bench,
        "19 02 00 01 10 01 03 A2 00 00 50 01 00 01",
        "19 82 00 01 44 01 00 17",
    ); // 25
    check(
        bench,
        "1C 02 00 01 10 01 03 A2 00 00 42 01 00 01",
        "1C 02 00 01 00 00",
    ); // 28
    check(
        bench,
        "1F 02 00 01 10 01 08 57 00 00 41 01 02 00",
        "1F 02 00 01 00 00",
    ); // 31
    check(bench, "1F 01 00 01 10 01 08 57 00 00", "1F 01 00 01 41 01 02 00");
    check(bench, "19 01 01 01 10 01 03 9A 00 00", "19 81 01 01 44 01 00 19"); // other axis
    check(bench, "21 03 00 01 10 01 03 9A 00 00", "21 81 00 01 44 01 00 21");
    // AKD manual 3.6: reference 0 is reserved and mirrored, no elements of a single value are one.
    check(bench, "00 01 00 01 10 01 03 9A 00 00", "00 01 00 01 42 01 00 01");
    check(bench, "01 01 00 01 10 00 03 9A 00 00", "01 01 00 01 42 01 00 01");
    // It allows 0xEA elements; 117 words fill the block of 240 octets.
    let words = ask(bench, &hex("01 01 00 01 10 75 03 D4 00 00")).unwrap();
    assert_eq!((words.len(), &words[..6]), (240, &hex("01 01 00 01 42 75")[..]));
    check(
        bench,
        "01 01 00 01 10 EA 03 D4 00 00",
        "01 81 00 01 44 02 00 03 00 75",
    );
    // 34: address and value alternating instead of all addresses first
    let mixed = hex("22 02 00 02 10 01 08 57 00 00 41 01 02 00 10 01 03 A2 00 00 42 01 00 01");
    assert!(ask(bench, &mixed).map_or(true, |answer| answer[1] == 0x82));
}

#[test]
fn the_example_of_the_manual() {
    let mut bench = Bench::new();
    check(
        &mut bench,
        "05 02 00 01 10 01 03 A2 00 00 42 01 00 02",
        "05 02 00 01 00 00",
    );
    assert_eq!(bench.read("DRV.OPMODE"), 2);
}

#[test]
fn limits_read_only_and_unknown() {
    let mut bench = Bench::new();
    let bench = &mut bench;
    check(
        bench,
        "01 02 00 01 10 01 0B F8 00 00 42 01 07 D1",
        "01 82 00 01 44 01 00 02",
    ); // PN.VELSCALING 2001
    check(
        bench,
        "01 02 00 01 10 01 0B F8 00 00 42 01 07 D0",
        "01 02 00 01 00 00",
    );
    check(
        bench,
        "01 02 00 01 10 01 08 3E 00 00 41 01 01 00",
        "01 82 00 01 44 01 00 01",
    ); // DRV.ACTIVE
    check(
        bench,
        "01 02 00 01 10 01 08 3C 00 00 42 01 07 D1",
        "01 82 00 01 44 01 00 05",
    ); // DRV.ACC as a word
    check(
        bench,
        "01 02 00 01 10 01 08 3C 00 00 43 02 00 00 07 D1 00 00 07 D1",
        "01 82 00 01 44 01 00 18",
    );
    check(bench, "01 01 00 01 10 01 00 04 00 00", "01 81 00 01 44 01 00 00");
    check(
        bench,
        "01 02 00 01 10 01 08 4F 00 00 42 01 00 01",
        "01 82 00 01 44 01 00 11",
    ); // DRV.EN
    check(
        bench,
        "01 02 00 01 10 01 09 A5 00 00 42 01 00 01",
        "01 02 00 01 00 00",
    ); // DRV.NVSAVE
    check(bench, "01 01 00 01 10 01 09 A5 00 00", "01 01 00 01 42 01 00 00"); // a command reads 0
}

#[test]
fn c_descriptions_and_texts() {
    let mut bench = Bench::new();
    let answer = ask(&mut bench, &hex("2E 01 00 01 20 01 03 9A 00 00")).unwrap(); // 46
    assert_eq!((answer[4], answer[5], answer.len()), (0x0A, 46, 52));
    check(
        &mut bench,
        "34 01 00 01 30 01 03 9A 00 00",
        "34 81 00 01 44 01 00 0F",
    ); // 52
    // 49: the limits of the description are those enforced
    check(
        &mut bench,
        "35 01 00 01 20 01 0B F8 00 07",
        "35 01 00 01 0A 04 00 00 00 01",
    );
    check(
        &mut bench,
        "36 01 00 01 20 01 0B F8 00 08",
        "36 01 00 01 0A 04 00 00 07 D0",
    );
    for parameter in AKD.catalogue.parameters {
        let [high, low] = parameter.pnu.to_be_bytes();
        let answer = ask(&mut bench, &[1, 1, 0, 1, 0x20, 1, high, low, 0, 0]).unwrap();
        assert_eq!(answer.len(), 52, "{parameter:?}");
    }
}

#[test]
fn d_profile_parameters() {
    let mut bench = Bench::new();
    let bench = &mut bench;
    check(bench, "37 01 00 01 10 01 03 C5 00 00", "37 01 00 01 42 01 03 29"); // 55
    let list = ask(bench, &hex("3A 01 00 01 10 75 03 D4 00 00")).unwrap(); // 58, 117 elements of 980
    assert_eq!((list[1], list.len()), (1, 240));
    check(
        bench,
        "3D 01 00 01 10 02 03 93 00 00",
        "3D 01 00 01 42 02 00 01 00 05",
    ); // 61
    check(
        bench,
        "3D 01 00 01 10 02 03 94 00 00",
        "3D 01 00 01 42 02 00 02 00 06",
    );
    check(bench, "43 01 00 01 10 01 03 B0 00 00", "43 01 00 01 42 01 00 00"); // 67
    bench.drive.inject_fault(301, false);
    bench.drive.inject_fault(304, false);
    check(bench, "43 01 00 01 10 01 03 B0 00 00", "43 01 00 01 42 01 00 01");
    check(
        bench,
        "43 01 00 01 10 02 03 B3 00 00",
        "43 01 00 01 42 02 01 2D 01 30",
    );
    bench.send(0x047E, 0, 1);
    bench.send(0x04FE, 0, 1);
    check(
        bench,
        "46 01 00 01 10 03 03 B3 00 07",
        "46 01 00 01 42 03 00 00 01 2D 01 30",
    ); // 70
    check(
        bench,
        "46 01 00 01 10 02 03 B3 00 3F",
        "46 81 00 01 44 02 00 03 00 40",
    );
}

#[test]
fn every_parameter_reads_with_its_own_size_and_no_other_format() {
    let mut bench = Bench::new();
    for parameter in AKD.catalogue.parameters {
        let [high, low] = parameter.pnu.to_be_bytes();
        let answer = ask(&mut bench, &[9, 1, 0, 1, 0x10, 1, high, low, 0, 0]).unwrap();
        assert_eq!(answer[..4], [9, 1, 0, 1], "{parameter:?}");
        assert_eq!(
            (answer[4], answer[5]),
            (parameter.size.format_code(), 1),
            "{parameter:?}"
        ); // 133
        assert_eq!(
            answer.len(),
            6 + parameter.size.octets().next_multiple_of(2),
            "{parameter:?}"
        );
    }
}

#[test]
fn e_state_machine() {
    let mut bench = Bench::new();
    assert_eq!(bench.send(0x047F, 0, 10) & 0x0040, 0x0040); // 79
    for word in [0x0476, 0x047E] {
        let mut bench = Bench::new();
        assert_eq!(bench.send(word, 0, 2) & 0x0077, 0x0031); // 76
    }
    bench.run(1638);
    let status = bench.send(0x047E, 0, 4); // 82
    assert_eq!(status & 0x0042, 0x0002);
    assert_eq!(bench.send(0x047E, 0, 40) & 0x0077, 0x0031);
    bench.run(1638);
    bench.send(0x047B, 0, 1); // 85
    for _ in 0..40 {
        bench.send(0x047F, 1638, 1);
        assert_ne!(bench.drive.state(), State::S4);
    }
    assert_eq!(bench.status & 0x0077, 0x0070);
    assert_eq!(bench.send(0x047E, 0, 2) & 0x0077, 0x0031); // 88
    assert_eq!(bench.send(0x007F, 0, 5) & 0x0077, 0x0031); // 91
    bench.run(163);
    bench.drive.inject_fault(501, false);
    bench.send(0x047F, 163, 30);
    bench.send(0x047E, 0, 1); // 94
    assert_eq!(bench.send(0x04FE, 0, 1) & 0x0008, 0);
    assert_eq!(bench.send(0x047E, 0, 1) & 0x0077, 0x0031);
}

#[test]
fn hostile_requests_are_answered_or_refused() {
    let mut bench = Bench::new();
    let request = hex("05 02 00 02 10 01 03 A2 00 00 10 01 08 3C 00 00 42 01 00 01 43 01 00 00 10 00");
    for end in 0..request.len() {
        let _ = ask(&mut bench, &request[..end]);
    }
    for at in 0..request.len() {
        for bit in 0..8 {
            let mut flipped = request.clone();
            flipped[at] ^= 1 << bit;
            let _ = ask(&mut bench, &flipped);
        }
    }
}

#[test]
fn halves_of_a_64_bit_value() {
    let mut bench = Bench::new();
    let bench = &mut bench;
    // SWLS.LIMIT1, 2385 and 2386: 2^36 as delivered.
    let read = "01 01 00 02 10 01 09 51 00 00 10 01 09 52 00 00";
    check(bench, read, "01 01 00 02 43 01 00 00 00 00 43 01 00 00 00 10");
    // High half, then low half, in one request: one value.
    let write = "02 02 00 02 10 01 09 52 00 00 10 01 09 51 00 00 43 01 FF FF FF FE 43 01 80 00 00 01";
    check(bench, write, "02 02 00 02 00 00");
    check(bench, read, "01 01 00 02 43 01 80 00 00 01 43 01 FF FF FF FE");
    assert_eq!(bench.read("SWLS.LIMIT1"), -(1 << 32) - 0x7FFF_FFFF);
    // In two requests too, but not when another parameter comes in between.
    let (high, low) = (
        "03 02 00 01 10 01 09 52 00 00 43 01 00 00 00 05",
        "04 02 00 01 10 01 09 51 00 00 43 01 00 00 00 07",
    );
    check(bench, high, "03 02 00 01 00 00");
    check(bench, read, "01 01 00 02 43 01 80 00 00 01 43 01 FF FF FF FE"); // no effect yet
    check(bench, high, "03 02 00 01 00 00");
    check(bench, low, "04 02 00 01 00 00");
    assert_eq!(bench.read("SWLS.LIMIT1"), (5 << 32) + 7);
    check(bench, high, "03 02 00 01 00 00");
    check(bench, "05 01 00 01 10 01 03 9A 00 00", "05 01 00 01 42 01 00 01");
    check(bench, low, "04 02 00 01 00 00");
    assert_eq!(
        bench.read("SWLS.LIMIT1"),
        7,
        "the low half alone is the whole value"
    );
    // Alone it has its sign; beyond the limits it is refused as one value.
    check(
        bench,
        "04 02 00 01 10 01 09 51 00 00 43 01 FF FF FF FF",
        "04 02 00 01 00 00",
    );
    assert_eq!(bench.read("SWLS.LIMIT1"), -1);
    let beyond = "02 02 00 02 10 01 09 52 00 00 10 01 09 51 00 00 43 01 00 20 00 00 43 01 00 00 00 00";
    check(bench, beyond, "02 82 00 02 40 00 44 01 00 02");
    assert_eq!(bench.read("SWLS.LIMIT1"), -1);
    // A measured one: PL.FB 2294 is read-only in both halves.
    check(
        bench,
        "06 02 00 01 10 01 08 F7 00 00 43 01 00 00 00 00",
        "06 82 00 01 44 01 00 01",
    );
    // What is not a half is not a number.
    check(bench, "07 01 00 01 10 01 09 E1 00 00", "07 81 00 01 44 01 00 00");
}

#[test]
fn both_halves_are_of_one_sample() {
    let mut bench = Bench::new();
    bench.write("PN.POSSCALE", 1).unwrap();
    bench.run(163);
    let low = ask(&mut bench, &hex("01 01 00 01 10 01 08 F6 00 00")).unwrap();
    let before = bench.read("PL.FB");
    bench.send(0x047F, 163, 50);
    assert_ne!(bench.read("PL.FB"), before);
    let high = ask(&mut bench, &hex("01 01 00 01 10 01 08 F7 00 00")).unwrap();
    let octets = [&high[6..10], &low[6..10]].concat();
    assert_eq!(i64::from_be_bytes(octets.try_into().unwrap()), before);
}

/// The byte description of the AKD has format 0x00 in the answer to a write. Beside a refused parameter the written one
/// has the format Zero (0x40) without values, and it is written.
#[test]
fn a_parameter_written_beside_a_refused_one_has_format_zero() {
    let mut bench = Bench::new();
    check(
        &mut bench,
        "02 02 00 02 10 01 03 A2 00 00 10 01 00 02 00 00 42 01 00 02 42 01 00 02",
        "02 82 00 02 40 00 44 01 00 01",
    );
    assert_eq!(bench.read("930"), 2);
}
