//! `profidrive list`

use client::Wait;
use profidrive::parameters;
use profidrive::report::ListReport;
use profile::notation::{Notation, Shown};

use super::values_table;
use crate::advice::Commands;
use crate::args::{List, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;
use crate::render::table::Table;

pub fn list(args: &List, target: &Target, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let wanted = parameters::List {
        filter: args.filter.clone(),
        values: args.values,
    };
    let bar = connect::bar(output, 0, "reading");
    let mut progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let wording = Commands::any();
    let listing = parameters::list(&mut session, &mut drive, &wanted, &wording, &mut progress);
    let report = listing.wait();
    bar.finish_and_clear();
    let report = report?;
    session.close().wait()?;
    if !report.values.is_empty() {
        output.json_report(&report);
        if !output.json() {
            output.table(&values_table(&report.values, args.raw));
        }
        let refused = report.values.iter().filter(|value| value.error.is_some()).count();
        if refused > 0 {
            output.say(&format!("{refused} of {} could not be read", report.values.len()));
        }
        return Ok(());
    }
    output.report(&report);
    if output.json() {
        return Ok(());
    }
    if drive.model.catalogue.is_none() {
        let count = counted(report.numbers.len());
        output.say(&format!("{count}; no names are known for this drive"));
        return Ok(());
    }
    let wide = report.parameters.iter();
    let also = match wide.filter(|parameter| parameter.high.is_some()).count() {
        0 => String::new(),
        1 => "; 1 of them has 64 bits and takes the next number too".to_owned(),
        wide => format!("; {wide} of them have 64 bits and take the next number too"),
    };
    output.say(&format!("{}{also}", counted(report.parameters.len())));
    Ok(())
}

impl Page for ListReport {
    fn print(&self, output: &Output) {
        let mut table = Table::new(&["name", "number", "access", "unit", "description"]);
        for parameter in &self.parameters {
            table.row([
                parameter.name.to_owned(),
                parameter.number.clone(),
                parameter.access.to_owned(),
                parameter.unit.to_owned(),
                parameter.description.to_owned(),
            ]);
        }
        output.table(&table);
        for pnu in &self.numbers {
            let shown = Shown {
                pnu: *pnu,
                index: None,
                writable: None,
                notation: Notation::Name,
            };
            output.line(&shown.to_string());
        }
    }
}

fn counted(count: usize) -> String {
    match count {
        1 => "1 parameter".into(),
        _ => format!("{count} parameters"),
    }
}
