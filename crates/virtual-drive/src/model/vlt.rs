//! Danfoss VLT AutomationDrive FC 302 with PROFINET option.
//!
//! Source of the numbers and their meaning: `data/vlt/`, much of it recalled; of the behaviour: FC 300 design guides
//! (MG33B), MCA 101 and MCA 120 manuals. The answer to a connect is that of a real drive
//! (captures of cisagov/icsnpp-profinet-io-cm). Facts without a source are ours and marked so.

use std::sync::OnceLock;

use profile::catalogue::{self, Part, PartNumbers};
use profile::fault::Shape;
use profinet::wire::ByteOrder;

use super::condition::{Cause, Condition, Limit, When};
use super::{
    Chosen, ControlTimeout, Converter, Lost, Model, ProcessFacts, RampTo, Signals, TimeoutAction, Wire,
};
use crate::axis::{Induction, Motor, Plant};

/// The FC 302 of 0.75 kW on 400 V with a small pump.
pub static VLT: Model = Model {
    catalogue: &catalogue::VLT,
    numbers: PartNumbers::of(&catalogue::VLT),
    terminals: &[],
    input_functions: &[],
    // counted faults: FC 300 programming guide 15-0*, from memory
    converter: Some(Converter {
        ramp_to: RampTo::Synchronous,
        own_in_set_up: [100, 499],
        hot: &[29],
        over_voltage: &[7],
    }),
    plant: PLANT,
    known: &profile::model::VLT,
    process: ProcessFacts {
        signals: Signals::Parts,
        setpoints: Chosen::Array(Part::ChosenSetpoints),
        actuals: Chosen::Array(Part::ChosenActuals),
    },
    wire: Wire {
        output_frame_ids: [0xC000, 0x8010],
        max_alarm_data: 1432,
        always_listed: &[1],
        ready_order: ByteOrder::Little,
        ready_arguments: 120,
    },
    conditions: CONDITIONS,
    connection_lost_fault: 34,
    connection_lost: Lost::After(&CONTROL_TIMEOUT),
    fault_buffer: Shape::EIGHT_BY_EIGHT,
    profile: 0x0329,
    derived: OnceLock::new(),
};

const PLANT: Plant = Plant {
    motor_inertia: 1.7e-3,
    load_inertia: 5.0e-3,
    motor: Motor::Induction(Induction {
        power: 750.0,
        voltage: 400.0,
        frequency: 50.0,
        current: 1.9,
        speed: 1420.0,
        pole_pairs: 2,
        magnetising_current: 0.95,
        breakdown: 2.8,
    }),
    ..Plant::INDUCTION
};

/// From memory of the FC 301/302 Programming Guide: delivered as "off", which keeps the last control word for ever.
const CONTROL_TIMEOUT: ControlTimeout = ControlTimeout {
    actions: &[
        (0, TimeoutAction::GoesOn),
        (1, TimeoutAction::Freezes),
        (2, TimeoutAction::Stops),
        (3, TimeoutAction::Jogs),
        (4, TimeoutAction::RunsAtMaximum),
        (5, TimeoutAction::Trips),
    ],
    number: 17,
};

/// A fault with the plain meaning of its row.
const fn alarm(number: u16, cause: Cause, limit: f64) -> Condition {
    Condition {
        number,
        warning: false,
        cause,
        limit: Limit::Fixed(limit),
        when: When::Always,
        delay: None,
    }
}

const fn warning(number: u16, cause: Cause, limit: f64) -> Condition {
    Condition {
        warning: true,
        ..alarm(number, cause, limit)
    }
}

/// A drive without mains shows it only while it should run; below the trip level it trips then.
const fn while_running(condition: Condition) -> Condition {
    Condition {
        when: When::Enabled,
        ..condition
    }
}

/// Voltages of the 380 to 500 V range: FC 300 design guide, from memory. Temperatures and loads are ours.
const CONDITIONS: &[Condition] = &[
    alarm(7, Cause::BusHigh, 855.0),
    warning(5, Cause::BusHigh, 810.0),
    while_running(alarm(8, Cause::BusLow, 373.0)),
    while_running(warning(6, Cause::BusLow, 410.0)),
    while_running(Condition {
        limit: Limit::Present,
        ..warning(4, Cause::MainsLost, 0.5)
    }),
    alarm(9, Cause::InverterLoad, 99.5),
    warning(9, Cause::InverterLoad, 90.0),
    alarm(10, Cause::MotorLoadTrip, 100.0),
    warning(10, Cause::MotorLoad, 100.0),
    alarm(11, Cause::MotorHot, 155.0),
    Condition {
        limit: Limit::Present,
        ..warning(59, Cause::CurrentLimit, 0.5)
    },
    alarm(29, Cause::PowerStage, 95.0),
    Condition {
        limit: Limit::Present,
        ..alarm(68, Cause::SafeTorqueOff, 0.5)
    },
];
