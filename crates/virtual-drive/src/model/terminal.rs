//! Digital inputs: the parameters of one, and what its mode makes of it.

use profile::catalogue::{Catalogue, Part};

/// Numbers of the parameters of one digital input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terminal {
    /// What it does: a number of the table of functions.
    pub mode: u16,
    /// 1: low is active.
    pub inverted: u16,
    /// Argument of its function.
    pub argument: u16,
}

impl Terminal {
    /// The digital inputs of a model, from number 1 on.
    pub(super) const fn all<const N: usize>(tables: &Catalogue) -> [Self; N] {
        let modes: [u16; N] = tables.part_numbers(Part::InputMode);
        let inversions: [u16; N] = tables.part_numbers(Part::InputInverted);
        let arguments: [u16; N] = tables.part_numbers(Part::InputArgument);
        let mut terminals = [Self {
            mode: 0,
            inverted: 0,
            argument: 0,
        }; N];
        let mut place = 0;
        while place < N {
            terminals[place] = Self {
                mode: modes[place],
                inverted: inversions[place],
                argument: arguments[place],
            };
            place += 1;
        }
        terminals
    }
}

/// What a digital input does. Those at an edge do it when the input becomes active; a changed parameter is no edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputFunction {
    /// At an edge: clears the faults whose cause is gone.
    ClearFaults,
    /// At an edge: starts the motion task of the argument; while a chain of tasks waits for an event, it is that event.
    StartTask,
    /// At an edge: starts homing.
    Home,
    /// At an edge: stops all motion on the ramp.
    Stop,
    /// While active: stops the axis and then disables it.
    ControlledStop,
    /// While active: the cause of this fault.
    Fault(u16),
}
