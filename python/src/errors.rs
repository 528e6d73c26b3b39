//! Errors of the library as exceptions of `profidrive.errors`.

use ::plant::WorldError;
use client::{Error, ErrorKind, LossAction, Rule};
use network::system::Error as SystemError;
use profidrive::motion::MotionError;
use profidrive::report::{Fault, Quantity, Wording as _};
use profidrive::{DriveError, Explained, OpenError};
use profile::value::ParameterProblem;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::time::seconds;
use crate::words::Calls;

/// An error on its way to Python.
#[derive(Debug)]
pub struct Failure {
    /// Decides the class.
    kind: ErrorKind,
    /// A class below that of the kind.
    class: Option<&'static str>,
    message: String,
    hint: Option<String>,
    /// Attributes of the exception, a JSON object.
    fields: Value,
}

impl Failure {
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            class: None,
            message: message.into(),
            hint: None,
            fields: json!({}),
        }
    }

    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, message)
    }

    /// The kind of the error.
    pub const fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// An error of this binding.
    pub fn internal(error: &dyn std::fmt::Display) -> Self {
        Self::new(ErrorKind::Internal, error.to_string())
    }

    /// Returns the error with a class below that of its kind.
    pub const fn of_class(mut self, class: &'static str) -> Self {
        self.class = Some(class);
        self
    }

    /// Returns the error with another kind, where there is one.
    pub fn of_kind(mut self, kind: Option<ErrorKind>) -> Self {
        self.kind = kind.unwrap_or(self.kind);
        self
    }

    /// Returns the error with more attributes. One that is null stays as its class has it.
    pub fn with(mut self, fields: Value) -> Self {
        if let (Value::Object(own), Value::Object(more)) = (&mut self.fields, fields) {
            own.extend(more.into_iter().filter(|(_, value)| !value.is_null()));
        }
        self
    }

    /// Returns what `profidrive.errors._made` makes the exception of.
    pub fn parts(&self) -> (&'static str, &str, &str, Option<&str>, String) {
        let class = self.class.unwrap_or_default();
        let hint = self.hint.as_deref();
        (
            self.kind.id(),
            class,
            &self.message,
            hint,
            self.fields.to_string(),
        )
    }

    /// Returns the error with what to do about it.
    pub fn hinted(self, hint: &str) -> Self {
        Self {
            hint: Some(hint.to_owned()),
            ..self
        }
    }

    /// Returns the error with the drive that it is about.
    pub fn about(self, drive: &str) -> Self {
        self.with(json!({ "drive": drive }))
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

/// An error of the library.
pub fn explained(error: &dyn Explained) -> Failure {
    let advice = error.advice();
    Failure {
        hint: (!advice.is_empty()).then(|| Calls.advice(&advice)),
        ..Failure::new(error.kind(), error.message())
    }
}

/// An error of a plant that runs, with the numbers of a refusal.
pub fn of_world(error: &WorldError) -> Failure {
    let failure = explained(error);
    match error {
        WorldError::Refused {
            drive,
            parameter,
            error,
        } => failure.with(json!({
            "drive": drive,
            "parameter": parameter,
            "number": error.0,
            "text": error.to_string(),
        })),
        WorldError::Parameter {
            drive,
            problem: ParameterProblem::Unknown { nearest, .. },
        } => failure
            .of_class("UnknownParameter")
            .with(json!({ "drive": drive, "nearest": nearest })),
        WorldError::Parameter { drive, .. }
        | WorldError::NoDrive { drive }
        | WorldError::Unreadable { drive, .. } => failure.with(json!({ "drive": drive })),
        _ => failure,
    }
}

/// An error of a client: its rule, the numbers of a refusal, what a drive does without its controller.
pub fn of_client(error: &Error) -> Failure {
    let failure = explained(error).with(json!({
        "rule": error.rule().map(Rule::id),
        "owner": error.owner(),
    }));
    match error {
        Error::Closed => closed("the network is closed"),
        Error::Timeout { drive, .. } => failure.of_class("DriveTimeout").about(drive),
        Error::Refused { drive, refusal } => failure.about(drive).with(json!({
            "parameter": refusal.shown.to_string(),
            "pnu": refusal.shown.pnu,
            "index": refusal.shown.index,
            "number": refusal.received(),
            "text": refusal.words(),
        })),
        Error::Parameter(ParameterProblem::Unknown { nearest, .. }) => failure
            .of_class("UnknownParameter")
            .with(json!({ "nearest": nearest })),
        Error::ConnectionLost { drive, .. }
        | Error::CarrierLost { drive, .. }
        | Error::LineSilent { drive, .. } => match error.loss_reaction() {
            Some(reaction) => failure.about(drive).with(json!({
                "after": reaction.after.map(seconds),
                "drive_continues": continues(reaction.action),
            })),
            None => failure.about(drive),
        },
        Error::SpeedNotReached {
            drive,
            wanted,
            highest,
            unit,
            ..
        } => failure.about(drive).with(json!({
            "target": Quantity::new(*wanted, *unit),
            "actual": highest.map(|speed| Quantity::new(speed, *unit)),
        })),
        Error::Held { error, .. } => Failure {
            fields: of_client(error).fields,
            ..failure
        },
        _ => failure,
    }
}

/// `None` where it is not known.
const fn continues(action: LossAction) -> Option<bool> {
    match action {
        LossAction::KeepsTurning => Some(true),
        LossAction::Unknown => None,
        _ => Some(false),
    }
}

/// An error of a motion, with what the motion was like and with the first fault of the drive.
pub fn of_motion(error: &MotionError) -> Failure {
    let inner = error.client().map(of_client);
    let mut failure = explained(error);
    if let Some(inner) = inner {
        failure = Failure {
            class: inner.class,
            ..failure.with(inner.fields)
        };
    }
    if let Some(rule) = error.rule() {
        failure = failure.with(json!({ "rule": rule.id() }));
    }
    if let Some(fault) = error.faults().first() {
        failure = failure.with(json!({ "fault": Fault::from(fault) }));
    }
    if let Some(report) = error.report() {
        failure = failure.with(json!({ "motion": report }));
    }
    failure
}

/// An error of a drive that is not found.
pub fn of_drive(error: &DriveError) -> Failure {
    match error {
        DriveError::Client(error) => of_client(error),
        DriveError::Open(error) => of_open(error),
        other => explained(other),
    }
}

/// An error of a network that cannot be opened.
pub fn of_open(error: &OpenError) -> Failure {
    let failure = explained(error);
    match error {
        OpenError::Network(SystemError::NoPermission { .. }) => failure.of_class("PermissionMissing"),
        _ => failure,
    }
}

/// An object that cannot be used any more, or not from there.
pub fn closed(message: &str) -> Failure {
    Failure::usage(message).of_class("MisuseError")
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        Python::attach(|py| {
            let made = py
                .import("profidrive.errors")
                .and_then(|errors| errors.getattr("_made"))
                .and_then(|made| made.call1(failure.parts()));
            made.map_or_else(|error| error, Self::from_value)
        })
    }
}
