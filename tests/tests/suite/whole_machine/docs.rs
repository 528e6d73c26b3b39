//! README and the site as a newcomer reads them: the commands of the console blocks are run, page by page in the order of
//! the table of contents, in one shell on one machine, and print what stands there.
//!
//! What a page may leave out, and what cannot be equal:
//! - a command with nothing below it has only to succeed; `..` alone on a line stands for any lines, at the end of a line
//!   for the rest of it;
//! - where an axis moves on the clock ([`ON_THE_CLOCK`]) times, numbers of frames, and speeds and positions of the moment
//!   are any numbers, and counts are equal to 100; words, states, setpoints and targets are equal.
//!
//! Serial ports of the reader (`/dev/tty..`) are not there: such commands are left out.
//!
//! Exit codes: that of a comment `# exit code N`, an error where `error:` is shown, else 0.

use std::fmt::Write;
use std::time::Duration;

use system_tests::{Lab, Side, built, root, undisturbed};

use crate::docs::pages::{self, Page};

/// Commands whose output depends on the moment.
const ON_THE_CLOCK: [&str; 7] = [
    "profidrive run",
    "profidrive move",
    "profidrive write akd-1 930=2 && profidrive home",
    "profidrive ack",
    // killed while it runs an axis, and what is seen of that axis
    "timeout -s KILL",
    "profidrive status vlt-1",
    "profidrive stop vlt-1",
];

/// What is done instead of a command, each for its reason.
const INSTEAD: [(&str, &str); 5] = [
    // this test is a part of it
    ("make test", ":"),
    // serves until Ctrl-C; each test of the page starts it
    ("cargo run -p profidrive-cli -- serve --demo", ":"),
    // what the Makefile runs, built already
    ("make demo", "\"$BUILT\" demo --fast"),
    // what this test has built is where README says
    (
        "cargo build -p profidrive-cli",
        "mkdir -p target/debug; ln -s \"$BUILT\" target/debug/profidrive",
    ),
    // the shell is in a namespace of its own already
    ("unshare ", ":"),
];

/// Folders of the checkout that commands name.
const FOLDERS: [&str; 3] = ["captures", "examples", "tests"];

/// All of it takes some fifteen seconds.
const LONGEST: Duration = Duration::from_secs(180);

/// Stands for any lines.
const ANY_LINES: &str = "..";
/// Between the outputs of two commands.
const MARK: &str = "@@ docs";

/// A command, and what is shown below it.
#[derive(Debug, Clone, Default)]
struct Step {
    page: String,
    command: String,
    shown: Vec<String>,
}

impl Step {
    fn on_the_clock(&self) -> bool {
        ON_THE_CLOCK.iter().any(|start| self.command.starts_with(start))
    }

    /// Returns the command without its comment.
    fn bare(&self) -> &str {
        self.command
            .split_once("  # ")
            .map_or(self.command.as_str(), |(command, _)| command)
            .trim_end()
    }

    /// Returns the exit code that the text promises; `None` for any failure.
    fn code(&self) -> Option<i32> {
        if let Some((_, code)) = self.command.split_once("# exit code ") {
            return code.split_whitespace().next()?.parse().ok();
        }
        let fails = self.shown.iter().any(|line| line.starts_with("error: "));
        (!fails).then_some(0)
    }

    /// Returns the input of the shell.
    fn script(&self) -> String {
        let mut command = self.bare().to_owned();
        if command.contains("/dev/tty") {
            command = ":".into();
        }
        for (start, instead) in INSTEAD {
            if let Some(rest) = command.strip_prefix(start) {
                command = if instead == ":" {
                    instead.to_owned()
                } else {
                    format!("{instead}{rest}")
                };
            }
        }
        // a simulation in the background is ready once it says how to end it
        if command.ends_with('&') {
            let (_, log) = command
                .split_once('>')
                .expect("a file for the events of a simulation");
            let log = log.split_whitespace().next().unwrap().to_owned();
            command +=
                &format!("\nuntil grep -q 'Ctrl-C ends' {log}; do kill -0 $! || break; sleep 0.05; done");
        }
        format!("{command}\nprintf '\\n{MARK} %s\\n' $?\n")
    }
}

/// Returns the commands of all console blocks of a page in order.
fn steps(page: &Page) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut in_block = false;
    for line in page.text.lines() {
        if let Some(kind) = line.strip_prefix("```") {
            in_block = !in_block && kind == "console";
            continue;
        }
        if !in_block {
            continue;
        }
        match line.strip_prefix("$ ").or_else(|| line.strip_prefix("# ")) {
            Some(command) if !continues(&steps, line) => steps.push(Step {
                page: page.name(),
                command: command.into(),
                shown: Vec::new(),
            }),
            _ => steps.last_mut().unwrap().shown.push(line.into()),
        }
    }
    steps
}

/// Returns true for a comment at the start of a file, which looks like a prompt.
fn continues(steps: &[Step], line: &str) -> bool {
    let shows_a_file = |step: &Step| step.command.starts_with("cat ");
    line.starts_with("# ") && steps.last().is_some_and(shows_a_file)
}

/// Words of a line; where it is of the moment, without the numbers that are.
fn words(line: &str, moment: bool) -> Vec<String> {
    if !moment {
        return vec![line.trim_end().to_owned()];
    }
    let all: Vec<&str> = line.split_whitespace().collect();
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    let mut words: Vec<String> = Vec::new();
    for (at, word) in all.iter().enumerate() {
        let before = at.checked_sub(1).map_or("", |at| all[at]);
        let after = all.get(at + 1).copied().unwrap_or("");
        let after = after.trim_end_matches([',', ';', ')']);
        let digits = word.trim_start_matches('(');
        let of_the_moment =
            matches!(after, "s" | "ms" | "cyclic" | "lost") || matches!(before, "actual" | "at");
        words.push(match digits.parse::<f64>() {
            Ok(_) if of_the_moment && is_number(word) => "#".into(),
            Ok(counts) if after == "counts" => format!("{:.0}00", counts / 100.0),
            _ => (*word).into(),
        });
    }
    words
}

fn same_line(shown: &str, printed: &str, moment: bool) -> bool {
    match shown.strip_suffix(" ..") {
        Some(start) => words(printed, moment)
            .concat()
            .starts_with(&words(start, moment).concat()),
        None => words(shown, moment) == words(printed, moment),
    }
}

fn same(shown: &[String], printed: &[&str], moment: bool) -> bool {
    match (shown.split_first(), printed.split_first()) {
        (None, None) => true,
        (Some((any, rest)), _) if any.trim() == ANY_LINES => {
            (0..=printed.len()).any(|from| same(rest, &printed[from..], moment))
        }
        (Some((first, rest)), Some((line, lines))) => {
            same_line(first, line, moment) && same(rest, lines, moment)
        }
        _ => false,
    }
}

/// All of it once; what went wrong where the clock takes part.
fn session(steps: &[Step]) -> Result<(), String> {
    let lab = Lab::alone("docs");
    let program = built("profidrive");
    let mut script = format!(
        "exec 2>&1\nexport BUILT={}\nunset PROFIDRIVE_INTERFACE\ncd {}\nexport XDG_RUNTIME_DIR=$PWD XDG_CONFIG_HOME=$PWD/config XDG_CACHE_HOME=$PWD/cache\n",
        program.display(),
        lab.folder().display()
    );
    for folder in FOLDERS {
        let _ = writeln!(script, "ln -s {} {folder}", root().join(folder).display());
    }
    for step in steps {
        script += &step.script();
    }
    script += "kill -KILL $(jobs -p)\n";
    let file = lab.folder().join("session.sh");
    std::fs::write(&file, script).unwrap();
    let arguments = ["--net".as_ref(), "bash".as_ref(), file.as_os_str()];
    let printed = lab.run(Side::Device, "unshare", arguments, LONGEST).out;
    let (mut wrong, mut disturbed) = (String::new(), String::new());
    let mut rest = printed.as_str();
    for step in steps {
        let mark = format!("\n{MARK} ");
        let (output, more) = rest
            .split_once(&mark)
            .unwrap_or_else(|| panic!("the shell ended in `{}`:\n{rest}", step.command));
        let (code, more) = more.split_once('\n').unwrap();
        rest = more;
        let code: i32 = code.parse().unwrap();
        let lines: Vec<&str> = output.trim_end().lines().collect();
        let fits = step.shown.is_empty() || same(&step.shown, &lines, step.on_the_clock());
        let ends = step.code().map_or(code != 0, |promised| code == promised);
        if fits && ends {
            continue;
        }
        let what = format!(
            "`{}` (exit code {code}) prints\n{output}\n{} has\n{}\n",
            step.command,
            step.page,
            step.shown.join("\n")
        );
        let list = if step.on_the_clock() {
            &mut disturbed
        } else {
            &mut wrong
        };
        let _ = writeln!(list, "{what}");
    }
    assert!(wrong.is_empty(), "{wrong}");
    if disturbed.is_empty() {
        Ok(())
    } else {
        Err(disturbed)
    }
}

#[test]
fn a_newcomer_sees_what_the_pages_show() {
    let steps: Vec<Step> = pages::all().iter().flat_map(steps).collect();
    assert!(steps.len() >= 60, "{}", steps.len());
    let shown = steps.iter().filter(|step| !step.shown.is_empty()).count();
    assert!(shown >= 40, "{shown}");
    undisturbed(|| session(&steps));
}

#[test]
fn the_demo_is_the_one_of_the_makefile() {
    let makefile = std::fs::read_to_string(root().join("Makefile")).unwrap();
    assert!(makefile.contains("--bin profidrive -- demo $(ARGS)"));
}

#[test]
fn what_may_differ_and_what_may_not() {
    let shown: Vec<String> = ["a 1.0 s", "..", "set 60.04 rpm  actual 59.31 rpm", "b ..", ".."]
        .map(String::from)
        .into();
    let lines = [
        "a 2.5 s",
        "x",
        "y",
        "set  60.04 rpm  actual  -3 rpm",
        "b and more",
        "z",
    ];
    assert!(same(&shown, &lines, true));
    assert!(!same(&shown, &lines, false));
    let other = ["a 2.5 s", "set 61 rpm actual 59.31 rpm", "b and more"];
    assert!(!same(&shown, &other, true));
    assert!(same_line(
        "10 rev (655360 counts)",
        "10 rev (655362 counts)",
        true
    ));
    assert!(!same_line(
        "10 rev (655360 counts)",
        "11 rev (655362 counts)",
        true
    ));
}
