//! The reference of all commands, from the help of the program.

use std::collections::BTreeSet;

use crate::Outcome;

/// The command whose options stand for those that all commands on a drive have.
const TYPICAL: &str = "info";

const HEAD: &str = "# Commands

This page is the output of `--help`, written by `make pages`. The options that most commands share are listed once, at the top.
";

/// Gives the help of a command, which is a list of names; of the program where there is none.
pub type Help<'h> = dyn FnMut(&[&str]) -> Outcome<String> + 'h;

/// Returns the page.
pub fn page(help: &mut Help<'_>) -> Outcome<String> {
    let top = help(&[])?;
    let typical = help(&[TYPICAL])?;
    let blocks = |text: &str| -> BTreeSet<String> { parts(text).iter().filter_map(Part::option).collect() };
    let common: BTreeSet<String> = blocks(&top).union(&blocks(&typical)).cloned().collect();
    let mut page = HEAD.to_owned();
    let (_, notes) = top
        .rsplit_once("\n\n")
        .ok_or("the help of the program has no end")?;
    section(&mut page, "Shared options", &options(&typical, notes));
    for name in names(&top) {
        add(&mut page, &[name], &common, help)?;
    }
    Ok(page)
}

/// Returns the section of a command, and those of its own commands.
fn add(page: &mut String, command: &[&str], common: &BTreeSet<String>, help: &mut Help<'_>) -> Outcome<()> {
    let text = help(command)?;
    let own = names(&text);
    if own.is_empty() {
        section(page, &command.join(" "), &without(&text, common));
    }
    for name in own {
        add(page, &[command, &[name]].concat(), common, help)?;
    }
    Ok(())
}

fn section(page: &mut String, title: &str, text: &str) {
    page.push_str(&format!(
        "\n## {title}\n\n```text\n{}\n```\n",
        text.trim_matches('\n')
    ));
}

/// Returns the commands that a help text lists.
fn names(text: &str) -> Vec<&str> {
    let list = text.split_once("\nCommands:\n").map_or("", |(_, list)| list);
    list.lines()
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect()
}

/// A part of a help text: an option with its description, or one line of all else.
struct Part<'t> {
    lines: Vec<&'t str>,
    is_option: bool,
}

impl Part<'_> {
    /// Returns an option in one line, whatever its columns are.
    fn option(&self) -> Option<String> {
        let words = self.lines.iter().flat_map(|line| line.split_whitespace());
        self.is_option.then(|| words.collect::<Vec<_>>().join(" "))
    }
}

fn parts(text: &str) -> Vec<Part<'_>> {
    let mut parts: Vec<Part<'_>> = Vec::new();
    let mut in_options = false;
    for line in text.lines() {
        if !line.is_empty() && !line.starts_with(' ') {
            in_options = line == "Options:";
        }
        let is_option = in_options && line.trim_start().starts_with('-') && !line.starts_with("       ");
        match parts.last_mut() {
            Some(last) if last.is_option && !is_option && line.starts_with("       ") => {
                last.lines.push(line)
            }
            _ => parts.push(Part {
                lines: vec![line],
                is_option,
            }),
        }
    }
    parts
}

/// Returns the options of a help text, with what all help texts say at their end.
fn options(text: &str, notes: &str) -> String {
    let options = parts(text);
    let lines = options
        .iter()
        .filter(|part| part.is_option)
        .flat_map(|part| &part.lines);
    let lines: Vec<&str> = lines.copied().collect();
    format!("{}\n\n{notes}", lines.join("\n"))
}

/// Returns a help text without the options that are common, and without an empty list.
fn without(text: &str, common: &BTreeSet<String>) -> String {
    let parts = parts(text);
    let own = |part: &&Part<'_>| part.option().is_none_or(|option| !common.contains(&option));
    let lines: Vec<&str> = parts
        .iter()
        .filter(own)
        .flat_map(|part| part.lines.iter().copied())
        .collect();
    let mut text = lines.join("\n");
    while text.contains("\n\n\n") {
        text = text.replace("\n\n\n", "\n\n");
    }
    let text = text.trim_end();
    match text.strip_suffix("Options:") {
        Some(text) => text.to_owned(),
        None => text.replace("\nOptions:\n\n", "\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOP: &str = "Drives\n\nCommands:\n  info  Show\n        more\n  file  Files\n  help  This\n\nOptions:\n      --json  Print\n\nDRIVE is a name.\nExit codes: 0 ok\n";
    const INFO: &str = "Show\n\nUsage: info\n\nOptions:\n      --json        Print\n      --model <M>   Kind\n                    of drive\n";
    const SHOW: &str = "Show a file\n\nUsage: show\n\nOptions:\n      --deep\n          All of it\n\n          - more\n\n      --json\n          Print\n\nEnd.\n";

    #[test]
    fn options_of_all_commands_stand_there_once() {
        let page = page(&mut |command| {
            Ok(match command {
                [] => TOP,
                ["info"] => INFO,
                ["file"] => "Files\n\nCommands:\n  show  Show\n\nOptions:\n      --json  Print\n",
                _ => SHOW,
            }
            .to_owned())
        })
        .unwrap();
        assert_eq!(page.matches("--json").count(), 1, "{page}");
        assert!(
            page.contains("of drive\n\nDRIVE is a name.\nExit codes: 0 ok\n```"),
            "{page}"
        );
        assert!(
            page.contains("## info\n\n```text\nShow\n\nUsage: info\n```\n"),
            "{page}"
        );
        assert!(page.contains("## file show\n"), "{page}");
        assert!(
            page.ends_with("--deep\n          All of it\n\n          - more\n\nEnd.\n```\n"),
            "{page}"
        );
    }
}
