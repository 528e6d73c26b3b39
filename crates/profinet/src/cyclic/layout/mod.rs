//! Where each submodule's data and status lie in the process data of one direction.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::vec;
use alloc::vec::Vec;

mod pack;

pub use pack::pack;

use super::timing::IocrError;
use crate::wire::rt::{MAX_DATA_LENGTH, MIN_DATA_LENGTH};

/// Direction of a cyclic connection, from the point of view of the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Device to controller.
    Input,
    /// Controller to device.
    Output,
}

/// Which data a submodule exchanges.
///
/// Source: IEC 61158-6-10, SubmoduleProperties bits 0 and 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum IoKind {
    /// No data; its status still travels like that of an input without length.
    None,
    /// Input only.
    Input,
    /// Output only.
    Output,
    /// Both.
    Both,
}

impl IoKind {
    /// Returns the kind that fits two lengths.
    #[must_use]
    pub const fn from_lengths(input: u16, output: u16) -> Self {
        match (input > 0, output > 0) {
            (false, false) => Self::None,
            (true, false) => Self::Input,
            (false, true) => Self::Output,
            (true, true) => Self::Both,
        }
    }

    /// Sends input data, be it of length 0.
    #[must_use]
    pub const fn has_input(self) -> bool {
        !matches!(self, Self::Output)
    }

    /// Receives output data.
    #[must_use]
    pub const fn has_output(self) -> bool {
        matches!(self, Self::Output | Self::Both)
    }
}

/// One expected submodule with the lengths of its data in octets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SubmoduleSize {
    /// Application process identifier; 0 is the default one.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Which data it has.
    pub kind: IoKind,
    /// Input octets without IOPS.
    pub input_length: u16,
    /// Output octets without IOPS.
    pub output_length: u16,
}

impl SubmoduleSize {
    /// Creates a submodule whose kind follows from its lengths.
    #[must_use]
    pub const fn new(api: u32, slot: u16, subslot: u16, input_length: u16, output_length: u16) -> Self {
        let kind = IoKind::from_lengths(input_length, output_length);
        Self {
            api,
            slot,
            subslot,
            kind,
            input_length,
            output_length,
        }
    }

    /// Returns the length of its data object of this direction; `None` if it has none.
    #[must_use]
    pub const fn data_length(&self, direction: Direction) -> Option<u16> {
        match direction {
            Direction::Input if self.kind.has_input() => Some(self.input_length),
            Direction::Output if self.kind.has_output() => Some(self.output_length),
            _ => None,
        }
    }

    /// Returns true if its IOCS travels in this direction: the status of the data that flows the other way.
    #[must_use]
    pub const fn has_status(&self, direction: Direction) -> bool {
        match direction {
            Direction::Input => self.kind.has_output(),
            Direction::Output => self.kind.has_input(),
        }
    }
}

/// One entry of the lists of an IOCR block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ObjectPlace {
    /// Application process identifier.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// First octet in the process data.
    pub offset: u16,
}

/// The data of one submodule; its IOPS is the octet behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct DataObject {
    /// Application process identifier.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// First octet of the data.
    pub offset: u16,
    /// Octets of data.
    pub length: u16,
}

impl DataObject {
    /// Returns the offset of the IOPS octet.
    #[must_use]
    pub const fn iops_offset(&self) -> u16 {
        self.offset.saturating_add(self.length)
    }
}

/// The IOCS octet of one submodule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StatusObject {
    /// Application process identifier.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// The octet.
    pub offset: u16,
}

/// The table of one direction's process data.
///
/// Source: IEC 61158-6-10, IOCRBlockReq with C_SDU of the RTC-PDU. The offsets are the controller's; they are checked,
/// never recomputed.
///
/// ```
/// use profidrive_profinet::cyclic::{SubmoduleSize, pack};
/// // a device access point without data, and a drive's telegram 1: two words each way
/// let (input, output) =
///     pack(&[SubmoduleSize::new(0, 0, 1, 0, 0), SubmoduleSize::new(0x3A00, 1, 1, 4, 4)]).unwrap();
/// let telegram = input.data(1, 1).unwrap();
/// assert_eq!((telegram.offset, telegram.iops_offset(), input.data_length()), (1, 5, 40));
/// assert_eq!(output.data(1, 1).unwrap().offset, 2);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    direction: Direction,
    data_length: u16,
    data: Vec<DataObject>,
    status: Vec<StatusObject>,
}

impl Layout {
    /// Builds and checks the table from the contents of an IOCR block and the expected submodules.
    ///
    /// # Errors
    /// The [`IocrError`] with the ErrorCode2 a device answers. Data and IOPS outside the frame or on top of
    /// something else are `DataOffset`, IOCS are `StatusOffset`.
    pub fn new(
        direction: Direction,
        data_length: u16,
        data: &[ObjectPlace],
        status: &[ObjectPlace],
        expected: &[SubmoduleSize],
    ) -> Result<Self, IocrError> {
        if !(MIN_DATA_LENGTH..=MAX_DATA_LENGTH).contains(&data_length) {
            return Err(IocrError::DataLength(data_length));
        }
        if data.is_empty() && status.is_empty() {
            return Err(IocrError::NumberOfApis);
        }
        let mut map = Occupied::new(data_length);
        let expected = Expected::new(expected);
        let (mut with_data, mut with_status) = (BTreeSet::new(), BTreeSet::new());
        let mut layout = Self {
            direction,
            data_length,
            data: Vec::new(),
            status: Vec::new(),
        };
        for place in data {
            let ObjectPlace {
                api,
                slot,
                subslot,
                offset,
            } = *place;
            let size = expected.find(
                place,
                IocrError::DataSlot(slot),
                IocrError::DataSubslot(slot, subslot),
            )?;
            let length = size
                .data_length(direction)
                .ok_or(IocrError::DataSubslot(slot, subslot))?;
            if !with_data.insert((api, slot, subslot)) {
                return Err(IocrError::DataSubslot(slot, subslot));
            }
            let end = u32::from(length) + 1;
            map.take(offset, end)
                .ok_or(IocrError::DataOffset(slot, subslot, offset))?;
            layout.data.push(DataObject {
                api,
                slot,
                subslot,
                offset,
                length,
            });
        }
        for place in status {
            let ObjectPlace {
                api,
                slot,
                subslot,
                offset,
            } = *place;
            let missing = IocrError::StatusSubslot(slot, subslot);
            let size = expected.find(place, IocrError::StatusSlot(slot), missing)?;
            let twice = !with_status.insert((api, slot, subslot));
            if twice || !size.has_status(direction) {
                return Err(missing);
            }
            map.take(offset, 1)
                .ok_or(IocrError::StatusOffset(slot, subslot, offset))?;
            layout.status.push(StatusObject {
                api,
                slot,
                subslot,
                offset,
            });
        }
        Ok(layout)
    }

    /// Direction this table is for.
    #[must_use]
    pub const fn direction(&self) -> Direction {
        self.direction
    }

    /// Octets of process data, status and gaps; the DataLength of the IOCR block.
    #[must_use]
    pub const fn data_length(&self) -> u16 {
        self.data_length
    }

    /// Returns all data objects in the order of the block.
    #[must_use]
    pub fn data_objects(&self) -> &[DataObject] {
        &self.data
    }

    /// Returns all IOCS in the order of the block.
    #[must_use]
    pub fn status_objects(&self) -> &[StatusObject] {
        &self.status
    }

    /// Returns the data object of a submodule.
    #[must_use]
    pub fn data(&self, slot: u16, subslot: u16) -> Option<&DataObject> {
        self.data.iter().find(|d| d.slot == slot && d.subslot == subslot)
    }

    /// Returns the IOCS of a submodule.
    #[must_use]
    pub fn status(&self, slot: u16, subslot: u16) -> Option<&StatusObject> {
        self.status
            .iter()
            .find(|s| s.slot == slot && s.subslot == subslot)
    }
}

/// The expected submodules by API, slot and subslot: found without looking at all of them, whatever a peer requests.
struct Expected<'a>(BTreeMap<(u32, u16, u16), &'a SubmoduleSize>);

impl<'a> Expected<'a> {
    fn new(sizes: &'a [SubmoduleSize]) -> Self {
        let mut map = BTreeMap::new();
        for size in sizes {
            map.entry((size.api, size.slot, size.subslot)).or_insert(size);
        }
        Self(map)
    }

    /// Returns the submodule of a place, or the error for what of it is missing.
    fn find(
        &self,
        place: &ObjectPlace,
        no_slot: IocrError,
        no_subslot: IocrError,
    ) -> Result<&'a SubmoduleSize, IocrError> {
        let ObjectPlace {
            api, slot, subslot, ..
        } = *place;
        let any = |first, last| self.0.range(first..=last).next().is_some();
        match self.0.get(&(api, slot, subslot)) {
            Some(size) => Ok(*size),
            None if any((api, slot, 0), (api, slot, u16::MAX)) => Err(no_subslot),
            None if any((api, 0, 0), (api, u16::MAX, u16::MAX)) => Err(no_slot),
            None => Err(IocrError::Api(api)),
        }
    }
}

/// Which octets of the process data are in use.
struct Occupied(Vec<bool>);

impl Occupied {
    fn new(length: u16) -> Self {
        Self(vec![false; usize::from(length)])
    }

    fn take(&mut self, offset: u16, length: u32) -> Option<()> {
        let start = usize::from(offset);
        let end = start.checked_add(usize::try_from(length).ok()?)?;
        let range = self.0.get_mut(start..end)?;
        if range.contains(&true) {
            return None;
        }
        range.fill(true);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    // the submodules of the captured S7-1500 connect
    pub(super) fn s7() -> Vec<SubmoduleSize> {
        vec![
            SubmoduleSize::new(0, 0, 1, 0, 0),
            SubmoduleSize::new(0, 0, 0x8000, 0, 0),
            SubmoduleSize::new(0, 0, 0x8001, 0, 0),
            SubmoduleSize::new(0, 1, 1, 1, 0),
            SubmoduleSize::new(0, 2, 1, 0, 1),
            SubmoduleSize::new(0, 3, 1, 1, 1),
            SubmoduleSize::new(0, 4, 1, 8, 8),
        ]
    }

    pub(super) fn places(layout: &Layout) -> (Vec<ObjectPlace>, Vec<ObjectPlace>) {
        let data = layout.data_objects().iter();
        let data = data.map(|d| ObjectPlace {
            api: d.api,
            slot: d.slot,
            subslot: d.subslot,
            offset: d.offset,
        });
        let status = layout.status_objects().iter();
        let status = status.map(|d| ObjectPlace {
            api: d.api,
            slot: d.slot,
            subslot: d.subslot,
            offset: d.offset,
        });
        (data.collect(), status.collect())
    }

    fn place(api: u32, slot: u16, subslot: u16, offset: u16) -> ObjectPlace {
        ObjectPlace {
            api,
            slot,
            subslot,
            offset,
        }
    }

    fn error(length: u16, data: &[ObjectPlace], status: &[ObjectPlace]) -> u8 {
        Layout::new(Direction::Input, length, data, status, &s7())
            .unwrap_err()
            .code2()
    }

    #[test]
    fn each_mistake_has_its_code() {
        let good = [place(0, 1, 1, 0)];
        assert_eq!(error(39, &good, &[]), 8);
        assert_eq!(error(1441, &good, &[]), 8);
        assert_eq!(error(40, &[], &[]), 19);
        assert_eq!(error(40, &[place(1, 1, 1, 0)], &[]), 20);
        assert_eq!(error(40, &[place(0, 9, 1, 0)], &[]), 22);
        assert_eq!(error(40, &[place(0, 1, 2, 0)], &[]), 23);
        assert_eq!(
            error(40, &[place(0, 2, 1, 0)], &[]),
            23,
            "an output has no input data"
        );
        assert_eq!(
            error(40, &[place(0, 1, 1, 0), place(0, 1, 1, 8)], &[]),
            23,
            "twice"
        );
        assert_eq!(
            error(40, &[place(0, 1, 1, 39)], &[]),
            24,
            "its IOPS would be octet 40"
        );
        assert_eq!(error(40, &[place(0, 1, 1, 65535)], &[]), 24);
        assert_eq!(
            error(40, &[place(0, 1, 1, 0), place(0, 3, 1, 1)], &[]),
            24,
            "on an IOPS"
        );
        assert_eq!(error(40, &good, &[place(7, 2, 1, 2)]), 20);
        assert_eq!(error(40, &good, &[place(0, 9, 1, 2)]), 26);
        assert_eq!(error(40, &good, &[place(0, 2, 7, 2)]), 27);
        assert_eq!(
            error(40, &good, &[place(0, 1, 1, 2)]),
            27,
            "an input has no IOCS in the input frame"
        );
        assert_eq!(
            error(40, &good, &[place(0, 2, 1, 2), place(0, 2, 1, 3)]),
            27,
            "twice"
        );
        assert_eq!(error(40, &good, &[place(0, 2, 1, 40)]), 28);
        assert_eq!(error(40, &good, &[place(0, 2, 1, 1)]), 28, "on an IOPS");
        let last = Layout::new(Direction::Input, 40, &[place(0, 1, 1, 38)], &[], &s7());
        assert!(last.is_ok());
    }

    proptest! {
        #[test]
        fn any_places_are_judged_without_panic(
            data in proptest::collection::vec((0u16..6, 0u16..3, any::<u16>()), 0..6),
            status in proptest::collection::vec((0u16..6, 0u16..3, 0u16..50), 0..6), length: u16) {
            let to = |v: Vec<(u16, u16, u16)>| v.into_iter().map(|(s, b, o)| place(0, s, b, o)).collect::<Vec<_>>();
            let _ = Layout::new(Direction::Output, length, &to(data), &to(status), &s7());
        }
    }
}
