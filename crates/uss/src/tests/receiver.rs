//! Telegrams among noise, halves, wrong check octets and lumps.

use proptest::prelude::*;

use super::*;

const START: Duration = Duration::from_secs(1);

fn receiver() -> (Timing, Receiver) {
    let timing = Timing::fc(9600);
    (timing, Receiver::new(timing, Layout::FC))
}

fn process(number: u8) -> Vec<u8> {
    telegram(Address(0x81), &[0x04, 0x7C, 0x20, number])
}

#[test]
fn a_telegram_at_the_pace_of_the_line() {
    let (timing, mut receiver) = receiver();
    let (end, found) = feed(&mut receiver, &timing, START, &process(0));
    assert_eq!(found, [hex("04 7C 20 00")]);
    // taken when the start delay has passed behind it
    assert_eq!(end, START + timing.telegram(8) + timing.start_delay);
    assert_eq!(receiver.statistics().telegrams, 1);
}

#[test]
fn silence_ends_whatever_was_wrong() {
    let whole = process(1);
    let mut wrong_check = whole.clone();
    wrong_check[7] ^= 0x10;
    // LGE 254 with too little behind it; a length no FC telegram has; half a telegram; noise; a telegram cut in front
    let wrongs = [
        hex("02 FE 81 00 00"),
        hex("02 05 81 00 00"),
        whole[..5].to_vec(),
        hex("FF 00 55"),
        whole[1..].to_vec(),
        wrong_check,
        hex("02"),
        hex("02 02 02 02"),
    ];
    for wrong in wrongs {
        let (timing, mut receiver) = receiver();
        let (now, found) = feed(&mut receiver, &timing, START, &wrong);
        assert_eq!(found, [[0; 0]; 0], "{wrong:02X?}");
        let (_, found) = feed(&mut receiver, &timing, now + timing.start_delay, &process(2));
        assert_eq!(found, [hex("04 7C 20 02")], "behind {wrong:02X?}");
        let seen = receiver.statistics();
        assert_eq!(seen.telegrams, 1);
        assert!(
            seen.noise + seen.broken + seen.lengths + seen.checksums > 0,
            "{wrong:02X?}"
        );
    }
}

/// Octets inside a damaged telegram that look like a telegram are not one: no station sent them.
#[test]
fn a_telegram_inside_a_damaged_one_is_ignored() {
    let inner = process(3);
    let outer = telegram(
        Address(0x81),
        &[&hex("F3 EF 05 00")[..], &inner[..], &[0; 4]].concat(),
    );
    for at in 0..outer.len() - inner.len() - 5 {
        let (timing, mut receiver) = receiver();
        let mut damaged = outer.clone();
        damaged[at] ^= 0x40;
        let (_, found) = feed(&mut receiver, &timing, START, &damaged);
        assert!(found.is_empty(), "octet {at}: {found:02X?}");
    }
    // the tail of a telegram that broke off in front: no silence before its STX
    for head in [&outer[1..7], &[0xFF], &[0xFF, 0x00]] {
        let (timing, mut receiver) = receiver();
        let (_, found) = feed(&mut receiver, &timing, START, &[head, &inner].concat());
        assert!(found.is_empty(), "behind {head:02X?}: {found:02X?}");
        assert_eq!(receiver.statistics().noise, (head.len() + inner.len()) as u64);
    }
}

/// A damaged LGE that shortens a telegram, with a check octet that matches by chance.
#[test]
fn what_follows_betrays_a_short_length() {
    let (timing, mut receiver) = receiver();
    // as parameter block it has LGE 0E; flipped to 06 its eighth octet is the right check octet
    let mut data = hex("15 FA 00 01 00 00 00 00 00 00 00 00");
    let mut octets = telegram(Address(0x81), &data);
    octets[1] = 0x06;
    data[4] = bcc(&octets[..7]);
    octets[7] = data[4];
    assert!(Telegram::decode(&octets[..8]).is_ok(), "it would be one");
    let (_, found) = feed(&mut receiver, &timing, START, &octets);
    assert!(found.is_empty());
    assert_eq!(receiver.statistics().trailing, 1);
}

/// A port may deliver several telegrams at once: echo and reply, or a broadcast and what follows.
#[test]
fn telegrams_in_one_lump() {
    let (_, mut receiver) = receiver();
    let lump = [process(1), process(2), process(3)].concat();
    let mut found = Vec::new();
    for &octet in &lump {
        receiver.handle_octet(START, octet);
        found.extend(receiver.take().map(|telegram| telegram.data[3]));
    }
    receiver.handle_timeout(receiver.poll_timeout().unwrap());
    found.extend(receiver.take().map(|telegram| telegram.data[3]));
    assert_eq!(found, [1, 2, 3]);
}

/// With a wide gap a telegram may come in pieces.
#[test]
fn a_telegram_in_pieces() {
    let timing = Timing::fc(9600);
    let octets = process(1);
    for (gap, whole) in [(Duration::ZERO, false), (Duration::from_millis(20), true)] {
        let mut receiver = Receiver::new(timing.with_gap(gap), Layout::FC);
        let (first, second) = octets.split_at(4);
        for &octet in first {
            receiver.handle_octet(START, octet);
        }
        for &octet in second {
            receiver.handle_octet(START + Duration::from_millis(16), octet);
        }
        if let Some(due) = receiver.poll_timeout() {
            receiver.handle_timeout(due);
        }
        assert_eq!(receiver.take().is_some(), whole);
    }
}

proptest! {
    /// Whatever came before, an undamaged telegram behind silence is taken; and nothing is ever waited for without end.
    #[test]
    fn noise_then_silence_then_a_telegram(noise in prop::collection::vec(prop_oneof![any::<u8>(), Just(STX)], 0..400),
                                          data in prop::collection::vec(any::<u8>(), 8..60)) {
        let (timing, mut receiver) = receiver();
        let (now, _) = feed(&mut receiver, &timing, START, &noise);
        prop_assert_eq!(receiver.poll_timeout(), None);
        let octets = telegram(Address(5), &data);
        let (_, found) = feed(&mut receiver, &timing, now + timing.start_delay, &octets);
        prop_assert_eq!(found, [data]);
    }

    /// One bit wrong anywhere: nothing is taken.
    #[test]
    fn flipped_bits(data in prop::collection::vec(any::<u8>(), 8..40), bit in 0..360_usize) {
        let (timing, mut receiver) = receiver();
        let mut octets = telegram(Address(5), &data);
        let bit = bit % (8 * octets.len());
        octets[bit / 8] ^= 1 << (bit % 8);
        let (_, found) = feed(&mut receiver, &timing, START, &octets);
        prop_assert!(found.is_empty(), "{:02x?} from {:02x?}", found, octets);
    }

    /// Cut anywhere, and then sent again whole.
    #[test]
    fn truncated(data in prop::collection::vec(any::<u8>(), 8..40), cut in 0..44_usize) {
        let (timing, mut receiver) = receiver();
        let octets = telegram(Address(5), &data);
        let cut = cut % octets.len();
        let (now, found) = feed(&mut receiver, &timing, START, &octets[..cut]);
        prop_assert!(found.is_empty());
        let (_, found) = feed(&mut receiver, &timing, now + timing.start_delay, &octets);
        prop_assert_eq!(found, [data]);
    }
}
