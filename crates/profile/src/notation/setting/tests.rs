//! Round trips, mistakes, cuts and changed octets.

use super::*;
use alloc::vec;
use proptest::prelude::*;

const OPEN: Form = Form {
    kind: "backup",
    oldest: 1,
    version: 3,
    sealed: false,
    comment_column: 20,
    comment_gap: 2,
};
const SEALED: Form = Form {
    kind: "state",
    sealed: true,
    comment_column: 0,
    comment_gap: 1,
    ..OPEN
};

fn entries(form: &Form, text: &str) -> Result<Vec<(usize, Entry)>, Problem> {
    let lines = form.read(text.as_bytes())?.lines;
    Ok(lines.into_iter().map(|line| (line.number, line.entry)).collect())
}

fn setting(name: &str, value: &str) -> Entry {
    let (name, value) = (name.to_owned(), value.to_owned());
    Entry::Setting { name, value }
}

fn head(key: &str, value: &str) -> Entry {
    let (key, value) = (key.to_owned(), value.to_owned());
    Entry::Head { key, value }
}

#[test]
fn known_checksum() {
    assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
}

#[test]
fn lines_are_what_their_first_mark_says() {
    let text = "\u{feff}profidrive backup 2 \r\n  a b = c = d:e # x # y\r\n\n# = no\nk : v = w\n\u{3a} = \nwords only\n";
    let expected = vec![
        (2, setting("a b", "c = d:e")),
        (5, head("k", "v = w")),
        (6, head("", "=")),
        (7, Entry::Words("words only".to_owned())),
    ];
    assert_eq!(entries(&OPEN, text), Ok(expected));
    let read = OPEN.read(text.as_bytes()).unwrap();
    assert_eq!((read.version, read.lines[0].comment.as_str()), (2, "x # y"));
}

#[test]
fn comments_begin_in_their_column() {
    let mut text = OPEN.begin(3);
    text.setting("a", "1", "one\ntwo");
    text.setting("a long name", "and a value", " x ");
    text.comment("y\u{1b}");
    text.blank();
    let expected = "profidrive backup 3\na = 1               # one two\n\
                    a long name = and a value  # x\n# y\\u{1b}\n\n";
    assert_eq!(text.finish(), expected);
}

#[test]
fn mistakes_are_reported_with_their_lines() {
    let sealed = |text: &str| format!("{text}checksum {:08x}\n", crc32(text.as_bytes()));
    let long = " ".repeat(LONGEST + 1);
    for (form, text, expected) in [
        (
            OPEN,
            "",
            "line 1: not a backup: the first line is `profidrive backup 3`, not ``",
        ),
        (
            OPEN,
            "profidrive state 1\n",
            "line 1: not a backup: the first line",
        ),
        (
            OPEN,
            "profidrive backup 4\n",
            "line 1: a backup of form 4, this program reads form 3",
        ),
        (
            OPEN,
            "profidrive backup 1",
            "line 1: the last line has no line break",
        ),
        (
            OPEN,
            "profidrive backup 1\na = 24",
            "line 2: the last line has no line break",
        ),
        (
            OPEN,
            "profidrive backup 1\n\na = \u{7}1\n",
            "line 3: '\\u{7}' is not text",
        ),
        (OPEN, &long, "line 1: longer than"),
        (
            OPEN,
            "profidrive backup 1\na = 1\nchecksum 00000000\n",
            "line 3: the text was changed",
        ),
        (
            SEALED,
            "profidrive state 1\na = 1\n",
            "line 2: the end of the text is missing",
        ),
        (
            SEALED,
            &sealed("profidrive state 1\n\u{1b} = 1\n"),
            "line 2: '\\u{1b}' is not text",
        ),
    ] {
        let error = entries(&form, text).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{text:?}: {error}");
    }
    let error = OPEN.read(b"profidrive backup 1\na = 1\n\xFF\n").unwrap_err();
    assert_eq!(error.to_string(), "line 3: not text (UTF-8), not a backup");
    let read = entries(&OPEN, &sealed("profidrive backup 1\na = 1\n"));
    assert_eq!(read, Ok(vec![(2, setting("a", "1"))]), "a checksum is no entry");
}

#[test]
fn what_is_not_an_escape_stays_as_it_is() {
    for text in ["\\u{110000} \\u{zz} \\u{1", "\\u{", "\\", ""] {
        assert_eq!(unescape(text), text);
    }
}

fn any_text() -> impl Strategy<Value = String> {
    let marks = "[ -~]{0,12}|[#=:\\\\ \t\n\r{}u0-9]{0,8}|checksum [0-9a-f]{8}|\\PC{0,4}";
    prop_oneof![marks, any::<String>()]
}

fn any_entry() -> impl Strategy<Value = Entry> {
    let word = any_text().prop_filter("no words", |text| !text.is_empty());
    prop_oneof![
        (any_text(), any_text()).prop_map(|(name, value)| Entry::Setting { name, value }),
        (any_text(), any_text()).prop_map(|(key, value)| Entry::Head { key, value }),
        word.prop_map(Entry::Words),
    ]
}

fn written(form: &Form, lines: &[(Entry, String)]) -> String {
    let mut text = form.begin(form.version);
    for (entry, comment) in lines {
        match entry {
            Entry::Setting { name, value } => text.setting(name, value, comment),
            Entry::Head { key, value } => text.head(key, value, comment),
            Entry::Words(words) => text.words(words),
        }
    }
    text.finish()
}

proptest! {
    /// All names and values survive the round trip, one a line, without terminal control characters.
    #[test]
    fn every_entry_survives_the_text(
        lines in prop::collection::vec((any_entry(), any_text()), 0..8), sealed: bool,
    ) {
        let form = if sealed { SEALED } else { OPEN };
        let text = written(&form, &lines);
        prop_assert!(!text.chars().any(|c| c != '\n' && is_unsafe(c)), "{:?}", text);
        let read = form.read(text.as_bytes());
        prop_assert!(read.is_ok(), "{:?} {:?}", text, read);
        let read = read.unwrap().lines;
        prop_assert_eq!(read.len(), lines.len());
        for (at, (line, (entry, comment))) in read.iter().zip(&lines).enumerate() {
            prop_assert_eq!(line.number, at + 2);
            prop_assert_eq!(&line.entry, entry);
            if !matches!(entry, Entry::Words(_)) {
                let comment = comment.replace(['\n', '\r', '\t'], " ");
                prop_assert_eq!(line.comment.as_str(), comment.trim());
            }
        }
    }

    /// A cut is refused with a line of what is left. Only an unsealed text may lose whole lines unnoticed.
    #[test]
    fn every_cut_is_noticed(lines in prop::collection::vec((any_entry(), any_text()), 0..4)) {
        let text = written(&SEALED, &lines);
        for end in 0..text.len() {
            let cut = SEALED.read(&text.as_bytes()[..end]);
            prop_assert!(cut.is_err_and(|problem| problem.line <= lines.len() + 2), "{}", end);
        }
        let text = written(&OPEN, &lines);
        let whole = OPEN.read(text.as_bytes()).unwrap().lines;
        for end in 0..text.len() {
            if let Ok(cut) = OPEN.read(&text.as_bytes()[..end]) {
                prop_assert!(whole.starts_with(&cut.lines), "{}", end);
            }
        }
    }

    #[test]
    fn a_changed_octet_of_a_sealed_text_is_noticed(
        lines in prop::collection::vec((any_entry(), any_text()), 0..4), at: prop::sample::Index, flip in 1..=255_u8,
    ) {
        let mut octets = written(&SEALED, &lines).into_bytes();
        let at = at.index(octets.len());
        octets[at] ^= flip;
        prop_assert!(SEALED.read(&octets).is_err());
    }

    #[test]
    fn foreign_octets_are_read_or_refused(octets in prop::collection::vec(any::<u8>(), 0..200), lines in "[ -~\\n#=:]{0,80}") {
        let _ = OPEN.read(&octets);
        let text = format!("profidrive backup 1\n{lines}");
        match OPEN.read(text.as_bytes()) {
            Ok(read) => prop_assert!(read.lines.iter().all(|line| line.number <= text.lines().count())),
            Err(problem) => prop_assert!((1..=text.lines().count()).contains(&problem.line)),
        }
    }
}
