//! The way to an axis: telegram, connection, control.

use std::time::Duration;

use profile::catalogue::Device;
use profile::value::Reading;
use profinet::controller::{ArId, ConnectConfig, Misuse, Resolve, Target};

use super::rest::{Closer, Ending, Place};
use super::{Axis, AxisPlan, AxisSettings, Session, speed_setpoint};
use crate::axis::{AxisControl, Cycle, Limits, Purpose, SpeedScale, Wiring};
use crate::engine::{At, Engine, Interest, at};
use crate::learn::device_of;
use crate::session::plugged::Layout;
use crate::session::prepare::{Prepared, ownerless};
use crate::session::takeover;
use crate::{Drive, Error, Link, LossReaction};

/// One unit of MinDeviceInterval and of the send clock.
const TICK: Duration = Duration::from_nanos(31_250);
/// How long the delays of this computer are measured before an axis may be enabled.
const MEASURED: Duration = Duration::from_millis(200);
/// One wait of that measurement.
const WAIT: Duration = Duration::from_millis(1);
/// Shortest time a drive has for accepting a task.
const ACCEPT: Duration = Duration::from_secs(2);

/// The axis of a drive is being taken: no other caller of this program takes it meanwhile, which would end the connection that is
/// opened here.
struct Taking {
    engine: Engine,
    place: At,
}

impl Taking {
    fn begin(engine: &Engine, drive: &Drive) -> Result<Self, Error> {
        if !engine.records().begin_taking(drive) {
            return Err(Error::UnderControl { drive: drive.label() });
        }
        Ok(Self {
            engine: engine.clone(),
            place: at(drive),
        })
    }
}

impl Drop for Taking {
    fn drop(&mut self) {
        self.engine.records().end_taking(self.place);
    }
}

impl Session {
    /// Checks that a speed is representable with the present scale of the drive: the setpoint has steps, and the
    /// nearest one must not be more than [`MOST_ROUNDING`](profile::value::MOST_ROUNDING) away. Reads only.
    ///
    /// # Errors
    /// [`Error::SpeedStep`] with the speeds beside it, [`Error::SpeedRange`] beyond what the setpoint holds, and when the
    /// drive cannot be reached.
    pub async fn check_speed(&mut self, drive: &mut Drive, rpm: f64) -> Result<(), Error> {
        self.read_scaling(drive).await?;
        let scale = SpeedScale::linear(drive.parameters.scaling.speed());
        speed_setpoint(drive, &scale, rpm).map(|_| ())
    }

    /// What [`take_axis`](Self::take_axis) would do, checked as far as reading can: control at the drive itself, mode,
    /// telegram, timing, another controller. Reads only.
    ///
    /// # Errors
    /// As [`take_axis`](Self::take_axis); [`Error::OwnedByController`] when a controller has the drive.
    pub async fn plan_axis(&mut self, drive: &mut Drive, settings: &AxisSettings) -> Result<AxisPlan, Error> {
        let tables = drive.model.catalogue;
        let device = tables.map_or_else(|| device_of(&drive.station), |tables| tables.device);
        drive.check_able(settings.purpose.mode())?;
        self.check_carrier(drive)?;
        self.read_scaling(drive).await?;
        if !drive.is_on_line() {
            cycle_of(drive, &device, settings)?;
        }
        let prepared = self.prepare(drive, &device, settings).await?;
        self.permitted_loss(drive, settings).await?;
        if prepared.layout.is_some()
            && let Some(controller) = self.owner(drive).await?.flatten()
        {
            return Err(Error::OwnedByController {
                drive: drive.label(),
                controller: Some(controller),
                cause: "a connection is open".to_owned(),
            });
        }
        Ok(AxisPlan {
            telegram: prepared.wiring.telegram(),
            telegram_before: prepared.reported,
            scale: prepared.scale,
        })
    }

    /// Opens the cyclic connection of an axis, with the telegram that its purpose needs and the drive has. Nothing
    /// moves: control is taken with the first goal.
    ///
    /// A drive that is in operation without a controller is taken over with [`Purpose::Control`] only: the control word
    /// and the setpoint that it obeys go on until the first goal, and the axis is stopped when this object goes.
    ///
    /// # Errors
    /// When the model is not known, no telegram does, the drive is in another mode, cannot be reached, is
    /// in local operation ([`Error::LocalOperation`]), this program has its axis already ([`Error::UnderControl`]), it is in operation without a controller ([`Error::Ownerless`]), it
    /// may run on when its controller is lost and that is not consented to ([`Error::RunsOn`]), it is to be observed and its
    /// status word is not readable ([`Error::StatusUnread`]) or it may move when the connection is lost
    /// ([`Error::MovesWhenLost`]), another controller owns it, the session carries UDP only ([`Error::NeedsRawFrames`]), or another program has the port on which the drive calls
    /// ([`Error::NeedsCallPort`]).
    pub async fn take_axis(&mut self, drive: &mut Drive, settings: AxisSettings) -> Result<Axis, Error> {
        let tables = drive.model.catalogue;
        let device = tables.map_or_else(|| device_of(&drive.station), |tables| tables.device);
        drive.check_able(settings.purpose.mode())?;
        self.check_carrier(drive)?;
        self.ended(drive).await?;
        // what stops a drive takes the control word from whoever has it
        let _taking = match settings.purpose {
            Purpose::Control => None,
            _ => Some(Taking::begin(&self.engine, drive)?),
        };
        self.read_scaling(drive).await?;
        let Prepared {
            mode,
            mut wiring,
            layout,
            reported,
            kept: in_operation,
            scale,
            acceleration,
            deceleration,
        } = self.prepare(drive, &device, &settings).await?;
        let loss = Box::new(self.permitted_loss(drive, &settings).await?);
        let kept = self.keep(drive, &wiring).await?;
        let taken_over = in_operation && settings.purpose == Purpose::Control;
        let present = if taken_over {
            Some(self.present_command(drive, &mut wiring, reported, &scale).await?)
        } else {
            None
        };
        let line = self.client().line_config();
        let (cycle, chosen) = match line {
            // the line goes as fast as it can
            Some(line) => (line.exchange(), None),
            None => {
                let chosen = cycle_of(drive, &device, &settings)?;
                (chosen.interval(), Some(chosen))
            }
        };
        let limits = Limits {
            dwell: (cycle * 4).max(Duration::from_millis(8)),
            stop: settings.stop,
            standstill: standstill(&scale),
            accept: ACCEPT.max(cycle * 16),
            task_active: drive.model.task_active,
            ..Limits::default()
        };
        let telegram = wiring.telegram();
        let control = match present {
            Some(present) => AxisControl::taking_over(limits, mode, present),
            None => AxisControl::in_mode(limits, mode),
        };
        self.make_way(drive).await?;
        // whoever leaves the network from another thread finds the closer, or there is no connection
        let open = self.engine.stay_open()?;
        let now = self.now();
        // from here on the object below sees to the end of the connection
        let (link, waiting) = self.attach(drive, layout.zip(chosen), wiring, control)?;
        let mut axis = Axis {
            drive: drive.clone(),
            link,
            settings,
            cycle,
            strained: None,
            telegram,
            telegram_before: reported,
            scale,
            acceleration,
            deceleration,
            evidence: None,
            loss,
            target: None,
            begun: now,
            watcher: None,
            warnings: Default::default(),
            reported: false,
            ending: Ending::new(settings.stop),
            session: self.clone(),
        };
        self.engine.records().axes.push(axis.place());
        self.engine.spawn(axis.closer(kept).attend());
        drop(open);
        match axis.come_up(waiting, chosen).await {
            Ok(()) => Ok(axis),
            Err(error) => {
                // it is given back before the error is returned
                let _ = axis.release().await;
                Err(error)
            }
        }
    }

    /// Gives the control of a drive its connection: a new one, or the line that it is on. Its words travel at once, unless
    /// the drive is to be asked first which signals they are: then they wait.
    fn attach(
        &self,
        drive: &Drive,
        connection: Option<(Layout, Cycle)>,
        wiring: Wiring,
        control: AxisControl,
    ) -> Result<(Link, Option<Waiting>), Error> {
        let Some((layout, cycle)) = connection else {
            let slave = drive.slave.ok_or(Misuse::UnknownConnection)?;
            self.client().attach_slave(slave, wiring, control);
            return Ok((Link::Slave(slave), None));
        };
        let mut config = ConnectConfig::new(layout.modules, cycle.timing);
        config.watchdog_factor = cycle.watchdog;
        config.data_hold_factor = cycle.watchdog;
        config.resolve = if drive.station.name.is_empty() {
            Resolve::Trust
        } else {
            Resolve::Check
        };
        let now = self.now();
        let ar = self
            .client()
            .controller()
            .connect(now, Target::of(&drive.station), config)?;
        let (slot, subslot) = layout.place;
        let waiting = if wiring.chosen_words().next().is_some() {
            Some((ar, slot, subslot, wiring, control))
        } else {
            self.client().attach_axis(ar, slot, subslot, wiring, control);
            None
        };
        Ok((Link::ArListEntry(ar), waiting))
    }

    /// What the drive does when its controller is lost, once a motion is allowed to depend on it. Control without a motion
    /// is what stops a drive, and needs no consent. A drive that is only observed must not move by it.
    async fn permitted_loss(
        &mut self,
        drive: &mut Drive,
        settings: &AxisSettings,
    ) -> Result<LossReaction, Error> {
        let loss = self.loss_reaction(drive).await?;
        match settings.purpose {
            // the power stage is off: only a reaction that commands a motion makes a difference
            Purpose::Observe if loss.may_command_motion() => Err(Error::MovesWhenLost {
                drive: drive.label(),
                reaction: Box::new(loss),
            }),
            Purpose::Observe | Purpose::Control => Ok(loss),
            _ => {
                loss.permit(drive, settings.may_run_on)?;
                Ok(loss)
            }
        }
    }

    /// Waits until every axis that was dropped is at rest, or cannot be reached any more, and what was changed for its motion
    /// is put back.
    ///
    /// # Errors
    /// When the wire fails or the caller requests a stop.
    pub async fn settled(&mut self) -> Result<(), Error> {
        while self.engine.records().ends_any_work() {
            self.look_again().await?;
        }
        Ok(())
    }

    /// Waits for the end of an axis of this drive that is being brought to rest, and until its settings are put back.
    pub(in crate::session) async fn ended(&mut self, drive: &Drive) -> Result<(), Error> {
        while self.engine.records().ends_work(drive) {
            self.look_again().await?;
        }
        Ok(())
    }

    /// Cyclic data travels in frames of its own, not in UDP; the drive calls when it is ready for them.
    fn check_carrier(&self, drive: &Drive) -> Result<(), Error> {
        if drive.is_on_line() {
            return Ok(());
        }
        if !self.engine.discovers() {
            return Err(Error::NeedsRawFrames { drive: drive.label() });
        }
        if !self.engine.receives_calls() {
            return Err(Error::NeedsCallPort { drive: drive.label() });
        }
        Ok(())
    }

    /// Returns the longest delay of a wake-up of this computer, measured over [`MEASURED`].
    async fn longest_delay(&mut self) -> Result<Duration, Error> {
        let end = self.now() + MEASURED;
        let mut longest = Duration::ZERO;
        while self.now() < end {
            let due = self.now() + WAIT;
            while self.now() < due {
                self.step(due).await?;
            }
            longest = longest.max(self.now() - due);
        }
        Ok(longest)
    }
}

/// Update time and watchdog for a drive: those requested, else calm ones that its tables and description allow. A connection that
/// commands nothing stops nothing by its end: unless requested otherwise it outlasts every stall that one can.
fn cycle_of(drive: &Drive, device: &Device, settings: &AxisSettings) -> Result<Cycle, Error> {
    let least = TICK * u32::from(device.min_device_interval);
    let cycle = Cycle::choose(&drive.vendor_timings, least, settings.cycle, settings.watchdog)?;
    let patient = settings.purpose == Purpose::Observe && settings.watchdog.is_none();
    Ok(if patient { cycle.patient() } else { cycle })
}

/// NIST_A below which the axis stands.
fn standstill(scale: &SpeedScale) -> u16 {
    let still = scale.unit().standstill();
    let steps = scale.speed(1).max(f64::MIN_POSITIVE);
    // of a scale that begins at a lowest speed every number is above it
    let raw = scale.raw(still).filter(|_| steps < still).unwrap_or(1);
    raw.unsigned_abs().max(1)
}

/// An axis whose telegram is attached once the drive reports the contents of its words.
type Waiting = (ArId, u16, u16, Wiring, AxisControl);

impl Axis {
    /// Waits until the connection carries data that fit.
    async fn come_up(&mut self, waiting: Option<Waiting>, chosen: Option<Cycle>) -> Result<(), Error> {
        let measures = self.settings.purpose != Purpose::Control;
        let drive = self.drive.clone();
        self.session.running(&drive, self.link).await?;
        self.session.under_control = Some((drive.label(), self.loss.clone()));
        self.session.interest = Interest::Axis(self.link);
        if let Link::ArListEntry(ar) = self.link {
            self.session.share(&drive, ar);
        }
        if let Some((ar, slot, subslot, mut wiring, control)) = waiting {
            // nothing was sent yet: only now the drive reports what is in the words of this telegram
            self.session.preset_chosen(&mut self.drive, &mut wiring).await?;
            self.session
                .client()
                .attach_axis(ar, slot, subslot, wiring, control);
        }
        if let Some(chosen) = chosen.filter(|_| measures) {
            // the connection is open and nothing is enabled: frames are sent as they will be later
            self.strained = chosen.judge(self.session.longest_delay().await?);
        }
        self.begun = self.session.now();
        // a device that does not report its connections reveals only now that it had no other controller
        let seen = self.status().and_then(|status| status.view.seen);
        if measures && takeover::is_kept(seen.map(|seen| seen.zsw1)) {
            return Err(ownerless(&self.drive));
        }
        Ok(())
    }

    /// Where it is, for those who come after it.
    fn place(&self) -> Place {
        Place::new(&self.drive, self.link, &self.ending)
    }

    /// The one who ends this axis.
    fn closer(&self, kept: Vec<Reading>) -> Closer {
        let mut session = self.session.clone();
        session.under_control = Some((self.drive.label(), self.loss.clone()));
        session.interest = Interest::Axis(self.link);
        Closer {
            session,
            drive: self.drive.clone(),
            link: self.link,
            cycle: self.cycle,
            scale: self.scale,
            deceleration: self.deceleration,
            kept,
            loss: self.loss.clone(),
            ending: self.ending.clone(),
            quick: false,
            hurried: false,
        }
    }
}
