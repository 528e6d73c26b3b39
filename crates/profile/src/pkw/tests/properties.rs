//! What holds for every telegram, sensible or not.

use core::time::Duration;

use proptest::prelude::*;

use super::*;

const DIALECTS: [PkwDialect; 5] = [
    PkwDialect::STANDARD,
    PkwDialect::DANFOSS_FC,
    PkwDialect::DANFOSS_PPO,
    PkwDialect::SIEMENS_PPO,
    PkwDialect::SIEMENS_USS,
];

fn request_of_a_known_parameter() -> impl Strategy<Value = [u8; 8]> {
    let pnu = prop::sample::select(&[1_u16, 100, 101, 207, 414, 930, 1007, 1530, 1540, 1612][..]);
    (0..16_u16, pnu, 0..3_u8, 0..3_u8, any::<u32>()).prop_map(|(ak, pnu, first, second, pwe)| {
        Pkw {
            pke: ak << 12 | pnu,
            ind: u16::from_be_bytes([first, second]),
            pwe,
        }
        .to_octets()
    })
}

proptest! {
    #[test]
    fn octets_survive(octets in any::<[u8; 8]>(), dialect in prop::sample::select(&DIALECTS[..])) {
        let pkw = Pkw::from_octets(octets);
        prop_assert_eq!(pkw.to_octets(), octets);
        // decoding and encoding again restores the words, except for undefined bits
        if let Some(address) = pkw.address(&dialect)
            && let Some(again) = Pkw::new(&dialect, pkw.ak(), address, pkw.pwe)
        {
            prop_assert_eq!(again.address(&dialect), Some(address));
            prop_assert_eq!((again.ak(), again.pwe), (pkw.ak(), pkw.pwe));
        }
        let _ = std_text(pkw, &dialect);
    }

    #[test]
    fn every_request_has_one_fitting_reply(octets in prop_oneof![any::<[u8; 8]>(), request_of_a_known_parameter()],
                                           dialect in prop::sample::select(&DIALECTS[..])) {
        let mut drive = Bench::default();
        let mut server = Server::new(dialect);
        let first = server.handle(octets, &mut drive);
        let writes = drive.writes.len();
        prop_assert_eq!(server.handle(octets, &mut drive), first, "asked again");
        prop_assert_eq!(drive.writes.len(), writes, "written again");
        let (request, reply) = (Pkw::from_octets(octets), Pkw::from_octets(first));
        let info = request.request_code().info();
        let code = reply.reply_code();
        prop_assert!(info.replies.contains(&code) || info.refusals.contains(&code) || code == ReplyCode::REFUSED);
        prop_assert!(dialect.replies_with(code), "{} in {}", code, dialect.name);
        if info.action != Action::Nothing {
            prop_assert_eq!(reply.ind, request.ind);
            prop_assert_eq!(reply.address(&dialect), request.address(&dialect));
        }
        if code == ReplyCode::REFUSED {
            let number = PkwErrorNumber(reply.pwe_low());
            prop_assert!(number.info(dialect.error_names).is_some(), "{number} in {}", dialect.name);
            prop_assert_eq!(writes, 0);
        }
    }

    #[test]
    fn any_block_is_answered_or_refused(octets in prop::collection::vec(any::<u8>(), 0..300), text in any::<bool>(),
                                        room in 0..300_usize) {
        let mut octets = octets;
        if text && let Some(first) = octets.first_mut() {
            *first |= 0xF0;
        }
        let mut out = alloc::vec![0; room];
        if let Ok(length) = Server::new(PkwDialect::DANFOSS_FC).handle_block(&octets, &mut Bench::default(), &mut out) {
            prop_assert!(length <= room && length >= 4);
        }
    }

    /// A client reads the value of the parameter from the server, independent of earlier jobs.
    #[test]
    fn a_client_and_a_server_agree(jobs in prop::collection::vec((0..5_usize, any::<u16>()), 1..20),
                                   dialect in prop::sample::select(&DIALECTS[..])) {
        let mut drive = Bench::default();
        let mut server = Server::new(dialect);
        let mut client = Client::new(dialect, ClientTiming::CYCLIC);
        let now = Duration::ZERO;
        for (kind, number) in jobs {
            let job = match kind {
                0 => Job::Read { pnu: 101, element: None },
                1 => Job::Read { pnu: 1530, element: Some((number % 12) as u8) },
                2 => Job::Change { pnu: 101, element: None, value: PkwValue::Word(number), memory: Memory::Ram },
                3 => Job::Change { pnu: 207, element: None, value: PkwValue::DoubleWord(number.into()), memory: Memory::Ram },
                _ => Job::Read { pnu: 207, element: None },
            };
            client.start(now, job).unwrap();
            let mut outcome = None;
            for _ in 0..4 {
                let mut out = [0; MAX_BLOCK];
                let length = server.handle_block(client.request(now), &mut drive, &mut out).unwrap();
                outcome = client.handle(now, &out[..length]);
                if outcome.is_some() {
                    break;
                }
            }
            let expected = match kind {
                1 if number % 12 > 9 => Err(JobError::Refused(PkwErrorNumber::SUBINDEX)),
                1 => Ok(Answer::Value(PkwValue::Word(drive.log[usize::from(number % 12)].into()))),
                0 => Ok(Answer::Value(PkwValue::Word(drive.word as u16))),
                2 => Ok(Answer::Value(PkwValue::Word(number))),
                3 => Ok(Answer::Value(PkwValue::DoubleWord(number.into()))),
                _ => Ok(Answer::Value(PkwValue::DoubleWord(drive.long))),
            };
            prop_assert_eq!(outcome, Some(expected));
        }
    }
}

/// Words for people are given for anything.
fn std_text(pkw: Pkw, dialect: &PkwDialect) -> alloc::string::String {
    alloc::format!("{} {}", pkw.words(dialect).request(), pkw.words(dialect).reply())
}
