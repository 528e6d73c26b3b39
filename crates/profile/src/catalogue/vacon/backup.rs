// Generated from data/vacon/backup.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::{BackupRule, Phase, Role};

#[rustfmt::skip]
pub static BACKUP: &[BackupRule] = &[
    BackupRule { pnu: 915, base: None, role: Role::Network, phase: Phase::Value, why: "the controller and its telegram decide it" },
    BackupRule { pnu: 916, base: None, role: Role::Network, phase: Phase::Value, why: "the controller and its telegram decide it" },
    BackupRule { pnu: 10001, base: Some(101), role: Role::Setting, phase: Phase::Scaling, why: "" },
    BackupRule { pnu: 10001, base: Some(102), role: Role::Setting, phase: Phase::Scaling, why: "" },
    BackupRule { pnu: 10001, base: Some(107), role: Role::Setting, phase: Phase::Limit, why: "" },
    BackupRule { pnu: 10001, base: Some(110), role: Role::Setting, phase: Phase::Motor, why: "" },
    BackupRule { pnu: 10001, base: Some(111), role: Role::Setting, phase: Phase::Motor, why: "" },
    BackupRule { pnu: 10001, base: Some(112), role: Role::Setting, phase: Phase::Motor, why: "" },
    BackupRule { pnu: 10001, base: Some(113), role: Role::Setting, phase: Phase::Motor, why: "" },
    BackupRule { pnu: 10001, base: Some(116), role: Role::Setting, phase: Phase::Motor, why: "" },
    BackupRule { pnu: 10001, base: Some(120), role: Role::Setting, phase: Phase::Motor, why: "" },
    BackupRule { pnu: 10001, base: Some(172), role: Role::Network, phase: Phase::Mode, why: "where the control word comes from" },
    BackupRule { pnu: 10001, base: Some(600), role: Role::Setting, phase: Phase::Mode, why: "" },
    BackupRule { pnu: 10001, base: Some(631), role: Role::Action, phase: Phase::Value, why: "it measures the motor" },
    BackupRule { pnu: 10001, base: Some(2001), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2002), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2003), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2004), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2005), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2006), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2007), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2008), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2009), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2010), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10001, base: Some(2011), role: Role::Setpoint, phase: Phase::Value, why: "" },
    BackupRule { pnu: 10122, base: None, role: Role::Setpoint, phase: Phase::Value, why: "" },
];
