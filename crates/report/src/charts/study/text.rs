//! Text that fits.

use super::super::axis::{number, round_step};
use super::super::figure::{Anchor, Figure, INK, QUIET, escape, text_width, units};
use super::super::legend::{ENTRY, Mark, legend};

/// Size of notes and of names beside rows, pixels.
pub(in crate::charts) const SIZE: f64 = 11.0;
/// Height of a line of notes, pixels.
const LINE: f64 = 15.0;

/// The text, or its beginning and end around an ellipsis.
pub(in crate::charts) fn middle(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let all: Vec<char> = text.chars().collect();
    let cut = |keep: usize| {
        let (head, tail) = (keep.div_ceil(2), keep / 2);
        let begin: String = all[..head].iter().collect();
        let end: String = all[all.len() - tail..].iter().collect();
        format!("{}\u{2026}{}", begin.trim_end(), end.trim_start())
    };
    (0..all.len())
        .rev()
        .map(cut)
        .find(|short| text_width(short, size) <= width)
        .unwrap_or_else(|| "\u{2026}".to_owned())
}

/// The text in as many lines as it takes, broken between words; a word that is too long is cut in its middle.
pub(in crate::charts) fn lines(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // Not at spaces that bind.
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line)
                if text_width(line, size) + text_width(&format!(" {word}"), size) <= width =>
            {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(middle(word, size, width)),
        }
    }
    // They have done their work.
    lines
        .into_iter()
        .map(|line| line.replace('\u{a0}', " "))
        .collect()
}

/// Where a name goes.
#[derive(Clone, Copy)]
pub(in crate::charts) enum Side {
    /// It begins at its place.
    Right,
    /// It ends there.
    Left,
    /// It stands in the middle.
    Over,
}

/// Writes a name cut to a width; what was cut away shows under the pointer.
pub(in crate::charts) fn name(
    figure: &mut Figure,
    at: (f64, f64),
    side: Side,
    (size, width): (f64, f64),
    attributes: &str,
    text: &str,
) {
    let short = middle(text, size, width);
    let cut = short != text;
    if cut {
        figure.raw(&format!("<g><title>{}</title>", escape(text)));
    }
    match side {
        Side::Right => figure.text(at, size, Anchor::Start, attributes, INK, &short),
        Side::Over => figure.text(at, size, Anchor::Middle, attributes, INK, &short),
        Side::Left => ends_at(figure, at, size, attributes, &short),
    }
    if cut {
        figure.close();
    }
}

/// Text that ends at a place.
fn ends_at(figure: &mut Figure, at: (f64, f64), size: f64, attributes: &str, text: &str) {
    if text.is_empty() {
        return;
    }
    let (x, y, size, text) = (units(at.0), units(at.1), units(size), escape(text));
    figure.raw(&format!(
        "<text x=\"{x}\" y=\"{y}\" text-anchor=\"end\" font-family=\"sans-serif\" font-size=\"{size}\" fill=\"{INK}\" {attributes}>{text}</text>"
    ));
}

/// Widest name of a legend, room between its columns, and that of a mark beside the name, pixels.
const NAME: f64 = 420.0;
const GUTTER: f64 = 24.0;
const MARK: f64 = 40.0;

/// Columns of a legend and their width: as many as fit.
fn columns<'n>(names: impl Iterator<Item = &'n str>, width: f64) -> (usize, f64) {
    let room = NAME.min(width - MARK);
    let widest = names
        .map(|name| text_width(&middle(name, SIZE, room), SIZE))
        .fold(0.0, f64::max);
    // A little wider than the text, lest the legend breaks the line.
    let wide = MARK + widest + 2.0;
    (
        ((width + GUTTER) / (wide + GUTTER)).floor().max(1.0) as usize,
        wide,
    )
}

/// Draws a legend in columns, line by line; names are cut in their middle.
fn entries(figure: &mut Figure, (left, top): (f64, f64), width: f64, entries: Vec<(Mark, &str)>) {
    let (columns, wide) = columns(entries.iter().map(|(_, name)| *name), width);
    for (k, (mark, name)) in entries.into_iter().enumerate() {
        let at = (
            left + (k % columns) as f64 * (wide + GUTTER),
            top + ENTRY * (k / columns) as f64,
        );
        let short = middle(name, SIZE, NAME.min(width - MARK));
        let cut = short != name;
        if cut {
            figure.raw(&format!("<g><title>{}</title>", escape(name)));
        }
        legend(figure, at, wide, "", &[(mark, short)]);
        if cut {
            figure.close();
        }
    }
}

/// Draws a legend and below it notes, both below the plots.
pub(in crate::charts) fn foot(
    figure: &mut Figure,
    (left, top): (f64, f64),
    width: f64,
    marks: Vec<(Mark, &str)>,
    told: &[String],
) {
    let below = top + entries_height(marks.iter().map(|(_, name)| *name), width);
    entries(figure, (left, top), width, marks);
    notes(figure, (left, below), width, told);
}

/// Height of such a foot, pixels.
pub(in crate::charts) fn foot_height<'n>(
    names: impl Iterator<Item = &'n str> + Clone,
    width: f64,
    told: &[String],
) -> f64 {
    entries_height(names, width) + notes_height(told, width) + 6.0
}

fn entries_height<'n>(names: impl Iterator<Item = &'n str> + Clone, width: f64) -> f64 {
    let (columns, _) = columns(names.clone(), width);
    match names.count() {
        0 => 0.0,
        count => ENTRY * count.div_ceil(columns) as f64 + 6.0,
    }
}

/// Height of notes of a width, pixels.
fn notes_height(notes: &[String], width: f64) -> f64 {
    notes
        .iter()
        .map(|note| LINE * lines(note, SIZE, width).len() as f64 + 5.0)
        .sum()
}

/// Writes notes below each other from a corner; each begins a little apart from the one before.
fn notes(figure: &mut Figure, (left, mut top): (f64, f64), width: f64, notes: &[String]) {
    for note in notes {
        for line in lines(note, SIZE, width) {
            figure.text((left, top + 11.0), SIZE, Anchor::Start, "", QUIET, &line);
            top += LINE;
        }
        top += 5.0;
    }
}

/// A value with the digits that a spread of that size leaves meaningful.
pub(in crate::charts) fn value(x: f64, spread: f64) -> String {
    if !x.is_finite() {
        return "not known".to_owned();
    }
    let scale = if spread.is_finite() && spread > 1e-12 * x.abs() {
        spread
    } else {
        x.abs().max(1e-300)
    };
    number(x, round_step(scale / 200.0))
}

/// A share of 0 to 1 in percent, with a decimal; more where it is close to an end.
pub(in crate::charts) fn percent(share: f64) -> String {
    let off = share.min(1.0 - share);
    if share.is_finite() && off > 0.0 && off < 0.001 {
        format!("{:.3}", 100.0 * share)
    } else {
        format!("{:.1}", 100.0 * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_both_ends() {
        assert_eq!(middle("friction", 11.0, 500.0), "friction");
        let long = "lubricant.traction.friction_coefficient_at_40_degc";
        let short = middle(long, 11.0, 150.0);
        assert!(
            short.starts_with("lubri") && short.ends_with("degc") && short.contains('\u{2026}'),
            "{short}"
        );
        assert!(text_width(&short, 11.0) <= 150.0 && short.chars().count() > 15);
        assert_eq!(middle(long, 11.0, 0.0), "\u{2026}");
        assert_eq!(
            middle(
                "\u{e9}\u{1f697}\u{e9}\u{1f697}\u{e9}\u{1f697}\u{e9}",
                11.0,
                40.0
            )
            .chars()
            .filter(|c| *c == '\u{2026}')
            .count(),
            1
        );
    }

    #[test]
    fn notes_break_between_words() {
        let text = "the 7 of 30 factors with the largest total index";
        let broken = lines(text, 11.0, 120.0);
        assert!(broken.len() > 2 && broken.iter().all(|line| text_width(line, 11.0) <= 120.0));
        assert_eq!(broken.join(" "), text);
        assert!(lines("", 11.0, 100.0).is_empty());
    }

    #[test]
    fn numbers_have_the_digits_of_their_spread() {
        assert_eq!(value(7.214_3, 0.9), "7.214");
        assert_eq!(value(-0.5, 0.0), "\u{2212}0.500");
        assert_eq!(value(1234.0, 800.0), "1234");
        assert_eq!(value(f64::NAN, 1.0), "not known");
        assert_eq!(
            (
                percent(0.934_2).as_str(),
                percent(0.999_7).as_str(),
                percent(1.0).as_str()
            ),
            ("93.4", "99.970", "100.0")
        );
    }
}
