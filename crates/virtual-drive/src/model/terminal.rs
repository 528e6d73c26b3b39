//! Digital inputs: the parameters of one, and what its mode makes of it.

/// Numbers of the parameters of one digital input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terminal {
    /// What it does: a number of the table of functions.
    pub mode: u16,
    /// 1: low is active.
    pub inverted: u16,
    /// What its function needs to know.
    pub argument: u16,
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
