//! `profidrive gsdml show FILE`

use profidrive::device_description::{LanguageError, show};
use profidrive::report::{GsdmlAccessPoint, GsdmlModule, GsdmlShowReport};

use crate::args::GsdmlShow;
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::number;
use crate::render::table::{Table, clean};

/// Milliseconds of one step of an update time.
const TICK: f64 = 0.031_25;

pub fn run(args: &GsdmlShow, output: &Output) -> Result<(), Failure> {
    let description = super::read(&args.file)?;
    let report = show(&description, args.language.as_deref()).map_err(no_language)?;
    output.json_report(&report);
    if output.json() {
        return Ok(());
    }
    identity(&report, output);
    for point in &report.access_points {
        access_point(point, output);
    }
    output.line("");
    output.table(&modules(&report.modules));
    if args.texts {
        output.line("");
        let mut table = Table::new(&["text", "words"]);
        let texts = args
            .language
            .as_ref()
            .and_then(|language| report.languages.get(language));
        for id in report.texts.keys() {
            let text = texts
                .and_then(|texts| texts.get(id))
                .or_else(|| report.texts.get(id));
            table.row([id.clone(), text.cloned().unwrap_or_default()]);
        }
        output.table(&table);
    }
    Ok(())
}

fn no_language(error: LanguageError) -> Failure {
    let failure = Failure::usage(error.to_string());
    if error.there.is_empty() {
        failure.hint("its texts are in the primary language only")
    } else {
        failure.hint(format!("it has {}", error.there.join(", ")))
    }
}

fn identity(report: &GsdmlShowReport, output: &Output) {
    let languages: Vec<&str> = report.languages.keys().map(String::as_str).collect();
    let family = [
        Some(report.main_family.as_str()),
        report.product_family.as_deref(),
    ];
    let family: Vec<&str> = family.into_iter().flatten().collect();
    for (name, value) in [
        ("vendor", format!("0x{:04X} {}", report.vendor_id, report.vendor)),
        ("device", format!("0x{:04X} {}", report.device_id, report.info)),
        ("family", family.join(", ")),
        (
            "schema",
            report
                .schema_version
                .clone()
                .unwrap_or_else(|| "not given".to_owned()),
        ),
        (
            "texts",
            format!(
                "{} in the primary language{}{}",
                report.texts.len(),
                if languages.is_empty() { "" } else { "; also " },
                languages.join(", ")
            ),
        ),
    ] {
        output.line(&format!("{name:<8} {}", clean(&value)));
    }
}

fn access_point(point: &GsdmlAccessPoint, output: &Output) {
    let name = clean(&format!("access point {}", point.id));
    output.line("");
    output.line(&format!(
        "{}  {}",
        output.paint(Colour::Strong, &name),
        clean(&point.name)
    ));
    let release = [
        ("order number", &point.order_number),
        ("hardware", &point.hardware),
        ("software", &point.software),
    ];
    let release: Vec<String> = release
        .iter()
        .filter_map(|(name, value)| value.as_ref().map(|value| format!("{name} {value}")))
        .collect();
    let line = |name: &str, value: String| {
        if !value.is_empty() {
            output.line(&format!("  {name:<14} {}", clean(&value)));
        }
    };
    line("release", release.join(", "));
    line("module ident", format!("0x{:08X}", point.module_ident));
    line("slots", point.slots.clone());
    let interval = point.min_device_interval;
    line(
        "update time",
        format!(
            "{} ms and longer ({interval} steps of 31.25 us)",
            number(f64::from(interval) * TICK)
        ),
    );
    if let Some(interface) = &point.interface {
        line(
            "interface",
            format!(
                "subslot 0x{:04X}, ident 0x{:08X}, {}, start-up {}",
                interface.subslot,
                interface.ident,
                point.rt_classes.join(" "),
                point.start_up.join(" ")
            ),
        );
        line("protocols", point.protocols.join(" "));
    }
    for port in &point.ports {
        line(
            "port",
            format!("subslot 0x{:04X}, ident 0x{:08X}", port.subslot, port.ident),
        );
    }
    if let Some(class) = &point.conformance_class {
        line("conformance", format!("class {class}"));
    }
    line("reset modes", point.reset_modes.clone());
    line(
        "cyclic data",
        format!(
            "at most {} octets of input, {} of output with status",
            point.max_input, point.max_output
        ),
    );
}

fn modules(modules: &[GsdmlModule]) -> Table {
    let mut table = Table::new(&[
        "module",
        "ident",
        "slots",
        "subslot",
        "submodule",
        "ident",
        "api",
        ">input",
        ">output",
    ]);
    for module in modules {
        let ident = format!("0x{:08X}", module.ident);
        let mut head = [module.name.clone(), ident, module.slots.clone()];
        if module.submodules.is_empty() {
            table.row(head.clone());
        }
        for submodule in &module.submodules {
            let name = submodule.name.clone().filter(|name| !name.is_empty());
            let own = name.or_else(|| submodule.id.clone()).unwrap_or_default();
            let own = match (own == module.name, submodule.pluggable) {
                (true, _) => String::new(),
                (false, true) => format!("+ {own}"),
                (false, false) => own,
            };
            table.row(std::mem::take(&mut head).into_iter().chain([
                submodule.subslots.clone(),
                own,
                format!("0x{:08X}", submodule.ident),
                format!("0x{:04X}", submodule.api),
                submodule.input.to_string(),
                submodule.output.to_string(),
            ]));
        }
    }
    table
}
