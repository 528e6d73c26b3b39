//! Every PNU of the table, through the parameter channel: reading, description, writing at and beside the limits, wrong
//! formats, counts, subindices and attributes.
//!
//! What is expected comes from `data/akd/` and from the profile's rules alone (error numbers, the order of the checks,
//! the layout of the description), worked out here a second time.

mod channel;
mod rows;

use channel::{Answer, Channel, block, number};
use rows::{Row, Table};

// Error numbers of the profile.
const UNKNOWN: u16 = 0x00;
const READ_ONLY: u16 = 0x01;
const LIMIT: u16 = 0x02;
const SUBINDEX: u16 = 0x03;
const NO_ARRAY: u16 = 0x04;
const TYPE: u16 = 0x05;
const DESCRIPTION_FIXED: u16 = 0x07;
const NO_TEXT: u16 = 0x0F;
const NOT_NOW: u16 = 0x11;
const VALUE: u16 = 0x14;
const ADDRESS: u16 = 0x16;
const FORMAT: u16 = 0x17;
const COUNT: u16 = 0x18;
const TEXT_FIXED: u16 = 0x20;

/// Answers that depend on more than the limits; every other row answers by its limits alone.
fn permitted(table: &Table, row: &Row, raw: i64) -> &'static [Answer] {
    const WRITTEN: &[Answer] = &[Answer::Written];
    const NOW: &[Answer] = &[Answer::Error(NOT_NOW)];
    const NO_SUCH: &[Answer] = &[Answer::Error(VALUE)];
    const OUT_OF_RANGE: &[Answer] = &[Answer::Error(LIMIT)];
    const NOT_NOW_OR_RANGE: &[Answer] = &[Answer::Error(NOT_NOW), Answer::Error(LIMIT)];
    match row.pnu {
        // The mapping of telegram 1, which is in use as delivered, is fixed (manual 5.11).
        915 | 916 => NOW,
        // BODE.MODE, CAPx.EN, DRV.ZERO, FB1.PFIND, PLS.RESET, CMPx.ARM: a virtual drive has no such procedure
        2023 | 2028 | 2041 | 2139 | 2149 | 2327 | 2914 | 2915 if raw != 0 => NOW,
        922 if ![0, 1, 7, 9, 350, 351, 352, 353, 354, 400].contains(&raw) => NO_SUCH,
        _ if table.is_nameless(row, raw) => NO_SUCH,
        // MT.CLEAR: a task of the table, or all of them by -1. MT.MOVE starts a task, which needs a homed axis in operation.
        2265 if !(-1..=128).contains(&raw) => OUT_OF_RANGE,
        2272 => NOT_NOW_OR_RANGE,
        _ => WRITTEN,
    }
}

/// Commands as delivered, disabled, with the field bus as command source: DRV.EN needs the service channel, and what
/// moves the axis needs operation.
fn executed(row: &Row) -> &'static [Answer] {
    match row.name.as_str() {
        "DRV.EN" | "HOME.MOVE" | "MT.CONTINUE" => &[Answer::Error(NOT_NOW)],
        // what a virtual drive has not
        "AIN.ZERO" | "AIN2.ZERO" | "GEAR.MOVE" | "REC.TRIG" | "SM.MOVE" | "WS.ARM" | "SD.LOAD"
        | "SD.SAVE" | "MODBUS.CLRERRORS" | "SFD.SECTORERASE" => &[Answer::Error(NOT_NOW)],
        _ => &[Answer::Written],
    }
}

#[test]
fn every_parameter_reads_in_its_size_and_as_delivered() {
    let table = Table::load();
    assert_eq!(table.rows.len(), 800);
    let mut channel = Channel::new();
    let mut compared = 0;
    for row in &table.rows {
        let raw = channel.read(row);
        assert!(row.range().contains(&raw));
        match row.access.as_str() {
            "command" => assert_eq!(raw, 0, "{row:?}"),
            "rw" => {
                if let Some(expected) = table.as_delivered(row) {
                    assert_eq!(channel.read_whole(row), expected, "{row:?}");
                    compared += 1;
                }
            }
            _ => {}
        }
        let plain = channel.ask(1, 0x10, 0, row.pnu, 0, &[]);
        assert!(
            row.is_array() || matches!(plain, Answer::Values(..)),
            "0 elements of a simple parameter: {row:?}"
        );
    }
    assert!(compared > 300, "{compared}");
}

#[test]
fn addresses_that_are_not_there() {
    let table = Table::load();
    let mut channel = Channel::new();
    for row in &table.rows {
        let block = block(row, row.format(), &[0]);
        let beyond = Answer::Error(if row.is_array() { SUBINDEX } else { NO_ARRAY });
        for subindex in [row.elements, row.elements + 1, 0xFFFE] {
            assert_eq!(channel.ask(1, 0x10, 1, row.pnu, subindex, &[]), beyond, "{row:?}");
            assert_eq!(
                channel.ask(2, 0x10, 1, row.pnu, subindex, &block),
                beyond,
                "{row:?}"
            );
        }
        // More elements than there are: the profile leaves the choice.
        if let Ok(more @ 2..=100) = u8::try_from(row.elements + 1) {
            let allowed = [if row.is_array() { SUBINDEX } else { NO_ARRAY }, ADDRESS];
            let answer = channel.ask(1, 0x10, more, row.pnu, 0, &[]);
            assert!(
                allowed.iter().any(|number| answer == Answer::Error(*number)),
                "{row:?} {answer:?}"
            );
        }
        for attribute in [0x00, 0x50, 0xF0] {
            assert_eq!(
                channel.ask(1, attribute, 1, row.pnu, 0, &[]),
                Answer::Error(ADDRESS),
                "{row:?}"
            );
            assert_eq!(
                channel.ask(2, attribute, 1, row.pnu, 0, &block),
                Answer::Error(ADDRESS),
                "{row:?}"
            );
        }
        assert_eq!(
            channel.ask(1, 0x30, 1, row.pnu, 0, &[]),
            Answer::Error(NO_TEXT),
            "{row:?}"
        );
        assert_eq!(
            channel.ask(2, 0x30, 1, row.pnu, 0, &block),
            Answer::Error(TEXT_FIXED),
            "{row:?}"
        );
        assert_eq!(
            channel.ask(2, 0x20, 1, row.pnu, 0, &block),
            Answer::Error(DESCRIPTION_FIXED),
            "{row:?}"
        );
    }
    let high = table.rows.iter().filter(|row| row.wide).map(|row| row.pnu + 1);
    let known: Vec<u16> = table.rows.iter().map(|row| row.pnu).chain(high).collect();
    for pnu in (1..=u16::MAX).filter(|pnu| !known.contains(pnu)) {
        assert_eq!(
            channel.ask(1, 0x10, 1, pnu, 0, &[]),
            Answer::Error(UNKNOWN),
            "{pnu}"
        );
        assert_eq!(
            channel.ask(2, 0x10, 1, pnu, 0, &[0x42, 1, 0, 0]),
            Answer::Error(UNKNOWN),
            "{pnu}"
        );
        assert_eq!(
            channel.ask(1, 0x20, 1, pnu, 0, &[]),
            Answer::Error(UNKNOWN),
            "{pnu}"
        );
    }
}

#[test]
fn every_description_matches_the_table() {
    let table = Table::load();
    let mut channel = Channel::new();
    for row in &table.rows {
        let Answer::Values(0x0A, octets) = channel.ask(1, 0x20, 1, row.pnu, 0, &[]) else {
            panic!("{row:?}")
        };
        assert_eq!(octets.len(), 46);
        let word = |at: usize| u16::from_be_bytes([octets[at], octets[at + 1]]);
        let identifier = word(0);
        assert_eq!(identifier & 0x00FF, u16::from(row.data_type()), "{row:?}");
        assert_eq!(identifier & 0x4000 != 0, row.is_array(), "{row:?}");
        assert_eq!(identifier & 0x0200 != 0, row.access == "ro", "{row:?}");
        assert_eq!(identifier & 0xA400, 0, "reserved, reset only, texts: {row:?}");
        assert_eq!(word(2), if row.is_array() { row.elements } else { 0 }, "{row:?}");
        let mut name = [b' '; 16];
        name.iter_mut()
            .zip(row.name.bytes())
            .for_each(|(place, octet)| *place = octet);
        assert_eq!(octets[14..30], name, "{row:?}");
        if row.access == "rw" {
            let limits = table.limits(row);
            let limit = |at: usize| {
                number(
                    &Row {
                        size: "dword".into(),
                        ..row.clone()
                    },
                    &octets[at..at + 4],
                )
            };
            assert_eq!(limit(30)..=limit(34), limits, "{row:?}");
        }
        assert!(
            octets[10..14]
                .iter()
                .chain(&octets[38..42])
                .all(|octet| *octet == 0),
            "reserved: {row:?}"
        );
        // The elements 1 to 12 are the parts of it.
        let mut parts = Vec::new();
        for element in 1..=12 {
            match channel.ask(1, 0x20, 1, row.pnu, element, &[]) {
                Answer::Values(0x0A, part) => parts.extend(part),
                other => panic!("{row:?}: {other:?}"),
            }
        }
        assert_eq!(parts, octets);
        assert_eq!(channel.ask(1, 0x20, 1, row.pnu, 13, &[]), Answer::Error(SUBINDEX));
    }
}

#[test]
fn what_can_only_be_read_is_never_written() {
    let table = Table::load();
    let mut channel = Channel::new();
    let mut found = 0;
    for row in table.rows.iter().filter(|row| row.access == "ro") {
        for raw in [0, 1, *row.range().end(), *row.range().start()] {
            assert_eq!(channel.write(row, raw), Answer::Error(READ_ONLY), "{row:?}");
        }
        // That comes before anything that may be wrong with the value.
        let wrong = [
            block(row, 0x50, &[0]),
            block(row, row.format(), &[0, 0]),
            vec![0x43, 1, 0, 0, 0, 0],
        ];
        for block in wrong {
            assert_eq!(
                channel.ask(2, 0x10, 1, row.pnu, 0, &block),
                Answer::Error(READ_ONLY),
                "{row:?}"
            );
        }
        found += 1;
    }
    assert_eq!(found, 178);
}

#[test]
fn wrong_formats_sizes_and_counts() {
    let table = Table::load();
    let mut channel = Channel::new();
    for row in table.rows.iter().filter(|row| row.access != "ro") {
        let before = channel.read(row);
        for format in [0x00, 0x40, 0x44, 0x45, 0x50, 0x64, 0xFF] {
            let answer = channel.ask(2, 0x10, 1, row.pnu, 0, &block(row, format, &[0]));
            assert_eq!(answer, Answer::Error(FORMAT), "format {format:02X}: {row:?}");
        }
        for (format, octets) in [
            (0x41_u8, 1),
            (0x42, 2),
            (0x43, 4),
            (0x02, 1),
            (0x06, 2),
            (0x04, 4),
            (0x37, 8),
        ] {
            if octets != row.octets() {
                let mut block = vec![format, 1];
                block.resize(2 + usize::next_multiple_of(octets, 2), 0);
                let answer = channel.ask(2, 0x10, 1, row.pnu, 0, &block);
                assert_eq!(answer, Answer::Error(TYPE), "format {format:02X}: {row:?}");
            }
        }
        for values in [&[][..], &[0, 0], &[0, 0, 0]] {
            let answer = channel.ask(2, 0x10, 1, row.pnu, 0, &block(row, row.format(), values));
            assert_eq!(answer, Answer::Error(COUNT), "{} values: {row:?}", values.len());
        }
        assert_eq!(channel.read(row), before, "nothing was changed: {row:?}");
    }
}

#[test]
fn writing_at_and_beside_the_limits() {
    let table = Table::load();
    let mut limited = 0;
    for row in table.rows.iter().filter(|row| row.access == "rw") {
        // Of a 64-bit value what can be written to its first number alone.
        let limits = table.limits(row);
        for raw in [*limits.start(), *limits.end()] {
            // A drive of its own: no row depends on what another one was set to.
            let mut channel = Channel::new();
            let before = channel.read(row);
            let answer = channel.write(row, raw);
            assert!(
                permitted(&table, row, raw).contains(&answer),
                "{raw}: {answer:?} {row:?}"
            );
            let expected = if answer == Answer::Written { raw } else { before };
            assert_eq!(channel.read(row), expected, "{row:?}");
        }
        let mut channel = Channel::new();
        let before = channel.read(row);
        for raw in [
            limits.start() - 1,
            limits.end() + 1,
            *row.range().start(),
            *row.range().end(),
        ] {
            if row.range().contains(&raw) && !limits.contains(&raw) {
                assert_eq!(channel.write(row, raw), Answer::Error(LIMIT), "{raw}: {row:?}");
                assert_eq!(channel.read(row), before, "{row:?}");
                limited += 1;
            }
        }
        // The true type in place of the substitution code, where the profile has one.
        if !row.is_array() {
            let answer = channel.ask(2, 0x10, 1, row.pnu, 0, &block(row, row.data_type(), &[before]));
            assert!(
                permitted(&table, row, before).contains(&answer) || !limits.contains(&before),
                "{answer:?} {row:?}"
            );
        }
    }
    assert!(limited > 600, "{limited}");
}

#[test]
fn enumerations_take_the_values_that_have_a_name() {
    let table = Table::load();
    let mut nameless = 0;
    for row in table
        .rows
        .iter()
        .filter(|row| row.access == "rw" && !row.is_array())
    {
        let limits = table.limits(row);
        let first = (*limits.start()).max(-2);
        let some = first..=(first + 64).min(*limits.end());
        if some.clone().all(|raw| !table.is_nameless(row, raw)) {
            continue; // no enumeration, or all values have a name
        }
        let mut channel = Channel::new();
        for raw in some {
            let answer = channel.write(row, raw);
            assert!(
                permitted(&table, row, raw).contains(&answer),
                "{raw}: {answer:?} {row:?}"
            );
            nameless += u32::from(answer == Answer::Error(VALUE));
        }
    }
    assert!(nameless > 100, "{nameless}");
}

#[test]
fn both_halves_of_64_bit_values() {
    let table = Table::load();
    let mut limited = 0;
    for row in table.rows.iter().filter(|row| row.wide && row.access == "rw") {
        let limits = table.whole_limits(row);
        let exact = |raw: &i64| raw.unsigned_abs() <= 1 << 53; // the precision of the decimals in the table
        for raw in [*limits.start(), *limits.end()].iter().filter(|raw| exact(raw)) {
            let mut channel = Channel::new();
            assert_eq!(channel.write_whole(row, *raw), Answer::Written, "{raw} {row:?}");
            assert_eq!(channel.read_whole(row), *raw, "{row:?}");
        }
        for raw in [limits.start().saturating_sub(1), limits.end().saturating_add(1)] {
            if !limits.contains(&raw) && exact(&raw) && (row.signed || raw >= 0) {
                let mut channel = Channel::new();
                let before = channel.read_whole(row);
                assert_eq!(
                    channel.write_whole(row, raw),
                    Answer::Error(LIMIT),
                    "{raw} {row:?}"
                );
                assert_eq!(channel.read_whole(row), before, "{row:?}");
                limited += 1;
            }
        }
    }
    assert!(limited > 20, "{limited}");
}

#[test]
fn commands_are_executed_by_any_value() {
    let table = Table::load();
    let mut found = 0;
    for row in table.rows.iter().filter(|row| row.access == "command") {
        for raw in [0, 1, 0xFFFF] {
            let mut channel = Channel::new();
            let answer = channel.write(row, raw);
            assert!(executed(row).contains(&answer), "{answer:?} {row:?}");
            assert_eq!(channel.read(row), 0, "{row:?}");
        }
        found += 1;
    }
    assert_eq!(found, 29);
}

/// Returns the block of an answer inside a response to many.
fn answer_block(row: &Row, answer: &Answer) -> Vec<u8> {
    match answer {
        Answer::Values(format, octets) => {
            let mut block = vec![*format, 1];
            block.extend(octets);
            block.resize(2 + row.octets().next_multiple_of(2), 0);
            block
        }
        Answer::Written => vec![0x40, 0],
        Answer::Error(number) => [&[0x44, 1][..], &number.to_be_bytes()].concat(),
    }
}

#[test]
fn many_parameters_in_one_request_answer_as_single_ones() {
    let table = Table::load();
    for (id, failing) in [(1, false), (1, true), (2, false), (2, true)] {
        let rows = table
            .rows
            .iter()
            .filter(|row| id == 1 || row.access == "rw" || failing && row.access == "ro");
        let rows: Vec<&Row> = rows.filter(|row| !row.is_array() && row.pnu != 922).collect();
        for some in rows.chunks(16) {
            let mut channel = Channel::new();
            let mut addresses = Vec::new();
            let (mut blocks, mut expected) = (Vec::new(), Vec::new());
            let mut refused = false;
            for (place, row) in some.iter().enumerate() {
                let unknown = failing && place % 5 == 3;
                let pnu = if unknown { 0xFFF0 } else { row.pnu };
                addresses.push(pnu);
                // The same as it has: writing changes nothing for the others.
                let value = block(row, row.format(), &[channel.read(row)]);
                let answer = channel.ask(id, 0x10, 1, pnu, 0, if id == 2 { &value } else { &[] });
                refused |= matches!(answer, Answer::Error(_));
                expected.extend(answer_block(row, &answer));
                if id == 2 {
                    blocks.extend(value);
                }
            }
            let response = channel.ask_many(id, &addresses, &blocks);
            let header = [
                0x77,
                if refused { id | 0x80 } else { id },
                0,
                u8::try_from(some.len()).unwrap(),
            ];
            assert_eq!(response[..4], header, "{addresses:?}");
            match (id, refused) {
                (2, false) => assert_eq!(response[4..], [0, 0]),
                _ => assert_eq!(response[4..], expected, "{addresses:?}"),
            }
        }
    }
}
