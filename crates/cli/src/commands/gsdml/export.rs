//! `profidrive gsdml export --model akd -o DIR`

use client::ErrorKind;
use network::files::StateFile;
use plant::host::interval;
use profidrive::report::GsdmlExportReport;
use virtual_drive::description::export::export_with;

use crate::args::GsdmlExport;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &GsdmlExport, output: &Output) -> Result<(), Failure> {
    let exported = export_with(args.model, args.min_cycle.map(interval).transpose()?);
    let mut files = vec![(
        exported.file_name.to_string(),
        exported.description.to_xml().into_bytes(),
    )];
    files.extend(exported.pictures);
    let mut written = Vec::new();
    for (name, content) in files {
        let path = args.output.join(name);
        StateFile::document(&path)
            .replace(&content)
            .map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?;
        if !output.json() {
            output.line(&path.display().to_string());
        }
        written.push(path.display().to_string());
    }
    output.json_report(&GsdmlExportReport { files: written });
    if !output.json() {
        output.say("install the .xml in the engineering tool; the drive is in its catalogue under drives");
    }
    Ok(())
}
