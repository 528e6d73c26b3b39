//! A drive of one parameter: what is measured with it is the request, not the drive.

use profidrive_profile::parameter::{Attributes, ErrorNumber, Format, Keep, ParameterAccess};

/// The value of PNU 930.
pub struct OneWord(pub u16);

impl ParameterAccess for OneWord {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        let word = Attributes::simple(Format::UNSIGNED16, 2, true);
        (pnu == 930).then_some(word)
    }
    fn read(&mut self, _: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(self.0.into())
    }
    fn write(&mut self, _: u16, _: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
        self.0 = raw as u16;
        Ok(())
    }
}
