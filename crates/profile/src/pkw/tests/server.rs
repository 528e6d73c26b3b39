//! What the slave side does, request by request.

use super::*;

fn reply(server: &mut Server, drive: &mut Bench, request: &str) -> [u8; 8] {
    server.handle(words(request), drive)
}

#[test]
fn a_reply_stands_and_follows_the_value() {
    let (mut server, mut drive) = (Server::new(PkwDialect::STANDARD), Bench::default());
    for value in [1500, 7, 0, 65535] {
        drive.speed = value;
        let reply = Pkw::from_octets(reply(&mut server, &mut drive, "11 9E 00 00 00 00 00 00"));
        assert_eq!((reply.ak(), reply.pwe), (1, value.into()));
    }
    // also behind a change
    reply(&mut server, &mut drive, "21 9E 00 00 00 00 00 64");
    drive.speed = 99;
    assert_eq!(
        reply(&mut server, &mut drive, "21 9E 00 00 00 00 00 64"),
        words("11 9E 00 00 00 00 00 63")
    );
    // and behind a refusal that is over
    assert_eq!(
        reply(&mut server, &mut drive, "16 4C 00 00 00 00 00 00"),
        words("76 4C 00 00 00 00 00 11")
    );
    drive.running = true;
    assert_eq!(
        reply(&mut server, &mut drive, "16 4C 00 00 00 00 00 00"),
        words("16 4C 00 00 00 00 00 E6")
    );
}

#[test]
fn a_change_is_done_once_until_the_request_changes() {
    let (mut server, mut drive) = (Server::new(PkwDialect::STANDARD), Bench::default());
    let steps = [
        ("21 9E 00 00 00 00 00 64", 1),
        ("21 9E 00 00 00 00 00 64", 1),
        ("21 9E 00 00 00 00 00 65", 2), // another value
        ("E1 9E 00 00 00 00 00 65", 3), // another request
        ("00 00 00 00 00 00 00 00", 3),
        ("E1 9E 00 00 00 00 00 65", 4), // the same after a rest
        ("E1 9E 00 00 00 00 00 65", 4),
    ];
    for (request, writes) in steps {
        reply(&mut server, &mut drive, request);
        assert_eq!(drive.writes.len(), writes, "{request}");
    }
    server.reset();
    reply(&mut server, &mut drive, "E1 9E 00 00 00 00 00 65");
    assert_eq!(drive.writes.len(), 5);
    let kept: Vec<bool> = drive.writes.iter().map(|write| write.3).collect();
    assert_eq!(kept, [false, false, true, true, true]);
}

/// Words of a PPO type, and blocks of four words, three words and text.
#[test]
fn every_request_can_be_refused_and_does_nothing_then() {
    for dialect in [PkwDialect::DANFOSS_FC, PkwDialect::DANFOSS_PPO] {
        let (mut server, mut drive) = (Server::new(dialect), Bench::default());
        let change = "21 9E 00 00 00 00 00 64";
        let changed = reply(&mut server, &mut drive, change);
        server.refuse_all(Some(PkwErrorNumber(131)));
        // what was done before is still acknowledged
        assert_eq!(reply(&mut server, &mut drive, change), changed);
        for request in ["11 9E 00 00 00 00 00 00", "21 9E 00 00 00 00 00 65"] {
            let refused = Pkw::from_octets(reply(&mut server, &mut drive, request));
            assert_eq!((refused.ak(), refused.pwe), (7, 131), "{request}");
            // a new connection changes nothing of it
            server.reset();
        }
        assert_eq!(reply(&mut server, &mut drive, "00 00 00 00 00 00 00 00"), [0; 8]);
        for block_of in ["21 9E 00 00 00 66", "F5 FA 05 00 70 75 6D 70"] {
            let mut out = [0; MAX_BLOCK];
            let length = server
                .handle_block(&block(block_of), &mut drive, &mut out)
                .unwrap();
            assert_eq!((out[0] >> 4, out[length - 1]), (7, 131), "{block_of}");
        }
        assert_eq!(drive.writes.len(), 1);
        // a change that stands is not carried out behind the master's back
        let second = "21 9E 00 00 00 00 00 67";
        reply(&mut server, &mut drive, second);
        server.refuse_all(None);
        assert_eq!(reply(&mut server, &mut drive, second)[0] >> 4, 7);
        assert_eq!(drive.writes.len(), 1);
        server.clear_refusal();
        assert_eq!(reply(&mut server, &mut drive, second)[0] >> 4, 1);
        assert_eq!(drive.writes.len(), 2);
    }
}

/// A refused change is not tried again behind the master's back.
#[test]
fn a_refusal_of_a_change_stands() {
    let (mut server, mut drive) = (Server::new(PkwDialect::STANDARD), Bench::default());
    drive.running = true;
    let change = "33 A2 00 00 00 00 00 02";
    assert_eq!(
        reply(&mut server, &mut drive, change),
        words("73 A2 00 00 00 00 00 11")
    );
    drive.running = false;
    assert_eq!(
        reply(&mut server, &mut drive, change),
        words("73 A2 00 00 00 00 00 11")
    );
    assert!(drive.writes.is_empty());
    assert_eq!(reply(&mut server, &mut drive, "00 00 00 00 00 00 00 00"), [0; 8]);
    assert_eq!(
        reply(&mut server, &mut drive, change),
        words("23 A2 00 00 00 00 00 02")
    );
}

#[test]
fn signs_and_widths() {
    let (mut server, mut drive) = (Server::new(PkwDialect::STANDARD), Bench::default());
    let mut ask = |request: &str| reply(&mut server, &mut drive, request);
    // negative words: PWE high stays 0; an octet is widened to a word
    assert_eq!(ask("10 65 00 00 00 00 00 00"), words("10 65 00 00 00 00 FF FE"));
    assert_eq!(ask("10 64 00 00 00 00 00 00"), words("10 64 00 00 00 00 FF FB"));
    // PWE high of a word request counts for nothing
    assert_eq!(ask("20 65 00 00 FF FF FF FD"), words("10 65 00 00 00 00 FF FD"));
    assert_eq!(ask("20 64 00 00 00 00 FF 80"), words("10 64 00 00 00 00 FF 80"));
    // what an octet cannot hold, in both directions
    assert_eq!(ask("20 64 00 00 00 00 00 80"), words("70 64 00 00 00 00 00 02"));
    assert_eq!(ask("20 64 00 00 00 00 FF 7F"), words("70 64 00 00 00 00 00 02"));
    // the width of the request has to be that of the parameter
    assert_eq!(ask("20 CF 00 00 00 00 00 01"), words("70 CF 00 00 00 00 00 05"));
    assert_eq!(ask("31 9E 00 00 00 00 00 01"), words("71 9E 00 00 00 00 00 05"));
    // eight octets have no room anywhere, a text not here
    assert_eq!(ask("17 D0 00 00 00 00 00 00"), words("77 D0 00 00 00 00 00 05"));
    assert_eq!(ask("16 04 00 00 00 00 00 00"), words("76 04 00 00 00 00 00 05"));
}

#[test]
fn arrays() {
    let (mut server, mut drive) = (Server::new(PkwDialect::STANDARD), Bench::default());
    let mut ask = |request: &str| reply(&mut server, &mut drive, request);
    assert_eq!(ask("95 FA 00 00 00 00 00 00"), words("65 FA 00 00 00 00 00 0A"));
    assert_eq!(ask("65 FA 09 00 00 00 00 00"), words("45 FA 09 00 00 00 00 09"));
    assert_eq!(ask("65 FA 0A 00 00 00 00 00"), words("75 FA 0A 00 00 00 00 03"));
    assert_eq!(ask("75 FA 02 00 00 00 00 21"), words("45 FA 02 00 00 00 00 21"));
    assert_eq!(ask("C5 FA 02 00 00 00 00 22"), words("45 FA 02 00 00 00 00 22"));
    assert_eq!(ask("85 FA 02 00 00 00 00 22"), words("75 FA 02 00 00 00 00 05"));
    // no array
    for request in ["61 9E", "71 9E", "91 9E"] {
        let request = alloc::format!("{request} 00 00 00 00 00 01");
        assert_eq!(Pkw::from_octets(ask(&request)).pwe_low(), 4, "{request}");
    }
    assert_eq!(ask("11 9E 01 00 00 00 00 00"), words("71 9E 01 00 00 00 00 04"));
    assert_eq!(drive.writes, [(1530, 2, 0x21, false), (1530, 2, 0x22, true)]);
    // a Siemens drive requires array requests
    let mut server = Server::new(PkwDialect::SIEMENS_PPO);
    assert_eq!(
        reply(&mut server, &mut drive, "15 FA 01 00 00 00 00 00"),
        words("75 FA 01 00 00 00 00 69")
    );
}

#[test]
fn descriptions() {
    let (mut server, mut drive) = (Server::new(PkwDialect::STANDARD), Bench::default());
    let mut ask = |request: &str| reply(&mut server, &mut drive, request);
    assert_eq!(ask("40 01 08 00 00 00 00 00"), words("30 01 08 00 00 00 00 34"));
    assert_eq!(ask("40 01 03 00 00 00 00 00"), words("30 01 03 00 3F 80 00 00"));
    assert_eq!(ask("40 01 06 00 00 00 00 00"), words("70 01 06 00 00 00 00 0E"));
    assert_eq!(ask("40 01 00 00 00 00 00 00"), words("70 01 00 00 00 00 00 03"));
    assert_eq!(ask("40 01 0D 00 00 00 00 00"), words("70 01 0D 00 00 00 00 03"));
    assert_eq!(ask("50 01 08 00 00 00 00 01"), words("70 01 08 00 00 00 00 07"));
    assert_eq!(ask("41 9E 01 00 00 00 00 00"), words("71 9E 01 00 00 00 00 09"));
}

#[test]
fn rights() {
    let mut drive = Bench {
        rights: false,
        ..Bench::default()
    };
    let change = "21 9E 00 00 00 00 00 64";
    let mut server = Server::new(PkwDialect::STANDARD);
    assert_eq!(
        reply(&mut server, &mut drive, change),
        words("81 9E 00 00 00 00 00 00")
    );
    // the FC protocol has no AK 8
    let mut server = Server::new(PkwDialect::DANFOSS_FC);
    assert_eq!(
        reply(&mut server, &mut drive, change),
        words("71 9E 00 00 00 00 00 0B")
    );
    assert!(drive.writes.is_empty());
    // reading needs none
    assert_eq!(reply(&mut server, &mut drive, "11 9E 00 00 00 00 00 00")[0], 0x11);
}

/// A request that a dialect does not have is refused with its own number and not executed.
#[test]
fn requests_that_do_not_exist() {
    let danfoss = [
        PkwDialect::DANFOSS_PPO,
        PkwDialect::DANFOSS_FC,
        PkwDialect::DANFOSS_WORDS,
    ];
    for (code, expected) in [
        (13, [false, true, true]),
        (14, [false, true, true]),
        (15, [false, true, false]),
    ] {
        let known = danfoss.map(|dialect| dialect.knows(RequestCode(code)));
        assert_eq!(known, expected, "AK {code}");
    }
    for (dialect, number) in [
        (PkwDialect::STANDARD, 18),
        (PkwDialect::DANFOSS_FC, 253),
        (PkwDialect::DANFOSS_WORDS, 253),
        (PkwDialect::DANFOSS_PPO, 18),
        (PkwDialect::SIEMENS_PPO, 106),
        (PkwDialect::SIEMENS_USS, 106),
    ] {
        for code in (0..16).filter(|&code| !dialect.knows(RequestCode(code))) {
            let mut drive = Bench::default();
            let request = [code << 4 | 1, 0x9E, 0, 0, 0, 0, 0, 1];
            let reply = Server::new(dialect).handle(request, &mut drive);
            assert_eq!(
                reply,
                [0x71, 0x9E, 0, 0, 0, 0, 0, number],
                "{} AK {code}",
                dialect.name
            );
            assert!(drive.writes.is_empty());
        }
    }
}

#[test]
fn pages_and_the_spm_bit() {
    let mut drive = Bench::default();
    // page 0x80: PNU 2000, which is eight octets wide
    let mut server = Server::new(PkwDialect::SIEMENS_USS);
    assert_eq!(
        reply(&mut server, &mut drive, "10 00 80 00 00 00 00 00"),
        words("70 00 80 00 00 00 00 66")
    );
    let mut server = Server::new(PkwDialect::SIEMENS_PPO);
    assert_eq!(
        reply(&mut server, &mut drive, "10 00 00 80 00 00 00 00"),
        words("70 00 00 80 00 00 00 66")
    );
    // an undocumented page is a parameter that does not exist
    assert_eq!(
        reply(&mut server, &mut drive, "11 9E 00 01 00 00 00 00"),
        words("71 9E 00 01 00 00 00 00")
    );
    // 11 bits: the bit above is SPM and goes back as 0, whatever a master leaves in it
    for dialect in [PkwDialect::STANDARD, PkwDialect::DANFOSS_PPO] {
        let mut server = Server::new(dialect);
        assert_eq!(
            reply(&mut server, &mut drive, "19 9E 00 00 00 00 00 00"),
            words("11 9E 00 00 00 00 05 DC")
        );
        assert_eq!(
            reply(&mut server, &mut drive, "19 C4 00 00 00 00 00 00"),
            words("71 C4 00 00 00 00 00 00")
        );
    }
    // 12 bits: it is another parameter, and numbers from 2048 on are reached
    let mut server = Server::new(PkwDialect::DANFOSS_FC);
    assert_eq!(
        reply(&mut server, &mut drive, "19 9E 00 00 00 00 00 00"),
        words("79 9E 00 00 00 00 00 00")
    );
    assert_eq!(
        reply(&mut server, &mut drive, "19 C4 00 00 00 00 00 00"),
        words("19 C4 00 00 00 00 05 DC")
    );
}

#[test]
fn texts() {
    let (mut server, mut drive) = (Server::new(PkwDialect::DANFOSS_FC), Bench::default());
    let mut out = [0; MAX_BLOCK];
    let mut ask = |request: &[u8]| {
        let length = server.handle_block(request, &mut drive, &mut out).unwrap();
        out[..length].to_vec()
    };
    let text = |head: &str, text: &[u8]| [&block(head), text].concat();
    // written, read back, written shorter
    assert_eq!(ask(&text("F3 EF 05 00", b"fan")), text("F3 EF 05 00", b"fan"));
    assert_eq!(ask(&text("F3 EF 05 00", b"fan")), text("F3 EF 05 00", b"fan"));
    assert_eq!(ask(&text("F3 EF 04 00", b"")), text("F3 EF 04 00", b"fan"));
    assert_eq!(ask(&text("F3 EF 05 00", b"")), text("F3 EF 05 00", b""));
    let refused = [
        (text("F3 EF 05 00", b"longer than it may be"), 2),
        (text("F6 04 05 00", b"read-only"), 1),
        (text("F6 04 04 01", b"0000"), 4),
        (text("F3 EF 05 01", b"fan"), 4),
        (text("F6 18 04 08", b"0000"), 3),
        (text("F6 18 05 08", b"0000"), 3),
        (text("F1 9E 04 00", b"0000"), 5),
        (text("F6 04 00 00", b"0000"), 253),
        (text("F6 04 06 00", b"0000"), 253),
        (text("F1 9E 00 00", b"0000"), 253),
        (text("F6 05 04 00", b"0000"), 0),
    ];
    for (request, number) in refused {
        let reply = ask(&request);
        assert_eq!(
            (reply[0] >> 4, reply[7], reply.len()),
            (7, number, 8),
            "{request:x?}"
        );
    }
    assert_eq!(drive.label, [b' '; 12]);
    // three octets of text, twelve of blanks: each written once
    assert_eq!(drive.writes.len(), 24);
    // in eight octets a text has no room
    let reply = Server::new(PkwDialect::DANFOSS_FC).handle(words("F6 04 04 00 00 00 00 00"), &mut drive);
    assert_eq!(reply, words("76 04 04 00 00 00 00 0D"));
}

#[test]
fn blocks_that_are_none() {
    let (mut server, mut drive) = (Server::new(PkwDialect::DANFOSS_FC), Bench::default());
    let mut out = [0; MAX_BLOCK];
    let request = words("21 9E 00 00 00 00 00 64");
    for length in (0..6).chain([7]).chain(9..20) {
        let octets: Vec<u8> = request.iter().copied().cycle().take(length).collect();
        assert_eq!(
            server.handle_block(&octets, &mut drive, &mut out),
            Err(BlockError::Length(length))
        );
    }
    let mut long = alloc::vec![b' '; MAX_BLOCK + 1];
    long[..4].copy_from_slice(&block("F3 EF 05 00"));
    assert!(server.handle_block(&long, &mut drive, &mut out).is_err());
    assert_eq!(
        server.handle_block(&request, &mut drive, &mut [0; 7]),
        Err(BlockError::Room)
    );
    assert!(drive.writes.is_empty());
}

/// USS with three words of parameter part: what needs a double word is refused before anything is done.
#[test]
fn blocks_with_one_word_of_value() {
    let (mut server, mut drive) = (Server::new(PkwDialect::SIEMENS_USS), Bench::default());
    let mut out = [0; MAX_BLOCK];
    let mut ask = |request: &str| {
        let length = server
            .handle_block(&block(request), &mut drive, &mut out)
            .unwrap();
        out[..length].to_vec()
    };
    assert_eq!(ask("00 00 00 00 00 00"), [0; 6]);
    assert_eq!(ask("11 9E 00 00 00 00"), block("11 9E 00 00 05 DC"));
    assert_eq!(ask("21 9E 00 00 00 64"), block("11 9E 00 00 00 64"));
    assert_eq!(ask("10 CF 00 00 00 00"), block("70 CF 00 00 00 66"));
    assert_eq!(ask("30 CF 00 00 00 01"), block("70 CF 00 00 00 66"));
    assert_eq!(ask("40 01 00 08 00 00"), block("70 01 00 08 00 66"));
    assert_eq!(ask("40 01 00 01 00 00"), block("30 01 00 01 04 05"));
    // the same request in eight octets is another, and has room
    assert_eq!(ask("10 CF 00 00 00 00 00 00"), block("20 CF 00 00 00 00 03 E8"));
    assert_eq!(drive.writes, [(414, 0, 100, false)]);
}
