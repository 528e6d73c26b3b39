//! What differs in the process data, and on PROFINET around them.

use profile::catalogue::Part;
use profinet::wire::ByteOrder;

/// What the process data of a model are.
#[derive(Debug, Clone, Copy)]
pub struct ProcessFacts {
    /// Which parameters the signals are.
    pub signals: Signals,
    /// The parameters that the words behind control word and setpoint set, in telegrams of the vendor.
    pub setpoints: Chosen,
    /// The parameters that the words behind status word and actual value carry, in telegrams of the vendor.
    pub actuals: Chosen,
}

/// Which parameters the signals are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signals {
    /// The parameter of a signal has its number (AKD).
    Numbers,
    /// The parameters with the parts of control word, status word, setpoint, actual speed and process data; other signals
    /// are none.
    Parts,
}

/// How the free words of a telegram are filled. A parameter of four octets takes two words with the same number in both.
#[derive(Debug, Clone, Copy)]
pub enum Chosen {
    /// There are none.
    Nothing,
    /// An element of the array with this part for each word, counted from the control or status word.
    Array(Part),
    /// One parameter for each free word holds the number.
    Each(&'static [u16]),
    /// These parameters, one for each free word.
    Fixed(&'static [u16]),
}

/// When a lost controller is a fault; else it is a warning of that number.
#[derive(Debug, Clone, Copy)]
pub enum Lost {
    /// Always.
    Always,
    /// Never at once: the last control word holds until its time is over.
    After(&'static ControlTimeout),
}

/// Supervision of the control word by parameters: after the time of [`Part::LossTime`], at once where the model has no such
/// parameter (VLT 8-03 and 8-04, Vacon ID 733).
#[derive(Debug, Clone, Copy)]
pub struct ControlTimeout {
    /// Values of [`Part::LostController`]; one that is not here leaves the drive as it is.
    pub actions: &'static [(i64, TimeoutAction)],
    /// Number of the warning while it does that, and of the fault of [`TimeoutAction::Trips`] and [`TimeoutAction::TripsCoasting`].
    pub number: u16,
}

/// What a drive does whose control word is out of date.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeoutAction {
    /// It goes on with the last one, without a warning.
    GoesOn,
    /// It keeps the speed that it has.
    Freezes,
    /// It ramps down and stays in its state until there is OFF and ON again.
    Stops,
    /// It turns at the speed of jogging.
    Jogs,
    /// It turns at its highest speed.
    RunsAtMaximum,
    /// It has a fault.
    Trips,
    /// It has a fault and switches its power stage off at once.
    TripsCoasting,
}

/// What is particular about a drive on PROFINET.
#[derive(Debug, Clone, Copy)]
pub struct Wire {
    /// FrameID of the outputs where the controller leaves the choice: class 1 and class 2.
    pub output_frame_ids: [u16; 2],
    /// Longest alarm it takes, octets.
    pub max_alarm_data: u16,
    /// Slots whose modules the ModuleDiffBlock names even when nothing differs.
    pub always_listed: &'static [u16],
    /// Byte order of its ApplicationReady call: of the RPC header and of the NDR lengths.
    pub ready_order: ByteOrder,
    /// ArgsMaximum of its ApplicationReady call, octets.
    pub ready_arguments: u32,
}

impl Wire {
    /// Nothing is.
    pub const PLAIN: Self = Self {
        output_frame_ids: [0xC000, 0x8000],
        max_alarm_data: 200,
        always_listed: &[],
        ready_order: ByteOrder::Big,
        ready_arguments: 1024,
    };
}
