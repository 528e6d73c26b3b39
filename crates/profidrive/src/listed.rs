//! Lists of names in a sentence.

/// Names that are shown before a list is cut.
const SHOWN: usize = 8;

/// Returns the first few names, and how many more there are.
#[must_use]
pub fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let (shown, more) = names.split_at(names.len().min(SHOWN));
    let shown: Vec<&str> = shown.iter().map(AsRef::as_ref).collect();
    match more.len() {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_of_names_are_cut() {
        let names = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j"];
        assert_eq!(listed(&names[..2]), "a, b");
        assert_eq!(listed(&names), "a, b, c, d, e, f, g, h and 2 more");
    }
}
