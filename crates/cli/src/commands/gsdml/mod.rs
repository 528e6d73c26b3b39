//! `profidrive gsdml export|show|check`: device descriptions.

mod check;
mod export;
mod show;

use std::path::Path;

use gsdml::Gsdml as Description;
use profidrive::device_description::{self, ReadError};

use crate::args::{Gsdml, GsdmlCommand};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::clean;

pub fn run(args: &Gsdml, output: &Output) -> Result<(), Failure> {
    match &args.what {
        GsdmlCommand::Export(args) => export::run(args, output),
        GsdmlCommand::Show(args) => show::run(args, output),
        GsdmlCommand::Check(args) => check::run(args, output),
    }
}

/// A description that can be used.
pub fn read(path: &Path) -> Result<Description, Failure> {
    device_description::read(path).map_err(|error| {
        let unusable = matches!(error, ReadError::Unusable { .. });
        let failure = Failure::new(error.kind(), clean(&error.to_string()));
        if !unusable {
            return failure;
        }
        failure.hint(format!(
            "`profidrive gsdml check {}` shows everything",
            path.display()
        ))
    })
}
