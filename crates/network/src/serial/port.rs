//! One serial port.

use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use profinet::Instant;
#[cfg(not(unix))]
use serialport::COMPort as Native;
#[cfg(unix)]
use serialport::TTYPort as Native;
use serialport::{DataBits, FlowControl, SerialPort, StopBits};

use super::Error;
use super::opening;
use crate::system::{Calls, now, wait_for_octets, wait_for_room};

/// How long the port may take no octets at all.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);

/// How long reading and writing may take: nothing, where waiting is a call of its own.
#[cfg(unix)]
const TIMEOUT: Duration = Duration::ZERO;
#[cfg(not(unix))]
const TIMEOUT: Duration = WRITE_TIMEOUT;

/// Errors of a port that was unplugged.
#[cfg(unix)]
const AWAY: &[i32] = &[libc::EIO, libc::ENXIO, libc::ENODEV, libc::EBADF, libc::EPIPE];
/// Access denied, invalid handle, bad command, device does not function, device not connected.
#[cfg(not(unix))]
const AWAY: &[i32] = &[5, 6, 22, 31, 1167];

/// Parity of the characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Parity {
    /// The usual of drives.
    #[default]
    Even,
    /// Odd.
    Odd,
    /// None.
    None,
}

/// Speed and form of the characters: eight data bits, one stop bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Bits per second.
    pub baud: u32,
    /// Parity.
    pub parity: Parity,
}

impl Settings {
    /// 8E1 at this speed.
    #[must_use]
    pub const fn new(baud: u32) -> Self {
        Self {
            baud,
            parity: Parity::Even,
        }
    }
}

/// An open serial port, opened exclusively.
#[derive(Debug)]
pub struct Port {
    name: String,
    tty: Native,
}

impl Port {
    /// Opens a port; what came before is thrown away.
    ///
    /// # Errors
    /// No such port, no right, in use, no serial port, no such settings.
    pub fn open(name: &str, settings: Settings) -> Result<Self, Error> {
        let parity = match settings.parity {
            Parity::Even => serialport::Parity::Even,
            Parity::Odd => serialport::Parity::Odd,
            Parity::None => serialport::Parity::None,
        };
        let builder = serialport::new(name, settings.baud)
            .data_bits(DataBits::Eight)
            .stop_bits(StopBits::One)
            .parity(parity)
            .flow_control(FlowControl::None)
            .timeout(TIMEOUT);
        let tty = Native::open(&builder).map_err(|error| opening(name, error))?;
        // only unrequested octets are lost
        let _ = tty.clear(serialport::ClearBuffer::Input);
        Ok(Self {
            name: name.to_owned(),
            tty,
        })
    }

    #[cfg(unix)]
    /// Two ends of a line without any hardware: this one, and the name of the other, which is opened as any port.
    ///
    /// # Errors
    /// When the system has no pseudo-terminal left.
    pub fn pair() -> Result<(Self, String), Error> {
        let failed = |error: serialport::Error| Error::System {
            port: "pseudo-terminal".to_owned(),
            source: error.into(),
        };
        let (mut tty, far) = Native::pair().map_err(failed)?;
        tty.set_timeout(Duration::ZERO).map_err(failed)?;
        let name = far.name().unwrap_or_default();
        // while this end stays open, closing the other one goes unnoticed
        drop(far);
        Ok((
            Self {
                name: name.clone(),
                tty,
            },
            name,
        ))
    }

    /// Returns the name as given.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Sleeps until octets wait, a call arrives, or `until`.
    ///
    /// # Errors
    /// When the port is gone.
    pub(super) fn wait(&self, until: Instant, calls: &Calls) -> Result<(), Error> {
        wait_for_octets(&self.tty, until, calls).map_err(|error| self.failed(error))
    }

    /// Takes octets that wait; 0 when there are none.
    ///
    /// # Errors
    /// When the port is gone.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Error> {
        if cfg!(not(unix)) && matches!(self.tty.bytes_to_read(), Ok(0)) {
            return Ok(0);
        }
        match self.tty.read(buffer) {
            Ok(0) => Err(self.gone()),
            Ok(length) => Ok(length),
            Err(error) if is_for_now(&error) => Ok(0),
            Err(error) => Err(self.failed(error)),
        }
    }

    /// Sends octets; waits for room half a second at most.
    ///
    /// # Errors
    /// When the port is gone, or takes nothing for that long.
    pub fn write(&mut self, mut octets: &[u8]) -> Result<(), Error> {
        let end = now() + WRITE_TIMEOUT;
        while !octets.is_empty() {
            match self.tty.write(octets) {
                Ok(0) if cfg!(unix) => return Err(self.gone()),
                Ok(0) => {
                    return Err(Error::Stuck {
                        port: self.name.clone(),
                    });
                }
                Ok(length) => octets = octets.get(length..).unwrap_or_default(),
                Err(error) if is_for_now(&error) && now() < end => {
                    wait_for_room(&self.tty, end).map_err(|error| self.failed(error))?;
                }
                Err(error) if is_for_now(&error) => {
                    return Err(Error::Stuck {
                        port: self.name.clone(),
                    });
                }
                Err(error) => return Err(self.failed(error)),
            }
        }
        Ok(())
    }

    fn gone(&self) -> Error {
        Error::Gone {
            port: self.name.clone(),
        }
    }

    fn failed(&self, source: io::Error) -> Error {
        let away = source.raw_os_error().is_some_and(|code| AWAY.contains(&code));
        if away || source.kind() == ErrorKind::BrokenPipe {
            return self.gone();
        }
        Error::System {
            port: self.name.clone(),
            source,
        }
    }
}

fn is_for_now(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    const SOON: Duration = Duration::from_secs(5);

    #[test]
    fn octets_go_both_ways_unchanged() {
        let (mut near, name) = Port::pair().unwrap();
        let mut far = Port::open(&name, Settings::new(19_200)).unwrap();
        let all: Vec<u8> = (0..=255).collect();
        for turn in 0..2 {
            let (from, to) = if turn == 0 {
                (&mut near, &mut far)
            } else {
                (&mut far, &mut near)
            };
            from.write(&all).unwrap();
            let mut came = Vec::new();
            let mut buffer = [0; 300];
            while came.len() < all.len() {
                to.wait(now() + SOON, &Calls::default()).unwrap();
                let length = to.read(&mut buffer).unwrap();
                assert!(length > 0, "{} octets came", came.len());
                came.extend_from_slice(&buffer[..length]);
            }
            assert_eq!(came, all);
            assert_eq!(to.read(&mut buffer).unwrap(), 0);
        }
    }

    #[test]
    fn an_unplugged_line_is_reported_at_once() {
        let (near, name) = Port::pair().unwrap();
        let mut far = Port::open(&name, Settings::new(9600)).unwrap();
        let began = now();
        drop(near);
        let waited = far.wait(now() + Duration::from_secs(60), &Calls::default());
        let error = waited.err().or_else(|| far.read(&mut [0; 8]).err()).unwrap();
        assert!(matches!(error, Error::Gone { .. }), "{error:?}");
        assert!(far.write(b"x").is_err());
        assert!(now() - began < Duration::from_secs(5));
    }

    #[test]
    fn a_port_without_a_reader_is_reported_and_does_not_hang() {
        let (mut near, name) = Port::pair().unwrap();
        let _far = Port::open(&name, Settings::new(9600)).unwrap();
        let error = (0..1000).find_map(|_| near.write(&[0; 512]).err()).unwrap();
        assert!(matches!(error, Error::Stuck { .. }), "{error:?}");
    }

    #[test]
    fn an_open_error_has_a_hint() {
        let open = |name: &str| Port::open(name, Settings::new(9600)).unwrap_err();
        let error = open("/dev/ttyNOWHERE7");
        assert_eq!(error.to_string(), "there is no serial port /dev/ttyNOWHERE7");
        assert!(error.hint().is_some());
        assert!(matches!(open("/dev/null"), Error::NotSerial { .. }));
        let (_near, name) = Port::pair().unwrap();
        let _first = Port::open(&name, Settings::new(9600)).unwrap();
        let second = open(&name);
        assert!(matches!(second, Error::Busy { .. }), "{second:?}");
        // the port is this test's own
        let number = std::process::id();
        assert!(
            second
                .to_string()
                .contains(&format!("in use by process {number} (")),
            "{second}"
        );
        assert!(second.hint().unwrap().contains(&format!("kill {number};")));
        let none = Error::NoPermission {
            port: "/dev/ttyS0".into(),
        };
        assert!(none.hint().unwrap().contains("dialout"));
    }

    #[test]
    fn a_bell_wakes_whoever_waits() {
        let (near, name) = Port::pair().unwrap();
        let _far = Port::open(&name, Settings::new(9600)).unwrap();
        let bell = crate::system::Bell::new().unwrap();
        let other = bell.clone();
        let began = now();
        let thread = std::thread::spawn(move || other.ring());
        let calls = Calls {
            bell: Some(bell),
            ..Calls::default()
        };
        near.wait(now() + Duration::from_secs(60), &calls).unwrap();
        thread.join().unwrap();
        assert!(now() - began < Duration::from_secs(30));
    }
}
