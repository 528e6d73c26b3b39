//! An axis that its caller holds: enabled once and moved as often as wanted, with the rules of the single motions.

use std::time::Duration;

use client::axis::{Jog as Setpoint, Move as Order, MovePlan, Purpose, SpeedUnit};
use client::{
    AxisSettings, AxisStatus, BeatHandle, Drive, Enabled, Error, ModeChange, Samples, Session, StopHandle,
};
use profile::state::Mode;

use super::axis::{Taken, check_controller_loss, report_rounded, report_switch};
use super::error::{End, MotionError};
use super::event::Observer;
use super::limit::{self, within};
use super::report::{MotionResult, Report};
use super::run::permit_speed;
use super::start::Start;
use super::{Control, SPEED_LIMIT, mode};

/// How an axis is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// What the axis is held for: decides over the mode and the telegram. [`Purpose::Speed`] has [`HeldAxis::run`] and
    /// [`HeldAxis::jog`], [`Purpose::Move`] has moves, tasks, homing and all jogs.
    pub purpose: Purpose,
    /// Any speed above this is refused, rpm.
    pub limit: f64,
    /// Time without a call after which the axis is brought to rest along its ramp; see [`AxisSettings::lease`].
    pub lease: Duration,
    /// What all motions have in common.
    pub control: Control,
}

impl Hold {
    /// For speeds up to [`SPEED_LIMIT`].
    #[must_use]
    pub fn for_speed() -> Self {
        Self::of(Purpose::Speed)
    }

    /// For positions, at speeds up to [`SPEED_LIMIT`].
    #[must_use]
    pub fn for_position() -> Self {
        Self::of(Purpose::Move)
    }

    fn of(purpose: Purpose) -> Self {
        let AxisSettings { lease, .. } = AxisSettings::default();
        Self {
            purpose,
            limit: SPEED_LIMIT,
            lease,
            control: Control::default(),
        }
    }

    const fn mode(&self) -> Mode {
        match self.purpose {
            Purpose::Speed => Mode::Velocity,
            _ => Mode::Position,
        }
    }
}

/// An axis under control of its caller. It moves only by a call, and every call applies the limits of its single motion.
///
/// It may go to another thread. However it ends, by [`release`](Self::release), by a drop, a panic or the end of its lease, the
/// axis is ramped down and released, then mode and telegram are put back. A motion that only lasts while a person wants it to,
/// a held button for example, is kept going by [`beat`](Self::beat).
///
/// ```
/// # #[cfg(feature = "simulate")] {
/// use std::time::Duration;
/// use profidrive::Wait;
/// use profidrive::motion::{self, Hold, Observer};
///
/// # let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// let mut drive = network.find(&"akd-1".parse()?).wait()?;
/// let observer = Observer::default();
/// let mut axis = motion::hold(&mut network, &mut drive, &Hold::for_speed(), &observer).wait()?;
/// axis.enable().wait()?;
/// axis.run(60.0).wait()?;
/// axis.pass(Duration::from_secs(1)).wait()?;
/// assert!(axis.status().and_then(|status| status.speed_actual).is_some_and(|speed| speed > 59.0));
/// assert!(axis.run(4000.0).wait().is_err()); // above the limit: the axis keeps its speed
/// axis.halt().wait()?; // along the ramp; it stays enabled
/// axis.release().wait()?;
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct HeldAxis {
    // dropped before what is put back once it is at rest
    taken: Taken,
    change: Option<ModeChange>,
    limit: f64,
    control: Control,
    session: Session,
    drive: Drive,
}

/// Takes control of an axis and nothing else: it is enabled by [`HeldAxis::enable`].
///
/// # Errors
/// When the mode, the reaction to a lost controller or another controller speaks against it.
pub async fn hold(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Hold,
    observer: &Observer,
) -> Result<HeldAxis, MotionError> {
    let wanted = &Hold {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let change = mode::enter(session, drive, wanted.mode(), &wanted.control, observer).await?;
    let settings = AxisSettings {
        lease: wanted.lease,
        ..wanted.control.settings(wanted.purpose, wanted.limit)
    };
    let axis = match session.take_axis(drive, settings).await {
        Ok(axis) => axis,
        Err(error) => {
            mode::leave(change, observer).await;
            return Err(error.into());
        }
    };
    let taken = match Taken::begin(axis, End::Open, Start::Hold, wanted.control.set_mode, observer).await {
        Ok(taken) => taken,
        Err(error) => {
            mode::leave(change, observer).await;
            return Err(error);
        }
    };
    Ok(HeldAxis {
        taken,
        change,
        limit: wanted.limit,
        control: wanted.control,
        session: session.clone(),
        drive: drive.clone(),
    })
}

impl HeldAxis {
    /// Enables the axis (S4). It stands.
    ///
    /// # Errors
    /// When the drive does not come into operation, or the connection is lost.
    pub async fn enable(&mut self) -> Result<(), Error> {
        self.taken.axis.enable().await?.leave();
        Ok(())
    }

    /// Works on the axis, which stays in operation with the motion that is under way then.
    async fn in_operation<T>(
        &mut self,
        work: impl AsyncFnOnce(&mut Enabled<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let drive = self.drive.label();
        let mut enabled = self.taken.axis.operation().ok_or(Error::NotEnabled { drive })?;
        let result = work(&mut enabled).await;
        enabled.leave();
        result
    }

    /// Follows this speed from now on, in rpm. Another speed is taken on the fly.
    ///
    /// # Errors
    /// A speed above the limit of the caller or of the drive, and when the axis is not enabled. What moved before goes on.
    pub async fn run(&mut self, speed: f64) -> Result<(), MotionError> {
        within(speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        let observer = self.taken.observer().clone();
        permit_speed(&mut self.session, &mut self.drive, speed, None, &observer).await?;
        if let Some(nearest) = self.taken.axis.rounded_speed(speed) {
            report_rounded(speed, nearest, SpeedUnit::Rpm.symbol(), &observer);
        }
        Ok(self
            .in_operation(async |enabled| enabled.run(speed).await)
            .await?)
    }

    /// Jogs by the jog function of the drive, at the speed that the drive has; returns it, in rpm.
    ///
    /// # Errors
    /// A jog speed above the limit of the caller or of the drive, and when the axis is not enabled.
    pub async fn jog(&mut self, setpoint: Setpoint) -> Result<f64, MotionError> {
        let setting = self.session.jog_speed(&mut self.drive, setpoint).await?;
        let reading = self.session.read_one(&mut self.drive, &setting.selection).await?;
        // a speed that is not known is within no limit
        let speed = setting.rpm(&reading).unwrap_or(f64::NAN);
        within(speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        let facts = self.session.motion_facts(&mut self.drive).await?;
        limit::jog(speed, &facts, &self.drive)?;
        report_switch(speed, &facts, self.taken.observer());
        self.in_operation(async |enabled| enabled.jog(setpoint).await)
            .await?;
        Ok(speed)
    }

    /// Jogs at this speed, in rpm, by the telegram (real-time jogging). Another speed is taken on the fly.
    ///
    /// # Errors
    /// A speed above the limit of the caller or of the drive, a drive in velocity mode, and when the axis is not enabled.
    pub async fn jog_at(&mut self, speed: f64) -> Result<(), MotionError> {
        within(speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        let sent = self.session.check_jog(&mut self.drive, speed, self.limit).await?;
        let observer = self.taken.observer().clone();
        report_rounded(speed, sent, SpeedUnit::Rpm.symbol(), &observer);
        let facts = self.session.motion_facts(&mut self.drive).await?;
        report_switch(speed, &facts, &observer);
        Ok(self
            .in_operation(async |enabled| enabled.jog_at(speed).await)
            .await?)
    }

    /// Starts a move and returns its plan once the drive has accepted it. A move under way is replaced on the fly;
    /// [`arrive`](Self::arrive) waits for its end.
    ///
    /// # Errors
    /// A speed above the limit, what speaks against the move ([`Error::Objections`]), and when the axis is not enabled.
    pub async fn start(&mut self, order: &Order) -> Result<MovePlan, MotionError> {
        within(order.speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        let start = async |enabled: &mut Enabled<'_>| {
            let plan = enabled.plan(order).await?;
            enabled.start(&plan).await?;
            Ok(plan)
        };
        Ok(self.in_operation(start).await?)
    }

    /// Starts a motion task of the drive; [`arrive`](Self::arrive) waits for its end.
    ///
    /// # Errors
    /// A task that the drive does not have or that cannot run, and when the axis is not enabled.
    pub async fn start_task(&mut self, number: u16) -> Result<(), MotionError> {
        self.session.check_task(&mut self.drive, number).await?;
        self.bounded("a motion task").await?;
        Ok(self
            .in_operation(async |enabled| enabled.start_task(number).await)
            .await?)
    }

    /// Waits until the move or task under way is at its target; returns how the axis was then. The axis goes on where the time is
    /// over first.
    ///
    /// # Errors
    /// When it takes longer than `limit`, the axis stops elsewhere, or it leaves operation.
    pub async fn arrive(&mut self, limit: Duration) -> Result<AxisStatus, Error> {
        self.in_operation(async |enabled| enabled.reach_target(Some(limit)).await)
            .await
    }

    /// Homes the axis as the drive is set up, and waits for the end.
    ///
    /// # Errors
    /// When homing fails or takes longer than `limit`, and when the axis is not enabled.
    pub async fn home(&mut self, limit: Duration) -> Result<(), MotionError> {
        self.bounded("homing").await?;
        Ok(self
            .in_operation(async |enabled| enabled.home(Some(limit)).await)
            .await?)
    }

    /// Refuses a motion whose speed only the drive has, where the machine bounds it.
    async fn bounded(&mut self, what: &'static str) -> Result<(), MotionError> {
        limit::of_drive(&mut self.session, &mut self.drive, &self.control, what).await
    }

    /// Lets time pass and keeps the axis: its motion goes on.
    ///
    /// # Errors
    /// When the axis leaves operation, and when the caller requests a stop.
    pub async fn pass(&mut self, time: Duration) -> Result<(), Error> {
        self.taken.axis.hold(time).await
    }

    /// Halts along the ramp; the axis stays enabled. Returns at standstill.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, or is not enabled.
    pub async fn halt(&mut self) -> Result<(), Error> {
        self.in_operation(async |enabled| enabled.halt().await).await
    }

    /// Ramp stop (OFF1) and the end of operation; control is kept. Returns at standstill.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, or the connection is lost.
    pub async fn stop(&mut self) -> Result<(), Error> {
        self.taken.axis.stop().await
    }

    /// Acknowledges faults by an edge of STW1 bit 7.
    ///
    /// # Errors
    /// When a fault stays, or the connection is lost.
    pub async fn acknowledge(&mut self) -> Result<(), Error> {
        self.taken.axis.acknowledge().await
    }

    /// Keeps a motion going for this time from now on, and renews the lease: see [`client::Axis::beat`].
    pub fn beat(&self, time: Option<Duration>) {
        self.taken.axis.beat(time);
        self.taken.axis.renew();
    }

    /// Returns what keeps a motion going, and renews the lease, from any thread: also while a call for the axis waits.
    #[must_use]
    pub fn beat_handle(&self) -> BeatHandle {
        self.taken.axis.beat_handle()
    }

    /// Returns the axis as its last inputs show it; `None` once the connection is closed.
    #[must_use]
    pub fn status(&self) -> Option<AxisStatus> {
        self.taken.axis.status()
    }

    /// Returns what stops this axis from any thread.
    #[must_use]
    pub fn stop_handle(&self) -> StopHandle {
        self.taken.axis.stop_handle()
    }

    /// Returns every cyclic sample of the axis from now on.
    #[must_use]
    pub fn samples(&self, room: usize) -> Samples {
        self.taken.axis.samples(room)
    }

    /// Returns the drive.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Ramps the axis down, gives control of it back, and puts mode and telegram back.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, the connection was lost before, or a setting was not put back.
    pub async fn release(self) -> Result<Report, MotionError> {
        let Self {
            taken,
            change,
            mut session,
            mut drive,
            ..
        } = self;
        let observer = taken.observer().clone();
        let found = MotionResult {
            speed: taken.speed(),
            ..MotionResult::default()
        };
        let done = taken.finish(Ok(()), found).await;
        let restored = mode::leave(change, &observer).await;
        done.report(restored, &observer, (&mut session, &mut drive)).await
    }
}
