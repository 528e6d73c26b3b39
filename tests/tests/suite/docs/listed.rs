//! What pages list is what the program has.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use plant::PlantPlan;
use pulldown_cmark::Event;
use system_tests::{built, root};

use super::pages::{self, Page};

/// A file with a key that does not exist, for each table of a plant file; `{}` stands for that key.
const UNKNOWN_KEYS: [(&str, &str); 8] = [
    ("Top level", "{} = 1"),
    ("[[drive]]", "[[drive]]\n{} = 1"),
    ("motor", "[[drive]]\nname = \"a\"\nmotor = { {} = 1 }"),
    ("load", "[[drive]]\nname = \"a\"\nload = { {} = 1 }"),
    ("travel", "[[drive]]\nname = \"a\"\ntravel = { {} = 1 }"),
    ("event", "[[drive]]\nname = \"a\"\nevent = [{ {} = 1 }]"),
    ("[[controller]]", "[[controller]]\n{} = 1"),
    ("step", "[[controller]]\nstep = [{ {} = 1 }]"),
];

/// Returns the keys that the parser expects in the place of one that it does not know.
fn expected(file: &str) -> BTreeSet<String> {
    let error = file
        .replace("{}", "no-such-key")
        .parse::<PlantPlan>()
        .unwrap_err();
    let list = error
        .message
        .strip_prefix("unknown field `no-such-key`, expected ")
        .unwrap_or_else(|| panic!("{file}: {error}"));
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// First cells of the tables below each heading, without their quotes.
fn first_cells(page: &Page) -> BTreeMap<String, BTreeSet<String>> {
    let mut tables: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut heading = String::new();
    for line in page.text.lines() {
        if line.starts_with('#') {
            heading = line.trim_start_matches('#').trim().trim_matches('`').to_owned();
        }
        if let Some(row) = line.strip_prefix("| `") {
            let (key, _) = row.split_once('`').unwrap();
            let new = tables.entry(heading.clone()).or_default().insert(key.to_owned());
            assert!(new, "{}: {heading}: {key} stands there twice", page.name());
        }
    }
    tables
}

#[test]
fn the_page_about_plant_files_has_every_key_of_the_parser_and_no_other() {
    let page = Page::read("docs/src/plant-file.md");
    let (_, example) = page.text.split_once("```toml\n").expect("an example");
    let (example, _) = example.split_once("```").expect("its end");
    if let Err(error) = example.parse::<PlantPlan>() {
        panic!("the example: {error}");
    }
    let used: BTreeSet<&str> = example
        .split(|letter: char| !letter.is_alphanumeric() && letter != '-')
        .collect();
    let listed = first_cells(&page);
    for (heading, file) in UNKNOWN_KEYS {
        let keys = expected(file);
        assert_eq!(listed.get(heading), Some(&keys), "{heading}");
        for key in keys {
            assert!(used.contains(&*key), "{heading}: the example has no {key}");
        }
    }
    assert_eq!(listed.len(), UNKNOWN_KEYS.len(), "{:?}", listed.keys());
}

/// Returns the `--help` text of the program or of one of its commands.
fn help(command: &[&str]) -> String {
    let mut program = std::process::Command::new(built("profidrive"));
    let output = program.args(command).arg("--help").output().unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Returns the options in a help text.
fn options(help: &str) -> BTreeSet<String> {
    help.split(|letter: char| letter.is_whitespace() || "`,[]".contains(letter))
        .filter(|word| word.starts_with("--"))
        .map(str::to_owned)
        .collect()
}

/// Every command with its options.
fn commands() -> BTreeMap<String, BTreeSet<String>> {
    let text = help(&[]);
    let (_, list) = text.split_once("Commands:\n").unwrap();
    let names = list
        .lines()
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ")?.split_once(' '))
        .map(|(name, _)| name)
        .filter(|name| !name.is_empty() && *name != "help");
    names
        .map(|name| (name.to_owned(), options(&help(&[name]))))
        .collect()
}

/// Returns the text that is marked as code, in sentences and tables.
fn code(page: &Page) -> Vec<String> {
    let code = |event| match event {
        Event::Code(text) => Some(text.to_string()),
        _ => None,
    };
    page.events().filter_map(code).collect()
}

#[test]
fn every_command_is_described_and_every_option_named_exists() {
    let commands = commands();
    assert!(commands.len() > 25, "{}", commands.len());
    let any: BTreeSet<String> = commands.values().flatten().cloned().collect();
    let mut missing: BTreeSet<&String> = commands.keys().collect();
    for page in pages::all() {
        for text in code(&page) {
            let line = text.strip_prefix("profidrive ").unwrap_or(&text);
            let first = line.split_whitespace().next().unwrap_or_default();
            let known = commands.get_key_value(first);
            if let Some((name, _)) = known {
                missing.remove(name);
            }
            let there = match known {
                Some((_, options)) => options,
                None if first.starts_with("--") => &any,
                None => continue,
            };
            for option in options(line) {
                assert!(there.contains(&option), "{}: `{text}`: no {option}", page.name());
            }
        }
    }
    assert!(missing.is_empty(), "on no page: {missing:?}");
}

#[test]
fn the_exit_codes_are_those_of_the_help() {
    let text = help(&[]);
    let (_, list) = text.split_once("Exit codes: ").unwrap();
    let digits = |text: &str| -> Vec<u8> { text.bytes().filter(u8::is_ascii_digit).collect() };
    let page = Page::read("docs/src/exit-codes.md");
    let rows = page
        .text
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.get(..1));
    assert_eq!(digits(list), digits(&rows.collect::<String>()));
}

/// Adds the text of the Rust files of a folder and those below it.
fn sources(folder: &Path, all: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, all);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            all.push_str(&std::fs::read_to_string(&path).unwrap());
        }
    }
}

/// Returns true if the module of a test path (`dissect::capture::arp::tests::NAME`) has the test: in a file of the sources
/// or of the integration tests of its crate.
fn has_test(crates: &Path, parts: &[&str]) -> bool {
    let [of_crate, modules @ .., name] = parts else {
        return false;
    };
    // tests at the foot of a file have a module that is not a file
    let inline = modules.strip_suffix(&["tests"]).unwrap_or(modules);
    let mut files = ["src", "tests"].into_iter().flat_map(|folder| {
        let base = crates.join(of_crate.replace('_', "-")).join(folder);
        [modules, inline].map(|modules| {
            modules
                .iter()
                .fold(base.clone(), |path, module| path.join(module))
        })
    });
    files.any(|path| {
        [path.with_extension("rs"), path.join("mod.rs")]
            .iter()
            .any(|file| {
                let text = std::fs::read_to_string(file).unwrap_or_default();
                text.contains("#[test]") && text.contains(&format!("fn {name}("))
            })
    })
}

#[test]
fn each_bound_has_a_test_or_the_reason_why_there_is_none() {
    let page = Page::read("docs/src/bounds.md");
    let rows = page.text.lines().filter(|line| line.starts_with("| "));
    let mut count = 0;
    for row in rows.filter(|row| !row.starts_with("| what ")) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let [_, _, _, _, test] = cells[..] else {
            panic!("not five cells: {row}")
        };
        assert!(test.contains("::") || test.starts_with("no test: "), "{row}");
        count += 1;
    }
    assert!(count > 90, "{count}");
}

#[test]
fn the_page_about_bounds_names_files_constants_and_tests_that_exist() {
    let page = Page::read("docs/src/bounds.md");
    let crates = root().join("crates");
    let mut all = String::new();
    sources(&crates, &mut all);
    sources(&root().join("python/src"), &mut all);
    let (mut files, mut constants, mut tests) = (0, 0, 0);
    for text in code(&page) {
        let parts: Vec<&str> = text.split("::").collect();
        let last = parts[parts.len() - 1];
        let constant = last.len() > 2
            && last
                .chars()
                .all(|letter| letter.is_ascii_uppercase() || letter == '_');
        // `{a,b}.rs` are several files
        if text.ends_with(".rs") && !text.contains('{') {
            let there = [&crates, &root()]
                .iter()
                .any(|folder| folder.join(&text).is_file());
            assert!(there, "{text}");
            files += 1;
        } else if constant {
            assert!(all.contains(&format!("const {last}:")), "{text}");
            constants += 1;
        } else if parts.len() > 2 && last.starts_with(|letter: char| letter.is_ascii_lowercase()) {
            assert!(has_test(&crates, &parts), "{text}");
            tests += 1;
        }
    }
    assert!(
        files > 50 && constants > 50 && tests > 100,
        "{files} {constants} {tests}"
    );
}

#[test]
fn the_numbers_on_the_page_about_bounds_are_those_of_the_code() {
    let page = Page::read("docs/src/bounds.md");
    let mut count = 0;
    for row in page.text.lines().filter(|line| line.starts_with("| ")) {
        // code and what is between it take turns
        let parts: Vec<&str> = row.split('`').collect();
        let files = parts.iter().filter(|part| part.ends_with(".rs")).map(|file| {
            let in_crates = root().join("crates").join(file);
            let path = if in_crates.is_file() {
                in_crates
            } else {
                root().join(file)
            };
            std::fs::read_to_string(path).unwrap_or_default()
        });
        let code: String = files.collect();
        for pair in parts[1..].chunks_exact(2) {
            let [name, after] = pair else { continue };
            let number = after.strip_prefix(' ').unwrap_or_default();
            let end = number.find(|letter: char| !letter.is_ascii_digit() && letter != ',');
            let (number, unit) = number.split_at(end.unwrap_or(number.len()));
            let number = number.trim_end_matches(',').replace(',', "");
            // a definition is a plain number, or an expression that is not looked at
            let plain: Vec<String> = code
                .lines()
                .filter(|line| line.contains(&format!("const {name}: ")))
                .filter_map(|line| line.split_once(" = ")?.1.strip_suffix(';'))
                .map(|value| value.replace('_', ""))
                .filter(|value| value.bytes().all(|digit| digit.is_ascii_digit()))
                .collect();
            if number.is_empty() || plain.is_empty() || unit.starts_with(" MiB") || unit.starts_with(" kB") {
                continue;
            }
            assert!(plain.contains(&number), "{name} {number}, in the code {plain:?}");
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}
