//! The rows of a recording on their way to files, plots and the terminal, and what happens meanwhile.

use profidrive::recording::{CsvLines, News, Recording, RecordingFile, Row, Scope, Sink, Table, WriteError};

use crate::failure::Failure;
use crate::live_plot::LivePlot;
use crate::output::Output;

/// Remarks that are kept while the terminal shows the curves.
const MOST_REMARKS: usize = 1000;

/// Takes the rows of a recording.
pub struct Taken<'o> {
    pub place: Place<'o>,
    pub scope: Option<Scope>,
    pub live: Option<LivePlot>,
    /// What is printed once the terminal has its text again.
    pub remarks: Vec<Remark>,
    pub output: &'o Output,
}

/// Something that happened.
pub struct Remark {
    is_warning: bool,
    text: String,
}

impl<'o> Taken<'o> {
    /// Records until the end. Returns what went wrong with single drives.
    pub async fn record(&mut self, recording: &mut Recording) -> Result<Vec<Failure>, Failure> {
        let mut problems = Vec::new();
        let mut broken: Option<WriteError> = None;
        while let Some(news) = recording.next().await? {
            match news {
                News::Row(row) if broken.is_none() => {
                    if let Err(error) = self.take(&row) {
                        // the connections are closed in order all the same, which can take its time
                        recording.stop_handle().stop_once();
                        self.remark(true, format!("{error}; the recording ends"));
                        broken = Some(error);
                    }
                }
                other => {
                    // the only drive ends the command with its error
                    let only = recording.table().drives.len() == 1;
                    if !only || !matches!(other, News::Ended { .. }) {
                        self.say(&other, recording);
                    }
                    if let News::Ended { error, .. } = other {
                        problems.push(Failure::from(error));
                    }
                }
            }
        }
        if let Some(error) = broken {
            return Err(error.into());
        }
        self.place.finish()?;
        Ok(problems)
    }

    /// Gives the terminal back, prints what was held back, and returns where the rows went.
    pub fn end(mut self) -> (Place<'o>, Option<Scope>) {
        drop(self.live.take());
        for Remark { is_warning, text } in &self.remarks {
            if *is_warning {
                self.output.warn(text);
            } else {
                self.output.say(text);
            }
        }
        (self.place, self.scope)
    }

    fn take(&mut self, row: &Row) -> Result<(), WriteError> {
        if let Some(scope) = &mut self.scope {
            scope.push(row);
        }
        if let Some(live) = &self.live {
            live.push(row);
        }
        self.place.write(row)
    }

    fn remark(&mut self, is_warning: bool, text: String) {
        match &self.live {
            Some(live) => {
                live.note(&text);
                if self.remarks.len() < MOST_REMARKS {
                    self.remarks.push(Remark { is_warning, text });
                }
            }
            None if is_warning => self.output.warn(&text),
            None => self.output.say(&text),
        }
    }

    /// Says what happens while drives are recorded.
    fn say(&mut self, news: &News, recording: &Recording) {
        for remark in news.remarks(recording.table()) {
            let text = match (news, &self.live) {
                (News::Waits { .. }, Some(_)) => format!("{}; q once more closes it now", remark.sentence),
                (News::Waits { .. }, None) => {
                    format!("{}; a second Ctrl-C closes it now", remark.sentence)
                }
                _ => remark.sentence,
            };
            self.remark(remark.is_warning, text);
        }
    }
}

/// Where rows go.
pub enum Place<'o> {
    File(Box<RecordingFile>),
    Printed(Box<CsvLines>, &'o Output),
    Nowhere,
}

impl<'o> Place<'o> {
    pub fn printed(table: &Table, output: &'o Output) -> Result<Self, Failure> {
        let lines = CsvLines::new(table).map_err(internal)?;
        let mut place = Self::Printed(Box::new(lines), output);
        place.print()?;
        Ok(place)
    }

    pub fn files(&self) -> &[std::path::PathBuf] {
        match self {
            Self::File(file) => file.files(),
            Self::Printed(..) | Self::Nowhere => &[],
        }
    }

    /// Returns the rows in the files; `None` where they went elsewhere.
    pub fn rows(&self) -> Option<u64> {
        match self {
            Self::File(file) => Some(file.rows()),
            Self::Printed(..) | Self::Nowhere => None,
        }
    }

    fn write(&mut self, row: &Row) -> Result<(), WriteError> {
        match self {
            Self::File(file) => file.write(row),
            Self::Printed(lines, _) => {
                // memory has room
                let _ = lines.push(row);
                let _ = self.print();
                Ok(())
            }
            Self::Nowhere => Ok(()),
        }
    }

    fn print(&mut self) -> Result<(), Failure> {
        if let Self::Printed(lines, output) = self {
            let text = lines.take().map_err(internal)?;
            let text = String::from_utf8_lossy(&text);
            text.lines().for_each(|line| output.line(line));
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), WriteError> {
        match self {
            Self::File(file) => file.finish(),
            Self::Printed(..) | Self::Nowhere => Ok(()),
        }
    }
}

fn internal(error: std::io::Error) -> Failure {
    Failure::new(client::ErrorKind::Internal, error.to_string())
}
