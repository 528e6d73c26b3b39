//! Saving so that a kill at any moment leaves the old or the new text, never a mixture.
//!
//! The steps are those of a careful program on a file system: write everything beside the old text, force it to the
//! medium, let the new one take the old one's place in one step, force that too.

/// Where one text is kept. Callers implement it with files; this module has an implementation in memory for tests.
pub trait Storage {
    /// Why the medium refuses.
    type Error;

    /// Returns the present text, `None` when nothing was ever saved.
    ///
    /// # Errors
    /// When the medium cannot be read.
    fn read(&mut self) -> Result<Option<Vec<u8>>, Self::Error>;

    /// Writes the new text beside the present one; what a former, interrupted save left there is overwritten.
    ///
    /// # Errors
    /// When the medium refuses.
    fn write_beside(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// Returns once the text beside is on the medium.
    ///
    /// # Errors
    /// When the medium refuses.
    fn flush_beside(&mut self) -> Result<(), Self::Error>;

    /// Puts the text beside in the place of the present one, in one step.
    ///
    /// # Errors
    /// When the medium refuses.
    fn replace(&mut self) -> Result<(), Self::Error>;

    /// Returns once the replacement is on the medium.
    ///
    /// # Errors
    /// When the medium refuses.
    fn flush_place(&mut self) -> Result<(), Self::Error>;
}

/// Saves `text`.
///
/// # Errors
/// When the medium refuses; the old text is then still there.
pub fn save<S: Storage>(storage: &mut S, text: &str) -> Result<(), S::Error> {
    storage.write_beside(text.as_bytes())?;
    storage.flush_beside()?;
    storage.replace()?;
    storage.flush_place()
}

/// Reads what was saved last, `None` when nothing was ever saved.
///
/// # Errors
/// When the medium cannot be read.
pub fn load<S: Storage>(storage: &mut S) -> Result<Option<Vec<u8>>, S::Error> {
    storage.read()
}

/// A [`Storage`] in memory that is killed after a given number of elementary steps, and after that shows what a
/// machine would find when it comes up again: everything that was flushed, and of the rest any part.
#[derive(Debug, Clone)]
pub struct CrashingStorage {
    /// What is on the medium.
    present: Option<Vec<u8>>,
    /// The text beside and how much of it is surely on the medium.
    beside: Vec<u8>,
    flushed: usize,
    /// A replacement that is not surely on the medium, with the text before it.
    unsure: Option<Option<Vec<u8>>>,
    /// Elementary steps (octets written, flushes, replacements) until the kill.
    steps: usize,
    random: u64,
}

/// The process was killed in the middle of a save.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Killed;

impl CrashingStorage {
    /// Holds `present`; is killed after `steps` elementary steps; `seed` decides what is left of unflushed data.
    #[must_use]
    pub fn new(present: Option<Vec<u8>>, steps: usize, seed: u64) -> Self {
        Self {
            present,
            beside: Vec::new(),
            flushed: 0,
            unsure: None,
            steps,
            random: seed | 1,
        }
    }

    /// Returns the content that the next start finds.
    #[must_use]
    pub fn restart(mut self, steps: usize) -> Self {
        if let Some(before) = self.unsure.take()
            && self.coin()
        {
            self.present = before;
        }
        // Of the text beside, what was not flushed may be there in part or as zeros.
        let keep = self.flushed + self.below(self.beside.len() - self.flushed + 1);
        let zeros = self.coin();
        for octet in self.beside.iter_mut().skip(keep) {
            if zeros {
                *octet = 0;
            }
        }
        if !zeros {
            self.beside.truncate(keep);
        }
        self.flushed = self.beside.len();
        self.steps = steps;
        self
    }

    fn next(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random
    }

    fn coin(&mut self) -> bool {
        self.next() & 0x1000 != 0
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() >> 11) as usize % limit.max(1)
    }

    fn step(&mut self) -> Result<(), Killed> {
        self.steps = self.steps.checked_sub(1).ok_or(Killed)?;
        Ok(())
    }
}

impl Storage for CrashingStorage {
    type Error = Killed;

    fn read(&mut self) -> Result<Option<Vec<u8>>, Killed> {
        Ok(self.present.clone())
    }

    fn write_beside(&mut self, bytes: &[u8]) -> Result<(), Killed> {
        self.step()?;
        self.beside.clear();
        self.flushed = 0;
        for octet in bytes {
            self.step()?;
            self.beside.push(*octet);
        }
        Ok(())
    }

    fn flush_beside(&mut self) -> Result<(), Killed> {
        self.step()?;
        self.flushed = self.beside.len();
        self.step()
    }

    fn replace(&mut self) -> Result<(), Killed> {
        self.step()?;
        let mut text = core::mem::take(&mut self.beside);
        // What was never flushed reaches the place as it may be on the medium: cut.
        let keep = self.flushed + self.below(text.len() - self.flushed + 1);
        text.truncate(keep);
        self.flushed = 0;
        self.unsure = Some(self.present.replace(text));
        self.step()
    }

    fn flush_place(&mut self) -> Result<(), Killed> {
        self.step()?;
        self.unsure = None;
        self.step()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Image, Values};
    use super::*;
    use profile::catalogue::{AKD, Scaling};

    fn states() -> (String, String) {
        let mut values = Values::new(&AKD);
        let old = values.image(&Scaling::default()).encode();
        for (position, parameter) in AKD.parameters.iter().enumerate() {
            let (low, high) = parameter.raw_limits(&Scaling::default());
            values.set_at(position, values.at(position).saturating_add(1).clamp(low, high));
        }
        (old, values.image(&Scaling::default()).encode())
    }

    #[test]
    fn killed_at_a_thousand_random_moments_the_old_or_the_new_set_is_there() {
        let (old, new) = states();
        let steps = new.len() + 8;
        let (mut olds, mut news) = (0, 0);
        let mut random = 0x5DEE_CE66_D1CE_4E5B_u64;
        for round in 0..1000 {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let seed = random;
            // Most of the time passes in writing; every fourth kill is put among the last steps on purpose.
            let moment = if round % 4 == 0 {
                steps - seed as usize % 10
            } else {
                seed as usize % steps
            };
            let mut storage = CrashingStorage::new(Some(old.clone().into_bytes()), moment, seed);
            let killed = save(&mut storage, &new).is_err();
            let mut storage = storage.restart(usize::MAX);
            let found = load(&mut storage).unwrap().expect("something is there");
            let found = Image::decode(&found)
                .unwrap_or_else(|error| panic!("seed {seed:#x} moment {moment}: {error}"));
            let text = Values::new(&AKD);
            let mut text = text;
            assert_eq!(text.restore(&found, |_| Scaling::default()).unwrap(), 0);
            let text = text.image(&Scaling::default()).encode();
            assert!(
                text == old || text == new,
                "a mixture: seed {seed:#x} moment {moment}"
            );
            assert!(
                killed || text == new,
                "a finished save is kept: seed {seed:#x} moment {moment}"
            );
            if text == old {
                olds += 1
            } else {
                news += 1
            }
            // And the next save works whatever the kill left beside.
            save(&mut storage, &new).unwrap();
            assert_eq!(
                load(&mut storage.restart(usize::MAX)).unwrap().unwrap(),
                new.as_bytes()
            );
        }
        assert!(olds > 100 && news > 50, "both ends were reached: {olds} {news}");
    }

    #[test]
    fn the_simulation_finds_a_careless_way_of_saving() {
        let (old, new) = states();
        let damaged = (0..200).any(|seed| {
            let mut storage = CrashingStorage::new(Some(old.clone().into_bytes()), usize::MAX, seed * 77 + 1);
            storage.write_beside(new.as_bytes()).unwrap();
            storage.replace().unwrap(); // not flushed before
            let found = load(&mut storage.restart(usize::MAX)).unwrap().unwrap();
            Image::decode(&found).is_err()
        });
        assert!(damaged);
    }

    #[test]
    fn the_first_save_of_a_new_drive() {
        let (_, new) = states();
        let mut storage = CrashingStorage::new(None, 10, 3);
        assert_eq!(save(&mut storage, &new), Err(Killed));
        let mut storage = storage.restart(usize::MAX);
        assert_eq!(load(&mut storage), Ok(None));
        save(&mut storage, &new).unwrap();
        assert_eq!(load(&mut storage).unwrap().unwrap(), new.as_bytes());
    }
}
