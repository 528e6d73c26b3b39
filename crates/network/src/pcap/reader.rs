//! Reads pcap and pcapng, damaged files included.

use std::io::{self, Read};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use pcap_parser::traits::{PcapNGPacketBlock, PcapReaderIterator};
use pcap_parser::{Block, Linktype, PcapBlockOwned, PcapError, create_reader};

/// Largest block read; no Ethernet frame comes near it.
pub const MAX_BLOCK: usize = 1 << 20;
/// Most interfaces of one section.
const MAX_INTERFACES: usize = 4096;

/// A frame out of a capture file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Captured {
    /// Calendar time since 1970.
    pub time: Duration,
    /// The octets that were kept.
    pub frame: Vec<u8>,
    /// Octets the frame had on the wire; more than `frame` holds if the capture was cut short.
    pub original_length: usize,
}

/// Why a capture file cannot be read (on).
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system reported an error.
    #[error("cannot read the capture: {0}")]
    Io(#[from] io::Error),
    /// Neither pcap nor pcapng.
    #[error("not a capture file: the header is neither pcap nor pcapng")]
    NotACapture,
    /// The file ends in the middle of a block.
    #[error("the capture ends in the middle of a block that begins at octet {offset}")]
    Truncated {
        /// Where the block begins.
        offset: u64,
    },
    /// A block that contradicts itself.
    #[error("damaged capture: {what} at octet {offset}")]
    Damaged {
        /// Where the block begins.
        offset: u64,
        /// What is wrong.
        what: &'static str,
    },
    /// A block longer than [`MAX_BLOCK`].
    #[error("damaged capture: the block at octet {offset} claims more than {MAX_BLOCK} octets")]
    TooLong {
        /// Where the block begins.
        offset: u64,
    },
    /// Captured on something else than Ethernet.
    #[error("the capture holds link type {link_type}; only Ethernet (1) is understood")]
    LinkType {
        /// The number of the link type (tcpdump.org/linktypes.html).
        link_type: i32,
    },
}

#[derive(Debug, Clone, Copy)]
struct Interface {
    link_type: i32,
    /// Ticks per second.
    resolution: u64,
    /// Seconds to add.
    offset: i64,
}

/// Iterates the Ethernet frames of a capture. After the first error there is no more.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use std::time::Duration;
/// use profidrive_network::pcap::{Reader, Writer};
/// use profinet::Instant;
/// # let mut file = Vec::new();
/// # { let mut writer = Writer::new(&mut file, "x", Duration::ZERO)?; writer.write(Instant::from_millis(16), &[0xFF; 60])?; writer.flush()?; }
/// for captured in Reader::new(std::io::Cursor::new(file))? {
///     let captured = captured?;
///     assert_eq!((captured.time, captured.frame.len()), (Duration::from_millis(16), 60));
/// }
/// # Ok(()) }
/// ```
pub struct Reader {
    inner: Box<dyn PcapReaderIterator + Send>,
    failure: Failure,
    interfaces: Vec<Interface>,
    /// Octets of the blocks so far: where the present one begins.
    offset: u64,
    /// pcapng, whose blocks carry their length; and whether the present section is big-endian.
    blocks: bool,
    big_endian: bool,
    done: bool,
}

/// Type of the block that opens a section; reads the same in both byte orders.
const SECTION_HEADER: [u8; 4] = [0x0A, 0x0D, 0x0D, 0x0A];

/// Where the source puts its own error, which the parser would lose.
type Failure = Arc<Mutex<Option<io::Error>>>;

impl std::fmt::Debug for Reader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reader")
            .field("offset", &self.offset)
            .field("done", &self.done)
            .finish_non_exhaustive()
    }
}

impl Reader {
    /// Looks at the head of the file.
    ///
    /// # Errors
    /// When it cannot be read or is not a capture.
    pub fn new<R: Read + Send + 'static>(source: R) -> Result<Self, ReadError> {
        let failure = Failure::default();
        let whole = Whole {
            source,
            failure: Arc::clone(&failure),
        };
        let inner = create_reader(2 * MAX_BLOCK, whole)
            .map_err(|_| taken(&failure).map_or(ReadError::NotACapture, ReadError::Io))?;
        let blocks = inner.data().starts_with(&SECTION_HEADER);
        Ok(Self {
            inner,
            blocks,
            big_endian: false,
            failure,
            interfaces: Vec::new(),
            offset: 0,
            done: false,
        })
    }

    /// Returns true when the next block announces fewer octets than type and lengths take. The parser would subtract
    /// them unseen from some kinds of block.
    fn is_too_short(&mut self) -> bool {
        let data = self.inner.data();
        let word = |at: usize| data.get(at..)?.first_chunk::<4>().copied();
        let (true, Some(kind), Some(length)) = (self.blocks, word(0), word(4)) else {
            return false;
        };
        if kind == SECTION_HEADER
            && let Some(mark) = word(8)
        {
            self.big_endian = mark == [0x1A, 0x2B, 0x3C, 0x4D];
        }
        let length = if self.big_endian {
            u32::from_be_bytes(length)
        } else {
            u32::from_le_bytes(length)
        };
        length < 12
    }

    /// Returns the next frame, `None` at the end.
    fn advance(&mut self) -> Result<Option<Captured>, ReadError> {
        loop {
            let offset = self.offset;
            let before = self.inner.data().len();
            if self.is_too_short() {
                return Err(ReadError::Damaged {
                    offset,
                    what: "a block shorter than its own frame",
                });
            }
            match self.inner.next() {
                Ok((0, _)) => {
                    return Err(ReadError::Damaged {
                        offset,
                        what: "a block without length",
                    });
                }
                Ok((length, block)) => {
                    let captured = take(&mut self.interfaces, offset, block);
                    self.inner.consume(length);
                    self.offset += length as u64;
                    if let Some(captured) = captured? {
                        return Ok(Some(captured));
                    }
                    continue;
                }
                Err(PcapError::Eof) => return Ok(None),
                Err(PcapError::Incomplete(missing)) if missing <= MAX_BLOCK => {}
                Err(PcapError::Incomplete(_) | PcapError::BufferTooSmall) => {
                    return Err(ReadError::TooLong { offset });
                }
                Err(PcapError::UnexpectedEof) => return Err(ReadError::Truncated { offset }),
                Err(_) => {
                    return Err(ReadError::Damaged {
                        offset,
                        what: "a block that contradicts itself",
                    });
                }
            }
            if self.inner.refill().is_err() {
                let lost = taken(&self.failure).unwrap_or_else(|| io::ErrorKind::Other.into());
                return Err(ReadError::Io(lost));
            }
            if self.inner.data().len() == before && !self.inner.reader_exhausted() {
                return Err(ReadError::TooLong { offset });
            }
        }
    }
}

impl Iterator for Reader {
    type Item = Result<Captured, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let next = self.advance().transpose();
        self.done = !matches!(next, Some(Ok(_)));
        next
    }
}

/// Returns the frame of a block, or stores the settings that the block has for the following ones.
fn take(
    interfaces: &mut Vec<Interface>,
    offset: u64,
    block: PcapBlockOwned<'_>,
) -> Result<Option<Captured>, ReadError> {
    let damaged = |what| ReadError::Damaged { offset, what };
    match block {
        PcapBlockOwned::LegacyHeader(header) => {
            let resolution = if header.is_nanosecond_precision() {
                1_000_000_000
            } else {
                1_000_000
            };
            // The upper bits hold the length of a frame check sequence.
            let link_type = header.network.0 & 0x03FF_FFFF;
            interfaces.push(Interface {
                link_type,
                resolution,
                offset: 0,
            });
            Ok(None)
        }
        PcapBlockOwned::Legacy(block) => {
            let interface = ethernet(
                interfaces
                    .first()
                    .copied()
                    .ok_or_else(|| damaged("a frame before the head"))?,
            )?;
            let fraction = u128::from(block.ts_usec) * 1_000_000_000 / u128::from(interface.resolution);
            let time = Duration::from_secs(u64::from(block.ts_sec))
                + Duration::from_nanos(u64::try_from(fraction).unwrap_or_default());
            Ok(Some(Captured {
                time,
                frame: block.data.to_vec(),
                original_length: block.origlen as usize,
            }))
        }
        PcapBlockOwned::NG(Block::SectionHeader(_)) => {
            interfaces.clear();
            Ok(None)
        }
        PcapBlockOwned::NG(Block::InterfaceDescription(block)) => {
            if interfaces.len() >= MAX_INTERFACES {
                return Err(damaged("too many interfaces"));
            }
            let resolution =
                resolution(block.if_tsresol).ok_or_else(|| damaged("an impossible time resolution"))?;
            let Linktype(link_type) = block.linktype;
            interfaces.push(Interface {
                link_type,
                resolution,
                offset: block.if_tsoffset,
            });
            Ok(None)
        }
        PcapBlockOwned::NG(Block::EnhancedPacket(block)) => {
            let interface = interfaces
                .get(block.if_id as usize)
                .copied()
                .ok_or_else(|| damaged("a frame of an interface that was not described"))?;
            let interface = ethernet(interface)?;
            let ticks = u64::from(block.ts_high) << 32 | u64::from(block.ts_low);
            Ok(Some(Captured {
                time: time(interface, ticks),
                frame: block.packet_data().to_vec(),
                original_length: block.origlen as usize,
            }))
        }
        PcapBlockOwned::NG(Block::SimplePacket(block)) => {
            let first = interfaces.first().copied();
            ethernet(first.ok_or_else(|| damaged("a frame of an interface that was not described"))?)?;
            Ok(Some(Captured {
                time: Duration::ZERO,
                frame: block.packet_data().to_vec(),
                original_length: block.origlen as usize,
            }))
        }
        PcapBlockOwned::NG(_) => Ok(None),
    }
}

fn ethernet(interface: Interface) -> Result<Interface, ReadError> {
    match interface.link_type {
        1 => Ok(interface),
        link_type => Err(ReadError::LinkType { link_type }),
    }
}

/// Ticks per second: a power of ten, or of two if the top bit is set.
fn resolution(code: u8) -> Option<u64> {
    match code & 0x80 {
        0 => 10u64.checked_pow(u32::from(code)),
        _ => 1u64.checked_shl(u32::from(code & 0x7F)),
    }
}

fn time(interface: Interface, ticks: u64) -> Duration {
    let resolution = interface.resolution.max(1);
    let seconds = (ticks / resolution).saturating_add_signed(interface.offset);
    let fraction = u128::from(ticks % resolution) * 1_000_000_000 / u128::from(resolution);
    Duration::new(seconds, u32::try_from(fraction).unwrap_or_default())
}

fn taken(failure: &Failure) -> Option<io::Error> {
    failure.lock().ok()?.take()
}

/// Fills the whole buffer where it can, so that the parser gets no short reads, and keeps the error.
struct Whole<R> {
    source: R,
    failure: Failure,
}

impl<R: Read> Read for Whole<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while let Some(rest) = buffer.get_mut(filled..).filter(|rest| !rest.is_empty()) {
            match self.source.read(rest) {
                Ok(0) => break,
                Ok(count) => filled += count.min(rest.len()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => {
                    let kind = error.kind();
                    if let Ok(mut place) = self.failure.lock() {
                        *place = Some(error);
                    }
                    return Err(kind.into());
                }
            }
        }
        Ok(filled)
    }
}
