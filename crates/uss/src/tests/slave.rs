//! To whom a slave answers, and when.

use super::*;

const START: Duration = Duration::from_secs(1);

/// Sends a telegram at the pace of the line; gives the time when its last octet is there.
fn send(slave: &mut Slave, start: Duration, octets: &[u8]) -> Duration {
    let mut now = start;
    for &octet in octets {
        now += slave.config().timing.character;
        slave.handle_octets(now, &[octet]);
    }
    now
}

/// Returns the data of a request, and whether it was a broadcast.
fn settle(slave: &mut Slave) -> Option<(Vec<u8>, bool)> {
    if let Some(due) = slave.poll_timeout() {
        slave.handle_timeout(due);
    }
    slave
        .poll_request()
        .map(|request| (request.data.to_vec(), request.broadcast))
}

#[test]
fn it_answers_what_is_for_it_and_nothing_else() {
    let data = hex("04 7C 20 00");
    for octet in 0..=255 {
        let mut slave = Slave::new(SlaveConfig::fc(5, 9600));
        let end = send(&mut slave, START, &telegram(Address(octet), &data));
        let addressee = Address(octet).addressee(Protocol::Fc);
        let received = settle(&mut slave);
        let answered = slave.respond(&hex("06 03 00 00")).is_ok()
            && slave
                .poll_transmit(end + slave.config().timing.start_delay, &mut [0; MAX_TELEGRAM])
                .is_some();
        match addressee {
            Addressee::Slave(5) => assert_eq!((received, answered), (Some((data.clone(), false)), true)),
            // statement 121: executed, no answer
            Addressee::Broadcast => assert_eq!((received, answered), (Some((data.clone(), true)), false)),
            _ => assert_eq!((received, answered), (None, false), "{octet:#x}"),
        }
    }
}

#[test]
fn the_address_goes_back_as_it_came() {
    for octet in [0x81, 0x01, 0x41] {
        let mut slave = Slave::new(SlaveConfig::fc(1, 19_200));
        let end = send(&mut slave, START, &telegram(Address(octet), &hex("04 7C 20 00")));
        settle(&mut slave).unwrap();
        slave.respond(&hex("06 03 00 00")).unwrap();
        let mut out = [0; MAX_TELEGRAM];
        let timing = slave.config().timing;
        // not before the start delay
        assert_eq!(slave.poll_timeout(), Some(end + timing.start_delay));
        let early = end + timing.start_delay - Duration::from_nanos(1);
        assert_eq!(slave.poll_transmit(early, &mut out), None);
        let length = slave.poll_transmit(end + timing.start_delay, &mut out).unwrap();
        assert_eq!(out[..length], telegram(Address(octet), &hex("06 03 00 00")));
        assert_eq!(slave.poll_transmit(end + timing.response, &mut out), None, "once");
    }
}

#[test]
fn a_late_reply_is_not_sent() {
    for (late, sent) in [(0, true), (1, false)] {
        let mut slave = Slave::new(SlaveConfig::fc(1, 9600));
        let end = send(&mut slave, START, &telegram(Address(0x81), &hex("04 7C 20 00")));
        settle(&mut slave).unwrap();
        slave.respond(&hex("06 03 00 00")).unwrap();
        let now = end + slave.config().timing.response + Duration::from_nanos(late);
        assert_eq!(slave.poll_transmit(now, &mut [0; MAX_TELEGRAM]).is_some(), sent);
        assert_eq!(slave.counters().dropped, u64::from(!sent));
    }
}

/// The master did not wait: its next telegram is answered, not the first.
#[test]
fn a_busy_line_takes_the_reply_away() {
    let mut slave = Slave::new(SlaveConfig::fc(1, 9600));
    send(&mut slave, START, &telegram(Address(0x81), &hex("04 7C 20 00")));
    settle(&mut slave).unwrap();
    slave.respond(&hex("06 03 00 00")).unwrap();
    let again = START + Duration::from_millis(20);
    let end = send(&mut slave, again, &telegram(Address(0x81), &hex("04 7C 20 01")));
    let mut out = [0; MAX_TELEGRAM];
    assert_eq!(slave.poll_transmit(end, &mut out), None);
    assert_eq!(settle(&mut slave).unwrap().0, hex("04 7C 20 01"));
    slave.respond(&hex("06 03 00 01")).unwrap();
    let due = end + slave.config().timing.start_delay;
    let length = slave.poll_transmit(due, &mut out).unwrap();
    assert_eq!(out[..length], telegram(Address(0x81), &hex("06 03 00 01")));
}

/// The echo of its own reply is not a request.
#[test]
fn its_own_echo_is_not_answered() {
    for echo in [Echo::Yes, Echo::Detect] {
        let mut slave = Slave::new(SlaveConfig {
            echo,
            ..SlaveConfig::fc(1, 9600)
        });
        let end = send(&mut slave, START, &telegram(Address(0x81), &hex("04 7C 20 00")));
        settle(&mut slave).unwrap();
        slave.respond(&hex("06 03 00 00")).unwrap();
        let mut out = [0; MAX_TELEGRAM];
        let now = end + slave.config().timing.start_delay;
        let length = slave.poll_transmit(now, &mut out).unwrap();
        send(&mut slave, now, &out[..length]);
        assert_eq!(settle(&mut slave), None);
        assert_eq!((slave.counters().echoes, slave.counters().requests), (1, 1));
        // the next request like that reply is a request
        send(&mut slave, now + Duration::from_secs(1), &out[..length]);
        assert!(settle(&mut slave).is_some());
    }
}

#[test]
fn a_mirror_telegram_comes_back() {
    let mut slave = Slave::new(SlaveConfig::uss(7, 9600));
    let octets = telegram(Address::uss(7).unwrap().mirror(), &[0xA5; 12]);
    let end = send(&mut slave, START, &octets);
    assert_eq!(settle(&mut slave), None);
    let mut out = [0; MAX_TELEGRAM];
    let length = slave
        .poll_transmit(end + slave.config().timing.start_delay, &mut out)
        .unwrap();
    assert_eq!(out[..length], octets);
    // another's
    let octets = telegram(Address::uss(8).unwrap().mirror(), &[0xA5; 12]);
    let end = send(&mut slave, START + Duration::from_secs(1), &octets);
    settle(&mut slave);
    assert_eq!(
        slave.poll_transmit(end + slave.config().timing.start_delay, &mut out),
        None
    );
}

#[test]
fn a_reply_that_fits_no_telegram_is_refused() {
    let mut slave = Slave::new(SlaveConfig::uss(7, 9600));
    send(&mut slave, START, &telegram(Address(7), &[0; 12]));
    settle(&mut slave).unwrap();
    assert_eq!(slave.respond(&[0; 4]), Err(EncodeError::Layout(4)));
    assert_eq!(slave.respond(&[0; 12]), Ok(()));
}
