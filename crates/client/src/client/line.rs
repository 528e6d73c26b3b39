//! The client as the master of a serial line.

use profile::parameter::DecodeError;
use profile::pkw::JobError;
use profinet::Instant;
use uss::{ReceiverStatistics, SlaveId};

use super::Client;
use crate::line::{Answered, Bridge, Line, LineConfig};

impl Client {
    /// Returns the counters of the serial line, telegrams and noise; `None` on a network.
    #[must_use]
    pub fn line_counters(&self) -> Option<&ReceiverStatistics> {
        self.line.as_ref().map(Line::counters)
    }

    pub(crate) fn line(&mut self) -> Option<&mut Line> {
        self.line.as_mut()
    }

    pub(crate) fn line_config(&self) -> Option<LineConfig> {
        self.line.as_ref().map(Line::config)
    }

    /// Begins a parameter job of a drive at the line.
    pub(crate) fn line_job(
        &mut self,
        now: Instant,
        slave: SlaveId,
        job: Result<Bridge, DecodeError>,
    ) -> Result<(), DecodeError> {
        self.line
            .as_mut()
            .map_or(Ok(()), |line| line.start(now, slave, job))
    }

    /// Returns the end of a parameter job of a drive at the line.
    pub(crate) fn take_line_job(&mut self, slave: SlaveId) -> Option<Result<Answered, JobError>> {
        self.line.as_mut()?.take(slave)
    }

    /// Takes octets that came from the serial line.
    pub fn handle_octets(&mut self, now: Instant, octets: &[u8]) {
        if let Some(line) = &mut self.line {
            line.handle_octets(now, octets);
        }
        self.news.everything = true;
        self.work(now);
    }

    /// Does what is due on the serial line at `now`.
    pub fn handle_line_timeout(&mut self, now: Instant) {
        if let Some(line) = &mut self.line {
            line.handle_timeout(now);
        }
        self.news.everything = true;
        self.work(now);
    }

    /// Returns the next octets to send on the serial line: their number in `buffer`, which has [`uss::MAX_TELEGRAM`] of
    /// them.
    pub fn poll_octets(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        self.line.as_mut()?.poll_octets(now, buffer)
    }

    /// Returns the time when [`handle_line_timeout`](Self::handle_line_timeout) and [`poll_octets`](Self::poll_octets)
    /// are due.
    #[must_use]
    pub fn poll_line_timeout(&self) -> Option<Instant> {
        self.line.as_ref()?.poll_timeout()
    }
}
