//! `profidrive bundle [DRIVE] -o FILE` and `profidrive report [DRIVE] -o FILE`

use client::Wait;
use profidrive::documents::bundle::{self, Contents};
use profidrive::documents::{NewFile, page};
use profidrive::report::{BundleReport, BundledDrive, PageReport};
use profidrive::{Outcome, listed};

use crate::advice::Commands;
use crate::args::{Bundle, Report, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;

pub fn bundle(args: &Bundle, target: &Target, output: &Output) -> Result<(), Failure> {
    let file = NewFile::at(&args.output)?;
    let selector = connect::selector(target, output)?;
    let opening = connect::unopened(target, Need::Identity)?;
    let contents = Contents {
        capture: args.capture,
        state: profidrive::state_folder(),
        files: args.add.clone(),
    };
    let mut steps = connect::steps(output);
    let mut progress = |step| steps.show(&step);
    let wording = Commands::any();
    let written = bundle::bundle(&opening, &selector, &contents, &file, &wording, &mut progress).wait();
    drop(steps);
    let written = written?;
    output.report(&written);
    ended(written.outcome(), &written.drives)
}

pub fn report(args: &Report, target: &Target, output: &Output) -> Result<(), Failure> {
    let file = NewFile::at(&args.output)?;
    let machine = connect::machine(&target.options, output)?;
    let selector = connect::selector(target, output)?;
    let (opening, mut network) = connect::network(target, &selector, Need::Identity, output)?;
    let mut steps = connect::steps(output);
    let mut progress = |step| steps.show(&step);
    let about = (&selector, machine.as_ref());
    let written = page::page(
        &opening,
        &mut network,
        about,
        &file,
        &Commands::any(),
        &mut progress,
    )
    .wait();
    drop(steps);
    let closed = network.close().wait();
    let written = written?;
    output.report(&written);
    ended(written.outcome(), &written.drives)?;
    Ok(closed?)
}

/// Returns how the command ends: with an error where nothing was read of a drive.
fn ended(outcome: Outcome, drives: &[BundledDrive]) -> Result<(), Failure> {
    let Some(kind) = outcome.kind() else {
        return Ok(());
    };
    let silent = drives.iter().filter(|drive| !drive.read);
    let silent: Vec<&str> = silent.map(|drive| drive.drive.as_str()).collect();
    let message = match silent.len() {
        0 => "no drive answered".to_owned(),
        count => format!(
            "nothing was read of {} ({count} of {})",
            listed(&silent),
            drives.len()
        ),
    };
    Err(Failure::new(kind, message).hint("{scan} lists who answers"))
}

/// `3 of 7 drives read`
fn read_of(drives: &[BundledDrive]) -> String {
    let read = drives.iter().filter(|drive| drive.read).count();
    let plural = if drives.len() == 1 { "" } else { "s" };
    format!("{read} of {} drive{plural} read", drives.len())
}

impl Page for BundleReport {
    fn print(&self, output: &Output) {
        output.line(&format!(
            "{}: {}, {} files, {} octets",
            self.file,
            read_of(&self.drives),
            self.files.len(),
            self.size
        ));
        missing(&self.drives, output);
        for note in &self.notes {
            output.warn(note);
        }
    }
}

impl Page for PageReport {
    fn print(&self, output: &Output) {
        output.line(&format!(
            "{}: {}, {} octets",
            self.file,
            read_of(&self.drives),
            self.size
        ));
        missing(&self.drives, output);
    }
}

fn missing(drives: &[BundledDrive], output: &Output) {
    for drive in drives {
        for missing in &drive.missing {
            output.warn(&format!("{}: {missing}", drive.drive));
        }
    }
}
