// Generated from data/vacon/parts.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::{Part, PartRow};

#[rustfmt::skip]
pub static PARTS: &[PartRow] = &[
    PartRow { part: Part::ControlWord, pnu: 10001, base: Some(2001) },
    PartRow { part: Part::StatusWord, pnu: 10001, base: Some(2101) },
    PartRow { part: Part::SpeedSetpoint, pnu: 10001, base: Some(2003) },
    PartRow { part: Part::SpeedActual, pnu: 10001, base: Some(2103) },
    PartRow { part: Part::Speed, pnu: 10001, base: Some(2) },
    PartRow { part: Part::Frequency, pnu: 10001, base: Some(1) },
    PartRow { part: Part::BusVoltage, pnu: 10001, base: Some(7) },
    PartRow { part: Part::Current, pnu: 10001, base: Some(3) },
    PartRow { part: Part::RampUpTime, pnu: 10001, base: Some(103) },
    PartRow { part: Part::RampDownTime, pnu: 10001, base: Some(104) },
    PartRow { part: Part::LowestReference, pnu: 10001, base: Some(101) },
    PartRow { part: Part::Jog1, pnu: 10001, base: Some(124) },
    PartRow { part: Part::Jog2, pnu: 10001, base: Some(124) },
    PartRow { part: Part::Reference, pnu: 10001, base: Some(102) },
    PartRow { part: Part::MotorFrequency, pnu: 10001, base: Some(111) },
    PartRow { part: Part::MotorSpeed, pnu: 10001, base: Some(112) },
    PartRow { part: Part::Page, pnu: 964, base: None },
    PartRow { part: Part::Page, pnu: 965, base: None },
    PartRow { part: Part::Page, pnu: 975, base: None },
    PartRow { part: Part::Page, pnu: 922, base: None },
    PartRow { part: Part::Page, pnu: 930, base: None },
    PartRow { part: Part::Page, pnu: 10001, base: Some(2001) },
    PartRow { part: Part::Page, pnu: 10001, base: Some(2101) },
    PartRow { part: Part::Page, pnu: 10001, base: Some(37) },
    PartRow { part: Part::Page, pnu: 944, base: None },
];
