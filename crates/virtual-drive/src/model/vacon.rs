//! Vacon 100 with built-in PROFINET.
//!
//! Source of the numbers and their meaning: `data/vacon/`, much of it recalled; of the words: OPTEA manual p. 103-123,
//! Vacon 100 PROFINET manual p. 25-32. Limits of the supervision are ours.

use profile::catalogue;
use profile::fault::Shape;
use profile::telegram::signal;

use super::condition::{Cause, Condition, Limit, When};
use super::live::{Live, Quantity, Sensor, Table};
use super::{
    Chosen, ControlTimeout, InverterRoles, Lost, Model, PanelRoles, PlateRoles, ProcessFacts, RampTo, Roles,
    SetUpRoles, Signals, TimeoutAction, Wire,
};
use crate::axis::{Induction, Motor, Plant};

/// The smallest Vacon 100 of 400 V with a motor of 1.1 kW and a small pump.
pub static VACON: Model = Model {
    catalogue: &catalogue::VACON,
    live: LIVE,
    roles: Roles {
        inverter: Some(&INVERTER),
        ..Roles::NONE
    },
    plant: PLANT,
    known: &profile::model::VACON,
    process: ProcessFacts {
        signals: Signals::Are(SIGNALS),
        setpoints: Chosen::Fixed(&DATA_IN),
        actuals: Chosen::Each(&DATA_OUT_SELECTION),
    },
    wire: Wire::PLAIN,
    conditions: CONDITIONS,
    fault_actions: &[],
    only_stopped: &[],
    connection_lost_fault: 53,
    connection_lost: Lost::After(&FIELDBUS_FAULT),
    fault_buffer: Shape::EIGHT_SINGLE,
    profile: 0x0329,
};

/// ID 733, from memory of the application manuals. That a drive without a reaction keeps its last control word is our
/// reading of "no action"; an alarm is the same with a warning.
const FIELDBUS_FAULT: ControlTimeout = ControlTimeout {
    time: 0,
    function: 733,
    actions: &[
        (0, TimeoutAction::GoesOn),
        (1, TimeoutAction::GoesOn),
        (2, TimeoutAction::Trips),
        (3, TimeoutAction::TripsCoasting),
    ],
    number: 53,
};

/// Process data in 1 to 8, and the selections of process data out 1 to 8.
const DATA_IN: [u16; 8] = [2004, 2005, 2006, 2007, 2008, 2009, 2010, 2011];
const DATA_OUT_SELECTION: [u16; 8] = [852, 853, 854, 855, 856, 857, 858, 859];

const PLANT: Plant = Plant {
    motor_inertia: 2.5e-3,
    load_inertia: 7.0e-3,
    motor: Motor::Induction(Induction {
        power: 1100.0,
        voltage: 400.0,
        frequency: 50.0,
        current: 2.6,
        speed: 1440.0,
        pole_pairs: 2,
        magnetising_current: 1.3,
        breakdown: 2.8,
    }),
    ..Plant::INDUCTION
};

/// Control word, reference, status word, actual speed (ID 2001, 2003, 2101, 2103), and the signals that a source names
/// beside them.
const SIGNALS: &[(u16, u16)] = &[
    (signal::STW1, 2001),
    (signal::ZSW1, 2101),
    (signal::NSOLL_A, 2003),
    (signal::NIST_A, 2103),
    (signal::vacon::DW_PDI6, 10_122),
    (signal::vacon::DW_PDI7, 10_122),
    (signal::vacon::DW_PDI8, 10_122),
];

const INVERTER: InverterRoles = InverterRoles {
    plate: PlateRoles {
        power: 116,
        voltage: 110,
        frequency: 111,
        current: 113,
        speed: 112,
        poles: 0,
        magnetising: 612,
    },
    ramps: [[103, 104], [502, 503]],
    ramp_to: RampTo::HighestReference,
    quick_stop: 0,
    jog_ramp: 0,
    jogs: [124, 124],
    jog: 124,
    reference: [101, 102],
    own_speed_of_range: true,
    reference_in_hertz: (0, 0),
    both_signs: (0, 0),
    presets: 0,
    correction: 0,
    speed_limits: [0, 102],
    frequency_limits: [0, 102],
    direction: 0,
    current_limit: 107,
    inverter_current: [0, 0],
    brake_current: 507,
    slip: [0, 0],
    flying_start: 505,
    thermal: (704, 1, 2),
    panel: PanelRoles {
        keys: [0; 3],
        not_by_bus: (172, 0),
    },
    set_ups: SetUpRoles {
        active: 0,
        edit: 0,
        by_bus: (0, &[]),
        own: [0, 0],
    },
    counters: None,
    watched: [[0, 0], [0, 0]],
};

const fn fault(number: u16, cause: Cause, limit: f64) -> Condition {
    Condition {
        number,
        warning: false,
        cause,
        limit: Limit::Fixed(limit),
        when: When::Always,
        delay: None,
    }
}

const fn present(number: u16, cause: Cause) -> Condition {
    Condition {
        limit: Limit::Present,
        ..fault(number, cause, 0.5)
    }
}

const CONDITIONS: &[Condition] = &[
    fault(2, Cause::BusHigh, 911.0),
    Condition {
        when: When::Enabled,
        ..fault(9, Cause::BusLow, 333.0)
    },
    Condition {
        warning: true,
        when: When::Enabled,
        ..present(10, Cause::MainsLost)
    },
    fault(14, Cause::PowerStage, 95.0),
    Condition {
        warning: true,
        ..fault(14, Cause::PowerStage, 90.0)
    },
    fault(16, Cause::MotorLoadTrip, 100.0),
    Condition {
        warning: true,
        ..fault(16, Cause::MotorLoad, 100.0)
    },
    fault(19, Cause::InverterLoad, 99.5),
    fault(66, Cause::MotorHot, 155.0),
    present(30, Cause::SafeTorqueOff),
];

const fn word(actual: bool, number: u8) -> Live {
    Live::Word { actual, number }
}

const LIVE: &[(u16, Live)] = &[
    (1, Live::Measured(Quantity::Frequency)),
    (2, Live::Measured(Quantity::Speed)),
    (3, Live::Measured(Quantity::Current)),
    (4, Live::Measured(Quantity::TorquePart)),
    (5, Live::Measured(Quantity::PowerPart)),
    (6, Live::Measured(Quantity::MotorVoltage)),
    (7, Live::Measured(Quantity::BusVoltage)),
    (8, Live::Measured(Quantity::Temperature(Sensor::PowerStage))),
    (9, Live::Measured(Quantity::MotorLoad)),
    (25, Live::Measured(Quantity::ReferenceFrequency)),
    (37, Live::Fault(0)),
    (43, Live::StatusWord),
    (45, Live::Measured(Quantity::Current)),
    (73, Live::Measured(Quantity::Power)),
    (864, Live::StatusWord),
    (865, Live::Measured(Quantity::SpeedOfRange)),
    (866, word(true, 0)),
    (867, word(true, 1)),
    (868, word(true, 2)),
    (869, word(true, 3)),
    (870, word(true, 4)),
    (871, word(true, 5)),
    (872, word(true, 6)),
    (873, word(true, 7)),
    (874, Live::ControlWord),
    (875, Live::SpeedReference),
    (876, word(false, 0)),
    (877, word(false, 1)),
    (878, word(false, 2)),
    (879, word(false, 3)),
    (880, word(false, 4)),
    (881, word(false, 5)),
    (882, word(false, 6)),
    (883, word(false, 7)),
    (915, Live::Array(Table::SetpointSignals)),
    (916, Live::Array(Table::ActualSignals)),
    (922, Live::Telegram),
    (923, Live::Array(Table::SignalParameters)),
    (930, Live::OperatingMode),
    (944, Live::FaultCounter),
    (947, Live::Array(Table::FaultNumbers)),
    (964, Live::Array(Table::Identification)),
    (965, Live::Profile),
    (975, Live::Array(Table::DriveObject)),
    (980, Live::Array(Table::Numbers(0))),
    (981, Live::Array(Table::Numbers(1))),
    (982, Live::Array(Table::Numbers(2))),
    (983, Live::Array(Table::Numbers(3))),
    (984, Live::Array(Table::Numbers(4))),
    (985, Live::Array(Table::Numbers(5))),
    (986, Live::Array(Table::Numbers(6))),
    (987, Live::Array(Table::Numbers(7))),
    (988, Live::Array(Table::Numbers(8))),
    (989, Live::Array(Table::Numbers(9))),
    (2001, Live::ControlWord),
    (2003, Live::SpeedReference),
    (2101, Live::StatusWord),
    (2103, Live::Measured(Quantity::SpeedOfRange)),
    (2104, word(true, 0)),
    (2105, word(true, 1)),
    (2106, word(true, 2)),
    (2107, word(true, 3)),
    (2108, word(true, 4)),
    (2109, word(true, 5)),
    (2110, word(true, 6)),
    (2111, word(true, 7)),
    (10_122, Live::Array(Table::WideWords)),
];
