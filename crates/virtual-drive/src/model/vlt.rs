//! Danfoss VLT AutomationDrive FC 302 with PROFINET option.
//!
//! Source of the numbers and their meaning: `data/vlt/`, much of it recalled; of the behaviour: FC 300 design guides
//! (MG33B), MCA 101 and MCA 120 manuals. The answer to a connect is that of a real drive
//! (captures of cisagov/icsnpp-profinet-io-cm). Where no source tells it, it is ours and says so.

use profile::catalogue;
use profile::fault::Shape;
use profile::telegram::signal;
use profinet::wire::ByteOrder;

use super::condition::{Cause, Condition, Limit, When};
use super::live::{Action, Live, Quantity, Sensor, Table};
use super::{
    Chosen, ControlTimeout, CounterRoles, InverterRoles, Lost, Model, PanelRoles, PlateRoles, ProcessFacts,
    RampTo, Roles, SetUpRoles, Signals, TimeoutAction, Wire,
};
use crate::axis::{Induction, Motor, Plant};

/// The FC 302 of 0.75 kW on 400 V with a small pump.
pub static VLT: Model = Model {
    catalogue: &catalogue::VLT,
    live: LIVE,
    roles: Roles {
        edit: Some(927),
        inverter: Some(&INVERTER),
        ..Roles::NONE
    },
    plant: PLANT,
    known: &profile::model::VLT,
    process: ProcessFacts {
        signals: Signals::Are(SIGNALS),
        setpoints: Chosen::Array(915),
        actuals: Chosen::Array(916),
    },
    wire: Wire {
        output_frame_ids: [0xC000, 0x8010],
        max_alarm_data: 1432,
        always_listed: &[1],
        ready_order: ByteOrder::Little,
        ready_arguments: 120,
    },
    conditions: CONDITIONS,
    fault_actions: &[],
    only_stopped: ONLY_STOPPED,
    connection_lost_fault: 34,
    connection_lost: Lost::After(&CONTROL_TIMEOUT),
    fault_buffer: Shape::EIGHT_BY_EIGHT,
    profile: 0x0329,
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

/// Motor, its control and its direction: from memory of the FC 301/302 Programming Guide. 8-10 is ours: the control word
/// that stands would mean something else at once.
const ONLY_STOPPED: &[u16] = &[
    101, 110, 120, 121, 122, 123, 124, 125, 130, 131, 133, 134, 135, 136, 139, 410, 810,
];

/// From memory of the FC 301/302 Programming Guide: delivered as "off", which keeps the last control word for ever.
const CONTROL_TIMEOUT: ControlTimeout = ControlTimeout {
    time: 803,
    function: 804,
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

/// Control word, reference, status word and main actual value (16-80, 16-82, 16-03, 16-05).
const SIGNALS: &[(u16, u16)] = &[
    (signal::STW1, 1680),
    (signal::ZSW1, 1603),
    (signal::NSOLL_A, 1682),
    (signal::NIST_A, 1605),
];

const INVERTER: InverterRoles = InverterRoles {
    plate: PlateRoles {
        power: 120,
        voltage: 122,
        frequency: 123,
        current: 124,
        speed: 125,
        poles: 139,
        magnetising: 0,
    },
    ramps: [[341, 342], [351, 352]],
    ramp_to: RampTo::Synchronous,
    quick_stop: 381,
    jog_ramp: 380,
    jogs: [890, 891],
    jog: 319,
    reference: [302, 303],
    own_speed_of_range: false,
    reference_in_hertz: (301, 3),
    both_signs: (300, 1),
    presets: 310,
    correction: 312,
    speed_limits: [411, 413],
    frequency_limits: [412, 414],
    direction: 410,
    current_limit: 418,
    inverter_current: [1636, 1637],
    brake_current: 201,
    slip: [162, 163],
    flying_start: 173,
    thermal: (190, 3, 4),
    panel: PanelRoles {
        keys: [40, 41, 42],
        not_by_bus: (801, 1),
    },
    set_ups: SetUpRoles {
        active: 10,
        edit: 11,
        // bus; bus or input
        by_bus: (855, &[1, 3]),
        own: [100, 499],
    },
    counters: Some(&COUNTERS),
    watched: [[450, 451], [452, 453]],
};

/// Source: FC 300 programming guide 15-0* and 15-2*, from memory.
const COUNTERS: CounterRoles = CounterRoles {
    hot: &[29],
    over_voltage: &[7],
    // digital input and output, warning word, alarm word, status word, control word, extended status word
    history: &[
        (1, 1660),
        (2, 1666),
        (3, 1692),
        (4, 1690),
        (5, 1603),
        (6, 1600),
        (7, 1694),
    ],
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

const LIVE: &[(u16, Live)] = &[
    (14, Live::EditedSetUps),
    (
        51,
        Live::Choose(&[
            (1, Action::CopySetUp(1)),
            (2, Action::CopySetUp(2)),
            (3, Action::CopySetUp(3)),
            (4, Action::CopySetUp(4)),
            (9, Action::CopySetUp(0)),
        ]),
    ),
    (900, Live::Signal(signal::NSOLL_A)),
    (907, Live::Measured(Quantity::SpeedPart)),
    (915, Live::Array(Table::SetpointWords)),
    (916, Live::Array(Table::ActualWords)),
    (922, Live::Telegram),
    (923, Live::Array(Table::SignalParameters)),
    (944, Live::FaultCounter),
    (945, Live::Array(Table::FaultNumbers)),
    (947, Live::Array(Table::FaultNumbers)),
    (952, Live::FaultSituations),
    (964, Live::Array(Table::Identification)),
    (965, Live::Profile),
    (967, Live::ControlWord),
    (968, Live::StatusWord),
    (971, Live::Choose(&[(1, Action::Save)])),
    (972, Live::Choose(&[(1, Action::Restart)])),
    (975, Live::Array(Table::DriveObject)),
    (980, Live::Array(Table::Numbers(0))),
    (981, Live::Array(Table::Numbers(1))),
    (982, Live::Array(Table::Numbers(2))),
    (983, Live::Array(Table::Numbers(3))),
    (990, Live::Array(Table::Changed(0))),
    (991, Live::Array(Table::Changed(1))),
    (992, Live::Array(Table::Changed(2))),
    (993, Live::Array(Table::Changed(3))),
    (1422, Live::Choose(&[(2, Action::Defaults)])),
    (1500, Live::Measured(Quantity::PowerTime)),
    (1501, Live::Measured(Quantity::RunningTime)),
    (1502, Live::Measured(Quantity::Energy)),
    (1503, Live::Measured(Quantity::PowerUps)),
    (1504, Live::Measured(Quantity::OverTemperatures)),
    (1505, Live::Measured(Quantity::OverVoltages)),
    (1506, Live::Choose(&[(1, Action::ResetEnergy)])),
    (1507, Live::Choose(&[(1, Action::ResetRunningTime)])),
    (1520, Live::Array(Table::HistoryEvents)),
    (1521, Live::Array(Table::HistoryValues)),
    (1522, Live::Array(Table::HistoryTimes)),
    (1530, Live::Array(Table::LogCodes)),
    (1532, Live::Array(Table::LogTimes)),
    (1592, Live::Array(Table::Numbers(0))),
    (1593, Live::Array(Table::Changed(0))),
    (1600, Live::ControlWord),
    (1601, Live::Measured(Quantity::Reference)),
    (1602, Live::Measured(Quantity::ReferencePart)),
    (1603, Live::StatusWord),
    (1605, Live::Measured(Quantity::SpeedPart)),
    (1610, Live::Measured(Quantity::Power)),
    (1611, Live::Measured(Quantity::Horsepower)),
    (1612, Live::Measured(Quantity::MotorVoltage)),
    (1613, Live::Measured(Quantity::Frequency)),
    (1614, Live::Measured(Quantity::Current)),
    (1615, Live::Measured(Quantity::FrequencyPart)),
    (1616, Live::Measured(Quantity::Torque)),
    (1617, Live::Measured(Quantity::Speed)),
    (1618, Live::Measured(Quantity::MotorLoad)),
    (1619, Live::Measured(Quantity::Temperature(Sensor::Motor))),
    (1622, Live::Measured(Quantity::TorquePart)),
    (1630, Live::Measured(Quantity::BusVoltage)),
    (1632, Live::Measured(Quantity::BrakePower)),
    (1633, Live::Measured(Quantity::BrakePower)),
    (1634, Live::Measured(Quantity::Temperature(Sensor::PowerStage))),
    (1635, Live::Measured(Quantity::InverterLoad)),
    (1639, Live::Measured(Quantity::Temperature(Sensor::Control))),
    (1650, Live::Measured(Quantity::ReferencePart)),
    (1680, Live::ControlWord),
    (1682, Live::Signal(signal::NSOLL_A)),
    (1684, Live::StatusWord),
    (1690, Live::AlarmWord(0)),
    (1691, Live::AlarmWord(32)),
    (1692, Live::WarningWord(0)),
    (1693, Live::WarningWord(32)),
    (1694, Live::ExtendedStatus),
];
