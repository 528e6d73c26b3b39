//! `profidrive step`

use std::path::Path;

use client::Wait;
use client::axis::SpeedUnit;
use profidrive::motion::{self, Response, StepPoint, Stepped};
use profidrive::recording::{OverlayError, RecordingFile, Sink, of_samples, overlay, read_step, response_of};
use profidrive::report::{Quantity, StepReport};

use super::axis;
use super::record::{draw, drawing, form};
use crate::args::{Step, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;

pub fn run(args: &Step, target: &Target, output: &Output) -> Result<(), Failure> {
    let wanted = wanted(args)?;
    let form = args.output.as_deref().map(form).transpose()?;
    if form == Some(None) {
        return Err(Failure::usage("-o -: a step is written to a file"));
    }
    args.plot.as_deref().map(drawing).transpose()?;
    if let Some(file) = args.output.as_deref().filter(|file| file.exists()) {
        let message = format!("{} exists already", file.display());
        return Err(Failure::usage(message).hint("choose another name: recordings are not replaced"));
    }
    // what cannot be compared with is found before anything moves
    let before = args.before.as_deref().map(read_step).transpose()?;
    let unit = wanted.run.unit.symbol();
    let mut file = None;
    let stepped = axis::with_drive(target, Need::Cyclic, output, |session, drive| {
        let observer = axis::observer(&drive.label(), output);
        let stepped = motion::step(session, drive, &wanted, &observer).wait()?;
        if let Some((path, form)) = args.output.as_deref().zip(form.flatten()) {
            let time = (session.wall_clock(), session.now());
            let (signals, samples) = (&stepped.signals, &stepped.samples);
            let (table, rows) = of_samples(&stepped.drive, signals, samples, stepped.cycle, time);
            let write = || {
                let mut file = RecordingFile::create(&table, path, form, None)?;
                rows.iter().try_for_each(|row| file.write(row))?;
                file.finish()
            };
            file = Some((path, write()));
        }
        Ok(stepped)
    })?;
    let points = stepped.points();
    let drawn = args
        .plot
        .as_deref()
        .map(|plot| (plot, plot_of(plot, &points, before.as_deref(), unit, &stepped)));
    let report = StepReport {
        drive: stepped.drive.clone(),
        from: Quantity::speed(wanted.from, wanted.run.unit),
        to: Quantity::speed(wanted.run.speed, wanted.run.unit),
        cycle: stepped.cycle.as_secs_f64(),
        samples: stepped.samples.len(),
        dropped: stepped.dropped,
        response: stepped.response,
        before: before
            .as_deref()
            .and_then(|points| response_of(points, wanted.band)),
        file: written(file.as_ref()),
        plot: written(drawn.as_ref()),
    };
    output.json_report(&report);
    if !output.json() {
        show(&report, unit, output);
    }
    if let Some((_, result)) = file {
        result?;
    }
    drawn.map_or(Ok(()), |(_, result)| result)
}

/// The name of a file that was written.
fn written<E>(file: Option<&(&Path, Result<(), E>)>) -> Option<String> {
    let (file, _) = file.filter(|(_, result)| result.is_ok())?;
    Some(file.display().to_string())
}

fn plot_of(
    file: &Path,
    points: &[StepPoint],
    before: Option<&[StepPoint]>,
    unit: &str,
    stepped: &Stepped,
) -> Result<(), Failure> {
    let mut steps = Vec::new();
    if let Some(before) = before {
        steps.push(("before:", before));
    }
    steps.push((stepped.drive.as_str(), points));
    draw(
        file,
        &format!("step of {}", stepped.drive),
        &overlay(&steps, unit),
        &[],
    )
}

/// The requested step, in one unit.
fn wanted(args: &Step) -> Result<motion::Step, Failure> {
    let (from, to) = &args.velocity;
    let percent = [from, to].iter().any(|speed| speed.unit.as_deref() == Some("%"));
    let unit = if percent {
        SpeedUnit::Percent
    } else {
        SpeedUnit::Rpm
    };
    let speed = |quantity, what| axis::in_unit(quantity, unit.symbol(), what);
    let to = speed(to, "--velocity")?;
    let usual = match unit {
        SpeedUnit::Rpm => motion::Run::at(to),
        SpeedUnit::Percent => motion::Run::at_percent(to),
    };
    let limit = args
        .limit
        .as_ref()
        .map(|limit| speed(limit, "--limit"))
        .transpose()?;
    let wanted = motion::Step {
        from: speed(from, "--velocity")?,
        run: motion::Run {
            limit: limit.map_or(usual.limit, f64::abs),
            time: Some(args.time),
            control: axis::in_mode(&args.control)?,
            ..usual
        },
        band: axis::in_unit(&args.band, "%", "--band")? / 100.0,
    };
    wanted.check()?;
    Ok(wanted)
}

impl From<OverlayError> for Failure {
    fn from(error: OverlayError) -> Self {
        Self::explained(&error).hint("`profidrive step DRIVE .. -o FILE.csv` records one")
    }
}

fn show(report: &StepReport, unit: &str, output: &Output) {
    let Some(response) = &report.response else {
        output.warn("no figures: the telegram carries no speed, or no sample of the step arrived");
        return;
    };
    let mut head = vec!["", "step"];
    if report.before.is_some() {
        head.push("before");
    }
    let mut table = Table::new(&head);
    for name in FIGURES {
        let columns = [Some(response), report.before.as_ref()].into_iter().flatten();
        let values = columns.map(|one| figure(name, one, unit));
        let title = match name {
            "settled" => format!("settled within {} %", response.band),
            name => name.to_owned(),
        };
        table.row(std::iter::once(title).chain(values));
    }
    output.table(&table);
}

const FIGURES: [&str; 5] = [
    "rise time, 10 % to 90 %",
    "overshoot",
    "settled",
    "greatest following error",
    "steady error",
];

/// Returns one of the [`FIGURES`] in words.
fn figure(name: &str, of: &Response, unit: &str) -> String {
    let seconds =
        |time: Option<f64>| time.map_or_else(|| "not reached".to_owned(), |time| format!("{time:.3} s"));
    match name {
        "overshoot" => format!("{:.1} %", of.overshoot),
        "settled" => seconds(of.settling_time),
        "greatest following error" => format!("{:.1} {unit}", of.following_error),
        "steady error" => format!("{:.2} {unit}", of.steady_error),
        _ => seconds(of.rise_time),
    }
}
