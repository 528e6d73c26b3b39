//! The pages that a reader finds: README, and those that the table of contents of the site names.

use std::path::PathBuf;

use pulldown_cmark::{Event, Options, Parser, Tag};
use system_tests::root;

/// Folder of the pages of the site.
pub const SOURCES: &str = "docs/src";

/// A page as it stands in the repository.
pub struct Page {
    /// Path from the folder of the workspace.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Page {
    /// Reads a page by its path from the folder of the workspace.
    pub fn read(path: impl Into<PathBuf>) -> Self {
        let path = path.into();
        let text = std::fs::read_to_string(root().join(&path))
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Self { path, text }
    }

    /// Returns its name for messages.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Returns its Markdown.
    pub fn events(&self) -> impl Iterator<Item = Event<'_>> {
        Parser::new_ext(&self.text, Options::ENABLE_TABLES)
    }

    /// Targets of its links and pictures, in order.
    pub fn links(&self) -> Vec<String> {
        let target = |event| match event {
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                Some(dest_url.to_string())
            }
            _ => None,
        };
        self.events().filter_map(target).collect()
    }
}

/// Returns the page of the repository's front, then those of the site in the order of its table of contents.
pub fn all() -> Vec<Page> {
    let summary = Page::read(format!("{SOURCES}/SUMMARY.md"));
    let names = summary
        .links()
        .into_iter()
        .map(|name| format!("{SOURCES}/{name}"));
    ["README.md".to_owned()]
        .into_iter()
        .chain(names)
        .map(Page::read)
        .collect()
}
