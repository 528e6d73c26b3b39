//! The parameter channel in cyclic data: each request once, and its reply once.

use profile::pkw::{Pkw, PkwDialect, ReplyCode, RequestCode};

use super::event::{Detail, Job, Sink};
use crate::Weight;
use crate::fields;
use crate::job::{JobDrive, pkw};

/// For how many frames a reply that was there before the request is taken for an old one.
const OLD: u32 = 3;

/// One direction of a channel.
#[derive(Debug, Default)]
pub struct Channel {
    /// What is in it now.
    pub last: Pkw,
    /// The request that is to be answered, where this is the direction of replies.
    asked: Pkw,
    /// What was there when that request came.
    before: Pkw,
    /// Frames since.
    frames: u32,
    answered: bool,
}

impl Channel {
    /// Looks at the words of a frame. `sent` is what the controller has in the channel.
    pub fn look(&mut self, drive: &mut JobDrive, now: Pkw, output: bool, sent: Pkw, sink: &mut Sink<'_>) {
        let dialect = drive.ppo();
        let changed = now != self.last;
        let before = self.last;
        self.last = now;
        if output {
            if changed && now.request_code() != RequestCode::NONE {
                let line = pkw::request(drive, dialect, now, None);
                report(line, dialect, now, "request", sink);
            }
            return;
        }
        if now.reply_code().info().spontaneous {
            if changed {
                let line = pkw::reply(drive, dialect, now, None);
                report(line, dialect, now, "response", sink);
            }
            return;
        }
        if sent != self.asked {
            self.asked = sent;
            self.before = before;
            self.frames = 0;
            self.answered = false;
        }
        self.frames = self.frames.saturating_add(1);
        let fresh = now != self.before || self.frames > OLD;
        let known = sent.request_code() != RequestCode::NONE;
        let fits = known && pkw::answers(dialect, sent, now);
        // without its request, as at the start of a capture, a reply is reported when it comes
        let unsolicited = !known
            && changed
            && now.reply_code() != ReplyCode::NONE
            && sent == Pkw::ZERO
            && before == Pkw::ZERO;
        if (fits && fresh && !self.answered) || unsolicited {
            self.answered = true;
            if let Some(reading) = pkw::reading(drive, dialect, now) {
                drive.learn_from(&reading);
            }
            let line = pkw::reply(drive, dialect, now, None);
            report(line, dialect, now, "response", sink);
        }
    }
}

/// Reports a request or a reply, with the numbers that are in it.
fn report(
    (weight, text): (Weight, String),
    dialect: &PkwDialect,
    words: Pkw,
    side: &'static str,
    sink: &mut Sink<'_>,
) {
    let address = words.address(dialect);
    let mut job = fields! {
        "side": side, "ak": words.ak(), "pke": words.pke, "ind": words.ind, "pwe": words.pwe,
        "pnu": address.as_ref().map(|address| address.pnu),
        "index": address.as_ref().map(|address| address.subindex),
    };
    job.extend(pkw::refusal_json(dialect, words).filter(|_| side == "response"));
    let detail = Job {
        refused: None,
        channel: "pkw",
        job,
        request_frame: None,
    };
    sink.report(weight, "PKW", text, Detail::Job(detail));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::event::{Event, Party};
    use std::time::Duration;

    struct Line {
        drive: JobDrive,
        requests: Channel,
        replies: Channel,
        events: Vec<Event>,
    }

    impl Line {
        fn new() -> Self {
            Self {
                drive: JobDrive::of(0x0080, 1),
                requests: Channel::default(),
                replies: Channel::default(),
                events: Vec::new(),
            }
        }

        /// One cycle: what the controller has in the channel and what the drive has.
        fn cycle(&mut self, request: [u8; 8], reply: [u8; 8]) -> Vec<String> {
            let mut sink = Sink {
                frame: 1,
                at: Duration::ZERO,
                source: Party::default(),
                target: Party::default(),
                events: &mut self.events,
            };
            self.requests.look(
                &mut self.drive,
                Pkw::from_octets(request),
                true,
                Pkw::ZERO,
                &mut sink,
            );
            let sent = self.requests.last;
            self.replies
                .look(&mut self.drive, Pkw::from_octets(reply), false, sent, &mut sink);
            self.events.drain(..).map(|event| event.text).collect()
        }
    }

    const ZERO: [u8; 8] = [0; 8];
    const READ: [u8; 8] = [0x11, 0x9E, 0, 0, 0, 0, 0, 0];

    const fn value(pwe: u8) -> [u8; 8] {
        [0x11, 0x9E, 0, 0, 0, 0, 0, pwe]
    }

    #[test]
    fn a_request_and_its_reply_are_reported_once() {
        let mut line = Line::new();
        assert!(line.cycle(ZERO, ZERO).is_empty());
        let lines = line.cycle(READ, ZERO);
        assert_eq!(lines, ["request value: Motor Speed High Limit [Hz] (4-14)"]);
        assert!(line.cycle(READ, ZERO).is_empty());
        let lines = line.cycle(READ, value(100));
        assert!(lines[0].contains("(4-14) = 10 Hz"), "{lines:?}");
        // the drive refreshes the value
        assert!(line.cycle(READ, value(101)).is_empty());
        assert!(line.cycle(READ, value(102)).is_empty());
        assert!(line.cycle(ZERO, ZERO).is_empty());
    }

    #[test]
    fn the_old_reply_is_not_that_of_a_new_request() {
        let mut line = Line::new();
        let write = |pwe| [0x21, 0x9E, 0, 0, 0, 0, 0, pwe];
        line.cycle(write(1), ZERO);
        assert_eq!(line.cycle(write(1), value(1)).len(), 1);
        // the next change while the reply of the first still stands
        assert_eq!(line.cycle(write(2), value(1)).len(), 1);
        assert!(line.cycle(write(2), value(1)).is_empty());
        let lines = line.cycle(write(2), value(2));
        assert!(lines[0].contains("= 0.2 Hz"), "{lines:?}");
        // the same value again: no frame shows when it is the new reply
        line.cycle(write(3), value(2));
        assert!(line.cycle(write(3), value(3))[0].contains("0.3 Hz"));
        line.cycle([0x61, 0x9E, 0, 0, 0, 0, 0, 0], value(3));
        let lines = line.cycle([0x61, 0x9E, 0, 0, 0, 0, 0, 0], [0x71, 0x9E, 0, 0, 0, 0, 0, 4]);
        assert!(lines[0].contains("refused: 4 "), "{lines:?}");
    }

    #[test]
    fn what_is_read_scales_other_values() {
        let mut line = Line::new();
        line.cycle([0x11, 0x2F, 0, 0, 0, 0, 0, 0], ZERO);
        let lines = line.cycle(
            [0x11, 0x2F, 0, 0, 0, 0, 0, 0],
            [0x21, 0x2F, 0, 0, 0, 0x2D, 0xC6, 0xC0],
        );
        assert!(lines[0].contains("Maximum Reference (3-03) = 3000"), "{lines:?}");
    }
}
