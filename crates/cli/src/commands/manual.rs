//! `profidrive manual FOLDER`, for packages: one page for each command.

use client::ErrorKind;

use crate::args::{self, Manual};
use crate::failure::Failure;

pub fn run(args: &Manual) -> Result<(), Failure> {
    std::fs::create_dir_all(&args.folder)
        .and_then(|()| clap_mangen::generate_to(args::command(), &args.folder))
        .map_err(|error| {
            let folder = args.folder.display();
            Failure::new(
                ErrorKind::Local,
                format!("cannot write the manual pages to {folder}: {error}"),
            )
        })
}
