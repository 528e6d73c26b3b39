//! What a build of the site would find, without its builder: contents, links, anchors, included parts, quoted code.

use std::collections::{BTreeSet, HashMap};
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{Event, Tag, TagEnd};
use system_tests::root;

use super::pages::{Page, SOURCES, all};

/// Where files of the repository that are not pages of the site are shown.
const REPOSITORY: &str = "https://github.com/profidrive/profidrive";

/// Programs and texts that pages quote, line by line.
const QUOTED: [&str; 3] = [
    "examples",
    "crates/profidrive/src",
    "crates/profidrive/src/motion",
];

/// `a/./b/../c` is `a/c`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

/// Ids of the headings as mdBook and GitHub make them.
fn anchors(page: &Page) -> BTreeSet<String> {
    let mut ids = BTreeSet::new();
    let mut counts: HashMap<String, usize> = HashMap::new();
    let mut heading: Option<String> = None;
    for event in page.events() {
        match event {
            Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
            Event::Text(text) | Event::Code(text) => {
                if let Some(heading) = &mut heading {
                    heading.push_str(&text);
                }
            }
            Event::End(TagEnd::Heading(_)) => {
                let id = id(&heading.take().unwrap());
                let count = counts.entry(id.clone()).or_default();
                ids.insert(if *count == 0 { id } else { format!("{id}-{count}") });
                *count += 1;
            }
            _ => {}
        }
    }
    ids
}

fn id(heading: &str) -> String {
    let kept = heading.to_lowercase();
    kept.chars()
        .filter_map(|letter| match letter {
            ' ' => Some('-'),
            letter if letter.is_alphanumeric() || matches!(letter, '-' | '_') => Some(letter),
            _ => None,
        })
        .collect()
}

/// Returns the problem of a link of a page; `None` for addresses elsewhere.
fn complaint(page: &Page, link: &str) -> Option<String> {
    let (target, anchor) = link
        .split_once('#')
        .map_or((link, None), |(target, anchor)| (target, Some(anchor)));
    let of_site = page.path.starts_with(SOURCES);
    let path = match target.strip_prefix(REPOSITORY) {
        Some(rest) => PathBuf::from(rest.strip_prefix("/blob/main/").unwrap_or("")),
        None if target.contains("://") => return None,
        None if target.is_empty() => page.path.clone(),
        None => plain(&page.path.parent().unwrap_or(Path::new("")).join(target)),
    };
    if !root().join(&path).exists() {
        return Some(format!("there is no {}", path.display()));
    }
    let leaves = of_site && !target.contains("://") && !path.starts_with(SOURCES);
    if leaves {
        return Some(format!(
            "not a page of the site; link to {REPOSITORY}/blob/main/{}",
            path.display()
        ));
    }
    let anchor = anchor?;
    let there = anchors(&Page::read(&path));
    (!there.contains(anchor)).then(|| format!("{} has no heading #{anchor}: {there:?}", path.display()))
}

#[test]
fn every_link_leads_to_a_page_and_a_heading() {
    let mut wrong = Vec::new();
    let others = [
        "CONTRIBUTING.md",
        "ARCHITECTURE.md",
        "SECURITY.md",
        "data/README.md",
    ]
    .map(Page::read);
    for page in all().iter().chain(&others) {
        for link in page.links() {
            wrong.extend(complaint(page, &link).map(|what| format!("{}: {link}: {what}", page.name())));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_page_is_in_the_table_of_contents_once() {
    let listed: Vec<PathBuf> = all().into_iter().skip(1).map(|page| page.path).collect();
    let mut there: Vec<PathBuf> = std::fs::read_dir(root().join(SOURCES))
        .unwrap()
        .map(|entry| Path::new(SOURCES).join(entry.unwrap().file_name()))
        .filter(|path| path.extension().is_some_and(|end| end == "md") && !path.ends_with("SUMMARY.md"))
        .collect();
    there.sort();
    let mut sorted = listed.clone();
    sorted.sort();
    assert_eq!(sorted, there);
    for page in all() {
        let mut titles = page
            .text
            .lines()
            .filter(|line| line.starts_with("# ") && !line.contains("profidrive "));
        assert!(
            titles.next().is_some(),
            "{}: a page begins with its title",
            page.name()
        );
    }
}

/// mdBook puts an error text into the page and goes on.
#[test]
fn every_included_part_exists() {
    let mut parts = 0;
    for page in all() {
        for part in page.text.split("{{#include ").skip(1) {
            let (part, _) = part.split_once("}}").expect("the end of an include");
            let (file, anchor) = part.split_once(':').expect("an anchor");
            let path = plain(&page.path.parent().unwrap().join(file));
            let text = Page::read(path).text;
            for mark in ["ANCHOR", "ANCHOR_END"] {
                let mark = format!("<!-- {mark}: {anchor} -->");
                assert_eq!(text.matches(&mark).count(), 1, "{}: {mark}", page.name());
            }
            parts += 1;
        }
    }
    assert!(parts > 0);
}

/// Blocks of Rust code, each a list of lines without indentation.
fn code(page: &Page) -> Vec<Vec<String>> {
    let blocks = page.text.split("\n```rust\n").skip(1);
    let lines = |block: &str| {
        let code = block.split("\n```").next().unwrap();
        let lines = code.lines().map(|line| line.trim().to_owned());
        lines.filter(|line| !line.is_empty()).collect()
    };
    blocks.map(lines).collect()
}

/// Returns true when the lines stand in the text in this order; others may be between them.
fn quotes(text: &str, lines: &[String]) -> bool {
    let mut rest = text.lines().map(|line| {
        line.trim()
            .trim_start_matches("//!")
            .trim_start_matches("///")
            .trim()
    });
    lines.iter().all(|line| rest.any(|other| other == line))
}

/// What is quoted is compiled and run where it stands.
#[test]
fn rust_code_is_quoted_from_an_example_or_a_tested_comment() {
    let mut sources = Vec::new();
    for folder in QUOTED {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|end| end == "rs") {
                sources.push(std::fs::read_to_string(path).unwrap());
            }
        }
    }
    let mut blocks = 0;
    for page in all() {
        for lines in code(&page) {
            let found = sources.iter().any(|source| quotes(source, &lines));
            assert!(found, "{}: not in any of {QUOTED:?}: {lines:#?}", page.name());
            blocks += 1;
        }
    }
    assert!(blocks >= 2, "{blocks}");
}

#[test]
fn the_pages_that_come_from_the_program_are_fresh() {
    let check = std::process::Command::new(system_tests::built("xtask"))
        .arg("pages")
        .arg(system_tests::built("profidrive"))
        .arg("--check")
        .output()
        .unwrap();
    assert!(
        check.status.success(),
        "{}",
        String::from_utf8_lossy(&check.stderr)
    );
}

#[test]
fn headings_get_the_ids_of_the_builder() {
    let page = Page {
        path: "x.md".into(),
        text: "# `[[drive]]`\n## What is refused, or not\n## Faults\n### Faults\n".into(),
    };
    let ids = anchors(&page);
    let expected = ["drive", "what-is-refused-or-not", "faults", "faults-1"];
    assert_eq!(ids, expected.map(String::from).into());
    assert!(complaint(&page, "README.md#five-minutes").is_none());
    assert!(complaint(&page, "README.md#six-minutes").is_some());
    assert!(complaint(&page, "nothing.md").is_some());
    assert!(quotes("//! a\n  b;\nc", &["a".into(), "c".into()]));
    assert!(!quotes("a\nb", &["b".into(), "a".into()]));
}
