//! Responses beside the request they answer: repeated addresses, zeros at the end, requests that are not complete.

use super::*;

fn drive(model: &str) -> JobDrive {
    JobDrive::new(profile::model::Model::by_name(model).unwrap())
}

/// Returns the lines of a response, which are those of a capture too.
fn lines(model: &str, request: Option<&str>, response: &str) -> Vec<String> {
    let request = request.map(octets);
    let response = octets(response);
    let decoded = decode(
        &mut drive(model),
        &response,
        Some(Side::Response),
        request.as_deref(),
    )
    .unwrap();
    let captured = response_job(&mut drive(model), &response, request.as_deref());
    assert_eq!(decoded.fields, captured.fields);
    decoded.lines.into_iter().map(|(_, line)| line).collect()
}

fn failure(model: &str, request: Option<&str>, response: &str) -> String {
    let request = request.map(octets);
    let response = octets(response);
    let decoded = decode(
        &mut drive(model),
        &response,
        Some(Side::Response),
        request.as_deref(),
    );
    let reason = decoded.unwrap_err().reason;
    let captured = response_job(&mut drive(model), &response, request.as_deref());
    assert_eq!(captured.fields["malformed"], reason.as_str());
    reason
}

/// The zeros of a buffer are not the address of another parameter, and a refusal stays one.
#[test]
fn zeros_behind_a_response_are_not_a_repeated_address() {
    let read = "01 01 00 01 10 02 00 78 00 00";
    let refusal = "01 81 00 01 44 01 00 16 00 00 00 00";
    let zeros = "  ! 4 zero octets behind the last value";
    let found = lines("vlt", Some(read), refusal);
    assert!(
        found[1].contains("(1-20") && found[1].contains("refused: 0x16"),
        "{found:?}"
    );
    assert_eq!(found[2], zeros);
    for model in ["vlt", "akd", "vacon", "standard"] {
        let found = lines(model, None, refusal);
        assert!(found[1].starts_with("  refused: 0x16"), "{model}: {found:?}");
        assert_eq!(found[2], zeros);
    }
    // a value: it was called written
    let mode = "05 01 00 01 10 01 03 A2 00 00";
    let found = lines("akd", Some(mode), "05 01 00 01 42 01 00 02 00 00 00 00");
    assert!(found[1].starts_with("  Operating mode (p0930) = 2"), "{found:?}");
    let error = failure("akd", Some(mode), "05 01 00 01 42 01 00 02 00 00 00 01");
    assert_eq!(error, "4 octets are left over at octet 8");
}

#[test]
fn addresses_of_another_request_are_not_repeated_ones() {
    let mode = "55 01 00 01 10 01 03 A2 00 00";
    let found = lines("akd", Some(mode), "55 01 00 01 10 01 03 A2 00 00 42 01 00 02");
    assert!(found[1].starts_with("  Operating mode (p0930) = 2"), "{found:?}");
    assert_eq!(found.len(), 2);
    let other = "55 01 00 01 10 01 03 B3 00 00 42 01 00 02";
    let found = lines("akd", Some(mode), other);
    assert_eq!(
        found.last().expect("a line"),
        "  ! answers Fault number (r0947[0]), requested was Operating mode (p0930)"
    );
    // without the request the addresses are all there is, of a drive that repeats them
    for model in ["akd", "standard"] {
        let found = lines(model, None, other);
        assert!(found[1].contains("0947") && found[1].contains("= 2"), "{found:?}");
    }
    for model in ["vlt", "vacon"] {
        failure(model, None, other);
        // and without a direction it is a request with octets too many
        let decoded = decode(&mut drive(model), &octets(other), None, None).unwrap();
        assert_eq!(decoded.fields["side"], "request", "{model}");
    }
}

/// What a drive answers to a request that is cut off, or has more parameters than it takes.
#[test]
fn the_refusal_of_an_incomplete_request_answers_it() {
    for (request, response, number) in [
        (
            "55 01 01 02 10 01 27 11 00 67",
            "55 81 01 02 44 01 00 6B 44 01 00 6B",
            "0x6B",
        ),
        ("55 01 01 FF 10 01 27 11 00 67", "55 81 01 01 44 01 00 68", "0x68"),
    ] {
        let found = lines("vacon", Some(request), response);
        assert_eq!(found, lines("vacon", None, response), "{request}");
        assert!(found[1].starts_with(&format!("  refused: {number}")), "{found:?}");
        // its header says what it was
        let found = lines("vacon", Some(&request.replace("55 01", "54 02")), response);
        let warnings = &found[found.len() - 2..];
        assert_eq!(
            warnings,
            [
                "  ! answers request 85, not 84",
                "  ! answers another kind of request"
            ]
        );
    }
    let decoded = decode(
        &mut drive("vacon"),
        &octets("55 81 01 01 44 01 00 68"),
        None,
        Some(&[0x55, 1]),
    );
    assert_eq!(
        decoded.unwrap_err().reason,
        "its request has 2 octets, a header has 4"
    );
}

/// An element of a description is not a value: it has no unit, no scale, no subindex, and cannot be written.
#[test]
fn elements_of_a_description_have_no_unit() {
    let line_and_value = |model: &str, request: &str, response: &str| {
        let decoded = decode(&mut drive(model), &octets(response), None, Some(&octets(request))).unwrap();
        let value = decoded.fields["parameters"][0]["values"][0].clone();
        (decoded.lines[1].1.clone(), value)
    };
    let (line, value) = line_and_value("vlt", "01 01 00 01 20 01 00 78 00 01", "01 01 00 01 0A 02 00 07");
    assert!(
        line.contains("description element 1 (identifier) of Motor Power [kW] (1-20) = 00 07"),
        "{line}"
    );
    assert!(!line.contains("07 kW"), "{line}");
    assert_eq!((&value["unit"], &value["number"]), (&"".into(), &"1-20".into()));
    assert_eq!(
        (&value["writable"], &value["index"]),
        (&false.into(), &Value::Null)
    );
    // the limit of a speed is not scaled like one, and not a control word in words
    let (line, value) = line_and_value("akd", "01 01 00 01 20 01 00 05 00 02", "01 01 00 01 42 01 00 07");
    assert!(line.contains("= 7   [") && !line.contains("if "), "{line}");
    assert_eq!((&value["value"], &value["unit"]), (&7.0.into(), &"".into()));
    let (line, _) = line_and_value("akd", "01 01 00 01 20 01 00 01 00 02", "01 01 00 01 42 01 00 07");
    assert!(line.contains("= 7   ["), "{line}");
}

const MODE: &str = "01 01 00 01 10 01 03 A2 00 00";
const TWO: &str = "01 01 00 02 10 01 03 A2 00 00 10 01 03 B0 00 00";

/// What no drive answers to this request is marked.
#[test]
fn each_difference_from_the_request_is_named() {
    for (request, response, warning) in [
        (
            "01 01 01 01 10 01 03 A2 00 00",
            "01 01 00 01 42 01 00 02",
            "answers axis 0, requested was axis 1",
        ),
        (
            TWO,
            "01 01 00 01 42 01 00 02",
            "answers 1 parameter, requested were 2",
        ),
        (
            MODE,
            "01 01 00 02 42 01 00 02 42 01 00 01",
            "answers 2 parameters, requested were 1",
        ),
        (
            MODE,
            "01 01 00 01 41 01 02 00",
            "Operating mode (p0930): Byte, the parameter has 2 octets",
        ),
        (
            MODE,
            "01 01 00 01 06 01 00 02",
            "Operating mode (p0930): Unsigned16, this drive answers Byte, Word and Double word only",
        ),
        (
            MODE,
            "01 01 00 01 42 02 00 02 00 01",
            "Operating mode (p0930): 2 values answered, requested were 1",
        ),
        (
            MODE,
            "01 01 00 01 10 01 03 A3 00 00 42 01 00 02",
            "answers 0931, requested was Operating mode (p0930)",
        ),
        (
            "05 02 00 02 10 01 03 A2 00 00 10 01 03 EC 00 00 42 01 00 02 42 01 00 01",
            "05 02 00 01 00 00",
            "answers 1 parameter, requested were 2",
        ),
    ] {
        let found = lines("akd", Some(request), response);
        let warnings: Vec<&String> = found.iter().filter(|line| line.starts_with("  ! ")).collect();
        assert_eq!(warnings, [&format!("  ! {warning}")], "{response}: {found:?}");
    }
    for (request, response) in [
        (MODE, "01 01 00 01 42 01 00 02"),
        (MODE, "01 01 00 01 10 01 03 A2 00 00 42 01 00 02"),
        (TWO, "01 81 00 02 42 01 00 02 44 01 00 00"),
        ("01 01 00 01 10 02 03 B3 00 00", "01 01 00 01 42 02 02 BE 00 00"),
    ] {
        let found = lines("akd", Some(request), response);
        assert!(found.iter().all(|line| !line.contains('!')), "{found:?}");
    }
}

/// Without a request, what this drive never sends.
#[test]
fn a_header_that_the_drive_never_sends_is_named() {
    for (response, warning) in [
        ("00 01 00 01 42 01 00 02", "reference 0 is reserved"),
        ("01 01 07 01 42 01 00 02", "axis 7 does not exist, only 0"),
        ("01 01 00 00", "0 parameters, 1 to 39 are allowed"),
        ("01 02 00 28 00 00", "40 parameters, 1 to 39 are allowed"),
    ] {
        let found = lines("akd", None, response);
        assert_eq!(
            found.last().expect("a line"),
            &format!("  ! {warning}"),
            "{found:?}"
        );
    }
    // of another drive the axis is not known
    let found = lines("standard", None, "01 01 07 01 42 01 00 02");
    assert!(found.iter().all(|line| !line.contains('!')), "{found:?}");
}

/// The layout of the note "AKD PROFINET Parameter Access Byte Descriptions": the address, then "no data".
#[test]
fn a_change_response_that_repeats_the_address_says_written() {
    let request = "05 02 00 01 10 01 03 A2 00 00 42 01 00 02";
    for request in [Some(request), None] {
        let found = lines("akd", request, "05 02 00 01 10 01 03 A2 00 00 00 00");
        assert_eq!(found[1], "  Operating mode (p0930): written", "{found:?}");
        assert_eq!(found.len(), 2, "{found:?}");
    }
}

/// A refusal repeats what was wrong with its request, 0x51 reads four octets whatever the type, and a text has one element.
#[test]
fn what_fits_its_request_is_not_marked() {
    let text = "01 01 00 01 09 14 46 43 2D 33 30 32".to_owned() + &" 20".repeat(14);
    for (model, request, response) in [
        ("akd", "01 01 07 01 10 01 03 A2 00 00", "01 81 07 01 44 01 00 19"),
        (
            "vlt",
            "05 51 00 01 10 01 00 01 00 00",
            "05 01 00 01 07 01 00 00 00 01",
        ),
        ("vlt", "01 01 00 01 10 01 06 04 00 00", text.as_str()),
    ] {
        let found = lines(model, Some(request), response);
        assert!(found.iter().all(|line| !line.contains('!')), "{found:?}");
    }
}
