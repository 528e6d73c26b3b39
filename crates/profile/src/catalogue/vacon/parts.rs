// Generated from data/vacon/parts.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::{Part, PartRow};

#[rustfmt::skip]
pub static PARTS: &[PartRow] = &[
    PartRow { part: Part::ControlWord, pnu: 10001, base: Some(2001), values: &[] },
    PartRow { part: Part::StatusWord, pnu: 10001, base: Some(2101), values: &[] },
    PartRow { part: Part::SpeedSetpoint, pnu: 10001, base: Some(2003), values: &[] },
    PartRow { part: Part::SpeedActual, pnu: 10001, base: Some(2103), values: &[] },
    PartRow { part: Part::Speed, pnu: 10001, base: Some(2), values: &[] },
    PartRow { part: Part::Frequency, pnu: 10001, base: Some(1), values: &[] },
    PartRow { part: Part::BusVoltage, pnu: 10001, base: Some(7), values: &[] },
    PartRow { part: Part::Current, pnu: 10001, base: Some(3), values: &[] },
    PartRow { part: Part::RampUpTime, pnu: 10001, base: Some(103), values: &[] },
    PartRow { part: Part::RampDownTime, pnu: 10001, base: Some(104), values: &[] },
    PartRow { part: Part::LowestReference, pnu: 10001, base: Some(101), values: &[] },
    PartRow { part: Part::Jog1, pnu: 10001, base: Some(124), values: &[] },
    PartRow { part: Part::Jog2, pnu: 10001, base: Some(124), values: &[] },
    PartRow { part: Part::Reference, pnu: 10001, base: Some(102), values: &[] },
    PartRow { part: Part::MotorFrequency, pnu: 10001, base: Some(111), values: &[] },
    PartRow { part: Part::MotorSpeed, pnu: 10001, base: Some(112), values: &[] },
    PartRow { part: Part::LostController, pnu: 10001, base: Some(733), values: &[3, 2] },
    PartRow { part: Part::LossStopFunction, pnu: 10001, base: Some(733), values: &[2] },
    PartRow { part: Part::LossCoast, pnu: 10001, base: Some(733), values: &[3] },
    PartRow { part: Part::StopFunction, pnu: 10001, base: Some(506), values: &[1] },
    PartRow { part: Part::ControlSite, pnu: 10001, base: Some(172), values: &[0] },
    PartRow { part: Part::Page, pnu: 964, base: None, values: &[] },
    PartRow { part: Part::Page, pnu: 965, base: None, values: &[] },
    PartRow { part: Part::Page, pnu: 975, base: None, values: &[] },
    PartRow { part: Part::Page, pnu: 922, base: None, values: &[] },
    PartRow { part: Part::Page, pnu: 930, base: None, values: &[] },
    PartRow { part: Part::Page, pnu: 10001, base: Some(2001), values: &[] },
    PartRow { part: Part::Page, pnu: 10001, base: Some(2101), values: &[] },
    PartRow { part: Part::Page, pnu: 10001, base: Some(37), values: &[] },
    PartRow { part: Part::Page, pnu: 944, base: None, values: &[] },
];
