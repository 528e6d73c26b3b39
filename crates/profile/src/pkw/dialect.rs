//! What the PKW channels of different vendors and carriers do differently, as data.

use super::code::{ReplyCode, RequestCode};
use super::error::{PkwErrorNames, PkwErrorNumber};
use crate::telegram::DANFOSS;

/// What the two octets of IND mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum IndLayout {
    /// First octet subindex, second unused (Danfoss in PPO).
    Subindex,
    /// First octet subindex, second page of the parameter number (Siemens in PPO).
    SubindexPage,
    /// First octet page of the parameter number, second subindex (Siemens USS).
    PageSubindex,
    /// First octet 0, or with AK 15 the text code, second the index (Danfoss FC protocol).
    TextIndex,
}

impl IndLayout {
    /// Returns true where IND carries the page of the parameter number.
    #[must_use]
    pub const fn has_page(self) -> bool {
        matches!(self, Self::SubindexPage | Self::PageSubindex)
    }
}

/// One row of the table of pages: how a parameter number above 1999 is split into PNU and page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageRow {
    /// First parameter number of the page; the PNU of PKE counts from it.
    pub first: u16,
    /// Page octet of IND.
    pub page: u8,
    /// False where no public document prints the octet.
    pub verified: bool,
}

/// Pages of Siemens drives, ascending. Each holds 2000 numbers.
/// Source: SINAMICS G120 p. 123; the octet of 4000 follows from the others, bit 7 being the lowest bit of number / 2000.
pub static PAGES: [PageRow; 9] = [
    row(0, 0x00, true),
    row(2000, 0x80, true),
    row(4000, 0x10, false),
    row(6000, 0x90, true),
    row(8000, 0x20, true),
    row(10_000, 0xA0, true),
    row(20_000, 0x50, true),
    row(30_000, 0xF0, true),
    row(60_000, 0x74, true),
];

const fn row(first: u16, page: u8, verified: bool) -> PageRow {
    PageRow {
        first,
        page,
        verified,
    }
}

/// How a request of the plain AKs (1 to 3, 13, 14) on an array parameter is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PlainArray {
    /// It means the element that IND names.
    Element,
    /// It is refused with this number.
    Refused(PkwErrorNumber),
}

/// Facts about the PKW channel of one vendor in one carrier. Virtual drives and clients both follow them.
///
/// ```
/// use profidrive_profile::pkw::{PkwDialect, RequestCode};
/// assert!(PkwDialect::DANFOSS_FC.knows(RequestCode::STORE_WORD));
/// assert!(!PkwDialect::DANFOSS_FC.knows(RequestCode::READ_ARRAY));
/// let old = PkwDialect { pnu_bits: 11, ..PkwDialect::DANFOSS_FC };
/// assert_eq!(old.split(2500), None);
/// assert_eq!(PkwDialect::SIEMENS_PPO.split(2500), Some((500, 0x80)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PkwDialect {
    /// Name for people.
    pub name: &'static str,
    /// Requests that exist: bit n is AK n.
    pub requests: u16,
    /// Replies that exist: bit n is AK n.
    pub replies: u16,
    /// Bits of the parameter number in PKE: 11, or 12 where there is no SPM bit.
    pub pnu_bits: u8,
    /// What the octets of IND mean.
    pub ind: IndLayout,
    /// Plain requests on arrays.
    pub plain_array: PlainArray,
    /// True when a reply with AK 7 names the parameter number; else it may have 0 in its place.
    pub refusal_names_pnu: bool,
    /// Error number for an AK that does not exist.
    pub unknown_request: PkwErrorNumber,
    /// Error number for a value that does not fit PWE.
    pub too_wide: PkwErrorNumber,
    /// Meanings of the vendor's own error numbers.
    pub error_names: PkwErrorNames,
}

/// Requests 0 to 9.
const PROFILE_REQUESTS: u16 = 0x03FF;
/// Requests 11 to 14.
const EEPROM_REQUESTS: u16 = 0x7800;
/// Replies 0 to 12.
const PROFILE_REPLIES: u16 = 0x1FFF;

/// AK 15 among requests or replies.
const TEXT: u16 = 1 << 15;

/// Vendors with a channel of their own at serial lines: with texts, and without.
static VENDORS: [(u16, PkwDialect, PkwDialect); 1] =
    [(DANFOSS, PkwDialect::DANFOSS_FC, PkwDialect::DANFOSS_WORDS)];

impl PkwDialect {
    /// PROFIdrive V2 in PPO words, for a drive of which nothing else is known: everything but text.
    pub const STANDARD: Self = Self {
        name: "PROFIdrive V2",
        requests: PROFILE_REQUESTS | EEPROM_REQUESTS,
        replies: PROFILE_REPLIES,
        pnu_bits: 11,
        ind: IndLayout::Subindex,
        plain_array: PlainArray::Element,
        refusal_names_pnu: true,
        unknown_request: PkwErrorNumber::OTHER,
        too_wide: PkwErrorNumber::DATA_TYPE,
        error_names: PkwErrorNames::Profile,
    };

    /// Danfoss FC protocol on the serial line: few requests, text, index in the second octet of IND, parameter numbers of
    /// 12 bits as in the newer FC guides. AK 4 is in the older FC guides only. An AK that is not there is refused with 253 as CDS 803 does; the other guides are silent.
    /// Source: Danfoss FC parameter block description p. 73, FC design guides (FC protocol), CDS 803 p. 56.
    pub const DANFOSS_FC: Self = Self {
        name: "Danfoss FC protocol",
        requests: 0b1110_0000_0001_1111,
        replies: 0b1000_0000_1000_1111,
        pnu_bits: 12,
        ind: IndLayout::TextIndex,
        unknown_request: PkwErrorNumber(253),
        error_names: PkwErrorNames::Danfoss,
        ..Self::STANDARD
    };

    /// Danfoss in the words of a PPO: requests 0 to 9, no EEPROM, subindex in the first octet of IND, bit 11 of PKE in no
    /// use (SPM). Source: Danfoss MCA 101 p. 34, FCM 300 p. 29 (a refusal with PNU 0).
    pub const DANFOSS_PPO: Self = Self {
        name: "Danfoss PPO",
        requests: PROFILE_REQUESTS,
        refusal_names_pnu: false,
        error_names: PkwErrorNames::Danfoss,
        ..Self::STANDARD
    };

    /// Siemens in the words of a PPO: subindex first, then page. Source: SINAMICS G120 p. 123, CU240S p. 123.
    pub const SIEMENS_PPO: Self = Self {
        name: "Siemens PPO",
        ind: IndLayout::SubindexPage,
        plain_array: PlainArray::Refused(PkwErrorNumber(105)),
        unknown_request: PkwErrorNumber(106),
        too_wide: PkwErrorNumber(102),
        error_names: PkwErrorNames::Siemens,
        ..Self::STANDARD
    };

    /// Siemens USS: page first, then subindex. Source: Siemens CU240S p. 178-179.
    pub const SIEMENS_USS: Self = Self {
        name: "Siemens USS",
        ind: IndLayout::PageSubindex,
        ..Self::SIEMENS_PPO
    };

    /// As [`DANFOSS_FC`](Self::DANFOSS_FC) in parameter parts of four words, as USS has them: no room for texts. No
    /// document states of a VLT at a USS line, this is ours.
    pub const DANFOSS_WORDS: Self = Self {
        name: "Danfoss FC in four words",
        requests: Self::DANFOSS_FC.requests & !TEXT,
        replies: Self::DANFOSS_FC.replies & !TEXT,
        ..Self::DANFOSS_FC
    };

    /// Returns the PKW dialect of a vendor's drives at a serial line: their own with any protocol, else that of the protocol.
    /// `texts`: the parameter part has room for them, as in the Danfoss FC protocol and not in USS.
    ///
    /// ```
    /// use profidrive_profile::pkw::PkwDialect;
    /// use profidrive_profile::telegram::{DANFOSS, KOLLMORGEN};
    /// assert_eq!(PkwDialect::of_line(Some(DANFOSS), true), PkwDialect::DANFOSS_FC);
    /// assert!(!PkwDialect::of_line(Some(DANFOSS), false).has_text());
    /// assert_eq!(PkwDialect::of_line(Some(KOLLMORGEN), false), PkwDialect::SIEMENS_USS);
    /// assert_eq!(PkwDialect::of_line(None, true), PkwDialect::DANFOSS_FC);
    /// ```
    #[must_use]
    pub fn of_line(vendor: Option<u16>, texts: bool) -> Self {
        let own = VENDORS.iter().find(|(of, ..)| vendor == Some(*of));
        match (own, texts) {
            (Some((_, with, _)), true) => *with,
            (Some((_, _, without)), false) => *without,
            (None, true) => Self::DANFOSS_FC,
            (None, false) => Self::SIEMENS_USS,
        }
    }

    /// Returns true when the request exists.
    #[must_use]
    pub const fn knows(&self, request: RequestCode) -> bool {
        self.requests >> (request.0 & 0x0F) & 1 == 1
    }

    /// Returns true when the reply exists.
    #[must_use]
    pub const fn replies_with(&self, reply: ReplyCode) -> bool {
        self.replies >> (reply.0 & 0x0F) & 1 == 1
    }

    /// Returns true when there are text blocks (AK 15).
    #[must_use]
    pub const fn has_text(&self) -> bool {
        self.knows(RequestCode::TEXT)
    }

    /// Returns the bits of PKE that are the parameter number.
    #[must_use]
    pub const fn pnu_mask(&self) -> u16 {
        if self.pnu_bits >= 12 { 0x0FFF } else { 0x07FF }
    }

    /// Returns a parameter number as PNU of PKE and page of IND; `None` when the channel cannot name it.
    #[must_use]
    pub fn split(&self, number: u16) -> Option<(u16, u8)> {
        if self.ind.has_page() {
            let row = PAGES.iter().rev().find(|row| row.first <= number)?;
            let pnu = number - row.first;
            return (pnu < 2000).then_some((pnu, row.page));
        }
        (number <= self.pnu_mask()).then_some((number, 0))
    }

    /// Returns the parameter number of a PNU and a page; `None` for an undocumented page.
    #[must_use]
    pub fn join(&self, pnu: u16, page: u8) -> Option<u16> {
        if !self.ind.has_page() {
            return Some(pnu);
        }
        let row = PAGES.iter().find(|row| row.page == page)?;
        row.first.checked_add(pnu)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_every_page_comes_back() {
        for row in &PAGES {
            for pnu in 0..2000 {
                let number = row.first + pnu;
                assert_eq!(PkwDialect::SIEMENS_USS.split(number), Some((pnu, row.page)));
                assert_eq!(PkwDialect::SIEMENS_USS.join(pnu, row.page), Some(number));
            }
        }
        for number in [12_000, 19_999, 22_000, 32_000, 62_000, u16::MAX] {
            assert_eq!(PkwDialect::SIEMENS_PPO.split(number), None, "{number}");
        }
        assert_eq!(PkwDialect::SIEMENS_PPO.join(5, 0x01), None);
    }

    /// The octet that no document prints is what the pattern of the printed ones gives.
    #[test]
    fn pages_follow_one_pattern() {
        for row in &PAGES {
            let page = row.first / 2000;
            let bits = [(0, 0x80), (1, 0x10), (2, 0x20), (3, 0x40), (4, 0x04)];
            let octet = bits
                .iter()
                .filter(|(bit, _)| page >> bit & 1 == 1)
                .fold(0, |octet, (_, place)| octet | place);
            assert_eq!(row.page, octet, "{}", row.first);
            assert_eq!(row.verified, row.first != 4000);
        }
    }

    #[test]
    fn subsets_of_the_danfoss_carriers() {
        let known = |dialect: PkwDialect| (0..16).filter(move |&code| dialect.knows(RequestCode(code)));
        assert!(known(PkwDialect::DANFOSS_FC).eq([0, 1, 2, 3, 4, 13, 14, 15]));
        assert!(known(PkwDialect::DANFOSS_PPO).eq(0..=9));
        assert!(known(PkwDialect::SIEMENS_USS).eq((0..=9).chain(11..=14)));
        let replies = (0..16).filter(|&code| PkwDialect::DANFOSS_FC.replies_with(ReplyCode(code)));
        assert!(replies.eq([0, 1, 2, 3, 7, 15]));
    }
}
