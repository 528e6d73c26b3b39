//! `profidrive gsdml export --model akd -o DIR`

use client::ErrorKind;
use plant::host::interval;
use profidrive::device_description::export;

use crate::args::GsdmlExport;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &GsdmlExport, output: &Output) -> Result<(), Failure> {
    let fastest = args.min_cycle.map(interval).transpose()?;
    let written = export(args.model, fastest, &args.output);
    let written = written.map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?;
    output.json_report(&written);
    if !output.json() {
        for file in &written.files {
            output.line(file);
        }
        output.say("install the .xml in the engineering tool; the drive is in its catalogue under drives");
    }
    Ok(())
}
