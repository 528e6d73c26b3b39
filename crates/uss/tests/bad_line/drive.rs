//! A drive whose values contain their owner and their time.

use std::time::Duration;

use profile::parameter::{Attributes, ErrorNumber, Format, Keep, ParameterAccess};

/// Octets of the text.
pub const TEXT: usize = 12;
/// The parameter with the text.
pub const LABEL: u16 = 7;

/// Values of 1 to 3 are those written last, 4 is an actual value that contains the time, 5 has two elements, 7 is a
/// text. There is no 9.
pub struct Named {
    number: u32,
    pub now: Duration,
    /// What is in the RAM and what is kept.
    values: [u32; 3],
    kept: [u32; 3],
    label: [u8; TEXT],
    /// What 1 to 3 and the text have been, and from when on.
    history: Vec<(u16, Vec<u8>, Duration)>,
    pub written: Vec<u32>,
}

impl Named {
    pub fn new(number: u32) -> Self {
        let values = [1, 2, 3].map(|name| Self::name(number, name));
        let mut drive = Self {
            number,
            now: Duration::ZERO,
            values,
            kept: values,
            label: [b' '; TEXT],
            history: Vec::new(),
            written: Vec::new(),
        };
        drive.note_all();
        drive
    }

    /// Returns the first octet of every value that this parameter of this drive ever has.
    pub const fn name(number: u32, name: u32) -> u32 {
        number << 28 | name << 24
    }

    /// Off and on again: what was not kept is gone.
    pub fn restart(&mut self) {
        self.values = self.kept;
        self.label = [b' '; TEXT];
        self.note_all();
    }

    fn note_all(&mut self) {
        for pnu in [1, 2, 3, LABEL] {
            self.note(pnu);
        }
    }

    fn note(&mut self, pnu: u16) {
        let content = match pnu {
            LABEL => self.text(),
            _ => self.values[usize::from(pnu) - 1].to_be_bytes().to_vec(),
        };
        self.history.push((pnu, content, self.now));
    }

    fn text(&self) -> Vec<u8> {
        self.label.trim_ascii_end().to_vec()
    }

    /// Returns true when the parameter had this content at some time since `begun`.
    pub fn had(&self, pnu: u16, content: &[u8], begun: Duration) -> bool {
        let of_it: Vec<_> = self.history.iter().filter(|entry| entry.0 == pnu).collect();
        of_it.iter().enumerate().any(|(at, (_, known, _))| {
            let until = of_it.get(at + 1).map(|next| next.2);
            known == content && until.is_none_or(|until| until >= begun)
        })
    }
}

impl ParameterAccess for Named {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        let double = Attributes::simple(Format::UNSIGNED32, 4, pnu < 4);
        match pnu {
            1..=4 => Some(double),
            5 => Some(Attributes {
                elements: 2,
                ..double
            }),
            LABEL => Some(Attributes::string(TEXT as u16, true)),
            _ => None,
        }
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        Ok(match pnu {
            LABEL => self.label[usize::from(subindex)].into(),
            1..=3 => self.values[usize::from(pnu) - 1].into(),
            _ => {
                let name = Self::name(self.number, u32::from(pnu + subindex));
                u64::from(name) | self.now.as_millis() as u64
            }
        })
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, keep: Keep) -> Result<(), ErrorNumber> {
        if pnu == LABEL {
            self.label[usize::from(subindex)] = raw as u8;
            if usize::from(subindex) == TEXT - 1 {
                self.note(pnu);
            }
            return Ok(());
        }
        let place = usize::from(pnu) - 1;
        self.values[place] = raw as u32;
        if keep == Keep::Permanent {
            self.kept[place] = raw as u32;
        }
        self.written.push(raw as u32);
        self.note(pnu);
        Ok(())
    }
}
