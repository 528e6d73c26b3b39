//! Serial telegrams for drives: USS and the Danfoss FC protocol.
//!
//! One master polls many slaves in turn over one pair of wires; STX, a length, an address and a check octet make the
//! frame, silence separates telegrams. Independent of drives and ports: it takes octets with the time they came, gives
//! octets to send and the next deadline. Time is a [`Duration`](core::time::Duration) since an origin the caller chose.
//!
//! * [`Telegram`] is the frame, [`Address`] its third octet, [`Layout`] how its data are divided into parameter and
//!   process part, [`Timing`] the times;
//! * [`Receiver`] finds telegrams in what a line brings;
//! * [`Master`] polls slaves, [`Slave`] answers. Rule for both: feed, drain, sleep until the deadline.
//!
//! Source: Siemens CU240S p. 178-179 and 8-24 (USS), Danfoss VLT 2800 design guide p. 108 and FC design guides (FC
//! protocol).
//!
//! ```
//! use profidrive_uss::{Address, Layout, Telegram};
//! let octets = [0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD];
//! let telegram = Telegram::decode(&octets).unwrap();
//! assert_eq!(telegram.address, Address::fc(1).unwrap());
//! let parts = Layout::FC.split(telegram.data).unwrap();
//! assert_eq!((parts.pkw, parts.pzd), (&[][..], &[0x04, 0x7C, 0x20, 0x00][..]));
//! ```
#![no_std]
#![forbid(unsafe_code)]
extern crate alloc;

mod address;
mod layout;
mod master;
mod receiver;
mod slave;
mod telegram;
#[cfg(test)]
mod tests;
mod timing;

pub use address::{Address, Addressee, Protocol};
pub use layout::{Layout, Parts, PkwPart};
pub use master::{Event, Master, MasterConfig, SlaveId, SlaveStatistics};
pub use receiver::{Echo, Receiver, ReceiverStatistics};
pub use slave::{Request, Slave, SlaveConfig, SlaveCounters};
pub use telegram::{DecodeError, EncodeError, MAX_DATA, MAX_LGE, MAX_TELEGRAM, STX, Telegram, bcc};
pub use timing::{BAUD_RATES, Timing};
