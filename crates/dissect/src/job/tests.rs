//! Tests with worked examples, with scalings derived from jobs, and with invalid octets.

use super::*;

mod answers;

fn words(hex: &str, request: Option<&str>) -> Vec<String> {
    let bytes = |text: &str| -> Vec<u8> {
        text.split(' ')
            .map(|octet| u8::from_str_radix(octet, 16).unwrap())
            .collect()
    };
    let request = request.map(bytes);
    let decoded = decode(&mut JobDrive::default(), &bytes(hex), None, request.as_deref()).unwrap();
    decoded.lines.into_iter().map(|(_, line)| line).collect()
}

#[test]
fn the_worked_examples() {
    let lines = words("05 02 00 01 10 01 03 A2 00 00 42 01 00 02", None);
    assert_eq!(lines[0], "change request 5, axis 0, 1 parameter");
    assert!(lines[1].starts_with("  Operating mode (p0930) = 2"), "{lines:?}");
    assert!(lines[1].ends_with("[Word 00 02]"), "{lines:?}");
    let lines = words("02 01 01 01 10 06 03 C4 00 00", None);
    assert_eq!(lines[0], "read request 2, axis 1, 1 parameter");
    let lines = words("05 02 00 01 00 00", None);
    assert_eq!(lines, ["change response 5, axis 0, 1 parameter", "  written"]);
    let lines = words("01 02 01 01", None);
    assert_eq!(lines, ["change response 1, axis 1, 1 parameter", "  written"]);
    let lines = words("01 82 01 01 44 01 00 01", None);
    assert!(
        lines[1].starts_with("  refused: 0x01 parameter value cannot be changed"),
        "{lines:?}"
    );
}

/// Each worked example of requests and responses of the profile, with what it is.
#[test]
fn every_example_of_the_profile() {
    for (hex, head, rest) in [
        (
            "02 01 01 01 10 06 03 C4 00 00",
            "read request 2, axis 1",
            "(r0964[0..5])",
        ),
        (
            "03 01 01 01 10 01 27 11 00 67",
            "read request 3, axis 1",
            "10001[103]",
        ),
        (
            "05 02 00 01 10 01 03 A2 00 00 42 01 00 02",
            "change request 5, axis 0",
            "(p0930) = 2",
        ),
        (
            "01 02 01 01 10 01 03 9F 00 00 06 01 00 00",
            "change request 1, axis 1",
            "0927 = 0",
        ),
        (
            "80 02 01 01 10 01 04 61 00 00 08 01 41 42 66 66",
            "change request 128, axis 1",
            "1121 = 12.15   [Float32 41 42 66 66]",
        ),
        (
            "02 01 01 01 42 06 01 BA 00 02 00 64 07 DE 00 65 00 01",
            "read response 2, axis 1",
            "442, 2, 100, 2014, 101, 1   [",
        ),
        (
            "0B 01 01 01 42 01 0C 05",
            "read response 11, axis 1",
            "3077   [Word 0C 05]",
        ),
        (
            "17 01 00 01 43 01 00 00 00 2B",
            "read response 23, axis 0",
            "43   [Double word 00 00 00 2B]",
        ),
        (
            "17 81 00 01 44 01 00 11",
            "read response with refusals 23, axis 0",
            "refused: 0x11 not executable",
        ),
        ("01 02 01 01", "change response 1, axis 1", "written"),
        (
            "01 82 01 01 44 01 00 01",
            "change response with refusals 1, axis 1",
            "refused: 0x01 ",
        ),
        ("05 02 00 01 00 00", "change response 5, axis 0", "written"),
        (
            "07 81 00 02 42 01 00 02 44 01 00 00",
            "read response with refusals 7, axis 0, 2 parameters",
            "refused: 0x00 impermissible parameter number",
        ),
        (
            "08 82 00 02 40 00 44 02 00 01 00 00",
            "change response with refusals 8, axis 0, 2 parameters",
            "refused: 0x01 parameter value cannot be changed, information 0",
        ),
    ] {
        let lines = words(hex, None);
        assert!(lines[0].starts_with(head), "{hex}: {lines:?}");
        assert!(
            lines[1..].iter().any(|line| line.contains(rest)),
            "{hex}: {lines:?}"
        );
        assert!(!lines.iter().any(|line| line.contains('!')), "{hex}: {lines:?}");
    }
}

fn octets(hex: &str) -> Vec<u8> {
    hex.split(' ')
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

/// Returns the answer of the drive to a request, in one line.
fn answered(drive: &mut JobDrive, request: &str, response: &str) -> String {
    let lines = response_job(drive, &octets(response), Some(&octets(request))).lines;
    lines.into_iter().map(|(_, line)| line).collect()
}

/// With one parameter in the only line, with several in that of each.
#[test]
fn what_is_refused_has_its_line() {
    let refused = |request: &str, response: &str| -> Vec<(usize, u16, u16)> {
        let mut drive = JobDrive::default();
        let decoded = response_job(&mut drive, &octets(response), Some(&octets(request)));
        assert!(
            decoded
                .refused
                .iter()
                .all(|(line, _)| decoded.lines[*line].1.contains("refused"))
        );
        let places = decoded.refused.iter();
        places.map(|(line, one)| (*line, one.pnu, one.error.0)).collect()
    };
    let one = refused("01 01 00 01 10 01 03 9F 00 00", "01 81 00 01 44 01 00 00");
    assert_eq!(one, [(0, 927, 0)]);
    let two = refused(
        "01 01 00 02 10 01 03 A2 00 00 10 01 03 A0 00 00",
        "01 81 00 02 42 01 00 01 44 01 00 00",
    );
    assert_eq!(two, [(2, 928, 0)]);
}

#[test]
fn scales_are_learnt_from_reads_and_writes() {
    let mut drive = JobDrive::default();
    let speed = ("01 01 00 01 10 01 00 05 00 00", "01 01 00 01 42 01 05 3E");
    let text = answered(&mut drive, speed.0, speed.1);
    assert!(
        text.contains("NSOLL_A (p0005) = raw 1342, 491.335 rpm if PN.VELSCALING 1638   [Word 05 3E]"),
        "{text}"
    );
    // PN.VELSCALING is read
    let text = answered(
        &mut drive,
        "02 01 00 01 10 01 0B F8 00 00",
        "02 01 00 01 42 01 00 C8",
    );
    assert!(text.contains("PN.VELSCALING (p3064) = 200"), "{text}");
    let text = answered(&mut drive, speed.0, speed.1);
    assert!(text.contains("NSOLL_A (p0005) = 59.992 rpm   ["), "{text}");
    // its mirror is written, first refused, then accepted
    let change = "03 02 00 01 10 01 03 F1 00 00 42 01 03 E8";
    let refused = answered(&mut drive, change, "03 82 00 01 44 01 00 11");
    assert!(refused.contains("refused"), "{refused}");
    let text = answered(&mut drive, speed.0, speed.1);
    assert!(text.contains("59.992 rpm"), "{text}");
    for written in ["03 02 00 01", "03 02 00 01 00 00"] {
        let mut drive = drive.clone();
        answered(&mut drive, change, written);
        let text = answered(&mut drive, speed.0, speed.1);
        assert!(text.contains("299.96 rpm"), "{text}");
    }
    // an answer to another request adds no information
    let text = answered(
        &mut drive,
        "04 01 00 01 10 01 0B F8 00 00",
        "09 01 00 01 42 01 00 01",
    );
    assert!(text.contains("answers request 9, not 4"), "{text}");
    let text = answered(&mut drive, speed.0, speed.1);
    assert!(text.contains("59.992 rpm"), "{text}");
    // each scale of its own: the position is not known yet
    let text = answered(
        &mut drive,
        "05 01 00 01 10 01 08 F6 00 00",
        "05 01 00 01 43 01 00 00 00 05",
    );
    assert!(
        text.contains("PL.FB (r2294) = raw 5, 5 counts if PN.POSSCALE 1000   ["),
        "{text}"
    );
}

#[test]
fn a_drive_of_another_vendor_has_other_parameters() {
    let mut drive = JobDrive::of(0x0002, 0x0001);
    let text = answered(
        &mut drive,
        "01 01 01 01 10 01 08 3C 00 00",
        "01 01 01 01 43 01 00 2D C6 C0",
    );
    assert!(text.contains("2108 = 3000000   ["), "{text}");
}

#[test]
fn words_by_name_and_high_halves() {
    let mut drive = JobDrive::default();
    let text = answered(
        &mut drive,
        "01 01 00 02 10 01 00 02 00 00 10 01 08 3D 00 00",
        "01 01 00 02 42 01 02 70 43 01 00 00 00 00",
    );
    assert!(
        text.contains("ZSW1 (r0002) = 0x0270 [INHIBIT, CTRL_REQ] S1 switching on inhibited   ["),
        "{text}"
    );
    assert!(text.contains("high half of DRV.ACC (2109) = 0"), "{text}");
}

/// Without a word on the direction: what a request has too much, or wrong, does not make a response of it.
#[test]
fn a_request_with_a_mistake_is_a_request() {
    for (hex, words) in [
        (
            "01 01 00 01 10 01 03 A2 00 00 AA BB",
            "2 octets too many at the end",
        ),
        ("01 01 00 01 40 01 03 A2 00 00", "attribute 0x40 does not exist"),
        (
            "01 01 00 01 10 01 03 A2 00 00 00 00",
            "read request 1, axis 0, 1 parameter",
        ),
    ] {
        let mut drive = JobDrive::new(profile::model::Model::by_name("akd").unwrap());
        let decoded = decode(&mut drive, &octets(hex), None, None).unwrap();
        let found = decoded.lines.iter().any(|(_, line)| line.contains(words));
        assert!(found, "{hex}: {:?}", decoded.lines);
    }
}

/// What stands in the octets is named, and what the drive answers to a request that ends too early or has no format.
#[test]
fn a_request_cut_off_has_the_answer_of_the_drive() {
    let lines = |model: &str, hex: &str| -> Vec<String> {
        let mut drive = JobDrive::new(profile::model::Model::by_name(model).unwrap());
        let decoded = decode(&mut drive, &octets(hex), None, None).unwrap();
        assert_eq!(decoded.fields["side"], "request", "{hex}");
        assert!(
            decoded.fields.contains_key("not_allowed"),
            "{hex}: {:?}",
            decoded.fields
        );
        let in_capture = request_job(&drive, &octets(hex)).fields;
        assert_eq!(in_capture, decoded.fields, "{hex}");
        decoded.lines.into_iter().map(|(_, line)| line).collect()
    };
    let mode = "Operating mode (p0930) = (no value: ";
    for (model, hex, expected) in [
        (
            "akd",
            "05 02 00 01 10 01 03 A2 00 00 42 01 00",
            &[mode, "the request ends too early: answered with error 0x18"][..],
        ),
        (
            "akd",
            "05 02 00 01 10 01 03 A2 00 00",
            &[mode, "the request ends too early: answered with error 0x18"],
        ),
        // the first value is there
        (
            "akd",
            "05 02 00 02 10 01 03 A2 00 00 10 01 08 3C 00 00 42 01 00 02",
            &[
                "Operating mode (p0930) = 2",
                "the request ends too early: answered with error 0x18",
            ],
        ),
        (
            "akd",
            "05 02 00 01 10 01 03 A2 00 00 00 01 00 02",
            &[
                mode,
                "0x00 is not the format of a value: answered with error 0x17",
            ],
        ),
        (
            "akd",
            "05 02 00 01 10 01 03 A2 00 00 99 01 00 02",
            &[
                mode,
                "0x99 is not the format of a value: answered with error 0x17",
            ],
        ),
        (
            "vacon",
            "01 02 01 01 10 01 27 11 00 67 42 03 00 01",
            &[
                "(ID 103) = (no value: ",
                "the request ends too early: answered with error 0x6B",
            ],
        ),
        (
            "vacon",
            "01 01 01 02 10 01 27 11 00 67 10",
            &[
                "error 0x6B",
                "(ID 103)",
                "the parameter addresses need 12 octets from offset 4, there are 7",
            ],
        ),
        (
            "akd",
            "05 01 00 01 10 01 03",
            &[
                "the record write is refused",
                "the parameter addresses need 6 octets",
            ],
        ),
    ] {
        let found = lines(model, hex);
        for words in expected {
            assert!(
                found.iter().any(|line| line.contains(words)),
                "{hex}: {words}: {found:#?}"
            );
        }
    }
    // a change with its value cut off, at each octet behind its addresses
    let whole = "05 02 00 01 10 01 03 A2 00 00 43 01 00 00 00 02";
    for length in 10..16 {
        let cut = &whole[..3 * length - 1];
        assert!(
            lines("akd", cut).iter().any(|line| line.contains("0x18")),
            "{cut}"
        );
    }
    // without a header there is nothing to name
    let failure = decode(&mut JobDrive::default(), &[1, 2, 0], Some(Side::Request), None);
    let failure = failure.err().unwrap().to_string();
    assert_eq!(
        failure,
        "not a valid parameter request: the header needs 4 octets, the block has 3"
    );
}

/// A drive can have a parameter that no table has: no error, but a word on the answer if it does not.
#[test]
fn a_parameter_that_no_table_has_is_no_mistake() {
    let line_and_value = |model: &str, hex: &str| {
        let drive = JobDrive::new(profile::model::Model::by_name(model).unwrap());
        request_job(&drive, &octets(hex))
    };
    let unknown = line_and_value("vacon", "01 01 01 01 10 01 27 11 FF FF");
    assert_eq!(
        unknown.lines,
        [(
            Weight::Normal,
            "read request 1, axis 1, 1 parameter: ID 65535   (not in the tables: answered with error 0x6C unless the \
             drive has the parameter)"
                .to_owned()
        )]
    );
    assert_eq!(unknown.fields["not_in_tables"][0]["error"], 0x6C);
    assert!(!unknown.fields.contains_key("not_allowed"));
    let unknown = line_and_value("standard", "01 01 01 01 10 01 27 11 FF FF");
    assert_eq!(unknown.lines.len(), 1, "{:?}", unknown.lines);
    assert!(!unknown.lines[0].1.contains("not"), "{:?}", unknown.lines);
    let (_, described) = line_and_value("vacon", "09 01 01 01 20 EA 27 11 13 88")
        .lines
        .pop()
        .expect("a line");
    assert!(
        described.ends_with("has no description (attribute 0x20): answered with error 0x09"),
        "{described}"
    );
}

#[test]
fn responses_with_their_request() {
    let request = "07 01 00 02 10 01 08 3C 00 00 10 01 FF FE 00 00";
    let lines = words("07 81 00 02 43 01 00 2D C6 C0 44 01 00 00", Some(request));
    assert_eq!(
        lines[1],
        "  DRV.ACC (p2108) = 3000 rpm/s   [Double word 00 2D C6 C0]"
    );
    assert!(
        lines[2].starts_with("  65534: refused: 0x00 impermissible parameter number"),
        "{lines:?}"
    );
    let lines = words("08 01 00 01 42 01 00 02", Some(request));
    assert!(
        lines.iter().any(|line| line.contains("answers request 8, not 7")),
        "{lines:?}"
    );
}

#[test]
fn a_response_that_repeats_the_address() {
    let lines = words("05 01 00 01 10 01 03 A2 00 00 42 01 00 02", None);
    assert!(lines[0].starts_with("read response 5"), "{lines:?}");
    assert!(lines[1].starts_with("  Operating mode (p0930) = 2"), "{lines:?}");
}

#[test]
fn invalid_input_is_reported() {
    for bytes in [&[][..], &[1], &[1, 1, 0, 5, 0x42], &[1, 1, 0, 1, 0x42, 9, 1]] {
        assert!(decode(&mut JobDrive::default(), bytes, None, None).is_err());
    }
}

/// The same numbers mean something else to another model: formats, errors, requests, who a parameter is.
#[test]
fn jobs_of_the_other_vendors() {
    let explained = |model: &str, request: &str, response: Option<&str>| {
        let mut drive = JobDrive::new(profile::model::Model::by_name(model).unwrap());
        match response {
            Some(response) => answered(&mut drive, request, response),
            None => request_job(&drive, &octets(request))
                .lines
                .into_iter()
                .map(|(_, line)| line)
                .collect(),
        }
    };
    let read = "07 01 00 01 10 01 01 9E 00 00";
    let text = explained("vlt", read, Some("07 01 00 01 06 01 03 E8"));
    assert!(
        text.contains("Motor Speed High Limit [Hz] (4-14) = 100 Hz   [Unsigned16 03 E8]"),
        "{text}"
    );
    let text = explained("vlt", read, Some("07 81 00 01 44 01 00 65"));
    assert!(text.contains("refused: 0x65 wrong axis"), "{text}");
    for (id, verb) in [
        ("42", "change request (kept)"),
        ("52", "change request (double words)"),
    ] {
        let text = explained(
            "vlt",
            &format!("07 {id} 00 01 10 01 01 9E 00 00 43 01 00 00 03 E8"),
            None,
        );
        assert!(
            text.starts_with(verb) && text.contains("(4-14) = 100 Hz"),
            "{text}"
        );
    }
    let text = explained(
        "vlt",
        "07 51 00 01 10 01 01 9E 00 00",
        Some("07 01 00 01 43 01 00 00 03 E8"),
    );
    assert!(text.contains("(4-14) = 100 Hz   [Double word"), "{text}");
    let text = explained(
        "vlt",
        "08 01 00 01 10 06 06 04 00 00",
        Some("08 01 00 01 09 06 46 43 2D 33 30 32"),
    );
    assert!(text.contains("(15-40") && text.contains("= \"FC-302\""), "{text}");
    let description = "09 01 00 01 20 01 01 9E 00 00";
    let octets = "00 06 00 00 00 00 00 00 1C FF 00 00 00 00 4D 6F 74 6F 72 20 53 70 65 65 64 20 48 69 67 68 \
                  00 00 00 00 00 00 05 28 00 00 00 00 00 00 00 00";
    let text = explained("vlt", description, Some(&format!("09 01 00 01 0A 2E {octets}")));
    assert!(
        text.contains("description of Motor Speed High Limit [Hz] (4-14) = \"Motor Speed High\", Unsigned16, 0 to 132 Hz"),
        "{text}"
    );
    let texts = "0A 01 00 01 30 02 00 64 00 00";
    let text = explained(
        "vlt",
        texts,
        Some(&format!(
            "0A 01 00 01 0A 20 {} {}",
            "53 70 65 65 64 20 6F 70 65 6E 20 6C 6F 6F 70 20",
            "54 6F 72 71 75 65 20 20 20 20 20 20 20 20 20 20"
        )),
    );
    assert!(text.contains("= \"Speed open loop\", \"Torque\""), "{text}");
    // OPTEA p. 119: an application id stands in the subindex of PNU 10001
    let read = "03 01 01 01 10 01 27 11 00 67";
    let text = explained("vacon", read, Some("03 01 01 01 42 01 00 32"));
    assert!(
        text.contains("Acceleration time 1 (ID 103) = 5 s   [Word 00 32]"),
        "{text}"
    );
    let text = explained("vacon", read, Some("03 81 01 01 44 01 00 66"));
    assert!(text.contains("refused: 0x66 "), "{text}");
    assert!(!text.contains("unknown service"), "{text}");
}

proptest::proptest! {
    #[test]
    fn any_bytes_give_an_answer(
        data in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..120),
        request in proptest::option::of(proptest::collection::vec(proptest::prelude::any::<u8>(), 0..60)),
    ) {
        let mut drive = JobDrive::default();
        let _ = decode(&mut drive, &data, None, request.as_deref());
        let _ = decode(&mut drive, &data, Some(Side::Request), None);
        let _ = response_job(&mut drive, &data, request.as_deref());
    }
}

/// What the tables of the dialect forbid is named where it stands, with the number that the drive answers.
#[test]
fn what_the_dialect_forbids_is_named() {
    let lines = |model: &str, hex: &str| -> Vec<String> {
        let octets: Vec<u8> = hex
            .split(' ')
            .map(|octet| u8::from_str_radix(octet, 16).unwrap())
            .collect();
        let mut drive = JobDrive::new(profile::model::Model::by_name(model).unwrap());
        let decoded = decode(&mut drive, &octets, Some(Side::Request), None).unwrap();
        let lines = decoded.lines.into_iter();
        lines
            .filter(|(weight, _)| *weight == Weight::Error)
            .map(|(_, line)| line)
            .collect()
    };
    assert_eq!(
        lines("vacon", "01 01 05 02 10 01 03 9A 00 00 10 EB 03 AF 00 00"),
        ["  not allowed (Vacon): axis 5 does not exist, only 1: answered with error 0x19"]
    );
    assert_eq!(
        lines("akd", "01 02 00 01 10 01 03 A2 00 00 00 00"),
        ["    not allowed (AKD): 0x00 is not the format of a value: answered with error 0x17"]
    );
    assert_eq!(
        lines("vacon", "01 01 01 00"),
        ["  not allowed (Vacon): 0 parameters, 1 to 39 are allowed: answered with error 0x68"]
    );
    assert_eq!(
        lines("akd", "01 01 01 01 10 01 03 9A 00 00"),
        ["  not allowed (AKD): axis 1 does not exist, only 0: answered with error 0x19"]
    );
    assert_eq!(
        lines("standard", "01 01 07 01 10 01 03 9A 00 00"),
        <[&str; 0]>::default()
    );
    let unknown = words("01 01 07 01 10 01 03 9A 00 00", None);
    assert!(
        unknown.iter().all(|line| !line.contains("not allowed")),
        "{unknown:?}"
    );
}

/// A request ID that does not exist is refused with a response ID of the drive's own; that is its answer.
#[test]
fn the_refusal_of_an_unknown_request_answers_it() {
    let read = "10 01 03 9A 00 00";
    for (device, head, answer) in [
        ((0x01BA, 0x0100), "05 03 01 01", "05 80 01 01 44 01 00 21"),
        ((0x01BA, 0x0100), "05 42 01 01", "05 80 01 01 44 01 00 21"),
        ((0x0080, 0x0001), "05 03 00 01", "05 81 00 01 44 01 00 66"),
        ((0x0080, 0x0001), "05 42 00 01", "05 81 00 01 44 01 00 66"),
    ] {
        let mut drive = JobDrive::of(device.0, device.1);
        let request = octets(&format!("{head} {read}"));
        let decoded = decode(&mut drive, &octets(answer), None, Some(&request)).unwrap();
        let lines: Vec<&str> = decoded.lines.iter().map(|(_, line)| line.as_str()).collect();
        assert!(lines.iter().any(|line| line.contains("refused: 0x")), "{lines:?}");
        assert!(!lines.iter().any(|line| line.contains('!')), "{lines:?}");
        assert!(!lines[0].contains("unknown"), "{lines:?}");
    }
    // the refusal of another request is none
    let mut drive = JobDrive::of(0x01BA, 0x0100);
    let request = octets(&format!("05 01 01 01 {read}"));
    let decoded = decode(
        &mut drive,
        &octets("05 80 01 01 44 01 00 21"),
        None,
        Some(&request),
    )
    .unwrap();
    let last = &decoded.lines.last().expect("a line").1;
    assert_eq!(last, "  ! answers another kind of request");
}

/// The AKD manual 3.6 reserves the attribute 0x00: no response begins with such a format.
#[test]
fn a_request_with_an_unknown_attribute_is_recognised_without_a_direction() {
    for (hex, attribute) in [
        ("05 01 00 01 00 01 03 A2 00 00", "0x00"),
        ("05 01 00 01 50 01 03 A2 00 00", "0x50"),
        ("05 01 00 01 00 01 03 A2 00 00 00 00", "0x00"),
        ("05 02 00 01 00 01 03 A2 00 00 42 01 00 02", "0x00"),
    ] {
        let lines = words(hex, None);
        assert!(
            lines.iter().any(|line| line.contains(&format!(
                "attribute {attribute} does not exist: answered with error 0x16"
            ))),
            "{hex}: {lines:?}"
        );
    }
}

/// The AKD manual 3.6: PNU 0x0001 to 0xFFFF, and the reference 0x00 is reserved.
#[test]
fn the_number_0_and_the_reference_0_are_named() {
    let lines = |model: &str, hex: &str| -> Vec<String> {
        let mut drive = JobDrive::new(profile::model::Model::by_name(model).unwrap());
        let decoded = decode(&mut drive, &octets(hex), None, None).unwrap();
        decoded.lines.into_iter().map(|(_, line)| line).collect()
    };
    for model in ["akd", "vlt", "standard"] {
        let read = lines(model, "05 01 00 01 10 01 00 00 00 00");
        let change = lines(model, "05 02 00 01 10 01 00 00 00 00 42 01 00 02");
        for found in [read, change] {
            let words = "parameter number 0 does not exist: answered with error 0x00";
            let named: Vec<_> = found.iter().filter(|line| line.contains(words)).collect();
            assert!(
                matches!(&named[..], [one] if one.contains("not allowed")),
                "{model}: {found:?}"
            );
        }
        let found = lines(model, "00 01 00 01 10 01 03 A2 00 00");
        assert!(
            found.iter().any(|line| line == "  ! reference 0 is reserved"),
            "{found:?}"
        );
    }
    let found = lines("vacon", "00 01 01 01 10 01 03 9A 00 00");
    let named = found
        .iter()
        .filter(|line| line.contains("reference 0 is reserved"));
    assert_eq!(named.count(), 1, "{found:?}");
    let drive = &mut JobDrive::default();
    let decoded = decode(drive, &octets("00 01 00 01 10 01 03 A2 00 00"), None, None).unwrap();
    assert_eq!(decoded.fields["warnings"][0], "reference 0 is reserved");
}
