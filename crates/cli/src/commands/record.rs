//! `profidrive record`

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use client::Wait;
use profidrive::lasting;
use profidrive::recording::{
    Every, Form, Mark, PlotError, Recording, RecordingError, RecordingFile, Request, Scope, Source, html,
    prepare, svg,
};
use profidrive::report::{RecordReport, RecordTrigger};

use super::axis;
use super::each::{self, Row as OfDrive};
use super::record_rows::{Place, Taken};
use super::remark;
use crate::args::{self, Record, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::live_plot::LivePlot;
use crate::output::Output;
use crate::render::table::Table as TextTable;

/// What the second signal does to a recording.
const CLOSES_NOW: &str =
    "second signal: the connections are closed now; a third one ends this program at once";

pub fn run(args: &Record, target: &Target, output: &Output) -> Result<(), Failure> {
    let request = request(args)?;
    let form = args.output.as_deref().map(form).transpose()?;
    check(args, form, output)?;
    let need = match request.every {
        Every::Interval(_) => Need::Records,
        Every::Cycle { .. } => Need::Cyclic,
    };
    let (mut session, found) = connect::drives_with(target, need, CLOSES_NOW, output)?;
    let names: Vec<&str> = found.members.iter().map(|member| member.name.as_str()).collect();
    if need == Need::Cyclic {
        output.say(&format!(
            "opens the cyclic connection of {}; it commands nothing, and no controller can connect as long as it lasts",
            profidrive::listed(&names)
        ));
    }
    let (sources, left_out) = ready(prepare(&session, found.members, &request).wait(), output)?;
    let cyclic: Vec<Option<(Duration, u16)>> = sources.iter().map(Source::cyclic).collect();
    let mut recording = Recording::begin(&session, session.wall_clock(), sources, &request)?;
    output.say(&beginning(&recording, args, &request));
    // the terminal first: a file that is created stays
    let live = args
        .live
        .then(|| LivePlot::begin(recording.table(), recording.stop_handle()))
        .transpose()?;
    let place = match args.output.as_deref().zip(form) {
        Some((file, Some(form))) => {
            let file = RecordingFile::create(recording.table(), file, form, args.rotate)?;
            Place::File(Box::new(file))
        }
        Some((_, None)) => Place::printed(recording.table(), output)?,
        None => Place::Nowhere,
    };
    let mut taken = Taken {
        place,
        scope: args.plot.as_ref().map(|_| Scope::new(recording.table())),
        live,
        remarks: Vec::new(),
        output,
    };
    let result = taken.record(&mut recording).wait();
    let (place, scope) = taken.end();
    let closed = session.close().wait();
    let mut report = RecordReport {
        written: place.rows(),
        ..RecordReport::of(&recording, &cyclic, place.files())
    };
    let drawn = match args.plot.as_ref().zip(scope) {
        Some((file, scope)) => {
            let marks: Vec<Mark> = report.trigger.iter().map(mark).collect();
            let drawn = draw(file, &target.drive, &scope, &marks);
            report.plot = drawn.is_ok().then(|| file.display().to_string());
            drawn
        }
        None => Ok(()),
    };
    output.json_report(&report);
    if !output.json() {
        let began = recording.check_triggered().is_ok();
        show(&report, !matches!(place, Place::Printed(..)), began, output);
    }
    for remark in report.remarks() {
        remark::print(&remark, "", output);
    }
    each::last(result?, output)?;
    drawn?;
    closed?;
    recording.check_triggered()?;
    left_out
}

/// What is wrong with files and output is found before drives are connected.
fn check(args: &Record, form: Option<Option<Form>>, output: &Output) -> Result<(), Failure> {
    if let Some((file, form)) = args.output.as_deref().zip(form.flatten()) {
        RecordingFile::check(file, form, args.rotate)?;
    }
    args.plot.as_deref().map(check_plot).transpose()?;
    let prints = form == Some(None);
    if prints && output.json() {
        return Err(Failure::usage(
            "`-o -` prints CSV, --json a document: write the rows to a file",
        ));
    }
    if prints && args.live {
        return Err(Failure::usage(
            "`-o -` prints CSV, --live draws on the terminal: write the rows to a file",
        ));
    }
    if args.live {
        LivePlot::check(output)
    } else {
        Ok(())
    }
}

fn request(args: &Record) -> Result<Request, Failure> {
    let control = axis::control(&args.cyclic)?;
    let every = match args.every {
        args::Every::Interval(interval) => Every::Interval(interval),
        args::Every::Cycle => Every::Cycle {
            cycle: control.cycle,
            watchdog: control.watchdog,
        },
    };
    if matches!(every, Every::Interval(_)) && (control.cycle.is_some() || control.watchdog.is_some()) {
        return Err(Failure::usage(
            "--cycle and --watchdog are for `--every cycle`: parameters are read without a cyclic connection",
        ));
    }
    let request = Request {
        time: args.time,
        trigger: args.trigger.clone(),
        pre: args.pre.unwrap_or_default(),
        ..Request::new(args.signals.iter().cloned(), every)
    };
    request.check()?;
    Ok(request)
}

fn mark(trigger: &RecordTrigger) -> Mark {
    Mark {
        time: trigger.time,
        text: format!("{} of {}", trigger.condition, trigger.drive),
    }
}

/// How a plot is drawn.
type Drawing = fn(&str, &Scope, &[Mark]) -> Result<String, PlotError>;

/// Checks that a plot can be drawn to a file: its kind is known, and it does not exist.
pub fn check_plot(file: &Path) -> Result<(), Failure> {
    drawing(file)?;
    if file.exists() {
        return Err(exists(file));
    }
    Ok(())
}

fn exists(file: &Path) -> Failure {
    Failure::new(
        client::ErrorKind::Local,
        format!("`{}` exists already", file.display()),
    )
    .hint("choose another name: plots are not replaced")
}

/// Returns how a file with this name is drawn.
fn drawing(file: &Path) -> Result<Drawing, Failure> {
    match file.extension().and_then(std::ffi::OsStr::to_str) {
        Some("svg") => Ok(svg),
        Some("html") => Ok(html),
        _ => Err(Failure::usage(format!(
            "--plot {}: unknown file extension; use .svg or .html",
            file.display()
        ))),
    }
}

/// Draws curves to a new file.
pub fn draw(file: &Path, title: &str, scope: &Scope, marks: &[Mark]) -> Result<(), Failure> {
    let local = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => exists(file),
        _ => Failure::new(
            client::ErrorKind::Local,
            format!("cannot write {}: {error}", file.display()),
        ),
    };
    let plot = drawing(file)?(title, scope, marks)?;
    let mut new = std::fs::File::create_new(file).map_err(local)?;
    new.write_all(plot.as_bytes()).map_err(local)
}

/// The form of the file; `None` for CSV that is printed.
pub fn form(file: &Path) -> Result<Option<Form>, Failure> {
    if file == Path::new("-") {
        return Ok(None);
    }
    Form::of(file).map(Some).ok_or_else(|| {
        let ends: Vec<String> = Form::ends().map(|end| format!(".{end}")).collect();
        let message = format!(
            "{}: unknown file extension; use {}",
            file.display(),
            ends.join(", ")
        );
        Failure::usage(message)
    })
}

/// Returns the drives that are ready, and how the command ends for those that do not answer. Nothing is recorded where one has
/// another problem, or none answers.
fn ready(
    members: Vec<profidrive::fleet::Member<Result<Source, RecordingError>>>,
    output: &Output,
) -> Result<(Vec<Source>, Result<(), Failure>), Failure> {
    let only = members.len() == 1;
    let rows = members.into_iter();
    let rows: Vec<OfDrive<Source>> = rows
        .map(|member| OfDrive::new(member, |_, _| Vec::new()))
        .collect();
    if only && let Some(problem) = rows.first().and_then(|row| row.problems.first()) {
        return Err(problem.clone());
    }
    let mut problems = rows.iter().flat_map(|row| &row.problems);
    let silent = problems.all(|problem| each::is_silence(problem.kind));
    let ended = each::ended(&rows, None, output);
    let sources: Vec<Source> = rows.into_iter().filter_map(|row| row.done).collect();
    match ended {
        Err(failure) if !silent || sources.is_empty() => Err(failure),
        ended => Ok((sources, ended)),
    }
}

fn beginning(recording: &Recording, args: &Record, request: &Request) -> String {
    let table = recording.table();
    let names: Vec<&str> = table.drives.iter().map(String::as_str).collect();
    let signals = match table.columns.len() {
        1 => "1 signal".to_owned(),
        count => format!("{count} signals"),
    };
    let wait = request
        .trigger
        .as_ref()
        .map_or_else(String::new, |trigger| format!("; waits for: {trigger}"));
    let file = args.output.as_deref().filter(|file| *file != Path::new("-"));
    let to = file.map_or_else(String::new, |file| format!(" to {}", file.display()));
    let end = if request.time.is_none() {
        "; Ctrl-C ends"
    } else {
        ""
    };
    format!(
        "records {signals} of {}{to}{wait}{end}",
        profidrive::listed(&names)
    )
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        match error {
            RecordingError::Drive(error) => error.into(),
            other => Self::explained(&other),
        }
    }
}

/// Shows what was recorded; beside rows that are printed, to the person only. A recording that never began has gaps alone.
fn show(report: &RecordReport, to_file: bool, began: bool, output: &Output) {
    let mut table = TextTable::new(&["drive", "rows", "gaps", "missed", "outages"]);
    for drive in &report.drives {
        table.row([
            drive.drive.clone(),
            drive.rows.to_string(),
            drive.gaps.to_string(),
            drive.missed.to_string(),
            drive.outages.to_string(),
        ]);
    }
    let time = lasting(Duration::try_from_secs_f64(report.time).unwrap_or_default());
    if to_file {
        output.table(&table);
    } else {
        table.lines().iter().for_each(|line| output.say(line));
        if began {
            output.say(&format!("{time} recorded"));
        }
    }
    if !began {
        return;
    }
    let all = report.rows + report.gaps;
    if let Some(written) = report.written.filter(|written| *written < all) {
        output.warn(&format!("only {written} of these {all} rows could be written"));
    }
    if !report.files.is_empty() {
        output.say(&format!("{time} recorded to {}", report.files.join(", ")));
    }
}
