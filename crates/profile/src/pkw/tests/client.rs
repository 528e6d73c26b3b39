//! What the master side does, telegram by telegram.

use core::time::Duration;

use super::*;

const READ: Job<'static> = Job::Read {
    pnu: 414,
    element: None,
};
const ZERO: [u8; 8] = [0; 8];

const fn at(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

/// Returns a client whose channel has come to rest.
fn rested(dialect: PkwDialect) -> Client {
    let mut client = Client::new(dialect, ClientTiming::CYCLIC);
    assert_eq!(client.request(at(0)), ZERO);
    assert_eq!(client.handle(at(0), &ZERO), None);
    client
}

fn value(word: u16) -> Option<Outcome> {
    Some(Ok(Answer::Value(PkwValue::Word(word))))
}

#[test]
fn a_request_stands_until_its_own_reply() {
    let mut client = rested(PkwDialect::STANDARD);
    client.start(at(0), READ).unwrap();
    assert_eq!(client.start(at(0), READ), Err(StartError::Busy));
    let request = words("11 9E 00 00 00 00 00 00");
    let others = [
        "00 00 00 00 00 00 00 00", // not there yet
        "11 9F 00 00 00 00 00 07", // another parameter
        "11 9E 01 00 00 00 00 07", // another element
        "31 9E 00 00 00 00 00 07", // another kind of reply
        "41 9E 00 00 00 00 00 07",
        "81 9E 00 00 00 00 00 00", // reading needs no rights
        "71 9F 00 00 00 00 00 00", // another's refusal
        "D1 9E 00 00 00 00 00 07", // no reply at all
    ];
    for (millis, other) in others.iter().enumerate() {
        let now = at(millis as u64);
        assert_eq!(client.request(now), request);
        assert_eq!(client.handle(now, &words(other)), None, "{other}");
    }
    for half in [&[][..], &[0x11, 0x9E], &request[..7], &[0x11; 9]] {
        assert_eq!(client.handle(at(10), half), None);
    }
    assert_eq!(
        client.handle(at(10), &words("11 9E 00 00 00 00 05 DC")),
        value(1500)
    );
    assert!(!client.is_busy());
    assert_eq!(client.request(at(11)), ZERO, "at rest AK 0");
}

/// The reply that still stands looks like the reply to the next request: it is not taken.
#[test]
fn a_stale_reply_is_ignored() {
    let mut client = rested(PkwDialect::STANDARD);
    let change = |number| Job::Change {
        pnu: 414,
        element: None,
        value: PkwValue::Word(number),
        memory: Memory::Ram,
    };
    client.start(at(0), change(10)).unwrap();
    let old = words("11 9E 00 00 00 00 00 0A");
    assert_eq!(client.handle(at(0), &old), value(10));
    for next in [change(20), READ] {
        client.start(at(1), next).unwrap();
        assert_eq!(client.request(at(1)), ZERO);
        assert_eq!(client.handle(at(1), &old), None);
        assert_eq!(client.request(at(2)), ZERO);
        assert_eq!(client.handle(at(2), &ZERO), None);
        assert_ne!(client.request(at(3)), ZERO);
        assert_eq!(client.handle(at(3), &words("11 9E 00 00 00 00 00 14")), value(20));
    }
}

/// Another parameter needs no rest, but where refusals do not name theirs.
#[test]
fn the_next_parameter_at_once() {
    let other = Job::Read {
        pnu: 930,
        element: None,
    };
    for (dialect, rest) in [(PkwDialect::STANDARD, false), (PkwDialect::DANFOSS_PPO, true)] {
        let mut client = rested(dialect);
        client.start(at(0), READ).unwrap();
        assert_eq!(client.handle(at(0), &words("11 9E 00 00 00 00 00 0A")), value(10));
        client.start(at(0), other).unwrap();
        assert_eq!(client.request(at(0)) == ZERO, rest, "{}", dialect.name);
    }
}

#[test]
fn after_a_time_out_the_channel_rests_for_a_round_trip() {
    let timing = ClientTiming::CYCLIC;
    let mut client = rested(PkwDialect::STANDARD);
    client.start(at(0), READ).unwrap();
    client.request(at(0));
    assert_eq!(client.poll_timeout(), Some(timing.reply));
    assert_eq!(client.handle_timeout(timing.reply - at(1)), None);
    let mut now = timing.reply;
    assert_eq!(client.handle_timeout(now), Some(Err(JobError::NoReply)));
    assert_eq!(client.poll_timeout(), None);
    // a zero telegram from before counts for nothing, nor does the reply that comes late
    client.start(now, READ).unwrap();
    assert_eq!(client.request(now), ZERO);
    let rested = now + timing.round_trip;
    for reply in [ZERO, words("11 9E 00 00 00 00 00 0A"), ZERO] {
        now += at(80);
        assert_eq!(client.handle(now, &reply), None);
        assert_eq!(client.request(now), ZERO);
    }
    assert_eq!(client.handle(rested, &ZERO), None);
    assert_eq!(client.request(rested), words("11 9E 00 00 00 00 00 00"));
    // the same when the carrier lost the drive
    assert_eq!(client.lost(), Some(Err(JobError::Lost)));
    assert_eq!(client.lost(), None);
    client.start(rested, READ).unwrap();
    assert_eq!(client.request(rested), ZERO);
    client.handle(rested + timing.round_trip - at(1), &ZERO);
    assert_eq!(client.request(rested + timing.round_trip), ZERO);
}

#[test]
fn a_channel_that_never_becomes_idle_is_reported() {
    let timing = ClientTiming::CYCLIC;
    let mut client = Client::new(PkwDialect::STANDARD, timing);
    client.start(at(0), READ).unwrap();
    let stuck = words("11 9E 00 00 00 00 00 0A");
    let end = timing.reply + timing.round_trip;
    assert_eq!(client.handle(end - at(1), &stuck), None);
    assert_eq!(client.handle(end, &stuck), Some(Err(JobError::NotAtRest)));
}

#[test]
fn spontaneous_messages_are_kept_aside() {
    let mut client = rested(PkwDialect::STANDARD);
    client.start(at(0), READ).unwrap();
    for (message, value) in [
        ("91 9E 00 00 00 00 00 07", PkwValue::Word(7)),
        ("A1 9E 00 00 00 01 00 00", PkwValue::DoubleWord(65_536)),
        ("B1 9E 00 00 00 00 00 08", PkwValue::Word(8)),
        ("C1 9E 00 00 00 00 00 09", PkwValue::DoubleWord(9)),
    ] {
        assert_eq!(client.handle(at(0), &words(message)), None);
        let report = client.take_spontaneous().unwrap();
        assert_eq!((report.pnu, report.subindex, report.value), (414, 0, value));
        assert_eq!(client.take_spontaneous(), None);
    }
    assert_eq!(client.handle(at(0), &words("11 9E 00 00 00 00 00 0A")), value(10));
}

#[test]
fn refusals_and_what_to_do() {
    let mut client = rested(PkwDialect::DANFOSS_FC);
    client.start(at(0), READ).unwrap();
    let outcome = client.handle(at(0), &words("71 9E 00 00 00 00 00 82"));
    let error = JobError::Refused(PkwErrorNumber(130));
    assert_eq!(outcome, Some(Err(error)));
    assert_eq!(
        error.remedy(PkwErrorNames::Danfoss),
        "read or set it at the drive's own panel"
    );
    let mut client = rested(PkwDialect::STANDARD);
    let change = Job::Change {
        pnu: 414,
        element: None,
        value: PkwValue::Word(1),
        memory: Memory::Ram,
    };
    client.start(at(0), change).unwrap();
    assert_eq!(
        client.handle(at(0), &words("81 9E 00 00 00 00 00 00")),
        Some(Err(JobError::NoRights))
    );
}

/// Which AK a job becomes in which dialect.
#[test]
fn jobs_and_their_requests() {
    let change = |element, value, memory| Job::Change {
        pnu: 5,
        element,
        value,
        memory,
    };
    let (word, double) = (PkwValue::Word(1), PkwValue::DoubleWord(1));
    let jobs = [
        (
            Job::Read {
                pnu: 5,
                element: None,
            },
            Some(1),
            Some(1),
            Some(1),
        ),
        (
            Job::Read {
                pnu: 5,
                element: Some(1),
            },
            Some(6),
            Some(1),
            Some(6),
        ),
        (change(None, word, Memory::Ram), Some(2), Some(2), Some(2)),
        (change(None, double, Memory::Ram), Some(3), Some(3), Some(3)),
        (change(Some(1), word, Memory::Ram), Some(7), Some(2), Some(7)),
        (change(Some(1), double, Memory::Ram), Some(8), Some(3), Some(8)),
        (change(None, word, Memory::Eeprom), Some(14), Some(14), None),
        (change(None, double, Memory::Eeprom), Some(13), Some(13), None),
        (change(Some(1), word, Memory::Eeprom), Some(12), Some(14), None),
        (change(Some(1), double, Memory::Eeprom), Some(11), Some(13), None),
        (Job::CountElements { pnu: 5 }, Some(9), None, Some(9)),
        (Job::Description { pnu: 5, element: 1 }, Some(4), Some(4), Some(4)),
        (Job::ReadText { pnu: 5, index: 0 }, None, Some(15), None),
    ];
    for (job, standard, fc, ppo) in jobs {
        for (dialect, code) in [
            (PkwDialect::STANDARD, standard),
            (PkwDialect::DANFOSS_FC, fc),
            (PkwDialect::DANFOSS_PPO, ppo),
        ] {
            let mut client = rested(dialect);
            let started = client.start(at(0), job);
            assert_eq!(started.is_ok(), code.is_some(), "{} {job:?}", dialect.name);
            if let Some(code) = code {
                assert_eq!(client.request(at(0))[0] >> 4, code, "{} {job:?}", dialect.name);
            }
        }
    }
}

#[test]
fn requests_that_cannot_be_encoded_are_reported() {
    let mut client = rested(PkwDialect::STANDARD);
    let far = Job::Read {
        pnu: 2048,
        element: None,
    };
    assert_eq!(
        alloc::format!("{}", client.start(at(0), far).unwrap_err()),
        "parameter number 2048 cannot be named in the parameter channel of PROFIdrive V2"
    );
    let text = Job::ReadText { pnu: 5, index: 0 };
    assert_eq!(
        alloc::format!("{}", client.start(at(0), text).unwrap_err()),
        "PROFIdrive V2 has no request to read or write text"
    );
    let mut client = rested(PkwDialect::DANFOSS_FC);
    let long = Job::ChangeText {
        pnu: 5,
        index: 0,
        text: &[b'x'; MAX_TEXT + 1],
    };
    assert_eq!(
        client.start(at(0), long),
        Err(StartError::TextLength(MAX_TEXT + 1))
    );
    assert!(!client.is_busy());
}
