//! Writes pcapng (draft-ietf-opsawg-pcapng): one section, one Ethernet interface, nanoseconds.

use std::io::{self, BufWriter, Write};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use profinet::Instant;

use crate::segment::Tap;

const SECTION_HEADER: u32 = 0x0A0D_0D0A;
const INTERFACE_DESCRIPTION: u32 = 1;
const ENHANCED_PACKET: u32 = 6;
const BYTE_ORDER: u32 = 0x1A2B_3C4D;
const LINKTYPE_ETHERNET: u16 = 1;
const OPTION_END: u16 = 0;
const OPTION_NAME: u16 = 2;
const OPTION_APPLICATION: u16 = 4;
const OPTION_RESOLUTION: u16 = 9;

/// Writes frames into a pcapng file that Wireshark and tshark read.
///
/// ```
/// # fn main() -> std::io::Result<()> {
/// use profidrive_network::pcap::Writer;
/// use profinet::Instant;
/// let mut file = Vec::new();
/// let mut writer = Writer::starting_now(&mut file, "segment")?;
/// writer.write(Instant::from_millis(16), &[0xFF; 60])?;
/// writer.flush()?;
/// drop(writer);
/// assert_eq!(file[..4], [0x0A, 0x0D, 0x0D, 0x0A]);
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct Writer<W: Write> {
    out: BufWriter<W>,
    /// The calendar time of [`Instant::ZERO`], in nanoseconds since 1970.
    origin: u64,
    /// Reused for every block.
    block: Vec<u8>,
    /// The first failure of a write on a tap's account.
    failure: Option<io::Error>,
}

impl<W: Write> Writer<W> {
    /// Begins a file for the interface `name`; `origin` is the calendar time (since 1970) of [`Instant::ZERO`].
    ///
    /// # Errors
    /// When the head of the file cannot be written.
    pub fn new(out: W, name: &str, origin: Duration) -> io::Result<Self> {
        let origin = u64::try_from(origin.as_nanos()).unwrap_or(0);
        let mut writer = Self {
            out: BufWriter::new(out),
            origin,
            block: Vec::new(),
            failure: None,
        };
        writer.block_of(SECTION_HEADER, |body| {
            body.extend_from_slice(&BYTE_ORDER.to_le_bytes());
            body.extend_from_slice(&1u16.to_le_bytes());
            body.extend_from_slice(&0u16.to_le_bytes());
            body.extend_from_slice(&u64::MAX.to_le_bytes()); // section length not known
            option(body, OPTION_APPLICATION, b"profidrive");
            option(body, OPTION_END, &[]);
        })?;
        writer.block_of(INTERFACE_DESCRIPTION, |body| {
            body.extend_from_slice(&LINKTYPE_ETHERNET.to_le_bytes());
            body.extend_from_slice(&[0; 2]);
            body.extend_from_slice(&0u32.to_le_bytes()); // no limit on the length of a frame
            option(body, OPTION_NAME, name.as_bytes());
            option(body, OPTION_RESOLUTION, &[9]); // 10^-9 s
            option(body, OPTION_END, &[]);
        })?;
        Ok(writer)
    }

    /// Begins a file whose [`Instant::ZERO`] is now: right for a simulation that starts at zero.
    ///
    /// # Errors
    /// When the head of the file cannot be written.
    pub fn starting_now(out: W, name: &str) -> io::Result<Self> {
        Self::new(
            out,
            name,
            SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default(),
        )
    }

    /// Adds one frame.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&mut self, at: Instant, frame: &[u8]) -> io::Result<()> {
        let time = self.origin.saturating_add(at.as_nanos());
        let length = u32::try_from(frame.len())
            .map_err(|_| io::Error::new(io::ErrorKind::InvalidInput, "frame longer than 4 GiB"))?;
        self.block_of(ENHANCED_PACKET, |body| {
            body.extend_from_slice(&0u32.to_le_bytes()); // the one interface
            body.extend_from_slice(&((time >> 32) as u32).to_le_bytes());
            body.extend_from_slice(&(time as u32).to_le_bytes());
            body.extend_from_slice(&length.to_le_bytes());
            body.extend_from_slice(&length.to_le_bytes());
            body.extend_from_slice(frame);
            pad(body);
        })
    }

    /// Writes all buffered data to the operating system.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// Returns a block: type, length, body (a multiple of four octets), length again.
    fn block_of(&mut self, kind: u32, body: impl FnOnce(&mut Vec<u8>)) -> io::Result<()> {
        let mut block = std::mem::take(&mut self.block);
        block.clear();
        block.extend_from_slice(&kind.to_le_bytes());
        block.extend_from_slice(&[0; 4]);
        body(&mut block);
        let total = u32::try_from(block.len() + 4).unwrap_or(u32::MAX).to_le_bytes();
        if let Some(length) = block.get_mut(4..8) {
            length.copy_from_slice(&total);
        }
        block.extend_from_slice(&total);
        let written = self.out.write_all(&block);
        self.block = block;
        written
    }
}

/// An option: code, length, value, padded to four octets.
fn option(body: &mut Vec<u8>, code: u16, value: &[u8]) {
    let value = value.get(..value.len().min(255)).unwrap_or_default();
    body.extend_from_slice(&code.to_le_bytes());
    body.extend_from_slice(&(value.len() as u16).to_le_bytes());
    body.extend_from_slice(value);
    pad(body);
}

fn pad(body: &mut Vec<u8>) {
    body.resize(body.len().next_multiple_of(4), 0);
}

impl<W: Write + Send> Tap for Writer<W> {
    fn frame(&mut self, at: Instant, frame: &[u8]) {
        if self.failure.is_none() {
            self.failure = self.write(at, frame).err();
        }
    }

    fn finish(&mut self) -> io::Result<()> {
        self.failure.take().map_or_else(|| self.flush(), Err)
    }
}
