//! README and the pages in `docs/`: their commands are run, their links and anchors exist, and what they list is what the
//! program has.

mod listed;
pub mod pages;
mod site;
