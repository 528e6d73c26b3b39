//! Motions of one drive, each a call with every safety rule in it: limits, mode and telegram that are put back, consent,
//! the way an axis ends.
//!
//! | motion | call | dry run |
//! |---|---|---|
//! | turn at a speed | [`run`] | [`plan_run`] |
//! | jog at the speed that the drive has, or at one set for the time | [`jog`] | [`plan_jog`] |
//! | jog at a speed of the telegram (real-time jogging) | [`jog_in_real_time`] | [`plan_jog_in_real_time`] |
//! | step from one speed to another, with every sample and figures | [`step`](step()) | |
//! | go to a position | [`move_to`] | [`plan_move`] |
//! | carry out a motion task of the drive | [`task`] | |
//! | set the home position | [`home`] | |
//! | hold an axis, and move it as often as wanted | [`hold`] | |
//! | acknowledge faults by the control word | [`acknowledge`] | |
//! | acknowledge faults by a parameter, beside the controller | [`acknowledge_by_parameter`] | |
//! | bring a drive to rest | [`stop`] | |
//!
//! A call sends its [`Event`]s to an [`Observer`] and returns a [`Report`]. What went wrong is a [`MotionError`], with what
//! the drive reports about itself.
//!
//! However a call ends, by its end, an error, a wish to stop ([`Session::interrupt_with`](client::Session::interrupt_with)) or a panic, the axis is ramped
//! down and released, then mode, telegram and jog speed are put back. A future that is dropped early leaves all of that to
//! the network, as the drop of an [`Axis`](client::Axis) does: [`Session::settled`](client::Session::settled) and the drop
//! of the network wait for it.
//!
//! ```
//! # use std::net::Ipv4Addr;
//! # use network::host::Host;
//! # use network::segment::{Pace, Segment, SegmentMedium};
//! # use profinet::{IpSuite, MacAddress, controller::ControllerConfig, device::Stored};
//! # use virtual_drive::{model, station::{Station, StationConfig}};
//! # let ip = |last| IpSuite {
//! #     address: Ipv4Addr::new(192, 168, 0, last),
//! #     mask: Ipv4Addr::new(255, 255, 255, 0),
//! #     gateway: Ipv4Addr::UNSPECIFIED,
//! # };
//! # let mut station = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
//! # station.network = Stored { name: "akd-1".into(), ip: ip(10), ..Stored::default() };
//! # let mut segment = Segment::new(1);
//! # segment.attach(Box::new(Host::new(Station::new(station))));
//! # let medium = SegmentMedium::new(segment, Pace::Virtual);
//! # let own = ControllerConfig::new(MacAddress([2, 0, 0, 0, 0, 9]), ip(1), "example", 1);
//! # let (mut network, _world) = client::Network::on(medium, own);
//! use std::time::Duration;
//! use profidrive::Wait;
//! use profidrive::motion::{self, Event, Observer, Run};
//!
//! // on a real network: let mut network = profidrive::open("eth0")?;
//! let mut drive = network.find(&"akd-1".parse()?).wait()?;
//! let wanted = Run { time: Some(Duration::from_secs(1)), ..Run::at(60.0) };
//! let observer = Observer::new(|event| {
//!     if let Event::Sample(status) = event {
//!         println!("{:?} rpm", status.speed_actual);
//!     }
//! });
//! let report = motion::run(&mut network, &mut drive, &wanted, &observer).wait()?;
//! assert!(report.result.speed.is_some_and(|speed| (speed.value - 60.0).abs() < 1.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod acknowledge;
mod axis;
mod check;
mod error;
mod event;
mod held;
mod jog;
mod leftover;
mod limit;
mod message;
mod mode;
mod plan;
mod position;
mod remark;
mod report;
mod response;
mod run;
mod speed;
mod start;
mod step;
mod stop;
mod tap;

use std::time::Duration;

use client::axis::Purpose;
use client::{AxisSettings, Drive, Session};

use crate::machine::SpeedBound;

pub use crate::remark::Remark;

pub use acknowledge::{acknowledge, acknowledge_by_parameter};
pub use error::{End, MotionError, TapError};
pub use event::{Arrival, Ended, Event, Observer, Setting, TelegramChange};
pub use held::{HeldAxis, Hold, hold};
pub use jog::{Jog, RealTimeJog, jog, jog_in_real_time, plan_jog, plan_jog_in_real_time};
pub use leftover::{Leftover, UnreadableNote, leftovers};
pub use message::{AxisState, CycleStrained, Message, RunsOn};
pub use plan::{JogChange, JogPlan, MoveReport, RunPlan, Telegrams};
pub use position::{Home, Move, Task, home, move_to, plan_move, task};
pub use report::{Frames, MotionResult, PutBack, Report};
pub use response::{Response, StepPoint, step_in};
pub use run::{Frequency, Run, TelegramName, plan_run, run, speed_at};
pub use speed::Speed;
pub use start::Start;
pub use step::{LONGEST_STEP, Step, Stepped, step};
pub use stop::{NoStop, StopMeans, StopOffer, StopReport, stop, stop_unowned};
pub use tap::SampleTap;

/// What all motions have in common.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Control {
    /// Update time of the cyclic connection; see [`AxisSettings::cycle`].
    pub cycle: Option<Duration>,
    /// Update times without data until both sides stop; see [`AxisSettings::watchdog`].
    pub watchdog: Option<u16>,
    /// Consent to move a drive that may run on when its controller is lost; see [`AxisSettings::may_run_on`].
    pub may_run_on: bool,
    /// Put the drive into the mode that the motion needs (PNU 930), and mode and telegram (PNU 922) back afterwards.
    /// Without it a drive in another mode is refused.
    pub set_mode: bool,
    /// Highest speed of the drive on this machine, beside that of the session ([`Session::speed_bound`]): the lower one counts. A
    /// motion above it is refused, whatever its own limit is.
    pub bound: Option<SpeedBound>,
}

impl Control {
    /// The same with the highest speed of this drive.
    fn on(self, session: &Session, drive: &Drive) -> Self {
        let bounds = self.bound.into_iter().chain(session.speed_bound(drive));
        let bound = bounds.min_by(|a, b| a.rpm.total_cmp(&b.rpm));
        Self { bound, ..self }
    }

    fn settings(&self, purpose: Purpose, speed_limit: f64) -> AxisSettings {
        AxisSettings {
            purpose,
            cycle: self.cycle,
            watchdog: self.watchdog,
            may_run_on: self.may_run_on,
            speed_limit,
            ..AxisSettings::default()
        }
    }
}

/// The highest speed of a motion where its caller sets no other, rpm.
pub const SPEED_LIMIT: f64 = 3000.0;
/// Longest wait of a motion without an end of its own.
const UNLIMITED: Duration = Duration::from_secs(100 * 365 * 24 * 3600);
