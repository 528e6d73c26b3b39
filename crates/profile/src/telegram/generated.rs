// Generated from data/profile/ by `cargo run -p xtask -- gen`.

use super::{Direction::*, Field, Image, Signal, Telegram};

/// All signals.
#[rustfmt::skip]
pub static SIGNALS: [Signal; 63] = [
    Signal { number: 1, name: "STW1", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Control word 1", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 2, name: "ZSW1", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Status word 1", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 3, name: "STW2", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Control word 2, bits 12 to 15 the controller's sign of life", common: "", source: "Siemens S110 Function Manual 01/2011 p. 532" },
    Signal { number: 4, name: "ZSW2", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Status word 2, bits 12 to 15 the drive's sign of life", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 5, name: "NSOLL_A", vendor: None, bits: 16, signed: true, direction: Setpoint, meaning: "Speed setpoint A", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 6, name: "NIST_A", vendor: None, bits: 16, signed: true, direction: Actual, meaning: "Speed actual value A", common: "speed", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 7, name: "NSOLL_B", vendor: None, bits: 32, signed: true, direction: Setpoint, meaning: "Speed setpoint B", common: "", source: "Siemens S110 Function Manual 01/2011 p. 532" },
    Signal { number: 8, name: "NIST_B", vendor: None, bits: 32, signed: true, direction: Actual, meaning: "Speed actual value B", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 9, name: "G1_STW", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Control word of sensor 1", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 10, name: "G1_ZSW", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Status word of sensor 1", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 11, name: "G1_XIST1", vendor: None, bits: 32, signed: false, direction: Actual, meaning: "Position actual value 1 of sensor 1", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 12, name: "G1_XIST2", vendor: None, bits: 32, signed: false, direction: Actual, meaning: "Position actual value 2 of sensor 1, or an error code", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 13, name: "G2_STW", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Control word of sensor 2", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 14, name: "G2_ZSW", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Status word of sensor 2", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 15, name: "G2_XIST1", vendor: None, bits: 32, signed: false, direction: Actual, meaning: "Position actual value 1 of sensor 2", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 16, name: "G2_XIST2", vendor: None, bits: 32, signed: false, direction: Actual, meaning: "Position actual value 2 of sensor 2, or an error code", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 17, name: "G3_STW", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Control word of sensor 3", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 18, name: "G3_ZSW", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Status word of sensor 3", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 19, name: "G3_XIST1", vendor: None, bits: 32, signed: false, direction: Actual, meaning: "Position actual value 1 of sensor 3", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 20, name: "G3_XIST2", vendor: None, bits: 32, signed: false, direction: Actual, meaning: "Position actual value 2 of sensor 3, or an error code", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 21, name: "E_DIGITAL", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Digital inputs", common: "", source: "Kollmorgen AKD2G web help, PROFINET signal list" },
    Signal { number: 22, name: "A_DIGITAL", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Digital outputs", common: "", source: "Kollmorgen AKD2G web help, PROFINET signal list" },
    Signal { number: 23, name: "E_ANALOG", vendor: None, bits: 16, signed: true, direction: Actual, meaning: "Analog input", common: "", source: "Kollmorgen AKD2G web help, PROFINET signal list" },
    Signal { number: 24, name: "A_ANALOG", vendor: None, bits: 16, signed: true, direction: Setpoint, meaning: "Analog output", common: "", source: "Kollmorgen AKD2G web help, PROFINET signal list" },
    Signal { number: 25, name: "XERR", vendor: None, bits: 32, signed: true, direction: Setpoint, meaning: "Position deviation (dynamic servo control)", common: "", source: "Siemens MASTERDRIVES compendium 09/2008 p. 8.2-21; AKD2G lists a word, the length of telegram 5 says double word" },
    Signal { number: 26, name: "KPC", vendor: None, bits: 32, signed: true, direction: Setpoint, meaning: "Position controller gain (dynamic servo control)", common: "", source: "Siemens MASTERDRIVES compendium 09/2008 p. 8.2-21; AKD2G lists a word, the length of telegram 5 says double word" },
    Signal { number: 27, name: "XSOLL_A", vendor: None, bits: 32, signed: true, direction: Setpoint, meaning: "Position setpoint A", common: "", source: "as recalled, no public source" },
    Signal { number: 28, name: "XIST_A", vendor: None, bits: 32, signed: true, direction: Actual, meaning: "Position actual value A", common: "position", source: "AKD PROFINET manual ed. M (10/2017) 5.6 and 5.11, printed unsigned" },
    Signal { number: 29, name: "XSOLL_B", vendor: None, bits: 64, signed: true, direction: Setpoint, meaning: "Position setpoint B", common: "", source: "as recalled, no public source" },
    Signal { number: 30, name: "XIST_B", vendor: None, bits: 64, signed: true, direction: Actual, meaning: "Position actual value B", common: "", source: "as recalled, no public source" },
    Signal { number: 32, name: "SATZANW", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Traversing block selection, bit 15 selects MDI", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 33, name: "AKTSATZ", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Traversing block in progress", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 34, name: "MDI_TARPOS", vendor: None, bits: 32, signed: true, direction: Setpoint, meaning: "MDI target position", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 35, name: "MDI_VELOCITY", vendor: None, bits: 32, signed: false, direction: Setpoint, meaning: "MDI velocity", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8 and 5.12.1; the full scale needs all 32 bits" },
    Signal { number: 36, name: "MDI_ACC", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "MDI acceleration", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 37, name: "MDI_DEC", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "MDI deceleration", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 38, name: "MDI_MOD", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "MDI mode, bit 0: 0 relative, 1 absolute", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 39, name: "G1_XIST3", vendor: None, bits: 64, signed: false, direction: Actual, meaning: "Position actual value 3 of sensor 1", common: "", source: "name: Heidenhain PROFIBUS DPV2 / PROFINET encoder manual p. 38-58" },
    Signal { number: 51, name: "IAIST_GLATT", vendor: None, bits: 16, signed: true, direction: Actual, meaning: "Current actual value, absolute, smoothed", common: "current", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 52, name: "ITIST_GLATT", vendor: None, bits: 16, signed: true, direction: Actual, meaning: "Torque-producing current, smoothed", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8; printed unsigned in 5.6, the text has a negative value" },
    Signal { number: 53, name: "MIST_GLATT", vendor: None, bits: 16, signed: true, direction: Actual, meaning: "Torque actual value, smoothed", common: "motor-torque", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 54, name: "PIST_GLATT", vendor: None, bits: 16, signed: true, direction: Actual, meaning: "Active power, smoothed", common: "power", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 57, name: "NIST_A_GLATT", vendor: None, bits: 16, signed: true, direction: Actual, meaning: "Speed actual value A, smoothed", common: "", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 58, name: "MELD_NAMUR", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "VIK-NAMUR message word", common: "", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 80, name: "STW2_ENC", vendor: None, bits: 16, signed: false, direction: Setpoint, meaning: "Control word 2 of an encoder", common: "", source: "name: Heidenhain PROFIBUS DPV2 / PROFINET encoder manual p. 38-58" },
    Signal { number: 81, name: "ZSW2_ENC", vendor: None, bits: 16, signed: false, direction: Actual, meaning: "Status word 2 of an encoder", common: "", source: "name: Heidenhain PROFIBUS DPV2 / PROFINET encoder manual p. 38-58" },
    Signal { number: 100, name: "HOME_DIST", vendor: Some(0x0105), bits: 32, signed: true, direction: Setpoint, meaning: "Homing distance", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 101, name: "MT_FEEDRATE", vendor: Some(0x0105), bits: 16, signed: false, direction: Setpoint, meaning: "Feed rate of motion tasks", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 102, name: "IL_CMD_FIELDBUS", vendor: Some(0x0105), bits: 16, signed: true, direction: Setpoint, meaning: "Current command", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 103, name: "HOME_MODE", vendor: Some(0x0105), bits: 16, signed: false, direction: Setpoint, meaning: "Homing mode", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 104, name: "XIST_ERROR", vendor: Some(0x0105), bits: 32, signed: true, direction: Actual, meaning: "Position error", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 105, name: "DRIVE_MOTION_STATUS", vendor: Some(0x0105), bits: 32, signed: false, direction: Actual, meaning: "Motion status", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 106, name: "DRIVE_INPUTS", vendor: Some(0x0105), bits: 16, signed: false, direction: Actual, meaning: "Limit switches, hardware disable, controlled stop, STO", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8.1" },
    Signal { number: 107, name: "RESERVED_107", vendor: Some(0x0105), bits: 16, signed: false, direction: Either, meaning: "Reserved", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8" },
    Signal { number: 108, name: "DRV_ACC", vendor: Some(0x0105), bits: 16, signed: false, direction: Setpoint, meaning: "Acceleration", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8; 6.1 exchanges 108 and 109" },
    Signal { number: 109, name: "DRV_DEC", vendor: Some(0x0105), bits: 16, signed: false, direction: Setpoint, meaning: "Deceleration", common: "", source: "AKD PROFINET manual ed. M (10/2017) 5.8; 6.1 exchanges 108 and 109" },
    Signal { number: 101, name: "MOMRED", vendor: Some(0x002a), bits: 16, signed: true, direction: Setpoint, meaning: "Torque reduction", common: "", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 102, name: "MELDW", vendor: Some(0x002a), bits: 16, signed: false, direction: Actual, meaning: "Message word", common: "", source: "Siemens S120 Installation and Start-Up 12/04 p. 4-102" },
    Signal { number: 301, name: "FAULT_CODE", vendor: Some(0x002a), bits: 16, signed: false, direction: Actual, meaning: "Fault number", common: "", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 303, name: "WARN_CODE", vendor: Some(0x002a), bits: 16, signed: false, direction: Actual, meaning: "Warning number", common: "", source: "name: Siemens G220 04/2024 p. 334-338" },
    Signal { number: 137, name: "DW_PDI6", vendor: Some(0x01ba), bits: 32, signed: false, direction: Setpoint, meaning: "32-bit process data in 6", common: "", source: "Vacon 100 PROFINET manual p. 30 and table 23" },
    Signal { number: 138, name: "DW_PDI7", vendor: Some(0x01ba), bits: 32, signed: false, direction: Setpoint, meaning: "32-bit process data in 7", common: "", source: "Vacon 100 PROFINET manual p. 30 and table 23" },
    Signal { number: 139, name: "DW_PDI8", vendor: Some(0x01ba), bits: 32, signed: false, direction: Setpoint, meaning: "32-bit process data in 8", common: "", source: "Vacon 100 PROFINET manual p. 30 and table 23" },
];

/// All telegrams.
#[rustfmt::skip]
pub static TELEGRAMS: [Telegram; 37] = [
    Telegram {
        number: 0, vendor: None, free: true, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[], octets: 0 },
        actual: Image { fields: &[], octets: 0 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.1; the length is that of the plugged module",
    },
    Telegram {
        number: 1, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 4 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.2; Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 2, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
        ], octets: 8 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
        ], octets: 8 },
        source: "Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 3, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[8], offset: 8 }, // G1_STW
        ], octets: 10 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[9], offset: 8 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 10 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 14 }, // G1_XIST2
        ], octets: 18 },
        source: "Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 4, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[8], offset: 8 }, // G1_STW
            Field { signal: &SIGNALS[12], offset: 10 }, // G2_STW
        ], octets: 12 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[9], offset: 8 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 10 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 14 }, // G1_XIST2
            Field { signal: &SIGNALS[13], offset: 18 }, // G2_ZSW
            Field { signal: &SIGNALS[14], offset: 20 }, // G2_XIST1
            Field { signal: &SIGNALS[15], offset: 24 }, // G2_XIST2
        ], octets: 28 },
        source: "Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 5, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[8], offset: 8 }, // G1_STW
            Field { signal: &SIGNALS[24], offset: 10 }, // XERR
            Field { signal: &SIGNALS[25], offset: 14 }, // KPC
        ], octets: 18 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[9], offset: 8 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 10 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 14 }, // G1_XIST2
        ], octets: 18 },
        source: "Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 6, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[8], offset: 8 }, // G1_STW
            Field { signal: &SIGNALS[12], offset: 10 }, // G2_STW
            Field { signal: &SIGNALS[24], offset: 12 }, // XERR
            Field { signal: &SIGNALS[25], offset: 16 }, // KPC
        ], octets: 20 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[9], offset: 8 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 10 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 14 }, // G1_XIST2
            Field { signal: &SIGNALS[13], offset: 18 }, // G2_ZSW
            Field { signal: &SIGNALS[14], offset: 20 }, // G2_XIST1
            Field { signal: &SIGNALS[15], offset: 24 }, // G2_XIST2
        ], octets: 28 },
        source: "Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 7, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[30], offset: 2 }, // SATZANW
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[31], offset: 2 }, // AKTSATZ
        ], octets: 4 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.3; Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 9, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[30], offset: 2 }, // SATZANW
            Field { signal: &SIGNALS[2], offset: 4 }, // STW2
            Field { signal: &SIGNALS[32], offset: 6 }, // MDI_TARPOS
            Field { signal: &SIGNALS[33], offset: 10 }, // MDI_VELOCITY
            Field { signal: &SIGNALS[34], offset: 14 }, // MDI_ACC
            Field { signal: &SIGNALS[35], offset: 16 }, // MDI_DEC
            Field { signal: &SIGNALS[36], offset: 18 }, // MDI_MOD
        ], octets: 20 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[31], offset: 2 }, // AKTSATZ
            Field { signal: &SIGNALS[3], offset: 4 }, // ZSW2
            Field { signal: &SIGNALS[27], offset: 6 }, // XIST_A
        ], octets: 10 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.4; Siemens SINAMICS S List Manual 07/2007 function diagram 2420",
    },
    Telegram {
        number: 20, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[42], offset: 2 }, // NIST_A_GLATT
            Field { signal: &SIGNALS[38], offset: 4 }, // IAIST_GLATT
            Field { signal: &SIGNALS[40], offset: 6 }, // MIST_GLATT
            Field { signal: &SIGNALS[41], offset: 8 }, // PIST_GLATT
            Field { signal: &SIGNALS[43], offset: 10 }, // MELD_NAMUR
        ], octets: 12 },
        source: "Siemens G220 04/2024 p. 334-338",
    },
    Telegram {
        number: 81, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[44], offset: 0 }, // STW2_ENC
            Field { signal: &SIGNALS[8], offset: 2 }, // G1_STW
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[45], offset: 0 }, // ZSW2_ENC
            Field { signal: &SIGNALS[9], offset: 2 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 4 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 8 }, // G1_XIST2
        ], octets: 12 },
        source: "Heidenhain PROFIBUS DPV2 / PROFINET encoder manual p. 38-42",
    },
    Telegram {
        number: 82, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[44], offset: 0 }, // STW2_ENC
            Field { signal: &SIGNALS[8], offset: 2 }, // G1_STW
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[45], offset: 0 }, // ZSW2_ENC
            Field { signal: &SIGNALS[9], offset: 2 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 4 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 8 }, // G1_XIST2
            Field { signal: &SIGNALS[5], offset: 12 }, // NIST_A
        ], octets: 14 },
        source: "Heidenhain PROFIBUS DPV2 / PROFINET encoder manual p. 38-42",
    },
    Telegram {
        number: 83, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[44], offset: 0 }, // STW2_ENC
            Field { signal: &SIGNALS[8], offset: 2 }, // G1_STW
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[45], offset: 0 }, // ZSW2_ENC
            Field { signal: &SIGNALS[9], offset: 2 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 4 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 8 }, // G1_XIST2
            Field { signal: &SIGNALS[7], offset: 12 }, // NIST_B
        ], octets: 16 },
        source: "Heidenhain PROFIBUS DPV2 / PROFINET encoder manual p. 38-42",
    },
    Telegram {
        number: 84, vendor: None, free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[44], offset: 0 }, // STW2_ENC
            Field { signal: &SIGNALS[8], offset: 2 }, // G1_STW
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[45], offset: 0 }, // ZSW2_ENC
            Field { signal: &SIGNALS[9], offset: 2 }, // G1_ZSW
            Field { signal: &SIGNALS[37], offset: 4 }, // G1_XIST3
            Field { signal: &SIGNALS[11], offset: 12 }, // G1_XIST2
            Field { signal: &SIGNALS[7], offset: 16 }, // NIST_B
        ], octets: 20 },
        source: "Heidenhain PROFIBUS DPV2 / PROFINET encoder manual p. 38-42",
    },
    Telegram {
        number: 102, vendor: Some(0x002a), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[56], offset: 8 }, // MOMRED
            Field { signal: &SIGNALS[8], offset: 10 }, // G1_STW
        ], octets: 12 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[57], offset: 8 }, // MELDW
            Field { signal: &SIGNALS[9], offset: 10 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 12 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 16 }, // G1_XIST2
        ], octets: 20 },
        source: "Siemens G220 04/2024 p. 334-338",
    },
    Telegram {
        number: 103, vendor: Some(0x002a), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[56], offset: 8 }, // MOMRED
            Field { signal: &SIGNALS[8], offset: 10 }, // G1_STW
            Field { signal: &SIGNALS[12], offset: 12 }, // G2_STW
        ], octets: 14 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[57], offset: 8 }, // MELDW
            Field { signal: &SIGNALS[9], offset: 10 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 12 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 16 }, // G1_XIST2
            Field { signal: &SIGNALS[13], offset: 20 }, // G2_ZSW
            Field { signal: &SIGNALS[14], offset: 22 }, // G2_XIST1
            Field { signal: &SIGNALS[15], offset: 26 }, // G2_XIST2
        ], octets: 30 },
        source: "Siemens G220 04/2024 p. 334-338",
    },
    Telegram {
        number: 105, vendor: Some(0x002a), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[56], offset: 8 }, // MOMRED
            Field { signal: &SIGNALS[8], offset: 10 }, // G1_STW
            Field { signal: &SIGNALS[24], offset: 12 }, // XERR
            Field { signal: &SIGNALS[25], offset: 16 }, // KPC
        ], octets: 20 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[57], offset: 8 }, // MELDW
            Field { signal: &SIGNALS[9], offset: 10 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 12 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 16 }, // G1_XIST2
        ], octets: 20 },
        source: "LinMot PROFIdrive manual p. 33",
    },
    Telegram {
        number: 106, vendor: Some(0x002a), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[6], offset: 2 }, // NSOLL_B
            Field { signal: &SIGNALS[2], offset: 6 }, // STW2
            Field { signal: &SIGNALS[56], offset: 8 }, // MOMRED
            Field { signal: &SIGNALS[8], offset: 10 }, // G1_STW
            Field { signal: &SIGNALS[12], offset: 12 }, // G2_STW
            Field { signal: &SIGNALS[24], offset: 14 }, // XERR
            Field { signal: &SIGNALS[25], offset: 18 }, // KPC
        ], octets: 22 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[7], offset: 2 }, // NIST_B
            Field { signal: &SIGNALS[3], offset: 6 }, // ZSW2
            Field { signal: &SIGNALS[57], offset: 8 }, // MELDW
            Field { signal: &SIGNALS[9], offset: 10 }, // G1_ZSW
            Field { signal: &SIGNALS[10], offset: 12 }, // G1_XIST1
            Field { signal: &SIGNALS[11], offset: 16 }, // G1_XIST2
            Field { signal: &SIGNALS[13], offset: 20 }, // G2_ZSW
            Field { signal: &SIGNALS[14], offset: 22 }, // G2_XIST1
            Field { signal: &SIGNALS[15], offset: 26 }, // G2_XIST2
        ], octets: 30 },
        source: "Siemens product information on telegram 105, by analogy",
    },
    Telegram {
        number: 350, vendor: Some(0x0105), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
            Field { signal: &SIGNALS[39], offset: 4 }, // ITIST_GLATT
        ], octets: 6 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.5",
    },
    Telegram {
        number: 351, vendor: Some(0x0105), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
            Field { signal: &SIGNALS[39], offset: 4 }, // ITIST_GLATT
            Field { signal: &SIGNALS[27], offset: 6 }, // XIST_A
        ], octets: 10 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.6",
    },
    Telegram {
        number: 352, vendor: Some(0x0105), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[30], offset: 2 }, // SATZANW
            Field { signal: &SIGNALS[2], offset: 4 }, // STW2
            Field { signal: &SIGNALS[32], offset: 6 }, // MDI_TARPOS
            Field { signal: &SIGNALS[33], offset: 10 }, // MDI_VELOCITY
            Field { signal: &SIGNALS[34], offset: 14 }, // MDI_ACC
            Field { signal: &SIGNALS[35], offset: 16 }, // MDI_DEC
            Field { signal: &SIGNALS[36], offset: 18 }, // MDI_MOD
            Field { signal: &SIGNALS[46], offset: 20 }, // HOME_DIST
        ], octets: 24 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[31], offset: 2 }, // AKTSATZ
            Field { signal: &SIGNALS[3], offset: 4 }, // ZSW2
            Field { signal: &SIGNALS[27], offset: 6 }, // XIST_A
        ], octets: 10 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.7; word 8 is blank there, MDI_ACC as in telegram 353",
    },
    Telegram {
        number: 353, vendor: Some(0x0105), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[30], offset: 2 }, // SATZANW
            Field { signal: &SIGNALS[2], offset: 4 }, // STW2
            Field { signal: &SIGNALS[32], offset: 6 }, // MDI_TARPOS
            Field { signal: &SIGNALS[33], offset: 10 }, // MDI_VELOCITY
            Field { signal: &SIGNALS[34], offset: 14 }, // MDI_ACC
            Field { signal: &SIGNALS[35], offset: 16 }, // MDI_DEC
            Field { signal: &SIGNALS[36], offset: 18 }, // MDI_MOD
            Field { signal: &SIGNALS[46], offset: 20 }, // HOME_DIST
            Field { signal: &SIGNALS[49], offset: 24 }, // HOME_MODE
        ], octets: 26 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[31], offset: 2 }, // AKTSATZ
            Field { signal: &SIGNALS[3], offset: 4 }, // ZSW2
            Field { signal: &SIGNALS[27], offset: 6 }, // XIST_A
        ], octets: 10 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.8",
    },
    Telegram {
        number: 354, vendor: Some(0x0105), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
            Field { signal: &SIGNALS[54], offset: 4 }, // DRV_ACC
            Field { signal: &SIGNALS[55], offset: 6 }, // DRV_DEC
        ], octets: 8 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 4 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.9",
    },
    Telegram {
        number: 400, vendor: Some(0x0105), free: true, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[30], offset: 2 }, // SATZANW
            Field { signal: &SIGNALS[2], offset: 4 }, // STW2
            Field { signal: &SIGNALS[32], offset: 6 }, // MDI_TARPOS
            Field { signal: &SIGNALS[33], offset: 10 }, // MDI_VELOCITY
            Field { signal: &SIGNALS[34], offset: 14 }, // MDI_ACC
            Field { signal: &SIGNALS[35], offset: 16 }, // MDI_DEC
            Field { signal: &SIGNALS[36], offset: 18 }, // MDI_MOD
        ], octets: 24 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[31], offset: 2 }, // AKTSATZ
            Field { signal: &SIGNALS[3], offset: 4 }, // ZSW2
            Field { signal: &SIGNALS[27], offset: 6 }, // XIST_A
        ], octets: 24 },
        source: "AKD PROFINET manual ed. M (10/2017) 5.11.10; the default is like telegram 9",
    },
    Telegram {
        number: 352, vendor: Some(0x002a), free: false, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 12 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[42], offset: 2 }, // NIST_A_GLATT
            Field { signal: &SIGNALS[38], offset: 4 }, // IAIST_GLATT
            Field { signal: &SIGNALS[40], offset: 6 }, // MIST_GLATT
            Field { signal: &SIGNALS[59], offset: 8 }, // WARN_CODE
            Field { signal: &SIGNALS[58], offset: 10 }, // FAULT_CODE
        ], octets: 12 },
        source: "Siemens G220 04/2024 p. 334-338",
    },
    Telegram {
        number: 999, vendor: Some(0x002a), free: true, pkw: false, parameters: false, own_words: false, full_speed: None,
        setpoint: Image { fields: &[], octets: 0 },
        actual: Image { fields: &[], octets: 0 },
        source: "Siemens SINAMICS S List Manual 07/2007 function diagram 2420; the length is that of the plugged module",
    },
    Telegram {
        number: 101, vendor: Some(0x0080), free: false, pkw: true, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 8 }, // STW1
            Field { signal: &SIGNALS[4], offset: 10 }, // NSOLL_A
        ], octets: 12 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 8 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 10 }, // NIST_A
        ], octets: 12 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory",
    },
    Telegram {
        number: 102, vendor: Some(0x0080), free: false, pkw: true, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 8 }, // STW1
            Field { signal: &SIGNALS[4], offset: 10 }, // NSOLL_A
        ], octets: 20 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 8 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 10 }, // NIST_A
        ], octets: 20 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory",
    },
    Telegram {
        number: 103, vendor: Some(0x0080), free: false, pkw: false, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 4 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory",
    },
    Telegram {
        number: 104, vendor: Some(0x0080), free: false, pkw: false, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 12 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 12 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory",
    },
    Telegram {
        number: 105, vendor: Some(0x0080), free: false, pkw: true, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 8 }, // STW1
            Field { signal: &SIGNALS[4], offset: 10 }, // NSOLL_A
        ], octets: 28 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 8 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 10 }, // NIST_A
        ], octets: 28 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory",
    },
    Telegram {
        number: 106, vendor: Some(0x0080), free: false, pkw: false, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 20 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 20 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory",
    },
    Telegram {
        number: 107, vendor: Some(0x0080), free: false, pkw: true, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 8 }, // STW1
            Field { signal: &SIGNALS[4], offset: 10 }, // NSOLL_A
        ], octets: 24 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 8 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 10 }, // NIST_A
        ], octets: 24 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory; the eight words are read from a drawing",
    },
    Telegram {
        number: 108, vendor: Some(0x0080), free: false, pkw: false, parameters: true, own_words: true, full_speed: Some(16384),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 16 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 16 },
        source: "MCA 101 manual p. 16; VLT PROFINET MCA 120 manual p. 25; the number is the selection of 9-22, from memory; the eight words are read from a drawing",
    },
    Telegram {
        number: 148, vendor: Some(0x01ba), free: false, pkw: false, parameters: true, own_words: true, full_speed: Some(10000),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 4 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 4 },
        source: "OPTEA manual p. 103-104",
    },
    Telegram {
        number: 149, vendor: Some(0x01ba), free: false, pkw: false, parameters: true, own_words: true, full_speed: Some(10000),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 12 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 12 },
        source: "OPTEA manual p. 103-104",
    },
    Telegram {
        number: 150, vendor: Some(0x01ba), free: false, pkw: false, parameters: true, own_words: true, full_speed: Some(10000),
        setpoint: Image { fields: &[
            Field { signal: &SIGNALS[0], offset: 0 }, // STW1
            Field { signal: &SIGNALS[4], offset: 2 }, // NSOLL_A
        ], octets: 20 },
        actual: Image { fields: &[
            Field { signal: &SIGNALS[1], offset: 0 }, // ZSW1
            Field { signal: &SIGNALS[5], offset: 2 }, // NIST_A
        ], octets: 20 },
        source: "OPTEA manual p. 103-104",
    },
];

/// Signal numbers by name.
pub mod signal {
    /// Control word 1.
    pub const STW1: u16 = 1;
    /// Status word 1.
    pub const ZSW1: u16 = 2;
    /// Control word 2, bits 12 to 15 the controller's sign of life.
    pub const STW2: u16 = 3;
    /// Status word 2, bits 12 to 15 the drive's sign of life.
    pub const ZSW2: u16 = 4;
    /// Speed setpoint A.
    pub const NSOLL_A: u16 = 5;
    /// Speed actual value A.
    pub const NIST_A: u16 = 6;
    /// Speed setpoint B.
    pub const NSOLL_B: u16 = 7;
    /// Speed actual value B.
    pub const NIST_B: u16 = 8;
    /// Control word of sensor 1.
    pub const G1_STW: u16 = 9;
    /// Status word of sensor 1.
    pub const G1_ZSW: u16 = 10;
    /// Position actual value 1 of sensor 1.
    pub const G1_XIST1: u16 = 11;
    /// Position actual value 2 of sensor 1, or an error code.
    pub const G1_XIST2: u16 = 12;
    /// Control word of sensor 2.
    pub const G2_STW: u16 = 13;
    /// Status word of sensor 2.
    pub const G2_ZSW: u16 = 14;
    /// Position actual value 1 of sensor 2.
    pub const G2_XIST1: u16 = 15;
    /// Position actual value 2 of sensor 2, or an error code.
    pub const G2_XIST2: u16 = 16;
    /// Control word of sensor 3.
    pub const G3_STW: u16 = 17;
    /// Status word of sensor 3.
    pub const G3_ZSW: u16 = 18;
    /// Position actual value 1 of sensor 3.
    pub const G3_XIST1: u16 = 19;
    /// Position actual value 2 of sensor 3, or an error code.
    pub const G3_XIST2: u16 = 20;
    /// Digital inputs.
    pub const E_DIGITAL: u16 = 21;
    /// Digital outputs.
    pub const A_DIGITAL: u16 = 22;
    /// Analog input.
    pub const E_ANALOG: u16 = 23;
    /// Analog output.
    pub const A_ANALOG: u16 = 24;
    /// Position deviation (dynamic servo control).
    pub const XERR: u16 = 25;
    /// Position controller gain (dynamic servo control).
    pub const KPC: u16 = 26;
    /// Position setpoint A.
    pub const XSOLL_A: u16 = 27;
    /// Position actual value A.
    pub const XIST_A: u16 = 28;
    /// Position setpoint B.
    pub const XSOLL_B: u16 = 29;
    /// Position actual value B.
    pub const XIST_B: u16 = 30;
    /// Traversing block selection, bit 15 selects MDI.
    pub const SATZANW: u16 = 32;
    /// Traversing block in progress.
    pub const AKTSATZ: u16 = 33;
    /// MDI target position.
    pub const MDI_TARPOS: u16 = 34;
    /// MDI velocity.
    pub const MDI_VELOCITY: u16 = 35;
    /// MDI acceleration.
    pub const MDI_ACC: u16 = 36;
    /// MDI deceleration.
    pub const MDI_DEC: u16 = 37;
    /// MDI mode, bit 0: 0 relative, 1 absolute.
    pub const MDI_MOD: u16 = 38;
    /// Position actual value 3 of sensor 1.
    pub const G1_XIST3: u16 = 39;
    /// Current actual value, absolute, smoothed.
    pub const IAIST_GLATT: u16 = 51;
    /// Torque-producing current, smoothed.
    pub const ITIST_GLATT: u16 = 52;
    /// Torque actual value, smoothed.
    pub const MIST_GLATT: u16 = 53;
    /// Active power, smoothed.
    pub const PIST_GLATT: u16 = 54;
    /// Speed actual value A, smoothed.
    pub const NIST_A_GLATT: u16 = 57;
    /// VIK-NAMUR message word.
    pub const MELD_NAMUR: u16 = 58;
    /// Control word 2 of an encoder.
    pub const STW2_ENC: u16 = 80;
    /// Status word 2 of an encoder.
    pub const ZSW2_ENC: u16 = 81;
    /// Signal numbers of this vendor.
    pub mod kollmorgen {
        /// Homing distance.
        pub const HOME_DIST: u16 = 100;
        /// Feed rate of motion tasks.
        pub const MT_FEEDRATE: u16 = 101;
        /// Current command.
        pub const IL_CMD_FIELDBUS: u16 = 102;
        /// Homing mode.
        pub const HOME_MODE: u16 = 103;
        /// Position error.
        pub const XIST_ERROR: u16 = 104;
        /// Motion status.
        pub const DRIVE_MOTION_STATUS: u16 = 105;
        /// Limit switches, hardware disable, controlled stop, STO.
        pub const DRIVE_INPUTS: u16 = 106;
        /// Reserved.
        pub const RESERVED_107: u16 = 107;
        /// Acceleration.
        pub const DRV_ACC: u16 = 108;
        /// Deceleration.
        pub const DRV_DEC: u16 = 109;
    }
    /// Signal numbers of this vendor.
    pub mod siemens {
        /// Torque reduction.
        pub const MOMRED: u16 = 101;
        /// Message word.
        pub const MELDW: u16 = 102;
        /// Fault number.
        pub const FAULT_CODE: u16 = 301;
        /// Warning number.
        pub const WARN_CODE: u16 = 303;
    }
    /// Signal numbers of this vendor.
    pub mod vacon {
        /// 32-bit process data in 6.
        pub const DW_PDI6: u16 = 137;
        /// 32-bit process data in 7.
        pub const DW_PDI7: u16 = 138;
        /// 32-bit process data in 8.
        pub const DW_PDI8: u16 = 139;
    }
}
