//! Submodules with their cyclic data and records.

use alloc::format;
use alloc::vec::Vec;

use roxmltree::Node;

use super::attributes::attribute;
use super::references::Kind;
use super::{Reader, child, is};
use crate::data::{BitItem, Consistency, DataDescription, DataItem, DataType, IoData};
use crate::model::{Constant, Menu, MenuEntry, ParameterRecord, ParameterRef, Submodule};
use crate::problem::{Rule, Severity};
use crate::value::shortened;

/// Most octets of cyclic data in one frame.
const MOST_DATA: u32 = 1440;

impl Reader<'_> {
    pub(super) fn submodule(&mut self, node: Node<'_, '_>, kind: Kind) -> Option<Submodule> {
        let id = self.id(node, kind);
        let ident = self.needed_number(node, "SubmoduleIdentNumber");
        let submodule = Submodule {
            api: self.number(node, "API").unwrap_or(0),
            fixed_in_subslots: self.values_or(node, "FixedInSubslots", "1"),
            process_alarms: self.flag(node, "MayIssueProcessAlarm"),
            writable_im: self.values(node, "Writeable_IM_Records"),
            info: self.module_info(node),
            io: self.io_data(node),
            records: self.list(node, "RecordDataList", "ParameterRecordDataItem", Self::record),
            graphics: self.graphic_refs(node),
            id: id?,
            ident: ident?,
        };
        Some(submodule)
    }

    fn io_data(&mut self, node: Node<'_, '_>) -> IoData {
        let Some(node) = child(node, "IOData") else {
            return IoData::default();
        };
        IoData {
            input: child(node, "Input").map(|node| self.data(node)),
            output: child(node, "Output").map(|node| self.data(node)),
            iops_length: self.number(node, "IOPS_Length").unwrap_or(1),
            iocs_length: self.number(node, "IOCS_Length").unwrap_or(1),
        }
    }

    fn data(&mut self, node: Node<'_, '_>) -> DataDescription {
        let consistency = match self.string(node, "Consistency").as_deref() {
            Some("All items consistency") => Consistency::All,
            Some("Item consistency") | None => Consistency::Item,
            Some(other) => {
                let message = format!("Consistency=\"{}\" is not known", shortened(other));
                self.at(Severity::Error, Rule::Value, node, message);
                Consistency::Item
            }
        };
        let data = DataDescription {
            consistency,
            items: self.children(node, "DataItem", Self::data_item),
        };
        let length = data.length();
        if length > MOST_DATA {
            let message = format!("{length} octets of data; a frame has at most {MOST_DATA}");
            self.at(Severity::Unusable, Rule::Length, node, message);
        }
        data
    }

    fn data_item(&mut self, node: Node<'_, '_>) -> Option<DataItem> {
        let name = self.needed_string(node, "DataType")?;
        let item = DataItem {
            data_type: DataType::of(name.trim()),
            length: self.number(node, "Length"),
            text: self.text_of(node, "TextId"),
            use_as_bits: self.flag(node, "UseAsBits"),
            bits: self.children(node, "BitDataItem", |reader, node| {
                let offset = reader.needed_number(node, "BitOffset");
                let text = reader.text_of(node, "TextId");
                Some(BitItem {
                    offset: offset?,
                    text,
                })
            }),
        };
        let octets = item.octets();
        if octets == 0 {
            let message = format!("DataItem of type `{}` has no length", shortened(&name));
            self.at(Severity::Unusable, Rule::Length, node, message);
        }
        if let Some(bit) = item.bits.iter().find(|bit| u32::from(bit.offset) >= octets * 8) {
            let message = format!("BitOffset {} in a DataItem of {octets} octets", bit.offset);
            self.at(Severity::Error, Rule::Value, node, message);
        }
        Some(item)
    }

    fn record(&mut self, node: Node<'_, '_>) -> Option<ParameterRecord> {
        let index = self.needed_number(node, "Index");
        let length = self.needed_number(node, "Length");
        let menus = self.list(node, "MenuList", "MenuItem", Self::menu);
        self.menus_end(node, &menus);
        let record = ParameterRecord {
            sequence: self.number(node, "TransferSequence").unwrap_or(0),
            name: self.text_of_child(node, "Name"),
            constants: self.children(node, "Const", Self::constant),
            parameters: self.children(node, "Ref", Self::parameter),
            menus,
            index: index?,
            length: length?,
        };
        self.record_fits(node, &record);
        Some(record)
    }

    /// Nothing in a record lies behind its end.
    fn record_fits(&mut self, node: Node<'_, '_>, record: &ParameterRecord) {
        let ends = record.constants.iter().map(|constant| {
            let length = u32::try_from(constant.data.len()).unwrap_or(u32::MAX);
            u32::from(constant.offset).saturating_add(length)
        });
        let end = ends.max().unwrap_or(0);
        if end > u32::from(record.length) {
            let message = format!(
                "record {}: constants end at octet {end}, the record at {}",
                record.index, record.length
            );
            self.at(Severity::Error, Rule::Length, node, message);
        }
        let parameters = record.parameters.iter().map(|parameter| {
            let bits = parameter.bit_length.map_or(0, u32::from) + parameter.bit_offset.map_or(0, u32::from);
            let octets = DataType::of(&parameter.data_type).octets();
            let octets = octets.or(parameter.length.map(u32::from));
            u32::from(parameter.offset) + octets.unwrap_or_else(|| bits.div_ceil(8).max(1))
        });
        let end = parameters.max().unwrap_or(0);
        if end > u32::from(record.length) {
            let message = format!(
                "record {}: a parameter ends at octet {end}, the record at {}",
                record.index, record.length
            );
            self.at(Severity::Error, Rule::Length, node, message);
        }
    }

    fn constant(&mut self, node: Node<'_, '_>) -> Option<Constant> {
        let offset = self.number(node, "ByteOffset").unwrap_or(0);
        let text = self.needed_string(node, "Data")?;
        let mut data = Vec::new();
        for octet in text.split(',') {
            let octet = octet.trim();
            let digits = octet.strip_prefix("0x").or_else(|| octet.strip_prefix("0X"));
            let value = digits
                .filter(|digits| digits.len() <= 2)
                .and_then(|digits| u8::from_str_radix(digits, 16).ok());
            let Some(value) = value else {
                let at = attribute(node, "Data").map_or(0, |attribute| attribute.range().start);
                let message = format!("Data: `{}` is not an octet such as 0x1F", shortened(octet));
                self.problem(Severity::Unusable, Rule::Value, at, message);
                return None;
            };
            data.push(value);
        }
        Some(Constant { offset, data })
    }

    fn parameter(&mut self, node: Node<'_, '_>) -> Option<ParameterRef> {
        let data_type = self.needed_string(node, "DataType")?;
        let values = self.string(node, "ValueItemTarget");
        if let Some(values) = &values {
            self.name(node, "ValueItemTarget", Kind::Value, values);
        }
        Some(ParameterRef {
            id: self.string(node, "ID"),
            data_type,
            offset: self.number(node, "ByteOffset").unwrap_or(0),
            bit_offset: self.number(node, "BitOffset"),
            bit_length: self.number(node, "BitLength"),
            length: self.number(node, "Length"),
            default: self.string(node, "DefaultValue"),
            allowed: self.string(node, "AllowedValues"),
            changeable: self.flag_or(node, "Changeable", true),
            visible: self.flag_or(node, "Visible", true),
            values,
            text: self.text_of(node, "TextId"),
        })
    }

    fn menu(&mut self, node: Node<'_, '_>) -> Option<Menu> {
        let id = self.needed_string(node, "ID")?;
        let entries = node.children().filter_map(|entry| {
            if is(entry, "ParameterRef") {
                let target = self.needed_string(entry, "ParameterTarget");
                target.map(MenuEntry::Parameter)
            } else if is(entry, "MenuRef") {
                self.needed_string(entry, "MenuTarget").map(MenuEntry::Menu)
            } else {
                None
            }
        });
        let entries = entries.collect();
        Some(Menu {
            id,
            name: self.text_of_child(node, "Name"),
            entries,
        })
    }
}
