//! Curves that scroll through a terminal, one chart for each unit.

use std::collections::VecDeque;

use dissect::hex16;
use profidrive::recording::{Row, Table, Value};
use profile::notation::figures;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};

use crate::output::clean;

/// Points of a curve that are kept at most: the window is shorter where more arrive in it.
const MOST_POINTS: usize = 20_000;
/// Seconds of the window: the shortest, the longest, and at first.
const WINDOW: (f64, f64, f64) = (1.0, 600.0, 10.0);
/// Messages that are kept at most.
const MOST_NOTES: usize = 1000;
/// Messages that are shown.
const SHOWN_NOTES: u16 = 3;
/// The least height of a chart, and the width of the legend.
const LEAST_HEIGHT: u16 = 7;
const LEGEND: u16 = 34;

const COLOURS: [Color; 7] = [
    Color::Cyan,
    Color::Yellow,
    Color::Green,
    Color::Magenta,
    Color::LightBlue,
    Color::LightRed,
    Color::White,
];

/// The signals of a recording as far as the window goes back, and what happened meanwhile.
#[derive(Debug)]
pub struct Scroll {
    title: String,
    curves: Vec<Curve>,
    columns: usize,
    now: f64,
    window: f64,
    notes: VecDeque<String>,
}

#[derive(Debug)]
struct Curve {
    name: String,
    unit: String,
    points: VecDeque<(f64, f64)>,
    last: Option<Value>,
}

impl Scroll {
    /// For the signals of a recording.
    pub fn new(table: &Table) -> Self {
        let of = |drive: &String| -> Vec<Curve> {
            let curve = |column: &profidrive::recording::Column| Curve {
                name: clean(&format!("{drive} {}", column.name)),
                unit: clean(&column.unit),
                points: VecDeque::new(),
                last: None,
            };
            table.columns.iter().map(curve).collect()
        };
        Self {
            title: clean(&table.drives.join(", ")),
            curves: table.drives.iter().flat_map(of).collect(),
            columns: table.columns.len(),
            now: 0.0,
            window: WINDOW.2,
            notes: VecDeque::new(),
        }
    }

    /// Adds a row; what has left the longest window goes.
    pub fn push(&mut self, row: &Row) {
        let time = row.time.as_secs_f64();
        self.now = self.now.max(time);
        let curves = self.curves.iter_mut().skip(row.drive * self.columns);
        for (curve, value) in curves.take(self.columns).zip(&row.values) {
            curve
                .points
                .push_back((time, value.map_or(f64::NAN, Value::number)));
            curve.last = *value;
            let old = |point: &(f64, f64)| point.0 < time - WINDOW.1;
            while curve.points.len() > MOST_POINTS || curve.points.front().is_some_and(old) {
                curve.points.pop_front();
            }
        }
    }

    /// Adds a message.
    pub fn note(&mut self, text: &str) {
        if self.notes.len() >= MOST_NOTES {
            self.notes.pop_front();
        }
        self.notes.push_back(clean(text));
    }

    /// Makes the window so many times as long, within its limits.
    pub fn zoom(&mut self, by: f64) {
        self.window = (self.window * by).clamp(WINDOW.0, WINDOW.1);
    }

    /// Draws everything.
    pub fn draw(&self, frame: &mut Frame<'_>) {
        let notes = u16::try_from(self.notes.len())
            .unwrap_or(u16::MAX)
            .min(SHOWN_NOTES);
        let [head, body, foot] = Layout::vertical([
            Constraint::Length(1),
            Constraint::Min(0),
            Constraint::Length(notes),
        ])
        .areas(frame.area());
        let keys = format!(
            "{}   {:.1} s   window {} s (+ -)   q ends",
            self.title, self.now, self.window
        );
        frame.render_widget(Paragraph::new(keys), head);
        let shown = self.notes.len().saturating_sub(notes.into());
        let lines: Vec<Line<'_>> = self
            .notes
            .range(shown..)
            .map(|note| Line::raw(note.as_str()))
            .collect();
        frame.render_widget(Paragraph::new(lines), foot);
        let legend = LEGEND.min(body.width / 2);
        let [charts, legend] =
            Layout::horizontal([Constraint::Min(0), Constraint::Length(legend)]).areas(body);
        self.draw_legend(frame, legend);
        self.draw_charts(frame, charts);
    }

    /// The curves by their unit. Words are shown in the legend only, as their numbers are no quantities.
    fn units(&self) -> Vec<(&str, Vec<(usize, &Curve)>)> {
        let mut units: Vec<(&str, Vec<(usize, &Curve)>)> = Vec::new();
        let drawn = self.curves.iter().enumerate();
        for (at, curve) in drawn.filter(|(_, curve)| !matches!(curve.last, Some(Value::Word(_)))) {
            match units.iter_mut().find(|(unit, _)| *unit == curve.unit) {
                Some((_, curves)) => curves.push((at, curve)),
                None => units.push((&curve.unit, vec![(at, curve)])),
            }
        }
        units
    }

    fn draw_charts(&self, frame: &mut Frame<'_>, area: Rect) {
        let mut units = self.units();
        units.truncate(usize::from(area.height / LEAST_HEIGHT).max(1));
        let areas = Layout::vertical(units.iter().map(|_| Constraint::Fill(1))).split(area);
        for ((unit, curves), area) in units.iter().zip(areas.iter()) {
            self.draw_chart(frame, *area, unit, curves);
        }
    }

    fn draw_chart(&self, frame: &mut Frame<'_>, area: Rect, unit: &str, curves: &[(usize, &Curve)]) {
        let from = (self.now - self.window).max(0.0);
        let to = self.now.max(from + WINDOW.0);
        let pieces: Vec<(usize, Pieces)> = curves
            .iter()
            .map(|(at, curve)| (*at, curve.pieces(from)))
            .collect();
        let values = pieces.iter().flat_map(|(_, pieces)| pieces).flatten();
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), (_, value)| {
            (low.min(*value), high.max(*value))
        });
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let room = if high > low { (high - low) * 0.05 } else { 1.0 };
        let bounds = [low - room, high + room];
        let datasets: Vec<Dataset<'_>> = pieces
            .iter()
            .flat_map(|(at, pieces)| pieces.iter().map(move |piece| (*at, piece)))
            .map(|(at, piece)| {
                Dataset::default()
                    .marker(Marker::Braille)
                    .graph_type(GraphType::Line)
                    .style(Style::new().fg(colour(at)))
                    .data(piece)
            })
            .collect();
        let label = |number: f64| short(number);
        let times = Axis::default()
            .bounds([from, to])
            .labels([format!("{from:.1} s"), format!("{to:.1} s")]);
        let scale = Axis::default().bounds(bounds).labels([
            label(bounds[0]),
            label(f64::midpoint(bounds[0], bounds[1])),
            label(bounds[1]),
        ]);
        let title = if unit.is_empty() { "no unit" } else { unit };
        let chart = Chart::new(datasets)
            .block(Block::bordered().title(title))
            .x_axis(times)
            .y_axis(scale);
        frame.render_widget(chart, area);
    }

    fn draw_legend(&self, frame: &mut Frame<'_>, area: Rect) {
        let room = usize::from(area.height);
        let all = self.curves.len();
        let shown = if all > room { room.saturating_sub(1) } else { all };
        let mut lines: Vec<Line<'_>> = self.curves.iter().take(shown).enumerate().map(legend).collect();
        if shown < all {
            lines.push(Line::raw(format!("  and {} more", all - shown)));
        }
        frame.render_widget(Paragraph::new(lines), area);
    }
}

/// Points between gaps.
type Pieces = Vec<Vec<(f64, f64)>>;

impl Curve {
    /// The points from a time on, between gaps.
    fn pieces(&self, from: f64) -> Pieces {
        let mut pieces = vec![Vec::new()];
        let first = self.points.partition_point(|(time, _)| *time < from);
        for &(time, value) in self.points.range(first..) {
            if !value.is_finite() {
                pieces.push(Vec::new());
            } else if let Some(piece) = pieces.last_mut() {
                piece.push((time, value));
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces
    }
}

fn colour(at: usize) -> Color {
    COLOURS.get(at % COLOURS.len()).copied().unwrap_or(Color::White)
}

/// `● akd-1 NIST_A  60.04 rpm`
fn legend((at, curve): (usize, &Curve)) -> Line<'_> {
    let value = match curve.last {
        None => "-".to_owned(),
        Some(Value::Word(word)) => hex16(word),
        Some(value) => format!("{} {}", short(value.number()), curve.unit),
    };
    let sign = match curve.last {
        Some(Value::Word(_)) => Span::raw("  "),
        _ => Span::styled("● ", Style::new().fg(colour(at))),
    };
    Line::from(vec![sign, Span::raw(format!("{}  {value}", curve.name))])
}

/// A number in the few places that there are.
fn short(number: f64) -> String {
    let steps = match number.abs() {
        1000.0.. => 1.0,
        10.0.. => 10.0,
        _ => 1000.0,
    };
    figures((number * steps).round() / steps)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use profidrive::recording::{Column, Kind};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;

    fn scroll() -> Scroll {
        let column = |name: &str, kind, unit: &str| Column {
            name: name.into(),
            kind,
            unit: unit.into(),
            parameter: String::new(),
            scaling: String::new(),
        };
        Scroll::new(&Table {
            drives: vec!["akd-1".into(), "akd-2".into()],
            facts: Vec::new(),
            columns: vec![
                column("NIST_A", Kind::Number, "rpm"),
                column("ZSW1", Kind::Word, ""),
                column("XIST_A", Kind::Number, "rev"),
            ],
        })
    }

    fn push(scroll: &mut Scroll, millis: u64, drive: usize, speed: Option<f64>) {
        scroll.push(&Row {
            time: Duration::from_millis(millis),
            wall: None,
            drive,
            gap: speed.is_none(),
            values: vec![
                speed.map(Value::Number),
                speed.map(|_| Value::Word(0x0237)),
                speed.map(|speed| Value::Number(speed / 60.0)),
            ],
        });
    }

    fn picture(scroll: &Scroll, width: u16, height: u16) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| scroll.draw(frame)).unwrap();
        terminal.backend().to_string()
    }

    #[test]
    fn there_is_a_chart_for_each_unit_and_the_last_value_of_each_signal() {
        let mut scroll = scroll();
        for at in 0..100 {
            push(&mut scroll, at * 16, 0, Some(60.0));
            push(&mut scroll, at * 16, 1, Some(at as f64));
        }
        scroll.note("akd-2 does not answer; retrying");
        let picture = picture(&scroll, 100, 30);
        for text in [
            "akd-1, akd-2",
            "q ends",
            "┌rpm",
            "┌rev",
            "● akd-1 NIST_A  60 rpm",
            "● akd-2 NIST_A  99 rpm",
            "akd-1 ZSW1  0x0237",
            "akd-2 does not answer; retrying",
        ] {
            assert!(picture.contains(text), "{text}:\n{picture}");
        }
        assert!(!picture.contains("no unit"), "words have no chart:\n{picture}");
        let braille = |one: char| ('\u{2801}'..='\u{28FF}').contains(&one);
        assert!(
            picture.chars().filter(|one| braille(*one)).count() > 50,
            "{picture}"
        );
    }

    #[test]
    fn the_window_scrolls_and_memory_is_bounded() {
        let mut scroll = scroll();
        for at in 0..(MOST_POINTS as u64 + 5000) {
            push(&mut scroll, at, 0, Some(at as f64));
        }
        assert_eq!(scroll.curves[0].points.len(), MOST_POINTS);
        let picture = picture(&scroll, 100, 30);
        assert!(
            picture.contains("15.0 s") && picture.contains("25.0 s"),
            "{picture}"
        );
        scroll.zoom(1e9);
        assert_eq!(scroll.window, WINDOW.1);
        for at in 0..2 * MOST_NOTES {
            scroll.note(&at.to_string());
        }
        assert_eq!(scroll.notes.len(), MOST_NOTES);
    }

    #[test]
    fn a_gap_interrupts_the_curve() {
        let mut scroll = scroll();
        for (at, speed) in [(0, Some(1.0)), (10, None), (20, Some(2.0))] {
            push(&mut scroll, at, 0, speed);
        }
        assert_eq!(
            scroll.curves[0].pieces(0.0),
            [vec![(0.0, 1.0)], vec![(0.02, 2.0)]]
        );
    }

    #[test]
    fn a_terminal_of_any_size_is_drawn_to() {
        let mut scroll = scroll();
        push(&mut scroll, 0, 0, Some(f64::MAX));
        push(&mut scroll, 16, 0, Some(f64::MIN));
        for (width, height) in [(1, 1), (2, 3), (10, 5), (300, 2), (3, 100)] {
            picture(&scroll, width, height);
        }
    }

    /// Names come from the network.
    #[test]
    fn a_name_commands_no_terminal() {
        let table = Table {
            drives: vec!["a\u{1b}[2J".into()],
            columns: Vec::new(),
            facts: Vec::new(),
        };
        assert!(!picture(&Scroll::new(&table), 40, 4).contains('\u{1b}'));
    }
}
