//! What is expected of the drives of a plant, and whether it came true.
//!
//! | module | content |
//! |---|---|
//! | `condition` | what must hold of a drive, and how it is looked at |
//! | `expectation` | an expectation as it was read |
//! | `goal` | conditions that a run waits for |
//! | `measure` | numbers that are made of a run |
//! | `parse` | expectations as TOML, with the line of each mistake |
//! | `monitor` | the checks, tick by tick, in bounded memory |
//! | `result` | what came of an expectation, in words and as data |
//! | `junit` | the same as a JUnit report |

mod condition;
mod expectation;
mod goal;
#[cfg(feature = "junit")]
mod junit;
mod measure;
mod monitor;
mod parse;
mod result;
mod value;

pub(crate) use condition::revolutions;
pub use condition::{Live, Observed, Quantity};
pub use expectation::Expectation;
pub use goal::Goal;
#[cfg(feature = "junit")]
pub use junit::{Suite, junit};
pub use measure::Measure;
pub use monitor::Monitor;
pub(crate) use parse::{Scope, read_all, read_goal, read_list};
pub use result::{ExpectationResult, Nearest, Outcome};
