//! The picture of a device: a bitmap of 70 x 40 points.

use alloc::vec;
use alloc::vec::Vec;

/// Columns of a picture.
pub const WIDTH: u32 = 70;
/// Rows of a picture.
pub const HEIGHT: u32 = 40;
/// Octets of a row in the file, filled up to four.
const ROW: usize = (WIDTH as usize * 3).next_multiple_of(4);
/// Octets before the points.
const HEAD: usize = 14 + 40;

/// A picture to be drawn and written as a BMP file of 24 bits without compression, the form every tool takes.
///
/// ```
/// use profidrive_gsdml::Bitmap;
/// let mut picture = Bitmap::new([255, 255, 255]);
/// picture.fill(10, 5, 50, 30, [0, 90, 160]);
/// let file = picture.to_bmp();
/// assert_eq!(&file[..2], b"BM");
/// assert_eq!(file.len(), 54 + 40 * 212);
/// assert_eq!(Bitmap::size_of(&file), Some((70, 40)));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bitmap {
    /// Rows from the top, in each point red, green, blue.
    points: Vec<[u8; 3]>,
}

impl Bitmap {
    /// In one colour.
    #[must_use]
    pub fn new(colour: [u8; 3]) -> Self {
        Self {
            points: vec![colour; WIDTH as usize * HEIGHT as usize],
        }
    }

    /// Fills a rectangle; what lies outside is cut off.
    pub fn fill(&mut self, x: u32, y: u32, width: u32, height: u32, colour: [u8; 3]) {
        for row in y..y.saturating_add(height).min(HEIGHT) {
            for column in x..x.saturating_add(width).min(WIDTH) {
                if let Some(point) = self.points.get_mut((row * WIDTH + column) as usize) {
                    *point = colour;
                }
            }
        }
    }

    /// Draws a pattern: a row of text for each row of points, every character but a blank is a point.
    pub fn stamp(&mut self, x: u32, y: u32, pattern: &[&str], colour: [u8; 3]) {
        for (row, line) in (y..).zip(pattern) {
            for (column, _) in (x..).zip(line.bytes()).filter(|(_, mark)| *mark != b' ') {
                self.fill(column, row, 1, 1, colour);
            }
        }
    }

    /// Returns the octets of the file.
    #[must_use]
    pub fn to_bmp(&self) -> Vec<u8> {
        let size = HEAD + ROW * HEIGHT as usize;
        let mut file = Vec::with_capacity(size);
        let word = |file: &mut Vec<u8>, value: u32| file.extend(value.to_le_bytes());
        file.extend(b"BM");
        word(&mut file, size as u32);
        word(&mut file, 0);
        word(&mut file, HEAD as u32);
        word(&mut file, 40);
        word(&mut file, WIDTH);
        word(&mut file, HEIGHT);
        // one plane, 24 bits
        word(&mut file, 24 << 16 | 1);
        word(&mut file, 0);
        word(&mut file, (ROW * HEIGHT as usize) as u32);
        // 2835 points a metre, 72 an inch
        word(&mut file, 2835);
        word(&mut file, 2835);
        word(&mut file, 0);
        word(&mut file, 0);
        for row in self.points.rchunks(WIDTH as usize) {
            let start = file.len();
            file.extend(row.iter().flat_map(|[red, green, blue]| [*blue, *green, *red]));
            file.resize(start + ROW, 0);
        }
        file
    }

    /// Columns and rows of a BMP file; none if it is not a BMP file.
    #[must_use]
    pub fn size_of(file: &[u8]) -> Option<(u32, u32)> {
        let word = |at: usize| {
            let octets: [u8; 4] = file.get(at..at + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(octets))
        };
        file.starts_with(b"BM")
            .then_some((word(18)?, word(22)?.cast_signed().unsigned_abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_of_the_picture_is_the_last_of_the_file() {
        let mut picture = Bitmap::new([0; 3]);
        picture.stamp(1, 0, &["# "], [1, 2, 3]);
        let file = picture.to_bmp();
        let row = &file[HEAD + 39 * ROW..];
        assert_eq!(row[..9], [0, 0, 0, 3, 2, 1, 0, 0, 0]);
        assert!(file[HEAD..HEAD + 39 * ROW].iter().all(|octet| *octet == 0));
    }

    #[test]
    fn nothing_is_drawn_outside() {
        let mut picture = Bitmap::new([0; 3]);
        picture.fill(69, 39, u32::MAX, u32::MAX, [9; 3]);
        picture.fill(70, 0, 1, 1, [9; 3]);
        picture.fill(0, 40, 1, 1, [9; 3]);
        assert_eq!(picture.points.iter().filter(|point| **point == [9; 3]).count(), 1);
        assert_eq!(Bitmap::size_of(b"BM"), None);
        assert_eq!(Bitmap::size_of(b"PNG"), None);
    }
}
