//! Curves as a picture (SVG) or an interactive page (HTML), each one file without external parts.

use client::{Advice, ErrorKind};
use plotters::prelude::*;

use super::scope::{Curve, Scope};
use crate::explained::Explained;

/// A vertical line with words: when something happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Time, s.
    pub time: f64,
    /// What happened.
    pub text: String,
}

/// Colours that can be distinguished on white, also with colour blindness (Okabe and Ito).
const COLOURS: [RGBColor; 8] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xC9, 0x85, 0x00),
    RGBColor(0x3D, 0x9B, 0xD6),
    RGBColor(0x8A, 0x7F, 0xE0),
    RGBColor(0x78, 0x88, 0x96),
];

const WIDTH: u32 = 1000;
const HEIGHT: u32 = 320;
/// Charts of a picture at most: one for each unit.
const MOST_CHARTS: usize = 12;

/// Something could not be drawn: an error in this program.
#[derive(Debug, thiserror::Error)]
#[error("the plot cannot be drawn: {0}")]
pub struct PlotError(String);

impl Explained for PlotError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Internal
    }

    fn advice(&self) -> Advice {
        Advice::default()
    }
}

/// Returns the curves by their unit; words have a chart of their own, as their numbers are no quantities.
fn charts(scope: &Scope) -> Vec<(&str, Vec<&Curve>)> {
    let mut charts: Vec<(&str, Vec<&Curve>)> = Vec::new();
    let drawn = scope.curves.iter().filter(|curve| !curve.points.is_empty());
    for curve in drawn {
        let unit = if curve.is_word {
            "bits"
        } else {
            curve.unit.as_str()
        };
        match charts.iter_mut().find(|(other, _)| *other == unit) {
            Some((_, curves)) => curves.push(curve),
            None => charts.push((unit, vec![curve])),
        }
    }
    charts.truncate(MOST_CHARTS);
    charts
}

/// Returns lowest and highest, with some room.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return (0.0, 1.0);
    }
    let room = if high > low { (high - low) * 0.05 } else { 1.0 };
    (low - room, high + room)
}

/// Returns the curves as a picture, one chart for each unit below the other.
///
/// # Errors
/// When they cannot be drawn, which is an error in this program.
pub fn svg(title: &str, scope: &Scope, marks: &[Mark]) -> Result<String, PlotError> {
    let charts = charts(scope);
    let count = u32::try_from(charts.len().max(1)).unwrap_or(1);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, HEIGHT * count + 30)).into_drawing_area();
        let failed = |error: &dyn std::fmt::Display| PlotError(error.to_string());
        area.fill(&WHITE).map_err(|error| failed(&error))?;
        let area = area
            .titled(title, ("sans-serif", 18))
            .map_err(|error| failed(&error))?;
        let areas = area.split_evenly((charts.len().max(1), 1));
        let times = charts
            .iter()
            .flat_map(|(_, curves)| curves)
            .flat_map(|curve| &curve.points);
        let (from, to) = range(times.map(|point| point.time));
        for ((unit, curves), area) in charts.iter().zip(&areas) {
            chart(area, unit, curves, marks, from..to).map_err(|error| failed(&error))?;
        }
        area.present().map_err(|error| failed(&error))?;
    }
    Ok(text)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn chart<'a>(
    area: &Area<'a>,
    unit: &str,
    curves: &[&Curve],
    marks: &[Mark],
    times: std::ops::Range<f64>,
) -> Result<(), DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>> {
    let values = curves.iter().flat_map(|curve| &curve.points);
    let (low, high) = range(values.flat_map(|point| [point.low, point.high]));
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .x_label_area_size(35)
        .y_label_area_size(70)
        .build_cartesian_2d(times, low..high)?;
    chart.configure_mesh().x_desc("s").y_desc(unit).draw()?;
    for (curve, colour) in curves.iter().zip(COLOURS.iter().cycle()) {
        for (at, piece) in curve.pieces().into_iter().enumerate() {
            let drawn = chart.draw_series(LineSeries::new(piece, colour))?;
            if at == 0 {
                let colour = *colour;
                drawn
                    .label(&curve.name)
                    .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], colour));
            }
        }
    }
    for mark in marks {
        let line = vec![(mark.time, low), (mark.time, high)];
        chart.draw_series(LineSeries::new(line, BLACK.mix(0.5)))?;
        let words = Text::new(mark.text.clone(), (mark.time, high), ("sans-serif", 12));
        chart.draw_series(std::iter::once(words))?;
    }
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()
}

/// Returns the curves as a page: zoom, values under the pointer, curves on and off. It has no external parts.
///
/// # Errors
/// When the curves cannot be put into the page, which is an error in this program.
pub fn html(title: &str, scope: &Scope, marks: &[Mark]) -> Result<String, PlotError> {
    let number = |value: f64| serde_json::Number::from_f64(value).map_or(serde_json::Value::Null, Into::into);
    let curves: Vec<serde_json::Value> = charts(scope)
        .iter()
        .flat_map(|(unit, curves)| curves.iter().map(move |curve| (*unit, *curve)))
        .map(|(unit, curve)| {
            let points = curve.points.iter();
            let points = points.map(|point| vec![number(point.time), number(point.low), number(point.high)]);
            serde_json::json!({
                "name": curve.name,
                "unit": unit,
                "hidden": curve.is_word,
                "points": points.collect::<Vec<_>>(),
            })
        })
        .collect();
    let marks: Vec<serde_json::Value> = marks
        .iter()
        .map(|mark| serde_json::json!({ "time": number(mark.time), "text": mark.text }))
        .collect();
    let colours: Vec<String> = COLOURS
        .iter()
        .map(|RGBColor(r, g, b)| format!("#{r:02X}{g:02X}{b:02X}"))
        .collect();
    let data = serde_json::json!({ "title": title, "curves": curves, "marks": marks, "colours": colours });
    let data = serde_json::to_string(&data).map_err(|error| PlotError(error.to_string()))?;
    // nothing in a name ends the script, and all texts are set as texts, not as markup
    let data = data
        .replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026");
    Ok(include_str!("page.html").replace("\"@DATA@\"", &data))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::recording::{Column, Kind, Row, Table, Value};

    fn scope(name: &str) -> Scope {
        let column = |name: &str, kind, unit: &str| Column {
            name: name.into(),
            kind,
            unit: unit.into(),
            parameter: String::new(),
            scaling: String::new(),
        };
        let table = Table {
            drives: vec![name.into()],
            facts: Vec::new(),
            columns: vec![
                column("speed", Kind::Number, "rpm"),
                column("ZSW1", Kind::Word, ""),
            ],
        };
        let mut scope = Scope::new(&table);
        for at in 0..100_u32 {
            let value = |value| if at == 50 { None } else { Some(value) };
            scope.push(&Row {
                time: Duration::from_millis(u64::from(at) * 16),
                wall: None,
                drive: 0,
                gap: at == 50,
                values: vec![value(Value::Number(f64::from(at))), value(Value::Word(0x0237))],
            });
        }
        scope
    }

    #[test]
    fn a_name_is_never_markup() {
        let scope = scope("</script><script>alert(1)</script>");
        let mark = Mark {
            time: 0.5,
            text: "<b>fault".into(),
        };
        for page in [
            html("<i>t", &scope, std::slice::from_ref(&mark)).unwrap(),
            svg("<i>t", &scope, &[mark]).unwrap(),
        ] {
            for evil in ["<script>alert", "<b>fault", "<i>t"] {
                assert!(!page.contains(evil), "{evil}");
            }
        }
    }

    #[test]
    fn a_plot_needs_nothing_else() {
        let scope = scope("akd-1");
        let page = html("t", &scope, &[]).unwrap();
        assert!(page.contains("akd-1 speed") && !page.contains("@DATA@"));
        assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("src="));
        let picture = svg("t", &scope, &[]).unwrap();
        // two charts; the gap interrupts both lines
        assert!(picture.matches("<polyline").count() >= 4, "{picture}");
        assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
    }

    #[test]
    fn nothing_to_draw_is_a_page_all_the_same() {
        let table = Table {
            drives: vec!["a".into()],
            columns: Vec::new(),
            facts: Vec::new(),
        };
        let scope = Scope::new(&table);
        assert!(svg("t", &scope, &[]).is_ok() && html("t", &scope, &[]).is_ok());
    }
}
