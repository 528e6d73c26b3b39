//! `profidrive explain 0x047F --as stw1`

use dissect::explain::{KINDS, Kind, explain};

use crate::args::Explain;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Explain, output: &Output) -> Result<(), Failure> {
    let kind = args.kind.or_else(|| Kind::of(&args.value)).ok_or_else(|| {
        let kinds = KINDS.map(|(name, ..)| name).join(", ");
        Failure::usage(format!(
            "`{}` can be of several kinds: --as is missing",
            args.value
        ))
        .hint(format!("--as <KIND> is one of {kinds}"))
    })?;
    if args.mode.is_some() && !kind.has_modes() {
        return Err(Failure::usage("--mode goes with --as stw1 and --as zsw1"));
    }
    let explained = explain(&args.value, kind, args.mode, args.model.model).map_err(|error| {
        let failure = Failure::usage(error.message);
        match error.hint {
            Some(hint) => failure.hint(hint),
            None => failure,
        }
    })?;
    output.json_report(&explained.meaning);
    if !output.json() {
        for line in explained.lines {
            output.line(&line);
        }
    }
    Ok(())
}
