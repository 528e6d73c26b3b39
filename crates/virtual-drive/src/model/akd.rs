//! Kollmorgen AKD with PROFINET, firmware 1.17.
//!
//! Source of the numbers: AKD PROFINET manual ed. M chapters 5 and 6; of the meanings `data/akd/`.

use profile::catalogue;
use profile::fault::Shape;

use super::akd_conditions::{ACTIONS, CONDITIONS};
use super::live::{Action, Bit, Live, Place, Quantity, Sensor, Table};
use super::{
    Chosen, HomeRoles, InputFunction, Lost, Model, PositionRoles, ProcessFacts, Roles, Signals, TaskRoles,
    Terminal, UnitRoles, Wire,
};
use crate::axis::Plant;

/// The AKD of 3 A with a small servo motor.
pub static AKD: Model = Model {
    catalogue: &catalogue::AKD,
    live: LIVE,
    roles: ROLES,
    plant: Plant::SERVO,
    known: &profile::model::AKD,
    process: ProcessFacts {
        signals: Signals::Numbers,
        setpoints: Chosen::Nothing,
        actuals: Chosen::Nothing,
    },
    wire: Wire::PLAIN,
    conditions: CONDITIONS,
    fault_actions: ACTIONS,
    only_stopped: &[],
    connection_lost_fault: 702,
    connection_lost: Lost::Always,
    fault_buffer: Shape::EIGHT_BY_EIGHT,
    profile: 0x0329,
};

const ROLES: Roles = Roles {
    acceleration: Some(2108), // DRV.ACC
    deceleration: Some(2115), // DRV.DEC
    quick_stop: Some(2053),   // CS.DEC
    standstill: None,         // CS.VTHRESH_32 is 120 rpm as delivered, too much for the profile's standstill
    jog_speed: [Some(1004), Some(1005)],
    jog_ramp: [Some(1006), Some(1007)],
    peak_current: Some(2132),                     // DRV.IPEAK
    current_limit: [Some(2231), Some(2230)],      // IL.LIMITP, IL.LIMITN
    speed_limit: [Some(2439), Some(2438)],        // VL.LIMITP_32, VL.LIMITN_32
    gain: Some(2436),                             // VL.KP
    integral: Some(2434),                         // VL.KI
    position_gain: Some(2302),                    // PL.KP
    speed_forward: Some(2437),                    // VL.KVFF
    continuous_current: [Some(2131), Some(2244)], // DRV.ICONT, MOTOR.ICONT
    motor_peak_current: Some(2247),               // MOTOR.IPEAK
    motor_peak_time: Some(2232),                  // IL.MFOLDD
    velocity_scaling: Some(3064),                 // PN.VELSCALING
    acceleration_scaling: Some(3065),             // PN.ACCSCALING
    position_scaling: Some(3014),                 // PN.POSSCALE
    singleturn_bits: Some(1002),
    mode: Some(2135),                // DRV.OPMODE
    command_source: Some(2113),      // DRV.CMDSOURCE
    service_speed: Some(2426),       // VL.CMDU_32
    service_current: Some(2215),     // IL.CMDU
    disable_mode: Some(2119),        // DRV.DISMODE
    bus_options: Some(2158),         // FBUS.PARAM02
    address_mode: Some(2606),        // IP.MODE
    brake: [Some(2241), Some(2242)], // MOTOR.BRAKE, MOTOR.BRAKERLS
    edit: None,
    positioning: POSITIONING,
    terminals: &[
        din(2060),
        din(2065),
        din(2070),
        din(2075),
        din(2080),
        din(2085),
        din(2090),
    ],
    input_functions: INPUT_FUNCTIONS,
    inverter: None,
};

/// DINx.INV, DINx.MODE and DINx.PARAM from the first of them on.
const fn din(first: u16) -> Terminal {
    Terminal {
        inverted: first,
        mode: first + 1,
        argument: first + 2,
    }
}

/// DINx.MODE, as far as a source tells what it does. That mode 2 is the event of a chain (MT.CNTL bits 5 to 9) is ours.
/// Source: AKD Parameter Guide 12/2009.
const INPUT_FUNCTIONS: &[(i64, InputFunction)] = &[
    (1, InputFunction::ClearFaults),
    (2, InputFunction::StartTask),
    (5, InputFunction::Home),
    (10, InputFunction::Fault(245)),
    (13, InputFunction::ControlledStop),
    (15, InputFunction::Stop),
];

const POSITIONING: PositionRoles = PositionRoles {
    task: TaskRoles {
        number: 2274,       // MT.NUM
        position: 2275,     // MT.P
        speed: 2283,        // MT.V_32
        acceleration: 2263, // MT.ACC
        deceleration: 2268, // MT.DEC
        control: 2266,      // MT.CNTL
        next: 2273,         // MT.MTNEXT
        dwell: 2278,        // MT.TNEXT
        profile: 2279,      // MT.TNUM
    },
    home: HomeRoles {
        mode: 2203,          // HOME.MODE
        speed: 2210,         // HOME.V_32
        ramps: [2192, 2195], // HOME.ACC, HOME.DEC
        direction: 2197,     // HOME.DIR
        feedrate: 2200,      // HOME.FEEDRATE
        current: 2201,       // HOME.IPEAK
        position: 2205,      // HOME.P
        distance: 2198,      // HOME.DIST
        stop_error: 2207,    // HOME.PERRTHRESH
        farthest: 2831,      // HOME.MAXDIST
        automatic: 2194,     // HOME.AUTOMOVE
    },
    unit: UnitRoles {
        motor: 2260,          // MOTOR.TYPE
        unit: [2393, 2391],   // UNIT.PROTARY, UNIT.PLINEAR
        custom: [2390, 2392], // UNIT.PIN, UNIT.POUT
        pitch: 2251,          // MOTOR.PITCH
    },
    modulo_range: [2303, 2305], // PL.MODP1, PL.MODP2
    modulo: 2308,               // PL.MODPEN
    modulo_direction: 2307,     // PL.MODPDIR
    limits_enabled: 2382,       // SWLS.EN
    limits: [2383, 2385],       // SWLS.LIMIT0, SWLS.LIMIT1
    target_window: 2280,        // MT.TPOSWND
    speed_window: 2282,         // MT.TVELWND_32
    error_window: 2292,         // PL.ERRWTHRESH
};

/// DRIVE_INPUTS (manual 5.8.1): SWLS.STATE, HWLS.NEGSTATE, HWLS.POSSTATE, DRV.DISSOURCES, STO.STATE.
const DRIVE_INPUTS: &[Bit] = &[
    input(0, 2387, 0),
    input(1, 2387, 1),
    input(2, 2211, 0),
    input(3, 2212, 0),
    input(4, 2120, 2),
    input(5, 2120, 5),
    input(6, 2381, 0),
];

const fn input(bit: u8, pnu: u16, of: u8) -> Bit {
    Bit { bit, pnu, of }
}

const LIVE: &[(u16, Live)] = &[
    (1, Live::ControlWord),
    (2, Live::StatusWord),
    (5, Live::Setpoint),
    (6, Live::Measured(Quantity::Speed)),
    (28, Live::Place(Place::Singleturn)),
    (32, Live::Setpoint),
    (33, Live::RunningTask),
    (34, Live::Setpoint),
    (35, Live::Setpoint),
    (36, Live::Setpoint),
    (37, Live::Setpoint),
    (38, Live::Setpoint),
    (52, Live::Measured(Quantity::Current)),
    (100, Live::Through(2198)),
    (101, Live::Setpoint),
    (102, Live::Setpoint),
    (103, Live::Through(2203)),
    (104, Live::Place(Place::FollowingSingleturn)),
    (105, Live::MotionStatus),
    (106, Live::Bits(DRIVE_INPUTS)),
    (108, Live::Through(2108)),
    (109, Live::Through(2115)),
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
    (1001, Live::Same(2203)),
    (1008, Live::Same(3065)),
    (1009, Live::Same(3064)),
    (2023, Live::Absent), // BODE.MODE
    (2028, Live::Absent), // CAP0.EN
    (2041, Live::Absent), // CAP1.EN
    (2058, Live::Rotary),
    (2064, Live::Input { number: 1 }),
    (2069, Live::Input { number: 2 }),
    (2074, Live::Input { number: 3 }),
    (2079, Live::Input { number: 4 }),
    (2084, Live::Input { number: 5 }),
    (2089, Live::Input { number: 6 }),
    (2094, Live::Input { number: 7 }),
    (2110, Live::Active),
    (2111, Live::Do(Action::ClearFaults)),
    (2112, Live::Do(Action::ClearFaults)),
    (2118, Live::Do(Action::Disable)),
    (2120, Live::DisableSources),
    (2127, Live::Do(Action::Enable)),
    (2134, Live::MotionStatus),
    (2135, Live::Mode),
    (2136, Live::Do(Action::Defaults)),
    (2137, Live::Do(Action::Stop)),
    (2139, Live::Absent), // DRV.ZERO
    (2144, Live::Place(Place::Angle)),
    (2149, Live::Absent), // FB1.PFIND
    (2157, Live::Telegram),
    (2204, Live::Do(Action::Home)),
    (2209, Live::Do(Action::SetHome)),
    (2211, Live::LimitSwitch { positive: false }),
    (2212, Live::LimitSwitch { positive: true }),
    (2214, Live::Measured(Quantity::CurrentCommand)),
    (2216, Live::Measured(Quantity::Current)),
    (2218, Live::Same(2219)),
    (2222, Live::Measured(Quantity::Foldback)),
    (2235, Live::Measured(Quantity::MotorFoldback)),
    (2257, Live::Measured(Quantity::MotorSensor)),
    (2265, Live::ClearTask),
    (2267, Live::Do(Action::ContinueTask)),
    (2271, Live::Do(Action::LoadTask)),
    (2272, Live::StartTask),
    (2277, Live::Do(Action::SetTask)),
    (2284, Live::Measured(Quantity::TaskSpeed)),
    (2285, Live::Place(Place::Command)),
    (2287, Live::Place(Place::Following)),
    (2294, Live::Place(Place::Actual)),
    (2327, Live::Absent),              // PLS.RESET
    (2358, Live::Do(Action::Nothing)), // REC.OFF: no recording runs
    (2367, Live::Measured(Quantity::RegenPower)),
    (2381, Live::TorqueAllowed),
    (2387, Live::SoftwareLimits),
    (2403, Live::Measured(Quantity::BusVoltage)),
    (2425, Live::Measured(Quantity::SpeedCommand)),
    (2427, Live::Measured(Quantity::SpeedError)),
    (2428, Live::Measured(Quantity::Speed)),
    (2429, Live::Measured(Quantity::SpeedFiltered)),
    (2441, Live::Measured(Quantity::Speed)),
    (2469, Live::Do(Action::Save)),
    (2477, Live::Fault(0)),
    (2478, Live::Fault(1)),
    (2479, Live::Fault(2)),
    (2480, Live::Fault(3)),
    (2481, Live::Fault(4)),
    (2482, Live::Fault(5)),
    (2483, Live::Fault(6)),
    (2484, Live::Fault(7)),
    (2485, Live::Fault(8)),
    (2486, Live::Fault(9)),
    (2784, Live::Do(Action::Blink)),
    (2785, Live::Do(Action::Nothing)), // DRV.CLRCRASHDUMP: there is none
    (2788, Live::Do(Action::Load)),
    (2791, Live::Warning(0)),
    (2792, Live::Warning(1)),
    (2793, Live::Warning(2)),
    (2805, Live::Place(Place::Feedback)),
    (2833, Live::Measured(Quantity::DriveFoldback)),
    (2836, Live::Do(Action::ApplyAddress)), // IP.RESET
    (2845, Live::Measured(Quantity::Speed)),
    (2847, Live::Do(Action::Nothing)), // WS.DISARM: nothing is armed
    (2874, Live::Measured(Quantity::Temperature(Sensor::Control))),
    (2875, Live::Measured(Quantity::Temperature(Sensor::PowerStage))),
    (2876, Live::Measured(Quantity::Temperature(Sensor::PowerStage))),
    (2877, Live::Measured(Quantity::Temperature(Sensor::PowerStage))),
    (2900, Live::Measured(Quantity::Temperature(Sensor::Motor))),
    (2914, Live::Absent),              // CMP0.ARM
    (2915, Live::Absent),              // CMP1.ARM
    (3013, Live::Do(Action::Restart)), // DRV.REBOOT
    (3022, Live::Watchdog),
];

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::Access;
    use profile::telegram::{Direction, Signal};

    fn is_setpoint(number: u16) -> bool {
        let signal = Signal::find(number, AKD.catalogue.device.vendor_id);
        signal.is_some_and(|signal| signal.direction == Direction::Setpoint)
    }

    #[test]
    fn every_setpoint_signal_that_can_be_written_is_one_in_the_drive() {
        for parameter in AKD.catalogue.parameters {
            if is_setpoint(parameter.pnu) && parameter.access == Access::ReadWrite {
                let live = LIVE
                    .iter()
                    .find(|(pnu, _)| *pnu == parameter.pnu)
                    .map(|(_, live)| live);
                assert!(
                    matches!(live, Some(Live::Setpoint | Live::Through(_))),
                    "{parameter:?}"
                );
            }
        }
    }

    #[test]
    fn the_tables_name_parameters_of_the_catalogue() {
        assert!(LIVE.windows(2).all(|pair| pair[0].0 < pair[1].0));
        for (pnu, live) in LIVE {
            let parameter = AKD.catalogue.by_pnu(*pnu).unwrap();
            let writable = parameter.access == Access::ReadWrite;
            match live {
                Live::Measured(_) | Live::Fault(_) | Live::Active | Live::FaultCounter => {
                    assert!(!writable, "{parameter:?}");
                }
                Live::Do(_) => assert_eq!(parameter.access, Access::WriteOnly, "{parameter:?}"),
                Live::Same(other) => assert!(AKD.catalogue.by_pnu(*other).is_some()),
                Live::Setpoint => assert!(writable && is_setpoint(*pnu), "{parameter:?}"),
                Live::Through(other) => {
                    let other = AKD.catalogue.by_pnu(*other).unwrap();
                    assert!(
                        is_setpoint(*pnu) && other.access == Access::ReadWrite,
                        "{parameter:?}"
                    );
                }
                Live::Bits(bits) => {
                    assert!(bits.iter().all(|bit| AKD.catalogue.by_pnu(bit.pnu).is_some()));
                }
                Live::Array(_) => assert!(parameter.is_array(), "{parameter:?}"),
                _ => {}
            }
        }
        for parameter in AKD
            .catalogue
            .parameters
            .iter()
            .filter(|parameter| parameter.is_array())
        {
            assert!(LIVE.iter().any(|(pnu, _)| *pnu == parameter.pnu), "{parameter:?}");
        }
    }

    #[test]
    fn every_digital_input_has_its_own_parameters_and_functions_of_the_table() {
        let name = |pnu: u16| AKD.catalogue.by_pnu(pnu).unwrap().name;
        for (number, terminal) in (1_u8..).zip(ROLES.terminals) {
            assert_eq!(name(terminal.mode), format!("DIN{number}.MODE"));
            assert_eq!(name(terminal.inverted), format!("DIN{number}.INV"));
            assert_eq!(name(terminal.argument), format!("DIN{number}.PARAM"));
            let state = LIVE.iter().find(|(_, live)| *live == Live::Input { number });
            assert_eq!(name(state.unwrap().0), format!("DIN{number}.STATE"));
            for (mode, function) in ROLES.input_functions {
                assert!(
                    AKD.catalogue
                        .by_pnu(terminal.mode)
                        .unwrap()
                        .choice(*mode)
                        .is_some()
                );
                if let InputFunction::Fault(fault) = function {
                    assert!(AKD.catalogue.fault(*fault, false).is_some());
                }
            }
        }
        assert_eq!(ROLES.terminals.len(), 7);
    }

    #[test]
    fn motor_and_load_agree_with_the_values_shown() {
        let value = |name: &str| AKD.catalogue.by_name(name).unwrap().default.unwrap();
        assert_eq!(AKD.plant.motor_inertia, value("MOTOR.INERTIA") * 1e-4);
        assert_eq!(AKD.plant.torque_constant, value("MOTOR.KT"));
    }
}
