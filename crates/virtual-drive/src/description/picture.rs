//! The picture of a virtual drive: a housing with its name, drawn here.

use gsdml::Bitmap;

const PAPER: [u8; 3] = [255, 255, 255];
const HOUSING: [u8; 3] = [58, 66, 74];
const EDGE: [u8; 3] = [32, 36, 42];
const FRONT: [u8; 3] = [214, 222, 228];
const LAMP: [u8; 3] = [40, 180, 90];
const SOCKET: [u8; 3] = [20, 22, 26];
const INK: [u8; 3] = [20, 80, 150];

/// Letters of 5 x 7 points, those that names of models need.
const LETTERS: &[(char, [&str; 7])] = &[
    (
        'A',
        [" ### ", "#   #", "#   #", "#####", "#   #", "#   #", "#   #"],
    ),
    (
        'D',
        ["#### ", "#   #", "#   #", "#   #", "#   #", "#   #", "#### "],
    ),
    (
        'K',
        ["#   #", "#  # ", "# #  ", "##   ", "# #  ", "#  # ", "#   #"],
    ),
];
/// A letter that is not in the table: an empty box.
const BOX: [&str; 7] = ["#####", "#   #", "#   #", "#   #", "#   #", "#   #", "#####"];

/// Returns a drive on the left, its name beside it.
pub(super) fn draw(name: &str) -> Bitmap {
    let mut picture = Bitmap::new(PAPER);
    picture.fill(4, 2, 24, 36, EDGE);
    picture.fill(5, 3, 22, 34, HOUSING);
    picture.fill(8, 6, 16, 8, FRONT);
    picture.fill(11, 9, 4, 2, LAMP);
    for row in 0..3 {
        picture.fill(8, 18 + 6 * row, 7, 4, SOCKET);
        picture.fill(17, 18 + 6 * row, 7, 4, SOCKET);
    }
    // a shaft that turns: the sign of a motor
    picture.fill(34, 26, 20, 10, HOUSING);
    picture.fill(54, 30, 8, 2, EDGE);
    for (place, letter) in (0..).zip(name.chars().take(5)) {
        let pattern = LETTERS
            .iter()
            .find(|(known, _)| *known == letter)
            .map_or(&BOX, |(_, pattern)| pattern);
        picture.stamp(34 + 7 * place, 8, pattern, INK);
    }
    picture
}
