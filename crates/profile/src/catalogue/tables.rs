//! A catalogue as a drive: what its parameters alone decide of an answer.

use super::Catalogue;
use crate::parameter::{Attributes, Description, ErrorNumber, Keep, ParameterAccess};

impl Catalogue {
    /// Facts about the parameter that a PNU and a subindex on the wire mean; the high half of a 64-bit value has those of
    /// the whole.
    #[must_use]
    pub fn attributes(&self, pnu: u16, subindex: u16) -> Option<Attributes> {
        let parameter = self.at(pnu, subindex).or_else(|| self.by_high(pnu))?;
        Some(parameter.attributes())
    }

    /// Returns true for a parameter number that exists, also when no parameter is at its subindex 0.
    #[must_use]
    pub fn exists(&self, pnu: u16) -> bool {
        self.attributes(pnu, 0).is_some() || self.is_collecting(pnu)
    }

    /// Returns the text of a value in 16 characters.
    #[must_use]
    pub fn text(&self, pnu: u16, value: u16) -> Option<[u8; 16]> {
        self.at(pnu, 0)?.choice(value.into()).map(padded)
    }
}

/// Returns a text in the 16 characters of names and texts, filled with blanks.
#[must_use]
pub fn padded(text: &str) -> [u8; 16] {
    let mut padded = [b' '; 16];
    for (place, octet) in padded.iter_mut().zip(text.bytes()) {
        *place = octet;
    }
    padded
}

/// A drive that has the parameters of a catalogue, every value 0, and refuses nothing by its state: what it refuses, the
/// tables and the rules of the dialect refuse.
///
/// ```
/// use profidrive_profile::catalogue::{Tables, VLT};
/// use profidrive_profile::parameter::{Dialect, objections};
/// let read = [1, 1, 0, 1, 0x10, 1, 0x4E, 0x20, 0, 0];
/// let found = objections(&read, &Dialect::VLT, Some(&mut Tables(&VLT)));
/// assert_eq!(found[0].to_string(), "not in the tables: answered with error 0x00 unless the drive has the parameter");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Tables(pub &'static Catalogue);

impl ParameterAccess for Tables {
    fn attributes(&self, pnu: u16, subindex: u16) -> Option<Attributes> {
        self.0.attributes(pnu, subindex)
    }

    fn exists(&self, pnu: u16) -> bool {
        self.0.exists(pnu)
    }

    fn read(&mut self, _: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(0)
    }

    fn write(&mut self, _: u16, _: u16, _: u64, _: Keep) -> Result<(), ErrorNumber> {
        Ok(())
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        self.0.attributes(pnu, 0).map(|_| Description::default())
    }

    fn text(&self, pnu: u16, index: u16) -> Option<[u8; 16]> {
        self.0.text(pnu, index)
    }
}
