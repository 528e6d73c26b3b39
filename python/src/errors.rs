//! Errors of the library as exceptions of `profidrive.errors`.

use ::plant::WorldError;
use client::{Error, ErrorKind};
use profidrive::Explained;
use profile::value::ParameterProblem;
use pyo3::prelude::*;
use serde_json::{Value, json};

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

    /// Returns the error with attributes.
    pub fn with(mut self, fields: Value) -> Self {
        self.fields = fields;
        self
    }
}

/// An error of the library.
pub fn explained(error: &dyn Explained) -> Failure {
    let advice = error.advice();
    Failure {
        hint: (!advice.is_empty()).then(|| advice.to_string()),
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

/// An error of a client about a parameter, with the numbers of a refusal.
pub fn of_parameter(error: &Error, drive: &str) -> Failure {
    let failure = explained(error);
    match error {
        Error::Refused { refusal, .. } => failure.with(json!({
            "drive": drive,
            "parameter": refusal.shown.to_string(),
            "pnu": refusal.shown.pnu,
            "index": refusal.shown.index,
            "number": refusal.received(),
            "text": refusal.words(),
        })),
        Error::Parameter(ParameterProblem::Unknown { nearest, .. }) => failure
            .of_class("UnknownParameter")
            .with(json!({ "drive": drive, "nearest": nearest })),
        _ => failure.with(json!({ "drive": drive })),
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        let class = failure.class.unwrap_or_default();
        let Failure {
            kind,
            message,
            hint,
            fields,
            ..
        } = failure;
        Python::attach(|py| {
            let made = py
                .import("profidrive.errors")
                .and_then(|errors| errors.getattr("_made"))
                .and_then(|made| made.call1((kind.id(), class, message, hint, fields.to_string())));
            made.map_or_else(|error| error, Self::from_value)
        })
    }
}
