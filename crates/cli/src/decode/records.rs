//! Records by number.

use crate::render::hex_bytes;

/// Name of a record index.
pub fn name(index: u16) -> String {
    let known = match index {
        0x002F => "parameter access (record 47)",
        0xB02E => "parameter access local",
        0xB02F => "parameter access global",
        0xAFF0 => "I&M0",
        0xAFF1 => "I&M1 (function and location)",
        0xAFF2 => "I&M2 (installation date)",
        0xAFF3 => "I&M3 (descriptor)",
        0xAFF4 => "I&M4 (signature)",
        0x8000..=0x801F => "submodule diagnosis or PDEV data",
        0x8028 => "input data",
        0x8029 => "output data",
        0x802A => "port data real",
        0x8080 => "interface data real",
        0xE000 | 0xF000 | 0xC000 | 0x8030 => "identification",
        0xE00C | 0xF00C | 0xC00C | 0xF80C => "diagnosis",
        0xE040 => "multiple write",
        0xE050 | 0xF820 => "AR data",
        0xF821 => "API data",
        0xF830 => "log data",
        0xF831 => "PDEV data",
        0xF840 => "I&M0 filter data",
        0xF841 => "PDEV data real",
        0xFBFF => "trigger of the connection monitoring",
        _ => return format!("record 0x{index:04X}"),
    };
    format!("{known} (0x{index:04X})")
}

/// Where a record lives: `slot 1/1`.
pub fn place(api: u32, slot: u16, subslot: u16) -> String {
    let api = if api == 0 {
        String::new()
    } else {
        format!(" API 0x{api:04X}")
    };
    if subslot > 0xFF {
        format!("slot {slot}/0x{subslot:04X}{api}")
    } else {
        format!("slot {slot}/{subslot}{api}")
    }
}

/// The start of its data.
pub fn content(data: &[u8]) -> String {
    const SHOWN: usize = 16;
    match data.split_at_checked(SHOWN) {
        Some((start, rest)) if !rest.is_empty() => format!("{} octets {} ..", data.len(), hex_bytes(start)),
        _ => format!("{} octets {}", data.len(), hex_bytes(data))
            .trim_end()
            .to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_have_names_where_there_are_any() {
        assert_eq!(name(0xFBFF), "trigger of the connection monitoring (0xFBFF)");
        assert_eq!(name(0x1234), "record 0x1234");
    }
}
