// Generated from data/vlt/meanings.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::Meaning;

#[rustfmt::skip]
pub static P1_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "English" },
    Meaning { value: 1, text: "Deutsch" },
    Meaning { value: 2, text: "Francais" },
    Meaning { value: 3, text: "Dansk" },
    Meaning { value: 4, text: "Spanish" },
    Meaning { value: 5, text: "Italiano" },
];

#[rustfmt::skip]
pub static P10_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Factory set-up" },
    Meaning { value: 1, text: "Set-up 1" },
    Meaning { value: 2, text: "Set-up 2" },
    Meaning { value: 3, text: "Set-up 3" },
    Meaning { value: 4, text: "Set-up 4" },
    Meaning { value: 9, text: "Multi set-up" },
];

#[rustfmt::skip]
pub static P100_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Speed open loop" },
    Meaning { value: 1, text: "Speed closed loop" },
    Meaning { value: 2, text: "Torque" },
    Meaning { value: 3, text: "Process" },
];

#[rustfmt::skip]
pub static P101_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "U/f" },
    Meaning { value: 1, text: "VVC+" },
    Meaning { value: 2, text: "Flux sensorless" },
    Meaning { value: 3, text: "Flux w/ motor feedb" },
];

#[rustfmt::skip]
pub static P102_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "24V encoder" },
];

#[rustfmt::skip]
pub static P103_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Constant torque" },
    Meaning { value: 1, text: "Variable torque" },
    Meaning { value: 2, text: "Auto Energy Optim." },
];

#[rustfmt::skip]
pub static P104_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "High torque" },
    Meaning { value: 1, text: "Normal torque" },
];

#[rustfmt::skip]
pub static P105_CHOICES: &[Meaning] = &[
    Meaning { value: 2, text: "As mode par. 1-00" },
];

#[rustfmt::skip]
pub static P11_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Factory set-up" },
    Meaning { value: 1, text: "Set-up 1" },
    Meaning { value: 2, text: "Set-up 2" },
    Meaning { value: 3, text: "Set-up 3" },
    Meaning { value: 4, text: "Set-up 4" },
    Meaning { value: 9, text: "Active set-up" },
];

#[rustfmt::skip]
pub static P110_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Asynchron" },
    Meaning { value: 1, text: "PM, non salient SPM" },
];

#[rustfmt::skip]
pub static P12_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Not linked" },
];

#[rustfmt::skip]
pub static P129_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Enable complete AMA" },
    Meaning { value: 2, text: "Enable reduced AMA" },
];

#[rustfmt::skip]
pub static P1420_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Manual reset" },
    Meaning { value: 1, text: "Automatic reset x 1" },
    Meaning { value: 2, text: "Automatic reset x 2" },
    Meaning { value: 3, text: "Automatic reset x 3" },
    Meaning { value: 13, text: "Infinite auto reset" },
];

#[rustfmt::skip]
pub static P1422_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Normal operation" },
    Meaning { value: 1, text: "Control card test" },
    Meaning { value: 2, text: "Initialisation" },
    Meaning { value: 3, text: "Boot mode" },
];

#[rustfmt::skip]
pub static P1506_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Do not reset" },
    Meaning { value: 1, text: "Reset counter" },
];

#[rustfmt::skip]
pub static P1507_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Do not reset" },
    Meaning { value: 1, text: "Reset counter" },
];

#[rustfmt::skip]
pub static P1640_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No" },
    Meaning { value: 1, text: "Yes" },
];

#[rustfmt::skip]
pub static P1661_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Current" },
    Meaning { value: 1, text: "Voltage" },
];

#[rustfmt::skip]
pub static P1663_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Current" },
    Meaning { value: 1, text: "Voltage" },
];

#[rustfmt::skip]
pub static P1690_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Brake check failed: resistor not connected or not working (28)" },
    Meaning { value: 1, text: "Power card too hot (69)" },
    Meaning { value: 2, text: "Earth fault between output phases and earth (14)" },
    Meaning { value: 3, text: "Control card too hot (65)" },
    Meaning { value: 4, text: "Control word timeout (17)" },
    Meaning { value: 5, text: "Over-current: peak current limit of the inverter (13)" },
    Meaning { value: 6, text: "Torque limit (12)" },
    Meaning { value: 7, text: "Motor thermistor says too hot, or is disconnected (11)" },
    Meaning { value: 8, text: "Motor too hot by calculation (ETR) (10)" },
    Meaning { value: 9, text: "Inverter overloaded: too high a current for too long (9)" },
    Meaning { value: 10, text: "DC link under-voltage (8)" },
    Meaning { value: 11, text: "DC link over-voltage (7)" },
    Meaning { value: 12, text: "Short circuit in motor or motor cable (16)" },
    Meaning { value: 13, text: "Inrush fault: too many power-ups in a short time (33)" },
    Meaning { value: 14, text: "Mains phase loss or too much imbalance (4)" },
    Meaning { value: 15, text: "one of 50, 51, 52, 53, 54, 55, 56, 57, 58" },
    Meaning { value: 16, text: "Live zero: analog input below half of its lowest value (2)" },
    Meaning { value: 17, text: "Internal fault (38)" },
    Meaning { value: 18, text: "Brake resistor power limit (26)" },
    Meaning { value: 19, text: "Motor phase U missing (30)" },
    Meaning { value: 20, text: "Motor phase V missing (31)" },
    Meaning { value: 21, text: "Motor phase W missing (32)" },
    Meaning { value: 22, text: "Fieldbus communication fault (34)" },
    Meaning { value: 23, text: "24 V supply low (47)" },
    Meaning { value: 24, text: "Mains failure (36)" },
    Meaning { value: 25, text: "1.8 V supply low (48)" },
    Meaning { value: 26, text: "Brake resistor short-circuited (25)" },
    Meaning { value: 27, text: "Brake transistor short-circuited (27)" },
    Meaning { value: 28, text: "Option configuration changed (67)" },
    Meaning { value: 29, text: "Drive initialised to its defaults (80)" },
    Meaning { value: 30, text: "Safe stop: 24 V missing at terminal 37 (68)" },
    Meaning { value: 31, text: "Mechanical brake: motor current below the release current (63)" },
];

#[rustfmt::skip]
pub static P1692_BITS: &[Meaning] = &[
    Meaning { value: 0, text: "Brake check failed: resistor not connected or not working (28)" },
    Meaning { value: 1, text: "Power card too hot (69)" },
    Meaning { value: 3, text: "Control card too hot (65)" },
    Meaning { value: 4, text: "Control word timeout (17)" },
    Meaning { value: 5, text: "Over-current: peak current limit of the inverter (13)" },
    Meaning { value: 6, text: "Torque limit (12)" },
    Meaning { value: 7, text: "Motor thermistor says too hot, or is disconnected (11)" },
    Meaning { value: 8, text: "Motor too hot by calculation (ETR) (10)" },
    Meaning { value: 9, text: "Inverter overloaded: too high a current for too long (9)" },
    Meaning { value: 10, text: "DC link under-voltage (8)" },
    Meaning { value: 11, text: "DC link over-voltage (7)" },
    Meaning { value: 12, text: "DC link voltage low (6)" },
    Meaning { value: 13, text: "DC link voltage high (5)" },
    Meaning { value: 14, text: "Mains phase loss or too much imbalance (4)" },
    Meaning { value: 15, text: "No motor at the output (3)" },
    Meaning { value: 16, text: "Live zero: analog input below half of its lowest value (2)" },
    Meaning { value: 17, text: "10 V supply of the control card low (1)" },
    Meaning { value: 18, text: "Brake resistor power limit (26)" },
    Meaning { value: 19, text: "Brake resistor short-circuited (25)" },
    Meaning { value: 20, text: "Brake transistor short-circuited (27)" },
    Meaning { value: 21, text: "Speed limit (49)" },
    Meaning { value: 22, text: "Fieldbus communication fault (34)" },
    Meaning { value: 23, text: "24 V supply low (47)" },
    Meaning { value: 24, text: "Mains failure (36)" },
    Meaning { value: 25, text: "Current limit (59)" },
    Meaning { value: 26, text: "Heat sink temperature low (66)" },
    Meaning { value: 27, text: "Voltage limit: load and speed need more voltage than there is (64)" },
    Meaning { value: 28, text: "Encoder loss (90)" },
    Meaning { value: 29, text: "Output frequency at its highest limit (62)" },
    Meaning { value: 30, text: "Safe stop: 24 V missing at terminal 37 (68)" },
];

#[rustfmt::skip]
pub static P172_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "DC hold/delay time" },
    Meaning { value: 1, text: "DC brake/delay time" },
    Meaning { value: 2, text: "Coast/delay time" },
    Meaning { value: 3, text: "Start speed cw" },
    Meaning { value: 4, text: "Horizontal operation" },
    Meaning { value: 5, text: "VVC+/Flux clockwise" },
];

#[rustfmt::skip]
pub static P173_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static P180_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Coast" },
    Meaning { value: 1, text: "DC hold" },
    Meaning { value: 2, text: "Motor check" },
    Meaning { value: 3, text: "Pre-magnetizing" },
    Meaning { value: 4, text: "DC voltage U0" },
];

#[rustfmt::skip]
pub static P190_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No protection" },
    Meaning { value: 1, text: "Thermistor warning" },
    Meaning { value: 2, text: "Thermistor trip" },
    Meaning { value: 3, text: "ETR warning 1" },
    Meaning { value: 4, text: "ETR trip 1" },
];

#[rustfmt::skip]
pub static P193_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "None" },
];

#[rustfmt::skip]
pub static P2_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "RPM" },
    Meaning { value: 1, text: "Hz" },
];

#[rustfmt::skip]
pub static P210_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Resistor brake" },
    Meaning { value: 2, text: "AC brake" },
];

#[rustfmt::skip]
pub static P3_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "International" },
    Meaning { value: 1, text: "US" },
];

#[rustfmt::skip]
pub static P300_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Min - Max" },
    Meaning { value: 1, text: "-Max - +Max" },
];

#[rustfmt::skip]
pub static P301_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "None" },
    Meaning { value: 1, text: "%" },
    Meaning { value: 2, text: "RPM" },
    Meaning { value: 3, text: "Hz" },
    Meaning { value: 4, text: "Nm" },
];

#[rustfmt::skip]
pub static P304_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Sum" },
    Meaning { value: 1, text: "External/Preset" },
];

#[rustfmt::skip]
pub static P313_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Linked to Hand/Auto" },
    Meaning { value: 1, text: "Remote" },
    Meaning { value: 2, text: "Local" },
];

#[rustfmt::skip]
pub static P315_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No function" },
    Meaning { value: 1, text: "Analog input 53" },
    Meaning { value: 2, text: "Analog input 54" },
    Meaning { value: 7, text: "Frequency input 29" },
    Meaning { value: 8, text: "Frequency input 33" },
    Meaning { value: 11, text: "Local bus reference" },
    Meaning { value: 20, text: "Digital pot.meter" },
];

#[rustfmt::skip]
pub static P316_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No function" },
    Meaning { value: 1, text: "Analog input 53" },
    Meaning { value: 2, text: "Analog input 54" },
    Meaning { value: 7, text: "Frequency input 29" },
    Meaning { value: 8, text: "Frequency input 33" },
    Meaning { value: 11, text: "Local bus reference" },
    Meaning { value: 20, text: "Digital pot.meter" },
];

#[rustfmt::skip]
pub static P317_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No function" },
    Meaning { value: 1, text: "Analog input 53" },
    Meaning { value: 2, text: "Analog input 54" },
    Meaning { value: 7, text: "Frequency input 29" },
    Meaning { value: 8, text: "Frequency input 33" },
    Meaning { value: 11, text: "Local bus reference" },
    Meaning { value: 20, text: "Digital pot.meter" },
];

#[rustfmt::skip]
pub static P318_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No function" },
];

#[rustfmt::skip]
pub static P340_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Linear" },
    Meaning { value: 1, text: "S-ramp Const Jerk" },
    Meaning { value: 2, text: "S-ramp Const Time" },
];

#[rustfmt::skip]
pub static P350_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Linear" },
    Meaning { value: 1, text: "S-ramp Const Jerk" },
    Meaning { value: 2, text: "S-ramp Const Time" },
];

#[rustfmt::skip]
pub static P360_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Linear" },
    Meaning { value: 1, text: "S-ramp Const Jerk" },
    Meaning { value: 2, text: "S-ramp Const Time" },
];

#[rustfmt::skip]
pub static P370_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Linear" },
    Meaning { value: 1, text: "S-ramp Const Jerk" },
    Meaning { value: 2, text: "S-ramp Const Time" },
];

#[rustfmt::skip]
pub static P392_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "On" },
];

#[rustfmt::skip]
pub static P4_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Resume" },
    Meaning { value: 1, text: "Forced stop, keep ref" },
    Meaning { value: 2, text: "Forced stop, ref=0" },
];

#[rustfmt::skip]
pub static P40_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static P41_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static P410_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Clockwise" },
    Meaning { value: 1, text: "Counter clockwise" },
    Meaning { value: 2, text: "Both directions" },
];

#[rustfmt::skip]
pub static P42_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static P420_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No function" },
];

#[rustfmt::skip]
pub static P421_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No function" },
];

#[rustfmt::skip]
pub static P43_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static P430_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Warning" },
    Meaning { value: 2, text: "Trip" },
    Meaning { value: 3, text: "Jog" },
    Meaning { value: 4, text: "Freeze Output" },
];

#[rustfmt::skip]
pub static P458_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Trip 100 ms" },
    Meaning { value: 2, text: "Trip 1000 ms" },
];

#[rustfmt::skip]
pub static P50_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No copy" },
    Meaning { value: 1, text: "All to LCP" },
    Meaning { value: 2, text: "All from LCP" },
    Meaning { value: 3, text: "Size indep. from LCP" },
];

#[rustfmt::skip]
pub static P500_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "PNP" },
    Meaning { value: 1, text: "NPN" },
];

#[rustfmt::skip]
pub static P501_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Input" },
    Meaning { value: 1, text: "Output" },
];

#[rustfmt::skip]
pub static P502_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Input" },
    Meaning { value: 1, text: "Output" },
];

#[rustfmt::skip]
pub static P51_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No copy" },
    Meaning { value: 1, text: "Copy to set-up 1" },
    Meaning { value: 2, text: "Copy to set-up 2" },
    Meaning { value: 3, text: "Copy to set-up 3" },
    Meaning { value: 4, text: "Copy to set-up 4" },
    Meaning { value: 9, text: "Copy to all" },
];

#[rustfmt::skip]
pub static P510_CHOICES: &[Meaning] = &[
    Meaning { value: 8, text: "Start" },
];

#[rustfmt::skip]
pub static P511_CHOICES: &[Meaning] = &[
    Meaning { value: 10, text: "Reversing" },
];

#[rustfmt::skip]
pub static P512_CHOICES: &[Meaning] = &[
    Meaning { value: 2, text: "Coast inverse" },
];

#[rustfmt::skip]
pub static P513_CHOICES: &[Meaning] = &[
    Meaning { value: 14, text: "Jog" },
];

#[rustfmt::skip]
pub static P514_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No operation" },
];

#[rustfmt::skip]
pub static P515_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No operation" },
];

#[rustfmt::skip]
pub static P530_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No operation" },
];

#[rustfmt::skip]
pub static P531_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No operation" },
];

#[rustfmt::skip]
pub static P540_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No operation" },
];

#[rustfmt::skip]
pub static P801_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital and ctrl. word" },
    Meaning { value: 1, text: "Digital only" },
    Meaning { value: 2, text: "Controlword only" },
];

#[rustfmt::skip]
pub static P802_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "None" },
    Meaning { value: 1, text: "FC RS485" },
    Meaning { value: 2, text: "FC USB" },
    Meaning { value: 3, text: "Option A" },
    Meaning { value: 4, text: "Option B" },
    Meaning { value: 5, text: "Option C0" },
    Meaning { value: 6, text: "Option C1" },
];

#[rustfmt::skip]
pub static P804_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Freeze output" },
    Meaning { value: 2, text: "Stop" },
    Meaning { value: 3, text: "Jogging" },
    Meaning { value: 4, text: "Max. speed" },
    Meaning { value: 5, text: "Stop and trip" },
];

#[rustfmt::skip]
pub static P805_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Hold set-up" },
    Meaning { value: 1, text: "Resume set-up" },
];

#[rustfmt::skip]
pub static P806_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Do not reset" },
    Meaning { value: 1, text: "Do reset" },
];

#[rustfmt::skip]
pub static P807_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disable" },
    Meaning { value: 1, text: "Trigger on alarms" },
    Meaning { value: 2, text: "Trigger alarm/warn." },
];

#[rustfmt::skip]
pub static P810_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "FC profile" },
    Meaning { value: 1, text: "PROFIdrive profile" },
    Meaning { value: 5, text: "ODVA" },
    Meaning { value: 7, text: "CANopen DSP 402" },
];

#[rustfmt::skip]
pub static P813_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No function" },
    Meaning { value: 1, text: "Profile default" },
    Meaning { value: 2, text: "Alarm 68 only" },
];

#[rustfmt::skip]
pub static P814_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "None" },
    Meaning { value: 1, text: "Profile default" },
];

#[rustfmt::skip]
pub static P830_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "FC" },
    Meaning { value: 1, text: "FC MC" },
    Meaning { value: 2, text: "Modbus RTU" },
];

#[rustfmt::skip]
pub static P832_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "2400 Baud" },
    Meaning { value: 1, text: "4800 Baud" },
    Meaning { value: 2, text: "9600 Baud" },
    Meaning { value: 3, text: "19200 Baud" },
    Meaning { value: 4, text: "38400 Baud" },
    Meaning { value: 5, text: "57600 Baud" },
    Meaning { value: 6, text: "76800 Baud" },
    Meaning { value: 7, text: "115200 Baud" },
];

#[rustfmt::skip]
pub static P833_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Even Parity, 1 Stop Bit" },
    Meaning { value: 1, text: "Odd Parity, 1 Stop Bit" },
    Meaning { value: 2, text: "No Parity, 1 Stop Bit" },
    Meaning { value: 3, text: "No Parity, 2 Stop Bits" },
];

#[rustfmt::skip]
pub static P840_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "Standard telegram 1" },
    Meaning { value: 101, text: "PPO 1" },
    Meaning { value: 102, text: "PPO 2" },
    Meaning { value: 103, text: "PPO 3" },
    Meaning { value: 104, text: "PPO 4" },
    Meaning { value: 105, text: "PPO 5" },
    Meaning { value: 106, text: "PPO 6" },
    Meaning { value: 107, text: "PPO 7" },
    Meaning { value: 108, text: "PPO 8" },
    Meaning { value: 200, text: "Custom telegram 1" },
];

#[rustfmt::skip]
pub static P850_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital input" },
    Meaning { value: 1, text: "Bus" },
    Meaning { value: 2, text: "Logic AND" },
    Meaning { value: 3, text: "Logic OR" },
];

#[rustfmt::skip]
pub static P851_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital input" },
    Meaning { value: 1, text: "Bus" },
    Meaning { value: 2, text: "Logic AND" },
    Meaning { value: 3, text: "Logic OR" },
];

#[rustfmt::skip]
pub static P852_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital input" },
    Meaning { value: 1, text: "Bus" },
    Meaning { value: 2, text: "Logic AND" },
    Meaning { value: 3, text: "Logic OR" },
];

#[rustfmt::skip]
pub static P853_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital input" },
    Meaning { value: 1, text: "Bus" },
    Meaning { value: 2, text: "Logic AND" },
    Meaning { value: 3, text: "Logic OR" },
];

#[rustfmt::skip]
pub static P854_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital input" },
    Meaning { value: 1, text: "Bus" },
    Meaning { value: 2, text: "Logic AND" },
    Meaning { value: 3, text: "Logic OR" },
];

#[rustfmt::skip]
pub static P855_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital input" },
    Meaning { value: 1, text: "Bus" },
    Meaning { value: 2, text: "Logic AND" },
    Meaning { value: 3, text: "Logic OR" },
];

#[rustfmt::skip]
pub static P856_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Digital input" },
    Meaning { value: 1, text: "Bus" },
    Meaning { value: 2, text: "Logic AND" },
    Meaning { value: 3, text: "Logic OR" },
];

#[rustfmt::skip]
pub static P922_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "Standard telegram 1" },
    Meaning { value: 101, text: "PPO 1" },
    Meaning { value: 102, text: "PPO 2" },
    Meaning { value: 103, text: "PPO 3" },
    Meaning { value: 104, text: "PPO 4" },
    Meaning { value: 105, text: "PPO 5" },
    Meaning { value: 106, text: "PPO 6" },
    Meaning { value: 107, text: "PPO 7" },
    Meaning { value: 108, text: "PPO 8" },
    Meaning { value: 200, text: "Custom telegram 1" },
];

#[rustfmt::skip]
pub static P927_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static P928_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disable" },
    Meaning { value: 1, text: "Enable cyclic master" },
];

#[rustfmt::skip]
pub static P963_CHOICES: &[Meaning] = &[
    Meaning { value: 255, text: "No baudrate found" },
];

#[rustfmt::skip]
pub static P971_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "Store all setups" },
];

#[rustfmt::skip]
pub static P972_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Power-on reset" },
    Meaning { value: 2, text: "Power-on reset prep" },
    Meaning { value: 3, text: "Comm option reset" },
];
