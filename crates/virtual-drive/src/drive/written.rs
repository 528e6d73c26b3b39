//! Which parameters were written, and how the change reached the drive.

use profile::catalogue::{Access, Parameter, Size};
use profile::parameter::ParameterAccess as _;

use super::{Drive, Event};

/// How a change of a parameter reached the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WriteChannel {
    /// A record of a connection: a parameter job, or a record that is a parameter itself.
    Record,
    /// The parameter channel (PKW), cyclic or at a serial line.
    Pkw,
    /// Anything else: the owner of the drive.
    #[default]
    Other,
}

/// A parameter that was written, as the drive reports it since.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// Its number.
    pub pnu: u16,
    /// Subindex on the wire; of a string the place of its first octet.
    pub subindex: u16,
    /// What it reads as since. Of a command, which has no value, the number that was written.
    pub value: WrittenValue,
    /// How the change reached the drive.
    pub channel: WriteChannel,
}

/// Value of a parameter that was written.
#[derive(Debug, Clone, PartialEq)]
pub enum WrittenValue {
    /// A number.
    Number {
        /// As on the wire, sign included.
        raw: i64,
        /// In the unit of the parameter.
        value: f64,
    },
    /// A whole string, without the blanks behind it.
    Text(String),
}

impl Drive {
    /// Lets `serve` work on the drive; what it writes came through `channel`.
    pub(crate) fn written_through<T>(
        &mut self,
        channel: WriteChannel,
        serve: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let before = std::mem::replace(&mut self.write_channel, channel);
        let result = serve(self);
        self.write_channel = before;
        result
    }

    /// Discards the events of parameters that were written until now: they belong to the set-up of the drive by its
    /// owner.
    pub fn forget_written(&mut self) {
        self.events.retain(|event| !matches!(event, Event::Written(_)));
    }

    /// Reports that an element was written. The octets of a string are one event.
    pub(super) fn report_written(&mut self, pnu: u16, subindex: u16, raw: i64) {
        let Ok((_, _, parameter)) = self.place(pnu, subindex) else {
            return;
        };
        let (subindex, value) = self.present(pnu, subindex).unwrap_or_else(|| {
            let value = parameter.engineering(raw, &self.settings.scaling);
            (subindex, WrittenValue::Number { raw, value })
        });
        let written = Written {
            pnu,
            subindex,
            value,
            channel: self.write_channel,
        };
        if let (Some(Event::Written(last)), WrittenValue::Text(_)) = (self.events.back_mut(), &written.value)
            && (last.pnu, last.subindex, last.channel) == (pnu, subindex, written.channel)
        {
            *last = written;
        } else {
            self.emit(Event::Written(written));
        }
    }

    /// Returns what a parameter reads as now, with its subindex: a string as a whole, with the place of its first octet.
    /// `None` for one that does not exist or has no value to read.
    #[must_use]
    pub fn present(&self, pnu: u16, subindex: u16) -> Option<(u16, WrittenValue)> {
        let (position, element, parameter) = self.place(pnu, subindex).ok()?;
        let octets = self.attributes(pnu, subindex);
        let octets = octets.map_or(0, |facts| facts.string_octets());
        if octets > 0 && parameter.is_text() {
            let first = element - element % octets;
            let text = self.text_of(position, first..first.saturating_add(octets));
            return Some((parameter.subindex(first), WrittenValue::Text(text)));
        }
        let raw = self.element(position, element).ok();
        let raw = raw.filter(|_| !is_command(parameter))?;
        let value = parameter.engineering(raw, &self.settings.scaling);
        Some((subindex, WrittenValue::Number { raw, value }))
    }

    fn text_of(&self, position: usize, elements: std::ops::Range<u16>) -> String {
        let octets = elements.map_while(|element| self.element(position, element).ok());
        // texts of a drive are Latin-1
        let text: String = octets.map(|octet| char::from(octet as u8)).collect();
        text.trim_end_matches([' ', '\0']).to_owned()
    }
}

/// Returns true for what does something and has no value.
fn is_command(parameter: &Parameter) -> bool {
    parameter.size == Size::Command || parameter.access == Access::WriteOnly
}

#[cfg(test)]
mod tests {
    use profile::parameter::{Keep, ParameterAccess};

    use super::*;
    use crate::model::{AKD, VLT};

    fn written(drive: &mut Drive) -> Vec<Written> {
        std::iter::from_fn(|| drive.poll_event())
            .filter_map(|event| match event {
                Event::Written(written) => Some(written),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn a_job_reports_each_change_that_the_drive_made() {
        let mut drive = Drive::new(&AKD);
        // 930 = 2, 947 cannot be written, 930 = 99 is not a mode
        let mut request = vec![1, 2, 0, 3];
        for pnu in [930_u16, 947, 930] {
            request.extend([0x10, 1, (pnu >> 8) as u8, pnu as u8, 0, 0]);
        }
        for value in [2, 1, 99] {
            request.extend([0x42, 1, 0, value]);
        }
        drive.serve(&request, &mut [0; 240]).unwrap();
        let expected = Written {
            pnu: 930,
            subindex: 0,
            value: WrittenValue::Number { raw: 2, value: 2.0 },
            channel: WriteChannel::Record,
        };
        assert_eq!(written(&mut drive), [expected]);
    }

    #[test]
    fn the_value_is_the_one_that_the_drive_reports() {
        let mut drive = Drive::new(&AKD);
        drive.write(2108, 0, 5000, Keep::Volatile).unwrap();
        let [change] = &written(&mut drive)[..] else {
            panic!("one change");
        };
        let reported = AKD.catalogue.by_pnu(2108).unwrap();
        let WrittenValue::Number { raw, value } = change.value else {
            panic!("a number");
        };
        assert_eq!(Some(value), drive.reported(reported, 0));
        assert_eq!(drive.read(2108, 0), Ok(raw.cast_unsigned()));
        assert_eq!(change.channel, WriteChannel::Other);
    }

    #[test]
    fn a_64_bit_value_is_written_with_its_low_half() {
        let mut drive = Drive::new(&AKD);
        let wide = AKD
            .catalogue
            .parameters
            .iter()
            .find(|row| row.wide && row.access == Access::ReadWrite && row.range().contains(&(1 << 32)));
        let wide = wide.unwrap();
        drive.write(wide.high().unwrap(), 0, 1, Keep::Volatile).unwrap();
        assert_eq!(written(&mut drive), []);
    }

    #[test]
    fn the_octets_of_a_string_are_one_event() {
        let mut drive = Drive::new(&VLT);
        drive.write_text(37, 0, b"HELLO", Keep::Volatile).unwrap();
        drive.write_text(38, 0, b"B", Keep::Volatile).unwrap();
        let texts = written(&mut drive)
            .into_iter()
            .map(|change| (change.pnu, change.value));
        let text = |text: &str| WrittenValue::Text(text.to_owned());
        assert_eq!(texts.collect::<Vec<_>>(), [(37, text("HELLO")), (38, text("B"))]);
    }

    #[test]
    fn a_set_up_by_the_owner_can_be_forgotten() {
        let mut drive = Drive::new(&AKD);
        drive.write(930, 0, 2, Keep::Volatile).unwrap();
        drive.forget_written();
        assert_eq!(written(&mut drive), []);
    }
}
