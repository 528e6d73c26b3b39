//! How the work on many drives ended.

use client::ErrorKind;

/// Returns the kind that decides how the work on many drives ended: the most serious one; `None` without any.
///
/// ```
/// use profidrive::client::ErrorKind;
/// use profidrive::fleet::kind_of;
///
/// let kinds = [ErrorKind::Refused, ErrorKind::Safety, ErrorKind::Difference];
/// assert_eq!(kind_of(kinds), Some(ErrorKind::Safety));
/// ```
#[must_use]
pub fn kind_of(kinds: impl IntoIterator<Item = ErrorKind>) -> Option<ErrorKind> {
    kinds.into_iter().max_by_key(|kind| weight(*kind))
}

/// Of several kinds the one with the highest number decides.
const fn weight(kind: ErrorKind) -> u8 {
    match kind {
        ErrorKind::Interrupted => 9,
        ErrorKind::Safety => 8,
        ErrorKind::Lost => 7,
        ErrorKind::Unreachable => 6,
        ErrorKind::Refused => 5,
        ErrorKind::Usage => 4,
        ErrorKind::Partial => 2,
        ErrorKind::Difference => 1,
        _ => 3,
    }
}
