//! How a controller chooses where each submodule's data and status lie.

use alloc::vec::Vec;

use super::{DataObject, Direction, Layout, StatusObject, SubmoduleSize};
use crate::cyclic::timing::IocrError;
use crate::wire::rt::{MAX_DATA_LENGTH, MIN_DATA_LENGTH};

/// Chooses the offsets as a controller: input table and output table.
///
/// For each submodule in the given order the entry of its input data comes first (data and IOPS in the input table,
/// IOCS in the output table), then the entry of its output data the other way round. This reproduces the connect
/// request of an S7-1500.
///
/// # Errors
/// [`IocrError::DataLength`] with what would be needed (at most 65535) when a direction needs more than 1440 octets.
pub fn pack(submodules: &[SubmoduleSize]) -> Result<(Layout, Layout), IocrError> {
    let mut input = Packer::new(Direction::Input);
    let mut output = Packer::new(Direction::Output);
    for size in submodules {
        if let Some(length) = size.data_length(Direction::Input) {
            input.data(size, length);
            output.status(size);
        }
        if let Some(length) = size.data_length(Direction::Output) {
            input.status(size);
            output.data(size, length);
        }
    }
    Ok((input.finish()?, output.finish()?))
}

struct Packer {
    layout: Layout,
    next: u32,
}

impl Packer {
    fn new(direction: Direction) -> Self {
        Self {
            layout: Layout {
                direction,
                data_length: 0,
                data: Vec::new(),
                status: Vec::new(),
            },
            next: 0,
        }
    }

    fn place(&mut self, length: u32) -> u16 {
        let at = u16::try_from(self.next).unwrap_or(u16::MAX);
        self.next = self.next.saturating_add(length);
        at
    }

    fn data(&mut self, size: &SubmoduleSize, length: u16) {
        let offset = self.place(u32::from(length) + 1);
        let SubmoduleSize {
            api, slot, subslot, ..
        } = *size;
        self.layout.data.push(DataObject {
            api,
            slot,
            subslot,
            offset,
            length,
        });
    }

    fn status(&mut self, size: &SubmoduleSize) {
        let offset = self.place(1);
        let SubmoduleSize {
            api, slot, subslot, ..
        } = *size;
        self.layout.status.push(StatusObject {
            api,
            slot,
            subslot,
            offset,
        });
    }

    fn finish(mut self) -> Result<Layout, IocrError> {
        let length = u16::try_from(self.next).unwrap_or(u16::MAX);
        if length > MAX_DATA_LENGTH {
            return Err(IocrError::DataLength(length));
        }
        self.layout.data_length = length.max(MIN_DATA_LENGTH);
        Ok(self.layout)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{places, s7};
    use super::*;
    use alloc::vec;
    use proptest::prelude::*;

    #[test]
    fn packing_reproduces_the_captured_connect() {
        let (input, output) = pack(&s7()).unwrap();
        let offsets: Vec<_> = input
            .data_objects()
            .iter()
            .map(|d| (d.offset, d.iops_offset()))
            .collect();
        assert_eq!(offsets, [(0, 0), (1, 1), (2, 2), (3, 4), (6, 7), (9, 17)]);
        let iocs: Vec<_> = input
            .status_objects()
            .iter()
            .map(|s| (s.slot, s.offset))
            .collect();
        assert_eq!(iocs, [(2, 5), (3, 8), (4, 18)]);
        let offsets: Vec<_> = output
            .data_objects()
            .iter()
            .map(|d| (d.slot, d.offset, d.iops_offset()))
            .collect();
        assert_eq!(offsets, [(2, 4, 5), (3, 7, 8), (4, 10, 18)]);
        let iocs: Vec<_> = output.status_objects().iter().map(|s| s.offset).collect();
        assert_eq!(iocs, [0, 1, 2, 3, 6, 9]);
        assert_eq!((input.data_length(), output.data_length()), (40, 40));
    }

    #[test]
    fn a_packed_layout_passes_the_device_check() {
        for (layout, direction) in [
            (pack(&s7()).unwrap().0, Direction::Input),
            (pack(&s7()).unwrap().1, Direction::Output),
        ] {
            let (data, status) = places(&layout);
            assert_eq!(
                Layout::new(direction, layout.data_length(), &data, &status, &s7()),
                Ok(layout)
            );
        }
    }

    #[test]
    fn too_much_data_is_an_error() {
        let size = [SubmoduleSize::new(0, 1, 1, 1439, 0)];
        assert_eq!(pack(&size).unwrap().0.data_length(), 1440);
        let size = [
            SubmoduleSize::new(0, 1, 1, 1439, 0),
            SubmoduleSize::new(0, 2, 1, 0, 0),
        ];
        assert_eq!(pack(&size), Err(IocrError::DataLength(1441)));
        let many = vec![SubmoduleSize::new(0, 1, 1, u16::MAX, u16::MAX); 70];
        assert_eq!(pack(&many), Err(IocrError::DataLength(u16::MAX)));
    }

    proptest! {
        #[test]
        fn whatever_is_packed_never_overlaps(lengths in proptest::collection::vec((0u16..30, 0u16..30), 1..20)) {
            let sizes: Vec<_> = lengths.iter().zip(0u16..)
                .map(|((i, o), slot)| SubmoduleSize::new(0, slot, 1, *i, *o)).collect();
            let (input, output) = pack(&sizes).unwrap();
            for (layout, direction) in [(input, Direction::Input), (output, Direction::Output)] {
                let (data, status) = places(&layout);
                if data.is_empty() && status.is_empty() { continue; }
                prop_assert_eq!(Layout::new(direction, layout.data_length(), &data, &status, &sizes), Ok(layout));
            }
        }
    }
}
