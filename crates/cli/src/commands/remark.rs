//! Remarks of the library, printed for all commands.

use profidrive::Remark;

use crate::advice;
use crate::output::Output;

/// Prints a remark: of these drives, where there are many.
pub fn print(remark: &Remark, drives: &str, output: &Output) {
    let option = remark.next.as_ref().map(|next| advice::text(next, "DRIVE"));
    let option = option.map_or_else(String::new, |option| format!(" (use {option})"));
    let words = format!("{drives}{}{option}", remark.sentence);
    if remark.is_warning {
        output.warn(&words);
    } else {
        output.say(&words);
    }
}
