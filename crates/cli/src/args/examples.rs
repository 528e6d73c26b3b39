//! Examples of each command for its help, and the groups of commands. One table: help, manual pages and the reference of commands
//! come from it, and a test reads each example with the real parser.

use clap::Command;

/// An example: a command line behind the name of the program, and what it does.
type Example = (&'static str, &'static str);

/// The examples of each command, by its words.
pub const EXAMPLES: &[(&str, &[Example])] = &[
    (
        "scan",
        &[
            ("scan", "all stations, with who they are"),
            ("scan --csv", "the same as a table for spreadsheets"),
            ("scan --watch", "who comes and goes, until Ctrl-C"),
        ],
    ),
    (
        "name",
        &[
            (
                "name 02:50:4e:00:00:01 akd-1",
                "name the station with this MAC address",
            ),
            (
                "name akd-1 press-1 --dry-run",
                "check another name, change nothing",
            ),
        ],
    ),
    (
        "ip",
        &[
            ("ip akd-1 192.168.77.11/24", "address and subnet mask"),
            (
                "ip akd-1 192.168.77.11/24 --gateway 192.168.77.1",
                "with a gateway",
            ),
        ],
    ),
    (
        "blink",
        &[
            ("blink akd-1", "which of them is it?"),
            (
                "blink 02:50:4e:00:00:01 --for 30s",
                "a station without a name, for half a minute",
            ),
        ],
    ),
    (
        "reset",
        &[
            (
                "reset akd-1 --mode communication",
                "name and address as delivered, after a confirmation",
            ),
            (
                "reset akd-1 --mode application --yes",
                "parameters as delivered, without asking",
            ),
        ],
    ),
    (
        "info",
        &[
            ("info akd-1", "firmware, serial number, modules, neighbours"),
            ("info all --json", "all drives, for a program"),
        ],
    ),
    (
        "status",
        &[
            ("status", "all drives, those kept from running first"),
            ("status akd-1", "why this one does not run"),
            (
                "status @line1 --short",
                "a group of the machine file, one sentence each",
            ),
        ],
    ),
    (
        "faults",
        &[
            ("faults akd-1", "the faults that are present and their remedy"),
            (
                "faults 'akd-*' --history",
                "also those before, of all drives whose names fit",
            ),
        ],
    ),
    (
        "ack",
        &[
            ("ack akd-1", "acknowledge as its controller"),
            ("ack akd-1 --by-parameter", "beside a running controller"),
        ],
    ),
    (
        "doctor",
        &[
            ("doctor", "this computer and all drives"),
            ("doctor akd-1 -i eth0", "one drive on this interface"),
        ],
    ),
    (
        "bundle",
        &[
            ("bundle -o state.zip", "all drives"),
            (
                "bundle @line1 -o state.zip --capture 30s",
                "a group, with its traffic",
            ),
        ],
    ),
    (
        "report",
        &[
            ("report -o machine.html", "all drives"),
            ("report model=vlt -o converters.html", "the drives of a model"),
        ],
    ),
    (
        "read",
        &[
            (
                "read akd-1 DRV.ACC p930 947[0..7]",
                "a name, a number, elements of an array",
            ),
            (
                "read all ramp-up max-speed",
                "common names, for drives of any vendor",
            ),
            ("read vlt-1 3-41 --json", "for a program"),
        ],
    ),
    (
        "write",
        &[
            (
                "write akd-1 DRV.ACC=5000rpm/s --save",
                "write, verify, keep over power-off",
            ),
            (
                "write model=vlt ramp-up=4s --dry-run",
                "what would be written to many",
            ),
        ],
    ),
    (
        "list",
        &[
            (
                "list akd-1 --filter ramp",
                "parameters with a word in name or description",
            ),
            ("list vlt-1 --filter 3- --values", "with their values"),
        ],
    ),
    (
        "describe",
        &[
            ("describe akd-1 DRV.ACC", "unit, limits, default"),
            ("describe vlt-1 3-41", "as the vendor writes it"),
        ],
    ),
    (
        "run",
        &[
            ("run akd-1 --velocity 60rpm --for 5s", "turn for 5 s, then stop"),
            (
                "run vlt-1 --velocity 25Hz --dry-run",
                "a converter by its frequency; sends nothing",
            ),
        ],
    ),
    (
        "step",
        &[
            (
                "step akd-1 --velocity 0:300rpm",
                "rise time, overshoot, settling time",
            ),
            ("step akd-1 --velocity 0:300rpm -o after.csv", "keep the samples"),
        ],
    ),
    (
        "jog",
        &[
            ("jog akd-1 --velocity 30rpm --for 2s", "turn at a jog speed"),
            ("jog akd-1 --velocity 30rpm --dry-run", "check, send nothing"),
        ],
    ),
    (
        "move",
        &[
            ("move akd-1 --to 10rev --velocity 300rpm", "to a position"),
            (
                "move akd-1 --to -2rev --relative --velocity 300rpm",
                "by a distance",
            ),
        ],
    ),
    (
        "task",
        &[
            ("task akd-1 1", "motion task 1 of the drive"),
            ("task akd-1 1 --set-mode", "switch to positioning for it"),
        ],
    ),
    (
        "home",
        &[
            ("home akd-1", "by the procedure that is set"),
            (
                "home akd-1 --set-mode --timeout 2min",
                "switch to positioning for it, wait longer",
            ),
        ],
    ),
    (
        "stop",
        &[
            ("stop all", "each drive as soon as it answers"),
            ("stop akd-1 --disable", "and switch its power stage off"),
        ],
    ),
    (
        "monitor",
        &[
            (
                "monitor akd-1 DRV.ACC --every 100ms",
                "state and a parameter as they change",
            ),
            ("monitor all --for 10s --json", "all drives, for a program"),
        ],
    ),
    (
        "record",
        &[
            (
                "record akd-1 VL.FB --every 10ms --for 5s -o speed.csv",
                "a parameter to a table",
            ),
            (
                "record all all --every cycle -o run.parquet",
                "every cyclic signal with each cycle",
            ),
        ],
    ),
    (
        "backup",
        &[
            ("backup akd-1 -o akd-1.backup", "one drive to a file"),
            ("backup all -o backups", "all drives to a folder"),
        ],
    ),
    (
        "diff",
        &[
            ("diff akd-1.backup akd-1", "what changed since the backup"),
            ("diff akd-1 akd-2", "two drives"),
            ("diff backups all", "each drive against its file in a folder"),
            ("diff machine.toml all", "the machine against its file"),
        ],
    ),
    (
        "restore",
        &[
            ("restore akd-1 akd-1.backup --dry-run", "what would be written"),
            (
                "restore akd-1 akd-1.backup --save",
                "write, verify, keep over power-off",
            ),
        ],
    ),
    (
        "commission",
        &[
            ("commission machine.toml --dry-run", "what differs from the file"),
            ("commission machine.toml", "change it, after a confirmation"),
            (
                "commission --from all machine.toml",
                "write the file from what is there",
            ),
        ],
    ),
    (
        "replace",
        &[
            (
                "replace 02:50:4e:00:00:09 akd-1 --backup akd-1.backup",
                "from a backup of the old drive",
            ),
            ("replace 192.168.77.20 akd-1", "from the machine file"),
        ],
    ),
    (
        "explain",
        &[
            ("explain 0x047F --as stw1", "the bits of a control word"),
            ("explain 439 --as fault --model akd", "a fault number"),
            ("explain W34", "a warning as a VLT displays it"),
        ],
    ),
    (
        "decode",
        &[
            (
                "decode trace.pcapng --only trouble",
                "what went wrong in a capture",
            ),
            ("decode -i eth0 --drive akd-1", "live, one drive"),
            (
                "decode -i eth0 --only trouble --keep 10min",
                "what goes wrong; its traffic is kept for `bundle`",
            ),
            ("decode --hex 047F0000 --telegram 1", "octets of a telegram"),
        ],
    ),
    (
        "gsdml show",
        &[
            ("gsdml show file.xml", "access points, modules, timings"),
            ("gsdml show file.xml --texts --language de", "with all texts"),
        ],
    ),
    (
        "gsdml check",
        &[("gsdml check file.xml", "everything that is against the rules")],
    ),
    (
        "gsdml export",
        &[(
            "gsdml export --model akd -o folder",
            "for the engineering tool of a controller",
        )],
    ),
    (
        "simulate",
        &[
            (
                "simulate --name akd-1 --ip 192.168.77.11/24 -i eth1",
                "one virtual drive",
            ),
            ("simulate plant.toml -i eth1", "the drives of a plant file"),
            (
                "simulate plant.toml --virtual-time --for 1h",
                "in memory, as fast as possible",
            ),
        ],
    ),
    (
        "inject",
        &[
            ("inject akd-1 fault=439", "a fault"),
            ("inject akd-1 cable=pulled --for 2s", "a cable out for 2 s"),
        ],
    ),
    (
        "demo",
        &[
            ("demo", "find, read and run virtual drives in memory"),
            ("demo --pcap demo.pcapng", "with the traffic for Wireshark"),
        ],
    ),
    #[cfg(feature = "serve")]
    (
        "serve",
        &[
            ("serve --demo", "six virtual drives in memory"),
            (
                "serve --plant plant.toml --open",
                "those of a plant file, in the browser at once",
            ),
            ("serve -i eth1", "the drives on an interface"),
            (
                "serve --ip 192.168.0.11 --read-only",
                "a drive by its address, to look at only",
            ),
        ],
    ),
    (
        "completions",
        &[(
            "completions bash",
            "for the file ~/.local/share/bash-completion/completions/profidrive",
        )],
    ),
];

/// The commands by what they are for, in the order of the help.
pub const GROUPS: &[(&str, &[&str])] = &[
    ("Find", &["scan", "name", "ip", "blink", "reset"]),
    ("Look", &["status", "info", "faults", "monitor", "doctor"]),
    ("Read and change", &["read", "write", "list", "describe", "ack"]),
    ("Move", &["run", "jog", "move", "task", "home", "stop"]),
    ("Record", &["record", "step"]),
    (
        "Keep",
        &[
            "backup",
            "diff",
            "restore",
            "commission",
            "replace",
            "bundle",
            "report",
        ],
    ),
    ("Explain", &["explain", "decode", "gsdml"]),
    ("Simulate", &["simulate", "inject", "demo"]),
    #[cfg(feature = "serve")]
    ("In the browser", &["serve"]),
    ("Others", &["completions", "help"]),
];

/// Returns the command line with the examples of each command, and with the commands of the program by groups.
pub fn completed(command: Command) -> Command {
    let command = with_examples(command, "");
    let list = grouped(&command);
    command.help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\nCommands:\n{list}\nOptions:\n{{options}}{{after-help}}"
    ))
}

/// A line for each group, then its commands, each with the first part of what it does.
fn grouped(command: &Command) -> String {
    let mut text = String::new();
    for (group, names) in GROUPS {
        text += &format!(" {group}:\n");
        for name in *names {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map_or_else(
                || "Print this message or the help of a command".to_owned(),
                ToString::to_string,
            );
            let short = about.split([';', ':']).next().unwrap_or_default().trim_end();
            text += &format!("  {name:<12} {short}\n");
        }
    }
    text
}

fn with_examples(command: Command, words: &str) -> Command {
    let command = command.mut_subcommands(|inner| {
        let words = format!("{words} {}", inner.get_name());
        with_examples(inner, words.trim_start())
    });
    // a command that only has others under it shows the first example of each of them
    let of_inner =
        |name: &str| !words.is_empty() && name.strip_prefix(words).is_some_and(|rest| rest.starts_with(' '));
    let examples: Vec<&Example> = match EXAMPLES.iter().find(|(name, _)| *name == words) {
        Some((_, examples)) => examples.iter().collect(),
        None => {
            let inner = EXAMPLES.iter().filter(|(name, _)| of_inner(name));
            inner.filter_map(|(_, examples)| examples.first()).collect()
        }
    };
    if examples.is_empty() {
        return command;
    }
    let mut text = command
        .get_after_help()
        .map(|text| format!("{text}\n\n"))
        .unwrap_or_default();
    text += "Examples:";
    for (line, what) in examples {
        text += &format!("\n  profidrive {line}\n      {what}");
    }
    command.after_help(text)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::CommandFactory;

    use super::*;
    use crate::args::Cli;

    /// The words of a line as a shell divides them: single quotes keep words together.
    fn words(line: &str) -> Vec<String> {
        line.split(' ')
            .map(|word| word.trim_matches('\'').to_owned())
            .collect()
    }

    /// All commands that can be carried out, by their words.
    fn commands(command: &Command, before: &str, found: &mut BTreeSet<String>) {
        for inner in command.get_subcommands().filter(|inner| !inner.is_hide_set()) {
            let name = format!("{before} {}", inner.get_name()).trim_start().to_owned();
            if inner.has_subcommands() {
                commands(inner, &name, found);
            } else {
                found.insert(name);
            }
        }
    }

    #[test]
    fn every_example_is_a_line_of_the_program_and_every_command_has_one() {
        let mut without = BTreeSet::new();
        commands(&Cli::command(), "", &mut without);
        for (command, examples) in EXAMPLES {
            assert!(without.remove(*command), "{command} is twice, or no command");
            for (line, _) in *examples {
                let read = Cli::read(std::iter::once("profidrive".to_owned()).chain(words(line)));
                let read = read.unwrap_or_else(|error| panic!("{line}: {error}"));
                assert_eq!(read.name, *command, "{line}");
            }
        }
        assert!(without.is_empty(), "without an example: {without:?}");
    }

    #[test]
    fn every_command_is_in_one_group() {
        let named: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, names)| names.iter().copied())
            .collect();
        let unique: BTreeSet<&str> = named.iter().copied().collect();
        assert_eq!(unique.len(), named.len());
        let command = Cli::command();
        let mut all: BTreeSet<&str> = command
            .get_subcommands()
            .filter(|inner| !inner.is_hide_set())
            .map(Command::get_name)
            .collect();
        all.insert("help");
        assert_eq!(unique, all);
    }
}
