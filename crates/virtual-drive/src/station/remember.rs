//! Name, address and I&M data as text, in the same form as the saved parameters.

use std::fmt::Write as _;
use std::net::Ipv4Addr;

use profinet::IpSuite;
use profinet::device::{ImRecords, Stored};

use crate::store::{Image, ImageError};

/// What stands in the place of the model.
const MODEL: &str = "network";

/// The text to keep for [`StationEvent::PersistNetwork`](super::StationEvent::PersistNetwork).
///
/// ```
/// use profinet::device::Stored;
/// use virtual_drive::station::{network_from_text, network_to_text};
/// let stored = Stored { name: "akd-1".into(), ..Stored::default() };
/// let text = network_to_text(&stored);
/// assert!(text.contains("\nname = akd-1\naddress = 0.0.0.0\n"));
/// assert_eq!(network_from_text(text.as_bytes()), Ok(stored));
/// ```
#[must_use]
pub fn network_to_text(stored: &Stored) -> String {
    let mut image = Image::new(MODEL);
    image.push_text("name", &stored.name);
    image.push_text("address", &stored.ip.address.to_string());
    image.push_text("mask", &stored.ip.mask.to_string());
    image.push_text("gateway", &stored.ip.gateway.to_string());
    let im = &stored.im;
    for (name, octets) in [
        ("im1", &im.im1[..]),
        ("im2", &im.im2),
        ("im3", &im.im3),
        ("im4", &im.im4),
    ] {
        let mut hex = String::new();
        for octet in octets {
            // Writing into a String does not fail.
            let _ = write!(hex, "{octet:02x}");
        }
        image.push_text(name, &hex);
    }
    image.encode()
}

/// The data of a kept text. Lines that say nothing known are passed over.
///
/// # Errors
/// When the text is damaged, of another version, or the text of something else.
pub fn network_from_text(text: &[u8]) -> Result<Stored, ImageError> {
    let image = Image::decode(text)?;
    if image.model() != MODEL {
        return Err(ImageError::Model {
            found: image.model().to_owned(),
            expected: MODEL,
        });
    }
    let mut stored = Stored {
        ip: IpSuite::NONE,
        im: ImRecords::default(),
        ..Stored::default()
    };
    let address = |text: &str| text.parse().unwrap_or(Ipv4Addr::UNSPECIFIED);
    for (name, value) in image.entries() {
        match name {
            "name" => value.clone_into(&mut stored.name),
            "address" => stored.ip.address = address(value),
            "mask" => stored.ip.mask = address(value),
            "gateway" => stored.ip.gateway = address(value),
            "im1" => fill(&mut stored.im.im1, value),
            "im2" => fill(&mut stored.im.im2, value),
            "im3" => fill(&mut stored.im.im3, value),
            "im4" => fill(&mut stored.im.im4, value),
            _ => {}
        }
    }
    Ok(stored)
}

/// Puts hexadecimal octets in; what is no octet leaves its place as it is.
fn fill(octets: &mut [u8], hex: &str) {
    for (octet, digits) in octets.iter_mut().zip(hex.as_bytes().chunks(2)) {
        let digits = core::str::from_utf8(digits).unwrap_or_default();
        if let Ok(value) = u8::from_str_radix(digits, 16) {
            *octet = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_comes_back() {
        let mut im = ImRecords::default();
        im.im1[0] = b'M';
        im.im4 = [0xA5; 54];
        let ip = IpSuite {
            address: [10, 1, 2, 3].into(),
            mask: [255, 0, 0, 0].into(),
            gateway: [10, 0, 0, 1].into(),
        };
        let stored = Stored {
            name: "a-1.b".into(),
            ip,
            im,
        };
        assert_eq!(network_from_text(network_to_text(&stored).as_bytes()), Ok(stored));
    }

    #[test]
    fn other_texts_are_refused() {
        let parameters = Image::new("AKD").encode();
        assert!(matches!(
            network_from_text(parameters.as_bytes()),
            Err(ImageError::Model { .. })
        ));
        assert!(network_from_text(b"name = x").is_err());
    }
}
