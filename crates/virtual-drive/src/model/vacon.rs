//! Vacon 100 with built-in PROFINET.
//!
//! Source of the numbers and their meaning: `data/vacon/`, much of it recalled; of the words: OPTEA manual p. 103-123,
//! Vacon 100 PROFINET manual p. 25-32. Limits of the supervision are ours.

use std::sync::OnceLock;

use profile::catalogue::{self, Part, PartNumbers};
use profile::fault::Shape;

use super::condition::{Cause, Condition, Limit, When};
use super::{
    Chosen, ControlTimeout, Converter, Lost, Model, ProcessFacts, RampTo, Signals, TimeoutAction, Wire,
};
use crate::axis::{Induction, Motor, Plant};

/// The smallest Vacon 100 of 400 V with a motor of 1.1 kW and a small pump.
pub static VACON: Model = Model {
    catalogue: &catalogue::VACON,
    numbers: PartNumbers::of(&catalogue::VACON),
    terminals: &[],
    input_functions: &[],
    converter: Some(Converter {
        ramp_to: RampTo::HighestReference,
        own_in_set_up: [0, 0],
        hot: &[],
        over_voltage: &[],
    }),
    plant: PLANT,
    known: &profile::model::VACON,
    process: ProcessFacts {
        signals: Signals::Parts,
        setpoints: Chosen::Fixed(&DATA_IN),
        actuals: Chosen::Each(&DATA_OUT_SELECTION),
    },
    wire: Wire::PLAIN,
    conditions: CONDITIONS,
    connection_lost_fault: 53,
    connection_lost: Lost::After(&FIELDBUS_FAULT),
    fault_buffer: Shape::EIGHT_SINGLE,
    profile: 0x0329,
    derived: OnceLock::new(),
};

/// ID 733, from memory of the application manuals. That a drive without a reaction keeps its last control word is our
/// reading of "no action"; an alarm is the same with a warning.
const FIELDBUS_FAULT: ControlTimeout = ControlTimeout {
    actions: &[
        (0, TimeoutAction::GoesOn),
        (1, TimeoutAction::GoesOn),
        (2, TimeoutAction::Trips),
        (3, TimeoutAction::TripsCoasting),
    ],
    number: 53,
};

static DATA_IN: [u16; 8] = catalogue::VACON.part_numbers(Part::ProcessDataIn);
static DATA_OUT_SELECTION: [u16; 8] = catalogue::VACON.part_numbers(Part::ProcessDataOutChoice);

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
