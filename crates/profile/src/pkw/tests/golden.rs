//! Examples as printed, both directions: the server gives them, the client takes them.

use core::time::Duration;

use super::*;

/// Request and reply of one worked example; the drive is prepared by `prepare`.
fn both(
    dialect: PkwDialect,
    job: Job<'_>,
    request: &str,
    reply: &str,
    outcome: Outcome,
    prepare: impl Fn(&mut Bench),
) {
    let mut drive = Bench::default();
    prepare(&mut drive);
    let mut server = Server::new(dialect);
    let mut out = [0; MAX_BLOCK];
    let length = server
        .handle_block(&block(request), &mut drive, &mut out)
        .unwrap();
    assert_eq!(out[..length], block(reply), "reply to {request}");

    let mut client = Client::new(dialect, ClientTiming::CYCLIC);
    let now = Duration::ZERO;
    client.start(now, job).unwrap();
    assert_eq!(client.request(now), [0; 8], "rest first");
    assert_eq!(client.handle(now, &[0; 8]), None);
    assert_eq!(client.request(now), block(request));
    assert_eq!(client.handle(now, &block(reply)), Some(outcome), "{reply}");
}

const fn read(pnu: u16, element: Option<u8>) -> Job<'static> {
    Job::Read { pnu, element }
}

/// Danfoss FCM 300 p. 29: parameter 207 = 1000 as a double word.
#[test]
fn a_double_word_in_a_ppo() {
    let value = Ok(Answer::Value(PkwValue::DoubleWord(1000)));
    both(
        PkwDialect::DANFOSS_PPO,
        read(207, None),
        "10 CF 00 00 00 00 00 00",
        "20 CF 00 00 00 00 03 E8",
        value,
        |_| {},
    );
}

/// Danfoss FCM 300 p. 29: rejected with error 2; this print has no PNU in the reply.
#[test]
fn a_refusal_without_a_number() {
    let mut client = Client::new(PkwDialect::DANFOSS_PPO, ClientTiming::CYCLIC);
    let now = Duration::ZERO;
    let change = Job::Change {
        pnu: 414,
        element: None,
        value: PkwValue::Word(4000),
        memory: Memory::Ram,
    };
    client.start(now, change).unwrap();
    client.request(now);
    client.handle(now, &[0; 8]);
    assert_eq!(client.request(now), words("21 9E 00 00 00 00 0F A0"));
    assert_eq!(
        client.handle(now, &words("70 00 00 00 00 00 00 02")),
        Some(Err(JobError::Refused(PkwErrorNumber::LIMIT)))
    );
    // where the number is always there, a reply without it is another's
    let mut client = Client::new(PkwDialect::STANDARD, ClientTiming::CYCLIC);
    client.start(now, change).unwrap();
    client.handle(now, &[0; 8]);
    assert_eq!(client.handle(now, &words("70 00 00 00 00 00 00 02")), None);
}

/// Kollmorgen S300 PROFIBUS p. 46: PNU 930 := 2, done and in the wrong state.
#[test]
fn operation_mode_of_an_s300() {
    let job = Job::Change {
        pnu: 930,
        element: None,
        value: PkwValue::DoubleWord(2),
        memory: Memory::Ram,
    };
    both(
        PkwDialect::STANDARD,
        job,
        "33 A2 00 00 00 00 00 02",
        "23 A2 00 00 00 00 00 02",
        Ok(Answer::Value(PkwValue::DoubleWord(2))),
        |_| {},
    );
    both(
        PkwDialect::STANDARD,
        job,
        "33 A2 00 00 00 00 00 02",
        "73 A2 00 00 00 00 00 11",
        Err(JobError::Refused(PkwErrorNumber::NOT_NOW)),
        |drive| drive.running = true,
    );
}

/// Danfoss FC: 15-30 index 1 by the serial line, where the index is the second octet of IND ...
#[test]
fn alarm_log_of_a_vlt() {
    both(
        PkwDialect::DANFOSS_FC,
        read(1530, Some(1)),
        "15 FA 00 01 00 00 00 00",
        "15 FA 00 01 00 00 00 0E",
        Ok(Answer::Value(PkwValue::Word(14))),
        |_| {},
    );
    // ... and in a PPO, where it is the first and arrays have a request of their own
    both(
        PkwDialect::DANFOSS_PPO,
        read(1530, Some(1)),
        "65 FA 01 00 00 00 00 00",
        "45 FA 01 00 00 00 00 0E",
        Ok(Answer::Value(PkwValue::Word(14))),
        |_| {},
    );
}

/// Danfoss FC: 4-14 := 1000 in RAM and EEPROM; the PKE of the worked example.
#[test]
fn a_value_that_lasts() {
    let job = Job::Change {
        pnu: 414,
        element: None,
        value: PkwValue::Word(1000),
        memory: Memory::Eeprom,
    };
    both(
        PkwDialect::DANFOSS_FC,
        job,
        "E1 9E 00 00 00 00 03 E8",
        "11 9E 00 00 00 00 03 E8",
        Ok(Answer::Value(PkwValue::Word(1000))),
        |_| {},
    );
    let mut drive = Bench::default();
    Server::new(PkwDialect::DANFOSS_FC).handle(words("E1 9E 00 00 00 00 03 E8"), &mut drive);
    assert_eq!(drive.writes, [(414, 0, 1000, true)]);
}

/// Danfoss FC: a parameter that is not there; PNU mirrored, number 0.
#[test]
fn a_parameter_that_is_not_there() {
    for dialect in [
        PkwDialect::DANFOSS_FC,
        PkwDialect::DANFOSS_PPO,
        PkwDialect::SIEMENS_USS,
    ] {
        let mut server = Server::new(dialect);
        assert_eq!(
            server.handle(words("15 FB 00 00 00 00 00 00"), &mut Bench::default()),
            words("75 FB 00 00 00 00 00 00"),
            "{}",
            dialect.name
        );
    }
}

/// Danfoss FC: the printed rejection of 15-30 index 1, which a drive gives that has no such parameter.
#[test]
fn a_printed_rejection() {
    let missing = Job::Read {
        pnu: 1530,
        element: Some(1),
    };
    let mut client = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::CYCLIC);
    let now = Duration::ZERO;
    client.start(now, missing).unwrap();
    client.handle(now, &[0; 8]);
    assert_eq!(client.request(now), words("15 FA 00 01 00 00 00 00"));
    let outcome = client.handle(now, &words("75 FA 00 01 00 00 00 00"));
    assert_eq!(
        outcome,
        Some(Err(JobError::Refused(PkwErrorNumber::UNKNOWN_PARAMETER)))
    );
    // and as octets of the reply
    let request = Pkw::from_octets(words("15 FA 00 01 00 00 00 00"));
    let reply = request.mirrored(&PkwDialect::DANFOSS_FC, ReplyCode::REFUSED, 0);
    assert_eq!(reply.to_octets(), words("75 FA 00 01 00 00 00 00"));
}

/// Kollmorgen S300 PROFIBUS p. 46: the zero telegram at the start is answered with itself, on every carrier.
#[test]
fn the_zero_telegram() {
    for dialect in [
        PkwDialect::STANDARD,
        PkwDialect::DANFOSS_FC,
        PkwDialect::DANFOSS_PPO,
        PkwDialect::SIEMENS_PPO,
        PkwDialect::SIEMENS_USS,
    ] {
        let mut server = Server::new(dialect);
        let drive = &mut Bench::default();
        assert_eq!(server.handle([0; 8], drive), [0; 8], "{}", dialect.name);
        // whatever stands in IND and PWE
        let reply = server.handle(words("00 00 01 02 03 04 05 06"), drive);
        assert_eq!(reply, [0; 8], "{}", dialect.name);
    }
}

/// PKE of the numbers that the guides spell out: 0-01, 1-20, 4-14, 15-30, 15-40.
#[test]
fn numbers_in_the_first_word() {
    for (pnu, pke) in [
        (1, 0x1001),
        (120, 0x1078),
        (414, 0x119E),
        (1530, 0x15FA),
        (1540, 0x1604),
    ] {
        let address = PkwAddress {
            pnu,
            subindex: 0,
            text: 0,
        };
        for dialect in [PkwDialect::DANFOSS_FC, PkwDialect::DANFOSS_PPO] {
            let pkw = Pkw::new(&dialect, 1, address, 0).unwrap();
            assert_eq!(pkw.pke, pke);
            assert_eq!(pkw.address(&dialect), Some(address));
        }
    }
}

/// FC design guide: identifier of 0-01, text array and type 5.
#[test]
fn a_description_element() {
    both(
        PkwDialect::DANFOSS_FC,
        Job::Description { pnu: 1, element: 1 },
        "40 01 00 01 00 00 00 00",
        "30 01 00 01 00 00 04 05",
        Ok(Answer::Description(0x0405)),
        |_| {},
    );
}

/// FC design guide: read 15-40 as text; the reply is as long as the text.
#[test]
fn a_text() {
    both(
        PkwDialect::DANFOSS_FC,
        Job::ReadText { pnu: 1540, index: 0 },
        "F6 04 04 00 00 00 00 00",
        "F6 04 04 00 46 43 2D 33 30 32",
        Ok(Answer::Text),
        |_| {},
    );
    both(
        PkwDialect::DANFOSS_FC,
        Job::ChangeText {
            pnu: 1007,
            index: 0,
            text: b"fan 2",
        },
        "F3 EF 05 00 66 61 6E 20 32",
        "F3 EF 05 00 66 61 6E 20 32",
        Ok(Answer::Text),
        |_| {},
    );
}

/// Output of `decode` for the words.
#[test]
fn words_for_people() {
    let dialect = PkwDialect::DANFOSS_FC;
    let request = |text: &str| alloc::format!("{}", Pkw::from_octets(words(text)).words(&dialect).request());
    let reply = |text: &str| alloc::format!("{}", Pkw::from_octets(words(text)).words(&dialect).reply());
    assert_eq!(request("00 00 00 00 00 00 00 00"), "no request");
    assert_eq!(request("15 FA 00 01 00 00 00 00"), "request value: PNU 1530[1]");
    assert_eq!(
        request("65 FA 00 01 00 00 00 00"),
        "request value (array): PNU 1530[1] (not a request of Danfoss FC protocol)"
    );
    assert_eq!(
        request("F6 04 04 00 00 00 00 00"),
        "read or write text: PNU 1540 (read)"
    );
    assert_eq!(
        reply("75 FA 00 01 00 00 00 83"),
        "PNU 1530[1] refused: 131 change not possible, the factory setup is selected"
    );
    assert_eq!(
        reply("91 9E 00 00 00 00 00 05"),
        "PNU 414 = 5 (word, spontaneous)"
    );
    assert_eq!(
        reply("30 01 00 01 00 00 04 05"),
        "PNU 1[1] description element = 0x405"
    );
}
