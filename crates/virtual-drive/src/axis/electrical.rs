//! The power stage: DC bus, temperatures and what the current does to them over time.

use super::within;

/// Rectified voltage of a mains voltage.
const RECTIFIED: f64 = core::f64::consts::SQRT_2;
/// Bus voltage below which no current can be made, V.
const DEAD: f64 = 40.0;
/// Voltage at which the model ends, V: whatever happens, no more.
const MOST: f64 = 1000.0;
/// Air around the drive, degC.
const AMBIENT: f64 = 25.0;
/// Temperature of the idle power stage above the air, K.
const IDLE_HEAT: f64 = 8.0;
/// From this part of the foldback reserve on the current limit comes down.
const NEARLY: f64 = 0.95;

/// The power stage and its supply: numbers that belong to a size of drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerStage {
    /// Nominal mains voltage between two lines, V.
    pub mains: f64,
    /// The brake resistor is switched on above this bus voltage, V.
    pub chopper: f64,
    /// Resistance of the brake resistor, ohm; 0: none is fitted.
    pub resistance: f64,
    /// Capacitance of the bus, F.
    pub capacitance: f64,
    /// Time in which the mains fills the bus, s.
    pub filling_time: f64,
    /// Power that the drive itself takes from the bus, W.
    pub own_power: f64,
    /// Winding and power stage, ohm: losses per square of current.
    pub loss: f64,
    /// Heat of the power stage, K per A^2.
    pub stage_heat: f64,
    /// Time constant of that, s.
    pub stage_time: f64,
    /// Heat of the motor winding, K per A^2.
    pub motor_heat: f64,
    /// Time constant of that, s.
    pub motor_time: f64,
}

impl PowerStage {
    /// A small servo drive on 230 V.
    pub const SERVO: Self = Self {
        mains: 230.0,
        chopper: 380.0,
        resistance: 33.0,
        capacitance: 560e-6,
        filling_time: 0.02,
        own_power: 15.0,
        loss: 2.0,
        stage_heat: 0.9,
        stage_time: 120.0,
        motor_heat: 6.0,
        motor_time: 900.0,
    };

    /// A frequency converter of 1.5 kW on 400 V without brake resistor. The winding is 80 K warm at 3.4 A.
    pub const VOLT_400: Self = Self {
        mains: 400.0,
        chopper: 770.0,
        resistance: 0.0,
        capacitance: 500e-6,
        filling_time: 0.002,
        own_power: 25.0,
        loss: 9.0,
        stage_heat: 1.7,
        stage_time: 180.0,
        motor_heat: 6.9,
        motor_time: 1200.0,
    };
}

/// How long a part takes more than its continuous current.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Endurance {
    /// Current for ever, A.
    pub continuous: f64,
    /// Highest current, A.
    pub peak: f64,
    /// Time for which it takes the peak when it comes from no current, s.
    pub time: f64,
}

impl Endurance {
    /// Squared ampere times seconds above the continuous current; 0 or less: no foldback.
    fn reserve(&self) -> f64 {
        (self.peak * self.peak - self.continuous * self.continuous) * self.time
    }
}

/// One foldback: what of the reserve is used up, A^2 s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Foldback {
    used: f64,
    reserve: f64,
    limit: f64,
}

impl Foldback {
    /// `square` is that of the current.
    fn step(&mut self, dt: f64, square: f64, endurance: &Endurance) {
        let reserve = endurance.reserve();
        self.reserve = reserve;
        self.limit = endurance.peak;
        if reserve.is_nan() || reserve <= 0.0 {
            self.used = 0.0;
            return;
        }
        let over = square - endurance.continuous * endurance.continuous;
        self.used = (self.used + over * dt).max(0.0).min(reserve);
        if self.used > NEARLY * reserve {
            let left = (1.0 - self.used / reserve) / (1.0 - NEARLY);
            self.limit = endurance.continuous + (endurance.peak - endurance.continuous) * left;
        }
    }

    fn load(&self) -> f64 {
        if self.reserve > 0.0 {
            self.used / self.reserve
        } else {
            0.0
        }
    }
}

/// DC bus, temperatures and foldback.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Electrical {
    stage: PowerStage,
    /// 2 / capacitance; 1 / resistance of the brake resistor, 0 without one; square of its voltage.
    feed: f64,
    conductance: f64,
    chopper: f64,
    /// Square of the bus voltage: twice the energy per capacitance.
    square: f64,
    /// Square of the rectified mains voltage.
    mains: f64,
    resistor: bool,
    /// Power in the brake resistor, W.
    burnt: f64,
    power_stage: f64,
    motor: f64,
    drive_foldback: Foldback,
    motor_foldback: Foldback,
    bus_override: Option<f64>,
    power_stage_override: Option<f64>,
    motor_override: Option<f64>,
}

impl Electrical {
    pub(super) fn new(stage: &PowerStage) -> Self {
        let foldback = Foldback {
            used: 0.0,
            reserve: 0.0,
            limit: f64::MAX,
        };
        let mut electrical = Self {
            stage: *stage,
            feed: 0.0,
            conductance: 0.0,
            chopper: 0.0,
            square: 0.0,
            mains: 0.0,
            resistor: true,
            burnt: 0.0,
            power_stage: AMBIENT + IDLE_HEAT,
            motor: AMBIENT,
            drive_foldback: foldback,
            motor_foldback: foldback,
            bus_override: None,
            power_stage_override: None,
            motor_override: None,
        };
        electrical.set_stage(stage);
        electrical.set_mains(None);
        electrical.square = electrical.mains;
        electrical
    }

    /// Another power stage; what is on the bus and how warm it is stays.
    pub(super) fn set_stage(&mut self, stage: &PowerStage) {
        let nominal = stage.mains == self.stage.mains;
        self.stage = *stage;
        self.feed = 2.0 / least(stage.capacitance, 1.0e-6);
        self.conductance = if stage.resistance > 0.0 {
            1.0 / stage.resistance
        } else {
            0.0
        };
        self.chopper = stage.chopper * stage.chopper;
        self.stage.filling_time = least(stage.filling_time, 1.0e-3);
        self.stage.stage_time = least(stage.stage_time, 1.0e-2);
        self.stage.motor_time = least(stage.motor_time, 1.0e-2);
        if !nominal {
            self.set_mains(None);
        }
    }

    /// One step of the bus: `power` W flow from it into the shaft, `heat` A^2 through the motor.
    pub(super) fn step(&mut self, dt: f64, power: f64, heat: f64) {
        let mut flow = -(power + self.stage.loss * heat + self.stage.own_power) * self.feed;
        if self.square < self.mains {
            flow += (self.mains - self.square) / self.stage.filling_time;
        }
        let chopper = self.resistor && self.square > self.chopper;
        self.burnt = 0.0;
        if chopper {
            self.burnt = self.square * self.conductance;
            flow -= self.burnt * self.feed;
        }
        self.square = (self.square + flow * dt).clamp(0.0, MOST * MOST);
    }

    /// What takes seconds to minutes, after some steps of the bus together: temperatures and foldback. `heat` is the mean of
    /// the squared current, A^2.
    pub(super) fn warm(&mut self, seconds: f64, heat: f64, drive: &Endurance, motor: &Endurance) {
        let share = |time: f64| (seconds / time).min(1.0);
        self.power_stage += (AMBIENT + IDLE_HEAT + self.stage.stage_heat * heat - self.power_stage)
            * share(self.stage.stage_time);
        self.motor += (AMBIENT + self.stage.motor_heat * heat - self.motor) * share(self.stage.motor_time);
        self.drive_foldback.step(seconds, heat, drive);
        self.motor_foldback.step(seconds, heat, motor);
    }

    /// A time of any length without current.
    pub(super) fn rest(&mut self, seconds: f64, drive: &Endurance, motor: &Endurance) {
        let filling = if self.square < self.mains {
            (self.mains - self.square) * (seconds / self.stage.filling_time).min(1.0)
        } else {
            0.0
        };
        let own = self.stage.own_power * self.feed * seconds;
        let lowest = if self.mains > 0.0 {
            self.mains.min(self.square + filling)
        } else {
            0.0
        };
        self.square = (self.square + filling - own).max(lowest);
        self.burnt = 0.0;
        self.warm(seconds, 0.0, drive, motor);
    }

    /// Highest current that the foldback allows, A (IL.IFOLD).
    #[must_use]
    pub fn foldback_limit(&self) -> f64 {
        self.drive_foldback.limit.min(self.motor_foldback.limit)
    }

    /// Limit of the drive's own foldback, A (IL.DIFOLD).
    #[must_use]
    pub const fn drive_foldback_limit(&self) -> f64 {
        self.drive_foldback.limit
    }

    /// Limit of the motor's foldback, A (IL.MIFOLD).
    #[must_use]
    pub const fn motor_foldback_limit(&self) -> f64 {
        self.motor_foldback.limit
    }

    /// Returns the used share of the drive's reserve above its continuous current, 0 to 1.
    #[must_use]
    pub fn drive_load(&self) -> f64 {
        self.drive_foldback.load()
    }

    /// Returns the used share of the motor's reserve above its continuous current, 0 to 1 (IL.MI2T).
    #[must_use]
    pub fn motor_load(&self) -> f64 {
        self.motor_foldback.load()
    }

    /// Returns true while a foldback takes current away.
    #[must_use]
    pub fn is_folding_back(&self) -> bool {
        self.drive_load() > NEARLY || self.motor_load() > NEARLY
    }

    /// Voltage of the DC bus, V (VBUS.VALUE).
    #[must_use]
    pub fn bus_voltage(&self) -> f64 {
        self.bus_override.unwrap_or_else(|| self.square.sqrt())
    }

    /// Power in the brake resistor, W (REGEN.POWER).
    #[must_use]
    pub const fn regen_power(&self) -> f64 {
        self.burnt
    }

    /// Temperature of the power stage, degC (TEMP.POWER).
    #[must_use]
    pub fn power_stage_temperature(&self) -> f64 {
        self.power_stage_override.unwrap_or(self.power_stage)
    }

    /// Temperature of the motor winding, degC (MOTOR.TEMPC).
    #[must_use]
    pub fn motor_temperature(&self) -> f64 {
        self.motor_override.unwrap_or(self.motor)
    }

    /// Temperature of the control board, degC (TEMP.CONTROL).
    #[must_use]
    pub const fn control_temperature(&self) -> f64 {
        AMBIENT + 12.0
    }

    /// Returns the true voltage of the bus, V, whatever the drive measures.
    pub(super) fn true_bus(&self) -> f64 {
        self.square.sqrt()
    }

    /// False when the bus is too low to make current.
    pub(crate) fn can_drive(&self) -> bool {
        match self.bus_override {
            None => self.square > DEAD * DEAD,
            Some(voltage) => voltage > DEAD,
        }
    }

    /// Returns whether the mains is there.
    #[must_use]
    pub const fn has_mains(&self) -> bool {
        self.mains > 0.0
    }

    /// Mains voltage, V; 0 is off.
    pub(super) fn set_mains(&mut self, voltage: Option<f64>) {
        let peak = RECTIFIED * sane(voltage.unwrap_or(self.stage.mains));
        self.mains = (peak * peak).min(MOST * MOST);
    }

    /// Takes the brake resistor away or puts it back.
    pub(super) const fn set_regen(&mut self, present: bool) {
        self.resistor = present;
    }

    /// Voltage that the drive shall measure instead.
    pub(super) fn override_bus(&mut self, voltage: Option<f64>) {
        self.bus_override = voltage.map(sane);
    }

    /// Temperature of the motor that the drive shall measure instead, degC.
    pub(super) fn override_motor(&mut self, temperature: Option<f64>) {
        self.motor_override = temperature.filter(|value| value.is_finite());
    }

    /// Temperature of the power stage that the drive shall measure instead, degC.
    pub(super) fn override_power_stage(&mut self, temperature: Option<f64>) {
        self.power_stage_override = temperature.filter(|value| value.is_finite());
    }
}

/// Returns the number, or what is taken when it is none or too small to divide by.
fn least(value: f64, smallest: f64) -> f64 {
    value.max(smallest)
}

/// Returns a voltage that can be: neither negative nor not a number.
fn sane(voltage: f64) -> f64 {
    within(voltage, 0.0, MOST)
}
