//! The eight octets of the channel: PKE, IND and PWE.

use core::fmt;

use super::code::{Action, ReplyCode, RequestCode, Width};
use super::dialect::{IndLayout, PkwDialect};
use super::error::PkwErrorNumber;

/// Octets of the channel in a PPO and of the usual serial block.
pub const PKW_LEN: usize = 8;
/// Octets of the longest block: what a serial telegram of 254 octets can hold without process data.
pub const MAX_BLOCK: usize = 252;
/// Characters of the longest text.
pub const MAX_TEXT: usize = MAX_BLOCK - TEXT_AT;
/// Where the characters of a text block begin.
pub const TEXT_AT: usize = 4;

/// Text code of IND in the Danfoss FC protocol: read.
pub const TEXT_READ: u8 = 0x04;
/// Text code of IND in the Danfoss FC protocol: write.
pub const TEXT_WRITE: u8 = 0x05;
/// SPM bit of PKE, where the parameter number has 11 bits.
const SPM: u16 = 0x0800;

/// Which parameter and element IND and PKE name, decoded by a dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PkwAddress {
    /// Parameter number with its page.
    pub pnu: u16,
    /// Element of an array, element of a description, or index of a text.
    pub subindex: u8,
    /// Text code (4 read, 5 write) in the Danfoss FC protocol, else 0.
    pub text: u8,
}

/// PKE, IND and PWE: a request or a reply, any octets are one.
/// Source: Danfoss FC parameter block description p. 73; Kollmorgen S300 PROFIBUS p. 18.
///
/// ```
/// use profidrive_profile::pkw::{Pkw, PkwDialect, ReplyCode};
/// let reply = Pkw::from_octets([0x20, 0xCF, 0, 0, 0, 0, 0x03, 0xE8]);
/// assert_eq!(reply.reply_code(), ReplyCode::DOUBLE_WORD);
/// assert_eq!(reply.address(&PkwDialect::DANFOSS_PPO).unwrap().pnu, 207);
/// assert_eq!(reply.pwe, 1000);
/// assert_eq!(reply.words(&PkwDialect::DANFOSS_PPO).reply().to_string(), "PNU 207 = 1000 (double word)");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Pkw {
    /// AK, SPM and PNU.
    pub pke: u16,
    /// Subindex, page, text code.
    pub ind: u16,
    /// Value or error number.
    pub pwe: u32,
}

impl Pkw {
    /// The zero telegram: no request, no reply.
    pub const ZERO: Self = Self {
        pke: 0,
        ind: 0,
        pwe: 0,
    };

    /// From the eight octets.
    #[must_use]
    pub const fn from_octets(octets: [u8; PKW_LEN]) -> Self {
        let [a, b, c, d, e, f, g, h] = octets;
        Self {
            pke: u16::from_be_bytes([a, b]),
            ind: u16::from_be_bytes([c, d]),
            pwe: u32::from_be_bytes([e, f, g, h]),
        }
    }

    /// Returns the eight octets.
    #[must_use]
    pub const fn to_octets(self) -> [u8; PKW_LEN] {
        let [a, b] = self.pke.to_be_bytes();
        let [c, d] = self.ind.to_be_bytes();
        let [e, f, g, h] = self.pwe.to_be_bytes();
        [a, b, c, d, e, f, g, h]
    }

    /// Returns a telegram with this AK for a parameter; `None` when the dialect cannot name the parameter.
    ///
    /// ```
    /// use profidrive_profile::pkw::{Pkw, PkwAddress, PkwDialect, RequestCode};
    /// let address = PkwAddress { pnu: 414, subindex: 0, text: 0 };
    /// let request = Pkw::new(&PkwDialect::DANFOSS_FC, RequestCode::STORE_WORD.0, address, 1000).unwrap();
    /// assert_eq!(request.to_octets(), [0xE1, 0x9E, 0, 0, 0, 0, 0x03, 0xE8]);
    /// ```
    #[must_use]
    pub fn new(dialect: &PkwDialect, ak: u8, address: PkwAddress, pwe: u32) -> Option<Self> {
        let (pnu, page) = dialect.split(address.pnu)?;
        let ind = match dialect.ind {
            IndLayout::Subindex => [address.subindex, 0],
            IndLayout::SubindexPage => [address.subindex, page],
            IndLayout::PageSubindex => [page, address.subindex],
            IndLayout::TextIndex => [address.text, address.subindex],
        };
        Some(Self {
            pke: u16::from(ak & 0x0F) << 12 | pnu,
            ind: u16::from_be_bytes(ind),
            pwe,
        })
    }

    /// Returns the upper four bits of PKE.
    #[must_use]
    pub const fn ak(self) -> u8 {
        self.pke.to_be_bytes()[0] >> 4
    }

    /// AK of a request.
    #[must_use]
    pub const fn request_code(self) -> RequestCode {
        RequestCode(self.ak())
    }

    /// AK of a reply.
    #[must_use]
    pub const fn reply_code(self) -> ReplyCode {
        ReplyCode(self.ak())
    }

    /// Returns the bit for spontaneous messages; always false where the parameter number has 12 bits.
    #[must_use]
    pub const fn spm(self, dialect: &PkwDialect) -> bool {
        dialect.pnu_bits < 12 && self.pke & SPM != 0
    }

    /// Returns the parameter that the words address; `None` for an undocumented page.
    #[must_use]
    pub fn address(self, dialect: &PkwDialect) -> Option<PkwAddress> {
        let [first, second] = self.ind.to_be_bytes();
        let (subindex, page, text) = match dialect.ind {
            IndLayout::Subindex => (first, 0, 0),
            IndLayout::SubindexPage => (first, second, 0),
            IndLayout::PageSubindex => (second, first, 0),
            IndLayout::TextIndex => (second, 0, first),
        };
        Some(PkwAddress {
            pnu: dialect.join(self.pke & dialect.pnu_mask(), page)?,
            subindex,
            text,
        })
    }

    /// Returns true for a request that the dialect has. With text (AK 15) IND indicates whether it is read or written.
    ///
    /// ```
    /// use profidrive_profile::pkw::{Pkw, PkwDialect};
    /// let text = |ind| Pkw { pke: 0xF604, ind, pwe: 0 };
    /// assert!(text(0x0400).is_request_of(&PkwDialect::DANFOSS_FC));
    /// assert!(!text(0).is_request_of(&PkwDialect::DANFOSS_FC));
    /// assert!(!text(0x0400).is_request_of(&PkwDialect::DANFOSS_WORDS));
    /// ```
    #[must_use]
    pub fn is_request_of(self, dialect: &PkwDialect) -> bool {
        let code = self.request_code();
        let text = self.address(dialect).map(|address| address.text);
        dialect.knows(code)
            && (code.info().action != Action::Text || matches!(text, Some(TEXT_READ | TEXT_WRITE)))
    }

    /// PWE low: a word value, an error number.
    #[must_use]
    pub const fn pwe_low(self) -> u16 {
        let [_, _, high, low] = self.pwe.to_be_bytes();
        u16::from_be_bytes([high, low])
    }

    /// Returns the value in PWE. Of a word only PWE low counts, whatever the sender put into PWE high: vendors differ
    /// in extending the sign there.
    #[must_use]
    pub const fn value(self, width: Width) -> u32 {
        match width {
            Width::Word => self.pwe & 0xFFFF,
            Width::DoubleWord => self.pwe,
        }
    }

    /// Creates a telegram that mirrors PNU and IND of this one under another AK; the SPM bit goes back as 0.
    #[must_use]
    pub const fn mirrored(self, dialect: &PkwDialect, reply: ReplyCode, pwe: u32) -> Self {
        Self {
            pke: (reply.0 as u16 & 0x0F) << 12 | self.pke & dialect.pnu_mask(),
            ind: self.ind,
            pwe,
        }
    }

    /// For people; choose whether it is a request or a reply.
    #[must_use]
    pub const fn words(self, dialect: &PkwDialect) -> Words<'_> {
        Words { pkw: self, dialect }
    }
}

/// A telegram about to be put in words.
#[derive(Debug, Clone, Copy)]
pub struct Words<'a> {
    pkw: Pkw,
    dialect: &'a PkwDialect,
}

impl<'a> Words<'a> {
    /// In the form of the master's request.
    ///
    /// ```
    /// use profidrive_profile::pkw::{Pkw, PkwDialect};
    /// let request = Pkw::from_octets([0xE1, 0x9E, 0, 0, 0, 0, 0x03, 0xE8]);
    /// let words = request.words(&PkwDialect::DANFOSS_FC).request().to_string();
    /// assert_eq!(words, "change value (word) in RAM and EEPROM: PNU 414 := 1000");
    /// ```
    #[must_use]
    pub const fn request(self) -> RequestWords<'a> {
        RequestWords(self)
    }

    /// As what the slave answers.
    ///
    /// ```
    /// use profidrive_profile::pkw::{Pkw, PkwDialect};
    /// let reply = Pkw::from_octets([0x75, 0xFA, 0, 1, 0, 0, 0, 0x11]);
    /// let words = reply.words(&PkwDialect::DANFOSS_FC).reply().to_string();
    /// assert_eq!(words, "PNU 1530[1] refused: 17 not possible in the present mode of the drive");
    /// ```
    #[must_use]
    pub const fn reply(self) -> ReplyWords<'a> {
        ReplyWords(self)
    }

    fn parameter(&self, f: &mut fmt::Formatter<'_>, array: bool) -> fmt::Result {
        match self.pkw.address(self.dialect) {
            Some(address) => {
                write!(f, "PNU {}", address.pnu)?;
                if array || address.subindex != 0 {
                    write!(f, "[{}]", address.subindex)?;
                }
                Ok(())
            }
            None => write!(
                f,
                "PNU {} of unknown page (IND 0x{:04X})",
                self.pkw.pke & self.dialect.pnu_mask(),
                self.pkw.ind
            ),
        }
    }
}

/// A request in words; see [`Words::request`].
#[derive(Debug, Clone, Copy)]
pub struct RequestWords<'a>(Words<'a>);

impl fmt::Display for RequestWords<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Words { pkw, dialect } = self.0;
        let info = pkw.request_code().info();
        if info.action == Action::Nothing {
            return f.write_str(info.name);
        }
        write!(f, "{}: ", info.name)?;
        self.0.parameter(f, info.array)?;
        if let Some(width) = info.width {
            write!(f, " := {}", pkw.value(width))?;
        }
        match pkw.address(dialect).map(|address| address.text) {
            Some(TEXT_READ) if info.action == Action::Text => f.write_str(" (read)"),
            Some(TEXT_WRITE) if info.action == Action::Text => f.write_str(" (write)"),
            _ if !pkw.is_request_of(dialect) => write!(f, " (not a request of {})", dialect.name),
            _ => Ok(()),
        }
    }
}

/// A reply in words; see [`Words::reply`].
#[derive(Debug, Clone, Copy)]
pub struct ReplyWords<'a>(Words<'a>);

impl fmt::Display for ReplyWords<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Words { pkw, dialect } = self.0;
        let code = pkw.reply_code();
        let info = code.info();
        if code == ReplyCode::NONE {
            return f.write_str(info.name);
        }
        self.0.parameter(f, info.array)?;
        if let Some(width) = info.width {
            let name = match width {
                Width::Word => "word",
                Width::DoubleWord => "double word",
            };
            let kind = if info.spontaneous { ", spontaneous" } else { "" };
            return write!(f, " = {} ({name}{kind})", pkw.value(width));
        }
        match code {
            ReplyCode::REFUSED => {
                let number = PkwErrorNumber(pkw.pwe_low());
                match number.info(dialect.error_names) {
                    Some(row) => write!(f, " refused: {} {}", number.0, row.meaning),
                    None => write!(f, " refused: {number}"),
                }
            }
            ReplyCode::DESCRIPTION => write!(f, " description element = 0x{:X}", pkw.pwe),
            ReplyCode::ELEMENTS => write!(f, " has {} elements", pkw.pwe_low()),
            _ => write!(f, ": {}", info.name),
        }
    }
}
