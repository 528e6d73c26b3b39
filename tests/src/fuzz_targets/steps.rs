//! A fuzzed life: octets cut into frames, datagrams and pauses.

use std::time::Duration;

/// One step of a fuzzed life.
#[derive(Debug, Clone, Copy)]
pub(super) enum Step<'a> {
    Frame(&'a [u8]),
    Datagram(&'a [u8]),
    Wait(Duration),
}

/// Cuts fuzzed octets into steps: kind, length in two octets, content. Kind 0 modulo 3 is a frame, 1 a datagram, 2 a
/// pause of as many milliseconds as the length gives.
pub(super) struct Steps<'a>(pub &'a [u8]);

impl<'a> Iterator for Steps<'a> {
    type Item = Step<'a>;

    fn next(&mut self) -> Option<Step<'a>> {
        let ([kind, high, low], rest) = self.0.split_first_chunk::<3>()?;
        let length = u16::from_be_bytes([*high, *low]);
        let (content, after) = rest.split_at(usize::from(length).min(rest.len()));
        match kind % 3 {
            2 => {
                self.0 = rest;
                Some(Step::Wait(Duration::from_millis(length.into())))
            }
            0 => {
                self.0 = after;
                Some(Step::Frame(content))
            }
            _ => {
                self.0 = after;
                Some(Step::Datagram(content))
            }
        }
    }
}
