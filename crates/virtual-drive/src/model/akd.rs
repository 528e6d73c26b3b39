//! Kollmorgen AKD with PROFINET, firmware 1.17.
//!
//! Source of the numbers: AKD PROFINET manual ed. M chapters 5 and 6; of the meanings `data/akd/`.

use std::sync::OnceLock;

use profile::catalogue::{self, PartNumbers};
use profile::fault::Shape;

use super::akd_conditions::CONDITIONS;
use super::{Chosen, InputFunction, Lost, Model, ProcessFacts, Signals, Terminal, Wire};
use crate::axis::Plant;

/// The AKD of 3 A with a small servo motor.
pub static AKD: Model = Model {
    catalogue: &catalogue::AKD,
    numbers: PartNumbers::of(&catalogue::AKD),
    terminals: &TERMINALS,
    input_functions: INPUT_FUNCTIONS,
    converter: None,
    plant: Plant::SERVO,
    known: &profile::model::AKD,
    process: ProcessFacts {
        signals: Signals::Numbers,
        setpoints: Chosen::Nothing,
        actuals: Chosen::Nothing,
    },
    wire: Wire::PLAIN,
    conditions: CONDITIONS,
    connection_lost_fault: 702,
    connection_lost: Lost::Always,
    fault_buffer: Shape::EIGHT_BY_EIGHT,
    profile: 0x0329,
    derived: OnceLock::new(),
};

static TERMINALS: [Terminal; 7] = Terminal::all(&catalogue::AKD);

/// DINx.MODE, as far as a source describes it. That mode 2 is the event of a chain (MT.CNTL bits 5 to 9) is ours.
/// Source: AKD Parameter Guide 12/2009.
const INPUT_FUNCTIONS: &[(i64, InputFunction)] = &[
    (1, InputFunction::ClearFaults),
    (2, InputFunction::StartTask),
    (5, InputFunction::Home),
    (10, InputFunction::Fault(245)),
    (13, InputFunction::ControlledStop),
    (15, InputFunction::Stop),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Live;
    use profile::catalogue::{Access, Part};
    use profile::telegram::{Direction, Signal};

    fn is_setpoint(number: u16) -> bool {
        let signal = Signal::find(number, AKD.catalogue.device.vendor_id);
        signal.is_some_and(|signal| signal.direction == Direction::Setpoint)
    }

    #[test]
    fn what_is_live_fits_its_parameter() {
        for (parameter, live) in AKD
            .catalogue
            .parameters
            .iter()
            .zip(AKD.live_by_position().iter().copied())
        {
            let writable = parameter.access == Access::ReadWrite;
            if is_setpoint(parameter.pnu) && writable {
                assert!(matches!(live, Live::Setpoint | Live::Through(_)), "{parameter:?}");
            }
            match live {
                Live::Measured(_) | Live::Fault(_) | Live::Active | Live::FaultCounter => {
                    assert!(!writable, "{parameter:?}");
                }
                Live::Do(_) => assert_eq!(parameter.access, Access::WriteOnly, "{parameter:?}"),
                Live::Through(other) => {
                    let other = AKD.catalogue.by_pnu(other).unwrap();
                    assert!(
                        is_setpoint(parameter.pnu) && other.access == Access::ReadWrite,
                        "{parameter:?}"
                    );
                }
                Live::Bits(bits) => assert!(bits.iter().all(|bit| AKD.number(bit.part).is_some())),
                Live::Array(_) => assert!(parameter.is_array(), "{parameter:?}"),
                _ => assert!(!parameter.is_array(), "{parameter:?}"),
            }
        }
    }

    #[test]
    fn every_digital_input_has_its_own_parameters_and_functions_of_the_table() {
        let name = |pnu: u16| AKD.catalogue.by_pnu(pnu).unwrap().name;
        let states: [u16; 7] = AKD.catalogue.part_numbers(Part::InputState);
        for ((number, terminal), state) in (1_u8..).zip(AKD.terminals).zip(states) {
            assert_eq!(name(terminal.mode), format!("DIN{number}.MODE"));
            assert_eq!(name(terminal.inverted), format!("DIN{number}.INV"));
            assert_eq!(name(terminal.argument), format!("DIN{number}.PARAM"));
            assert_eq!(name(state), format!("DIN{number}.STATE"));
            for (mode, function) in AKD.input_functions {
                let parameter = AKD.catalogue.by_pnu(terminal.mode).unwrap();
                assert!(parameter.choice(*mode).is_some());
                if let InputFunction::Fault(fault) = function {
                    assert!(AKD.catalogue.fault(*fault, false).is_some());
                }
            }
        }
    }

    #[test]
    fn motor_and_load_agree_with_the_values_shown() {
        let value = |name: &str| AKD.catalogue.by_name(name).unwrap().default.unwrap();
        assert_eq!(AKD.plant.motor_inertia, value("MOTOR.INERTIA") * 1e-4);
        assert_eq!(AKD.plant.torque_constant, value("MOTOR.KT"));
    }
}
