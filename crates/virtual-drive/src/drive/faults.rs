//! The fault buffer: eight situations of eight fault numbers (PNU 944, 947).

/// Fault situations and faults in each.
const SIDE: usize = 8;

/// Fault numbers by situation; situation 0 is not acknowledged yet.
#[derive(Debug, Clone)]
pub(super) struct Faults {
    numbers: [u16; SIDE * SIDE],
    counter: u16,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            numbers: [0; SIDE * SIDE],
            counter: 0,
        }
    }
}

impl Faults {
    /// Adds a fault to the present situation. False when it is there already or the situation is full.
    pub fn raise(&mut self, number: u16) -> bool {
        if self.has(number) {
            return false;
        }
        let Some(free) = self.numbers.iter_mut().take(SIDE).find(|place| **place == 0) else {
            return false;
        };
        *free = number;
        self.counter = self.counter.wrapping_add(1);
        true
    }

    /// Shifts every situation by one; the oldest is lost.
    pub fn acknowledge(&mut self) {
        if self.is_present() {
            self.numbers.copy_within(..SIDE * (SIDE - 1), SIDE);
            self.numbers[..SIDE].fill(0);
            self.counter = self.counter.wrapping_add(1);
        }
    }

    pub fn is_present(&self) -> bool {
        self.number(0) != 0
    }

    pub fn has(&self, number: u16) -> bool {
        self.numbers.iter().take(SIDE).any(|place| *place == number)
    }

    pub fn number(&self, index: usize) -> u16 {
        self.numbers.get(index).copied().unwrap_or(0)
    }

    pub const fn counter(&self) -> u16 {
        self.counter
    }
}
