//! Saves on their way to non-volatile memory, which the owner of the drive writes.
//!
//! Each save has a number. The owner stores the newest image and reports the number; a report counts for all saves up to
//! that number. A waiting caller polls the state of its save, so nothing here blocks.

use std::collections::VecDeque;
use std::ops::RangeInclusive;

use profile::parameter::{SaveId, SaveState};

use super::Event;

/// Maximum number of failures stored for callers that still wait.
const MOST_FAILURES: usize = 8;
/// Maximum number of images that the owner is storing; until it reports one, only the newest further one is kept.
const MOST_UNDER_WAY: usize = 8;

/// Images of the saved parameters: in non-volatile memory, on their way there, and not yet given to the owner.
#[derive(Debug, Default)]
pub(super) struct Saving {
    /// The owner reports what became of every save; otherwise a save counts as done at once.
    confirmed: bool,
    /// Number of the newest save.
    issued: u64,
    /// Highest number that the owner has reported.
    reported: u64,
    /// Numbers of saves that failed.
    failed: VecDeque<RangeInclusive<u64>>,
    /// Image in non-volatile memory.
    stored: Option<String>,
    /// Images that the owner is storing, the newest last.
    under_way: VecDeque<(u64, String)>,
    /// Image that the owner has not fetched, and whether a client requested the save.
    due: Option<(String, bool)>,
    /// Newest save that a channel has not looked at.
    started: Option<SaveId>,
    /// The drive is switched off: the owner gets the newest image although it reported none of those before.
    ending: bool,
}

impl Saving {
    /// The drive has started with this image.
    pub fn start(&mut self, image: String) {
        self.stored = Some(image);
    }

    /// The owner reports every save from now on.
    pub fn confirm(&mut self) {
        self.confirmed = true;
    }

    /// Returns the newest image.
    pub fn newest(&self) -> Option<&str> {
        let due = self.due.as_ref().map(|(image, _)| image);
        let under_way = || self.under_way.back().map(|(_, image)| image);
        due.or_else(under_way)
            .or(self.stored.as_ref())
            .map(String::as_str)
    }

    /// Saves an image. It takes the place of one that the owner has not fetched.
    pub fn save(&mut self, image: String, asked: bool) {
        self.issued += 1;
        let asked = asked || self.due.as_ref().is_some_and(|(_, asked)| *asked);
        self.due = Some((image, asked));
        self.started = Some(SaveId(self.issued)).filter(|_| self.confirmed);
    }

    /// The newest image contains the values to save. A request waits for this image, unless it is stored.
    pub fn join(&mut self) {
        if let Some((_, asked)) = &mut self.due {
            *asked = true;
        }
        let is_pending = self.due.is_some() || !self.under_way.is_empty();
        self.started = Some(SaveId(self.issued)).filter(|_| self.confirmed && is_pending);
    }

    /// The drive is switched off: no report comes that the newest image could wait for.
    pub fn end(&mut self) {
        self.ending = true;
    }

    /// Returns the image that the owner is to store; `None` while [`MOST_UNDER_WAY`] are not reported.
    pub fn poll(&mut self) -> Option<Event> {
        if self.under_way.len() >= MOST_UNDER_WAY && !self.ending {
            return None;
        }
        let (text, asked) = self.due.take()?;
        self.ending = false;
        if self.confirmed {
            self.under_way.push_back((self.issued, text.clone()));
        } else {
            self.stored = Some(text.clone());
        }
        let save = SaveId(self.issued);
        Some(Event::Save { text, asked, save })
    }

    /// The owner has stored the image of this save, or could not. After a failure the values stored before count again.
    pub fn report(&mut self, SaveId(number): SaveId, stored: bool) {
        if number <= self.reported || number > self.issued {
            return;
        }
        if !stored {
            if self.failed.len() >= MOST_FAILURES {
                self.failed.pop_front();
            }
            self.failed.push_back(self.reported + 1..=number);
        }
        self.reported = number;
        let reported = self
            .under_way
            .iter()
            .take_while(|(under_way, _)| *under_way <= number)
            .count();
        if let Some((_, image)) = self.under_way.drain(..reported).next_back().filter(|_| stored) {
            self.stored = Some(image);
        }
    }

    /// Returns the result of a save.
    pub fn state(&self, SaveId(number): SaveId) -> SaveState {
        if !self.confirmed {
            SaveState::Stored
        } else if number > self.reported {
            SaveState::Pending
        } else if self.failed.iter().any(|failed| failed.contains(&number)) {
            SaveState::Failed
        } else {
            SaveState::Stored
        }
    }

    /// Returns the newest save since the last call, if a client waits for it.
    pub fn take_started(&mut self) -> Option<SaveId> {
        self.started.take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_are_bounded_and_the_newest_are_known() {
        let mut saving = Saving::default();
        saving.confirm();
        for number in 1..=100 {
            saving.save(number.to_string(), true);
            assert!(saving.poll().is_some());
            saving.report(SaveId(number), false);
        }
        assert_eq!(saving.failed.len(), MOST_FAILURES);
        assert!(saving.state(SaveId(100)) == SaveState::Failed);
    }

    #[test]
    fn an_owner_that_stores_nothing_gets_a_few_images_and_later_the_newest() {
        let mut saving = Saving::default();
        saving.confirm();
        let mut given = 0;
        for number in 1..=1000 {
            saving.save(number.to_string(), true);
            given += usize::from(saving.poll().is_some());
        }
        assert_eq!(given, MOST_UNDER_WAY);
        assert_eq!(saving.under_way.len(), MOST_UNDER_WAY);
        assert_eq!(saving.newest(), Some("1000"));
        assert!(saving.state(SaveId(1000)) == SaveState::Pending);
        saving.report(SaveId(8), true);
        assert!(matches!(saving.poll(), Some(Event::Save { text, .. }) if text == "1000"));
        saving.report(SaveId(1000), true);
        assert!(saving.state(SaveId(1000)) == SaveState::Stored);
    }

    #[test]
    fn a_drive_that_is_switched_off_gives_its_newest_image_to_an_owner_that_stores_nothing() {
        let mut saving = Saving::default();
        saving.confirm();
        for number in 1..=100 {
            saving.save(number.to_string(), true);
            saving.poll();
        }
        assert!(saving.poll().is_none());
        saving.end();
        assert!(matches!(saving.poll(), Some(Event::Save { text, .. }) if text == "100"));
        saving.save("101".to_owned(), true);
        assert!(saving.poll().is_none(), "one image for each end");
    }
}
