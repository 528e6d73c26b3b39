// Generated from data/akd/meanings.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::Meaning;

#[rustfmt::skip]
pub static AKTSATZ_BITS: &[Meaning] = &[
    Meaning { value: 15, text: "The MDI task runs" },
];

#[rustfmt::skip]
pub static AKTSATZ_CHOICE_0_14: &[Meaning] = &[
    Meaning { value: 0, text: "none of 1 to 128" },
];

#[rustfmt::skip]
pub static AOUT_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "User value" },
    Meaning { value: 1, text: "Actual velocity" },
    Meaning { value: 2, text: "Velocity error" },
    Meaning { value: 3, text: "Velocity command" },
    Meaning { value: 4, text: "Actual current" },
    Meaning { value: 5, text: "Current command" },
    Meaning { value: 6, text: "Actual position" },
    Meaning { value: 7, text: "Position error" },
    Meaning { value: 8, text: "Triangle test" },
    Meaning { value: 9, text: "Debug" },
];

#[rustfmt::skip]
pub static BODE_INJECTPOINT_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "None" },
    Meaning { value: 1, text: "Current" },
    Meaning { value: 2, text: "Velocity" },
];

#[rustfmt::skip]
pub static BODE_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Pseudo-random binary" },
    Meaning { value: 2, text: "Sine" },
    Meaning { value: 3, text: "Noise" },
    Meaning { value: 4, text: "Constant torque offset" },
];

#[rustfmt::skip]
pub static CAPX_EDGE_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "Rising" },
    Meaning { value: 2, text: "Falling" },
    Meaning { value: 3, text: "Both" },
];

#[rustfmt::skip]
pub static CAPX_EVENT_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "None" },
    Meaning { value: 1, text: "After edge" },
    Meaning { value: 2, text: "While high" },
    Meaning { value: 3, text: "While low" },
];

#[rustfmt::skip]
pub static CAPX_FILTER_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Fast" },
    Meaning { value: 2, text: "Slow" },
];

#[rustfmt::skip]
pub static CAPX_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Position" },
    Meaning { value: 1, text: "Drive time" },
    Meaning { value: 2, text: "Distributed-clock time" },
    Meaning { value: 3, text: "Primary encoder index" },
];

#[rustfmt::skip]
pub static CAPX_PREEDGE_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "Rising" },
    Meaning { value: 2, text: "Falling" },
    Meaning { value: 3, text: "Both" },
];

#[rustfmt::skip]
pub static CMPX_SOURCE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "FB1" },
    Meaning { value: 1, text: "FB2" },
    Meaning { value: 2, text: "FB3" },
    Meaning { value: 3, text: "PL.FB" },
];

#[rustfmt::skip]
pub static DINX_INV_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Active high" },
    Meaning { value: 1, text: "Active low" },
];

#[rustfmt::skip]
pub static DINX_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Fault reset" },
    Meaning { value: 2, text: "Start motion task of DINx.PARAM" },
    Meaning { value: 3, text: "Motion task select bit" },
    Meaning { value: 4, text: "Start the selected motion task" },
    Meaning { value: 5, text: "Start homing" },
    Meaning { value: 6, text: "Start jog, speed in DINx.PARAM" },
    Meaning { value: 7, text: "Switch operation mode, tens digit falling, units digit rising edge" },
    Meaning { value: 8, text: "Zero latch" },
    Meaning { value: 9, text: "Reserved in 2009" },
    Meaning { value: 10, text: "External fault (F245)" },
    Meaning { value: 11, text: "Home reference switch" },
    Meaning { value: 12, text: "Position latch" },
    Meaning { value: 13, text: "Emergency stop, ramp then disable" },
    Meaning { value: 14, text: "Reserved" },
    Meaning { value: 15, text: "Quick stop like DRV.STOP" },
    Meaning { value: 16, text: "Start electronic gearing" },
    Meaning { value: 17, text: "Gearing position shift, speed in DINx.PARAM" },
    Meaning { value: 18, text: "Positive limit switch" },
    Meaning { value: 19, text: "Negative limit switch" },
    Meaning { value: 20, text: "Brake release" },
    Meaning { value: 26, text: "Suspend motion" },
];

#[rustfmt::skip]
pub static DOUT_CTRL_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Firmware" },
    Meaning { value: 1, text: "Fieldbus" },
];

#[rustfmt::skip]
pub static DOUTX_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "User or fieldbus" },
    Meaning { value: 1, text: "Reserved" },
    Meaning { value: 2, text: "Software limit reached" },
    Meaning { value: 3, text: "Move complete" },
    Meaning { value: 4, text: "In position, window in DOUTx.PARAM" },
    Meaning { value: 5, text: "Position greater than DOUTx.PARAM" },
    Meaning { value: 6, text: "Position less than DOUTx.PARAM" },
    Meaning { value: 7, text: "Warning" },
    Meaning { value: 8, text: "Drive enabled" },
    Meaning { value: 9, text: "Reserved" },
    Meaning { value: 10, text: "Motor brake" },
    Meaning { value: 11, text: "Fault" },
    Meaning { value: 12, text: "Absolute speed greater than DOUTx.PARAM" },
    Meaning { value: 13, text: "Absolute speed less than DOUTx.PARAM" },
];

#[rustfmt::skip]
pub static DRIVE_INPUTS_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Negative software limit (SWLS.STATE bit 0)" },
    Meaning { value: 1, text: "Positive software limit (SWLS.STATE bit 1)" },
    Meaning { value: 2, text: "Negative limit switch (HWLS.NEGSTATE)" },
    Meaning { value: 3, text: "Positive limit switch (HWLS.POSSTATE)" },
    Meaning { value: 4, text: "Hardware disable (DRV.DISSOURCES bit 2)" },
    Meaning { value: 5, text: "Controlled stop input (DRV.DISSOURCES bit 5)" },
    Meaning { value: 6, text: "Torque allowed (STO.STATE)" },
];

#[rustfmt::skip]
pub static DRV_CMDSOURCE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Service channel (TCP/IP)" },
    Meaning { value: 1, text: "Fieldbus" },
    Meaning { value: 2, text: "Gearing" },
    Meaning { value: 3, text: "Analog" },
    Meaning { value: 4, text: "Digital" },
    Meaning { value: 5, text: "Bode plot in 2009; BASIC program in AKD BASIC code" },
];

#[rustfmt::skip]
pub static DRV_DISMODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "At once" },
    Meaning { value: 1, text: "Dynamic brake" },
    Meaning { value: 2, text: "Ramp then disable" },
    Meaning { value: 3, text: "Ramp then dynamic brake" },
];

#[rustfmt::skip]
pub static DRV_DISSOURCES_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Software disable" },
    Meaning { value: 1, text: "Fault present" },
    Meaning { value: 2, text: "Hardware disable" },
    Meaning { value: 3, text: "In-rush disable" },
    Meaning { value: 4, text: "Initialisation not finished" },
    Meaning { value: 5, text: "Controlled stop by a digital input" },
    Meaning { value: 6, text: "Fieldbus asks for disable (SynqNet, EtherNet/IP)" },
    Meaning { value: 7, text: "AKD-C asks for disable (AKD-N)" },
    Meaning { value: 8, text: "Pre-charge (AKD-C)" },
    Meaning { value: 9, text: "not known" },
    Meaning { value: 10, text: "AKD-C in download mode" },
];

#[rustfmt::skip]
pub static DRV_EMUEMODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Output with index per rev" },
    Meaning { value: 2, text: "Output with absolute index" },
    Meaning { value: 3, text: "A/B input" },
    Meaning { value: 4, text: "Step/direction input" },
    Meaning { value: 5, text: "Up/down input" },
];

#[rustfmt::skip]
pub static DRV_MOTIONSTAT_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Motion task active" },
    Meaning { value: 1, text: "Home position found, reference set" },
    Meaning { value: 2, text: "Homing routine finished (bits 1 and 2 together confirm homing)" },
    Meaning { value: 3, text: "Homing active" },
    Meaning { value: 4, text: "Homing error" },
    Meaning { value: 5, text: "Gearing slave synchronised" },
    Meaning { value: 6, text: "Electronic gearing active" },
    Meaning { value: 7, text: "Emergency stop in progress" },
    Meaning { value: 8, text: "Emergency stop error" },
    Meaning { value: 9, text: "Service motion active" },
    Meaning { value: 10, text: "Motion task could not be activated" },
    Meaning { value: 11, text: "Motion task target reached: trajectory done and inside MT.TPOSWND" },
    Meaning { value: 12, text: "Motion task target speed reached, see MT.TVELWND" },
    Meaning { value: 13, text: "Motion task exception (older firmware: Bode procedure active)" },
    Meaning { value: 14, text: "Target position of a motion task was crossed" },
    Meaning { value: 15, text: "Actual position inside the target window without waiting for the end of the trajectory" },
];

#[rustfmt::skip]
pub static DRV_OPMODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Torque (current)" },
    Meaning { value: 1, text: "Velocity" },
    Meaning { value: 2, text: "Position" },
];

#[rustfmt::skip]
pub static FAULTX_ACTION_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Fault" },
    Meaning { value: 1, text: "Ignored" },
    Meaning { value: 4, text: "Warning" },
];

#[rustfmt::skip]
pub static FB1_IDENTIFIED_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Unknown" },
    Meaning { value: 10, text: "Incremental" },
    Meaning { value: 20, text: "Sine encoder" },
    Meaning { value: 30, text: "EnDat 2.1" },
    Meaning { value: 31, text: "EnDat 2.2" },
    Meaning { value: 32, text: "BiSS" },
    Meaning { value: 33, text: "HIPERFACE" },
    Meaning { value: 40, text: "Resolver" },
    Meaning { value: 41, text: "SFD" },
];

#[rustfmt::skip]
pub static FBUS_PARAM02_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Fault 702 when the controller goes from RUN to STOP" },
];

#[rustfmt::skip]
pub static HOME_DIR_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Negative" },
    Meaning { value: 1, text: "Positive" },
];

#[rustfmt::skip]
pub static HOME_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Set the position where the axis stands" },
    Meaning { value: 1, text: "To a limit switch" },
    Meaning { value: 2, text: "To a limit switch, then zero angle" },
    Meaning { value: 3, text: "To a limit switch, then index" },
    Meaning { value: 4, text: "To the home switch" },
    Meaning { value: 5, text: "To the home switch, then zero angle" },
    Meaning { value: 6, text: "To the home switch, then index" },
    Meaning { value: 7, text: "To the zero angle of the feedback" },
    Meaning { value: 8, text: "To an end stop" },
    Meaning { value: 9, text: "To an end stop, then zero angle" },
    Meaning { value: 10, text: "To an end stop, then index" },
    Meaning { value: 11, text: "To the index without precondition" },
    Meaning { value: 12, text: "To the home switch with end stop detection" },
    Meaning { value: 13, text: "Absolute: use the feedback position" },
    Meaning { value: 14, text: "Added 05/2014; meaning not found for AKD (reserved on AKD2G)" },
    Meaning { value: 15, text: "Next zero of the feedback (as on AKD2G; added to AKD 05/2014)" },
];

#[rustfmt::skip]
pub static IP_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Rotary switches, or DHCP and AutoIP when they are 0" },
    Meaning { value: 1, text: "IP.ADDRESS, IP.SUBNET and IP.GATEWAY as stored; DCP overwrites them and sets this mode" },
    Meaning { value: 2, text: "DHCP and AutoIP" },
];

#[rustfmt::skip]
pub static MDI_MOD_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Absolute positioning, else relative" },
    Meaning { value: 1, text: "Reserved" },
    Meaning { value: 2, text: "Reserved" },
    Meaning { value: 3, text: "Reserved" },
    Meaning { value: 4, text: "Reserved" },
    Meaning { value: 5, text: "Reserved" },
    Meaning { value: 6, text: "Reserved" },
    Meaning { value: 7, text: "Reserved" },
    Meaning { value: 8, text: "Reserved" },
    Meaning { value: 9, text: "Reserved" },
    Meaning { value: 10, text: "Reserved" },
    Meaning { value: 11, text: "Reserved" },
    Meaning { value: 12, text: "Reserved" },
    Meaning { value: 13, text: "Reserved" },
    Meaning { value: 14, text: "Reserved" },
    Meaning { value: 15, text: "Reserved" },
];

#[rustfmt::skip]
pub static MOTOR_BRAKERLS_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Drive controls it" },
    Meaning { value: 1, text: "Released" },
];

#[rustfmt::skip]
pub static MOTOR_IDDATAVALID_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Error" },
    Meaning { value: 1, text: "Read" },
    Meaning { value: 2, text: "In process" },
    Meaning { value: 3, text: "Not started" },
    Meaning { value: 4, text: "Data not verified" },
];

#[rustfmt::skip]
pub static MOTOR_RTYPE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "PTC" },
    Meaning { value: 1, text: "NTC" },
];

#[rustfmt::skip]
pub static MOTOR_TYPE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Rotary" },
    Meaning { value: 1, text: "Linear" },
];

#[rustfmt::skip]
pub static MT_CNTL_BITS: &[Meaning] = &[
    Meaning { value: 4, text: "A following task is executed" },
    Meaning { value: 12, text: "Was the homing feedrate switch before firmware 01-11-02; deprecated" },
    Meaning { value: 13, text: "New tasks are refused while this one runs" },
    Meaning { value: 14, text: "The task may only start while another one runs" },
    Meaning { value: 15, text: "Reserved" },
    Meaning { value: 16, text: "Target speed from an external source such as an analog input" },
];

#[rustfmt::skip]
pub static MT_CNTL_CHOICE_0_3: &[Meaning] = &[
    Meaning { value: 0, text: "Absolute target MT.P" },
    Meaning { value: 1, text: "Relative to PL.CMD" },
    Meaning { value: 3, text: "Relative to the previous target" },
    Meaning { value: 5, text: "Relative to an external start position" },
    Meaning { value: 7, text: "Relative to PL.FB" },
    Meaning { value: 8, text: "Absolute from an external source in 2009, later reserved" },
];

#[rustfmt::skip]
pub static MT_CNTL_CHOICE_10_11: &[Meaning] = &[
    Meaning { value: 0, text: "Trapezoidal" },
];

#[rustfmt::skip]
pub static MT_CNTL_CHOICE_5_9: &[Meaning] = &[
    Meaning { value: 0, text: "At once after stopping" },
    Meaning { value: 1, text: "After stopping and MT.TNEXT" },
    Meaning { value: 2, text: "After stopping and an external event" },
    Meaning { value: 3, text: "After stopping, MT.TNEXT and an event" },
    Meaning { value: 7, text: "After stopping and MT.TNEXT or an event" },
    Meaning { value: 16, text: "Change on the fly, reaches the target at the present speed" },
    Meaning { value: 24, text: "Change on the fly, reaches the target already at the next speed" },
];

#[rustfmt::skip]
pub static OPERATING_MODE_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "speed control" },
    Meaning { value: 2, text: "positioning" },
    Meaning { value: 32768, text: "current control (a vendor-specific mode)" },
];

#[rustfmt::skip]
pub static PL_ERRMODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Magnitude of the following error" },
    Meaning { value: 1, text: "Deviation from the predicted error, for 100 ms" },
];

#[rustfmt::skip]
pub static PL_FBSOURCE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Primary" },
    Meaning { value: 1, text: "Secondary" },
];

#[rustfmt::skip]
pub static PL_MODPDIR_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Inside the range, never over its end" },
    Meaning { value: 1, text: "Positive direction" },
    Meaning { value: 2, text: "Negative direction" },
    Meaning { value: 3, text: "The shorter way" },
];

#[rustfmt::skip]
pub static PL_MODPEN_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Linear axis" },
    Meaning { value: 1, text: "Modulo axis" },
];

#[rustfmt::skip]
pub static REC_TRIGSLOPE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Negative" },
    Meaning { value: 1, text: "Positive" },
];

#[rustfmt::skip]
pub static REC_TRIGTYPE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Immediate" },
    Meaning { value: 1, text: "Next command" },
    Meaning { value: 2, text: "Parameter" },
];

#[rustfmt::skip]
pub static REGEN_TYPE_CHOICES: &[Meaning] = &[
    Meaning { value: -1, text: "External user defined" },
    Meaning { value: 0, text: "Internal" },
];

#[rustfmt::skip]
pub static SATZANW_BITS: &[Meaning] = &[
    Meaning { value: 15, text: "MDI: the task is that of the MDI signals, bits 0 to 14 do not count" },
];

#[rustfmt::skip]
pub static STO_STATE_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "Torque allowed" },
    Meaning { value: 0, text: "Safe torque off" },
];

#[rustfmt::skip]
pub static SWLS_STATE_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Negative software limit active" },
    Meaning { value: 1, text: "Positive software limit active" },
];

#[rustfmt::skip]
pub static UNIT_ACCLINEAR_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "custom" },
    Meaning { value: 1, text: "mm/s^2" },
    Meaning { value: 2, text: "um/s^2" },
    Meaning { value: 3, text: "counts/s^2" },
];

#[rustfmt::skip]
pub static UNIT_ACCROTARY_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "rpm/s" },
    Meaning { value: 1, text: "rps/s" },
    Meaning { value: 2, text: "deg/s^2" },
    Meaning { value: 3, text: "custom" },
];

#[rustfmt::skip]
pub static UNIT_PLINEAR_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "counts 32 bit" },
    Meaning { value: 1, text: "mm" },
    Meaning { value: 2, text: "um" },
    Meaning { value: 3, text: "custom" },
    Meaning { value: 4, text: "counts 16 bit" },
];

#[rustfmt::skip]
pub static UNIT_PROTARY_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "counts, 2^32 per revolution" },
    Meaning { value: 1, text: "rad" },
    Meaning { value: 2, text: "deg" },
    Meaning { value: 3, text: "custom, UNIT.PIN / UNIT.POUT per revolution" },
    Meaning { value: 4, text: "counts, 2^16 per revolution" },
];

#[rustfmt::skip]
pub static UNIT_VLINEAR_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "custom/s" },
    Meaning { value: 1, text: "um/s" },
    Meaning { value: 2, text: "mm/s" },
    Meaning { value: 3, text: "counts/s" },
];

#[rustfmt::skip]
pub static UNIT_VROTARY_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "rpm" },
    Meaning { value: 1, text: "rps" },
    Meaning { value: 2, text: "deg/s" },
    Meaning { value: 3, text: "custom/s" },
];

#[rustfmt::skip]
pub static VBUS_UVMODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Always" },
    Meaning { value: 1, text: "Only when enabling is tried" },
];

#[rustfmt::skip]
pub static VL_FBSOURCE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Primary" },
    Meaning { value: 1, text: "Secondary" },
];

#[rustfmt::skip]
pub static VL_GENMODE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Derivative" },
    Meaning { value: 1, text: "Observer" },
];

#[rustfmt::skip]
pub static WS_STATE_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Done" },
    Meaning { value: 1, text: "Armed" },
    Meaning { value: 2, text: "Running" },
    Meaning { value: 10, text: "Error" },
    Meaning { value: 11, text: "Not needed" },
];
