//! The summary of the demo as a picture of a terminal (SVG), for README and the site.

use std::fmt::Write;

use crate::Outcome;

/// The line above the summary.
const HEAD: &str = "what happened";

/// Width of a letter and height of a line, in pixels.
const LETTER: f64 = 7.25;
const LINE: usize = 18;
/// Space around the text.
const MARGIN: usize = 16;

/// Mark, step and result of a line, each with the column where it begins.
fn columns(line: &str) -> Option<[(usize, &str); 3]> {
    let (mark, rest) = line.split_once("  ")?;
    let step = rest.trim_start();
    let (name, result) = step.split_once("  ")?;
    let result = result.trim_start();
    // places in the line, in letters
    let column = |part: &str| line.chars().count() - part.chars().count();
    Some([(0, mark), (column(step), name), (column(result), result)])
}

/// Returns the picture of what the demo prints.
pub fn draw(text: &str) -> Outcome<String> {
    let (_, summary) = text
        .split_once(&format!("{HEAD}\n"))
        .ok_or("the demo prints no summary")?;
    let lines: Vec<&str> = summary.lines().filter(|line| !line.is_empty()).collect();
    let longest = lines.iter().map(|line| line.chars().count()).max();
    let longest = longest.ok_or("the summary of the demo is empty")?;
    let width = (longest as f64 * LETTER).ceil() as usize + 2 * MARGIN;
    let height = (lines.len() + 1) * LINE + 2 * MARGIN;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">
<style>text {{ font: 12px ui-monospace, Menlo, Consolas, "DejaVu Sans Mono", monospace }}
.step {{ fill: #d7dce2 }} .ok {{ fill: #5fd787 }} .bad {{ fill: #ff6b6b }} .faint {{ fill: #8b949e }}</style>
<rect width="{width}" height="{height}" rx="8" fill="#161b22"/>
"##
    );
    let mut row = |number: usize, parts: &[(&str, usize, &str)]| -> Outcome<()> {
        let y = MARGIN + (number + 1) * LINE - 5;
        write!(svg, r#"<text y="{y}">"#)?;
        for (class, column, part) in parts {
            let x = MARGIN as f64 + *column as f64 * LETTER;
            write!(svg, r#"<tspan x="{x}" class="{class}">{}</tspan>"#, escaped(part))?;
        }
        writeln!(svg, "</text>")?;
        Ok(())
    };
    row(0, &[("faint", 0, "$ make demo")])?;
    for (number, line) in lines.iter().enumerate() {
        let [mark, step, result] =
            columns(line).ok_or_else(|| format!("not a line of the summary: {line}"))?;
        let class = if mark.1 == "ok" { "ok" } else { "bad" };
        let parts = [
            (class, mark.0, mark.1),
            ("step", step.0, step.1),
            ("faint", result.0, result.1),
        ];
        row(number + 1, &parts)?;
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_becomes_lines_at_their_columns() {
        let line = "ok    jog             a -> b & c";
        assert_eq!(columns(line), Some([(0, "ok"), (6, "jog"), (22, "a -> b & c")]));
        let svg = draw(&format!("> jog\n{HEAD}\n{line}\n")).unwrap();
        assert!(
            svg.contains(r#"class="ok">ok<"#) && svg.contains("a -&gt; b &amp; c"),
            "{svg}"
        );
        assert!(draw("> jog\n").is_err());
        assert!(draw(&format!("{HEAD}\n")).is_err());
    }
}
