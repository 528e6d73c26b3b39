//! What the vendors' manuals say of requests and answers, table by table, against the virtual drives.
//!
//! Source: Danfoss FC parameter block description p. 73, MG06G102 5.5 to 5.8, Vacon OPTEA manual tables 81 and 82.

use virtual_drive::drive::Injection;
use virtual_drive::station::StationEvent;

use super::bench::{Bench, VACON, VLT};
use super::channel::Line;

/// Drive stopped with valid data, FC profile; and started.
const STOP: u16 = 0x043C;
const START: u16 = 0x047C;

/// The parameter block of the answer while the drive stands.
fn asked(line: &mut Line, request: [u8; 8]) -> Vec<u8> {
    let data = line.channel(request, STOP, 0);
    data[..data.len() - 4].to_vec()
}

fn is_saved(line: &mut Line, text: &str) -> bool {
    std::iter::from_fn(|| line.station.poll_event()).any(|event| match event {
        StationEvent::PersistParameters {
            text: kept, asked, ..
        } => asked && kept.contains(text),
        _ => false,
    })
}

#[test]
fn every_command_of_the_fc_parameter_block_and_its_reply() {
    let mut line = Line::new();
    // 0000: no command, no reply
    assert_eq!(asked(&mut line, [0; 8]), [0; 8]);
    // 0001: read, word and double word (1-22, 3-41)
    assert_eq!(
        asked(&mut line, [0x10, 0x7A, 0, 0, 0, 0, 0, 0]),
        [0x10, 0x7A, 0, 0, 0, 0, 0x01, 0x90]
    );
    assert_eq!(
        asked(&mut line, [0x11, 0x55, 0, 0, 0, 0, 0, 0]),
        [0x21, 0x55, 0, 0, 0, 0, 0x01, 0x2C]
    );
    // 0010 and 0011: write to the RAM, word and double word (3-19, 3-41)
    assert_eq!(
        asked(&mut line, [0x21, 0x3F, 0, 0, 0, 0, 0, 200]),
        [0x11, 0x3F, 0, 0, 0, 0, 0, 200]
    );
    assert_eq!(
        asked(&mut line, [0x31, 0x55, 0, 0, 0, 0, 0x02, 0]),
        [0x21, 0x55, 0, 0, 0, 0, 0x02, 0]
    );
    assert!(!is_saved(&mut line, ""), "the RAM");
    // 1101 and 1110: to RAM and EEPROM, double word and word
    assert_eq!(
        asked(&mut line, [0xD1, 0x55, 0, 0, 0, 0, 0x02, 1]),
        [0x21, 0x55, 0, 0, 0, 0, 0x02, 1]
    );
    assert!(is_saved(&mut line, "\n3-41 = 5.13"));
    assert_eq!(
        asked(&mut line, [0xE1, 0x3F, 0, 0, 0, 0, 0, 201]),
        [0x11, 0x3F, 0, 0, 0, 0, 0, 201]
    );
    assert!(is_saved(&mut line, "\n3-19 = 201"));
    // 1111: read a text
    assert_eq!(
        asked(&mut line, [0xF6, 0x04, 0x04, 0, 0, 0, 0, 0]),
        *b"\xF6\x04\x04\x00FC-302"
    );
    // the index of an array is the low octet of IND (3-10[2])
    assert_eq!(
        asked(&mut line, [0x21, 0x36, 0, 2, 0, 0, 0x0B, 0xB8]),
        [0x11, 0x36, 0, 2, 0, 0, 0x0B, 0xB8]
    );
    assert_eq!(
        asked(&mut line, [0x11, 0x36, 0, 2, 0, 0, 0, 0]),
        [0x11, 0x36, 0, 2, 0, 0, 0x0B, 0xB8]
    );
    assert_eq!(
        asked(&mut line, [0x11, 0x36, 0, 1, 0, 0, 0, 0]),
        [0x11, 0x36, 0, 1, 0, 0, 0, 0]
    );
}

#[test]
fn every_error_message_of_the_fc_parameter_block() {
    let mut line = Line::new();
    let refused = |answer: &[u8]| {
        assert_eq!(answer[0] & 0xF0, 0x70, "{answer:02X?}");
        u16::from_be_bytes([answer[6], answer[7]])
    };
    for (number, request) in [
        // 2-07 is not there
        (0, [0x10, 0xCF, 0, 0, 0, 0, 0, 0]),
        // 16-13 is a read-out
        (1, [0x26, 0x4D, 0, 0, 0, 0, 0, 1]),
        // 3-41 up to 3600.00 s
        (2, [0x31, 0x55, 0, 0, 0, 0x10, 0, 0]),
        // 3-10 has eight elements
        (3, [0x11, 0x36, 0, 8, 0, 0, 0, 0]),
        // 3-41 is not an array
        (4, [0x11, 0x55, 0, 1, 0, 0, 0, 0]),
        // 15-60 has eight texts, 0-37 and 0-39 one each, read and written
        (3, [0xF6, 0x18, 0x04, 8, 0, 0, 0, 0]),
        (4, [0xF0, 0x25, 0x04, 1, 0, 0, 0, 0]),
        (4, [0xF0, 0x25, 0x05, 1, b'f', b'a', b'n', b' ']),
        (4, [0xF0, 0x27, 0x04, 2, 0, 0, 0, 0]),
        // AK 15 that neither reads nor writes
        (253, [0xF0, 0x25, 0x00, 0, 0, 0, 0, 0]),
        (253, [0xF0, 0x25, 0x06, 0, 0, 0, 0, 0]),
        // 3-41 is a double word
        (5, [0x21, 0x55, 0, 0, 0, 0, 0, 1]),
    ] {
        assert_eq!(refused(&asked(&mut line, request)), number, "{request:02X?}");
    }
    // 17: motor data while the motor runs; the same value is not a change, and a ramp can be changed
    line.channel([0; 8], START, 0x2000);
    let nominal_voltage = [0x20, 0x7A, 0, 0, 0, 0, 0x01, 0x7C];
    assert_eq!(refused(&line.channel(nominal_voltage, START, 0x2000)), 17);
    let same = [0x20, 0x7A, 0, 0, 0, 0, 0x01, 0x90];
    assert_eq!(line.channel(same, START, 0x2000)[0], 0x10);
    assert_eq!(
        line.channel([0x31, 0x55, 0, 0, 0, 0, 0x02, 0], START, 0x2000)[0],
        0x21
    );
    line.channel([0; 8], 0x0434, 0);
    assert_eq!(line.channel(nominal_voltage, 0x0434, 0)[0], 0x10);
    // 131: the factory set-up is the one that is edited (0-11)
    assert_eq!(asked(&mut line, [0x20, 0x0B, 0, 0, 0, 0, 0, 0])[0], 0x10);
    assert_eq!(refused(&asked(&mut line, [0x31, 0x55, 0, 0, 0, 0, 0x02, 0])), 131);
}

/// USS has the four words of the FC protocol, so no text.
#[test]
fn the_commands_of_the_fc_parameter_block_over_uss() {
    let mut line = Line::uss();
    // the index is the low octet of IND (3-10[2]), bit 11 of PKE is part of the number
    assert_eq!(
        asked(&mut line, [0x21, 0x36, 0, 2, 0, 0, 0x0B, 0xB8]),
        [0x11, 0x36, 0, 2, 0, 0, 0x0B, 0xB8]
    );
    assert_eq!(
        asked(&mut line, [0x11, 0x36, 0, 1, 0, 0, 0, 0]),
        [0x11, 0x36, 0, 1, 0, 0, 0, 0]
    );
    assert_eq!(
        asked(&mut line, [0x19, 0x55, 0, 0, 0, 0, 0, 0]),
        [0x79, 0x55, 0, 0, 0, 0, 0, 0]
    );
    // 1101 and 1110 write to the EEPROM
    for request in [
        [0xD1, 0x55, 0, 0, 0, 0, 0x02, 1],
        [0xE1, 0x3F, 0, 0, 0, 0, 0, 201],
    ] {
        asked(&mut line, request);
    }
    assert!(is_saved(&mut line, "\n3-19 = 201"));
    // 1111 is refused, whatever IND says
    for ind in [0, 4, 5] {
        assert_eq!(
            asked(&mut line, [0xF0, 0x25, ind, 0, 0, 0, 0, 0]),
            [0x70, 0x25, ind, 0, 0, 0, 0, 253]
        );
    }
}

#[test]
fn request_header_and_addresses_of_a_vlt() {
    let mut bench = Bench::new(&VLT);
    // the request number comes back
    for number in ["01", "7F", "FF"] {
        let answer = bench.ask(&format!("{number} 01 00 01 10 01 03 9A 00 00"));
        assert_eq!(answer[0], u8::from_str_radix(number, 16).unwrap());
    }
    // 1 and 2 are requests, axis 0 is the one
    assert_eq!(bench.error("01 03 00 01 10 01 03 9A 00 00"), 0x66);
    assert_eq!(bench.error("01 01 01 01 10 01 03 9A 00 00"), 0x65);
    // value, description and text of 8-10
    assert_eq!(
        bench.ask("01 01 00 01 10 01 03 2A 00 00"),
        [1, 1, 0, 1, 5, 1, 0, 0]
    );
    assert_eq!(
        bench.ask("01 01 00 01 20 01 03 2A 00 00")[..6],
        [1, 1, 0, 1, 0x0A, 46]
    );
    let text = bench.ask("01 01 00 01 30 01 03 2A 00 01");
    assert_eq!(text, [&[1, 1, 0, 1, 9, 16][..], b"PROFIdrive profi"].concat());
    // a few elements from a subindex on; the blocks have nothing but format, number and data
    assert_eq!(
        bench.ask("01 02 00 01 10 02 01 36 00 02 03 02 03 E8 07 D0"),
        [1, 2, 0, 1]
    );
    assert_eq!(
        bench.ask("01 01 00 01 10 03 01 36 00 01"),
        [1, 1, 0, 1, 3, 3, 0, 0, 0x03, 0xE8, 0x07, 0xD0]
    );
    // formats in decimal as the parameters are: 2, 3, 4, 5, 6, 7, 9, 10, 33, 35, 54
    for (parameter, format) in [
        ("07 6C", 2),
        ("00 A2", 3),
        ("06 41", 4),
        ("03 2A", 5),
        ("00 7A", 6),
        ("01 55", 7),
        ("06 04", 9),
        ("03 C5", 10),
        ("06 45", 33),
        ("06 43", 35),
    ] {
        let answer = bench.ask(&format!("01 01 00 01 10 00 {parameter} 00 00"));
        assert_eq!((answer[1], answer[4]), (1, format), "{parameter}");
    }
    assert_eq!(bench.ask("01 01 00 01 10 01 05 28 00 00")[4], 54);
    // more or less data than requested
    for data in ["07 01 00 00 01", "07 01 00 00 01 F4 00 00", "07 02 00 00 01 F4"] {
        let answer = bench.ask(&format!("01 02 00 01 10 01 01 55 00 00 {data}"));
        assert_eq!((answer[1], answer[4]), (0x82, 0x44), "{data}");
    }
    assert_eq!(
        bench.ask("01 01 00 01 10 01 01 55 00 00")[4..],
        [7, 1, 0, 0, 0x01, 0x2C]
    );
}

#[test]
fn request_header_and_parameter_address_of_a_vacon() {
    let mut bench = Bench::new(&VACON);
    let read = "10 01 27 11 00 67";
    assert_eq!(
        bench.ask(&format!("55 01 01 01 {read}")),
        [0x55, 1, 1, 1, 0x42, 1, 0, 50]
    );
    // request ID 1 and 2, no other
    for id in ["00", "03", "42", "FF"] {
        let answer = bench.ask(&format!("01 {id} 01 01 {read}"));
        assert_eq!(answer[1], 0x80, "{id}");
        assert!(
            matches!(answer[4..], [0x44, 1, 0, 0x21 | 0x66]),
            "{id}: {answer:02X?}"
        );
    }
    // 1 to 39 parameters
    let many = |count: u8| format!("01 01 01 {count:02X} ") + &format!("{read} ").repeat(count.into());
    assert_eq!(bench.ask(&many(39)).len(), 4 + 39 * 4);
    for head in ["01 01 01 00", "01 01 01 28", "01 01 01 FF"] {
        let answer = bench.ask(&format!("{head} {read}"));
        assert_eq!(answer[4..8], [0x44, 1, 0, 0x68], "{head}");
    }
    // attributes 10 and 20; 30 is not supported; others
    assert_eq!(bench.ask("01 01 01 01 20 01 03 9A 00 00")[1], 1);
    assert!(matches!(
        bench.error("01 01 01 01 30 01 27 11 00 67"),
        0x0F | 0x69
    ));
    assert_eq!(bench.error("01 01 01 01 40 01 27 11 00 67"), 0x69);
    // 0 and 1 elements of what is not an array, and no more; of an array as many as it has
    assert_eq!(
        bench.ask("01 01 01 01 10 00 27 11 00 67"),
        [1, 1, 1, 1, 0x42, 1, 0, 50]
    );
    assert_eq!(bench.ask("01 01 01 01 10 02 03 9A 00 00")[1], 0x81);
    assert_eq!(
        bench.ask("01 01 01 01 10 08 03 B3 00 00")[..6],
        [1, 1, 1, 1, 0x42, 8]
    );
    assert_eq!(bench.ask("01 01 01 01 10 09 03 B3 00 00")[1], 0x81);
    assert_eq!(bench.error("01 01 01 01 10 EB 03 B3 00 00"), 0x16);
    // the description of a parameter too: 0 or 1 element of 930, 1 to 234 of 947
    for (elements, pnu, possible) in [
        ("00", "03 A2", true),
        ("01", "03 A2", true),
        ("02", "03 A2", false),
        ("EA", "03 A2", false),
        ("FF", "03 A2", false),
        ("00", "03 B3", false),
        ("08", "03 B3", true),
        ("EA", "03 B3", true),
        ("EB", "03 B3", false),
    ] {
        let request = format!("01 01 01 01 20 {elements} {pnu} 00 00");
        if possible {
            assert_eq!(bench.ask(&request)[..6], [1, 1, 1, 1, 0x0A, 46], "{request}");
        } else {
            assert_eq!(bench.error(&request), 0x16, "{request}");
        }
    }
    // any subindex is a question; not all have an answer
    for subindex in ["00 00", "FF FF"] {
        assert_eq!(bench.ask(&format!("01 01 01 01 10 01 27 11 {subindex}"))[1], 0x81);
    }
}

#[test]
fn the_fault_history_of_a_vacon_has_eight_entries_of_one_fault_each() {
    let mut bench = Bench::new(&VACON);
    let before = bench.words(944, 0, 1)[0];
    for number in [1, 2, 9, 14, 19, 30, 51, 52, 53] {
        bench.inject(Injection::Fault {
            number,
            lasting: false,
        });
        bench.word(0x047E);
        assert_eq!(bench.words(947, 0, 2)[0], number);
        bench.word(0x04FE);
        bench.word(0x047E);
    }
    // acknowledged ones from entry 1 on, the newest first; the oldest are gone
    assert_eq!(bench.words(947, 0, 8), [0, 53, 52, 51, 30, 19, 14, 9]);
    assert_ne!(bench.words(944, 0, 1)[0], before);
    // 945 and 950 are not among the numbers of a Vacon 100
    assert_eq!(bench.error("01 01 01 01 10 01 03 B1 00 00"), 0);
    assert_eq!(bench.error("01 01 01 01 10 01 03 B6 00 00"), 0);
}
