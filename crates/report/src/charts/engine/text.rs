//! Widths of texts; cuts and wraps texts to a width.

/// Estimates the width of a text in a wide sans-serif face, pixels.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let ems = text.chars().map(|c| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '|' | '\'' | '!' | '(' | ')' | '[' | ']'
        | ' ' => 0.4,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 1.0,
        c if c as u32 >= 0x1100 => 1.05,
        c if c.is_uppercase() => 0.75,
        _ => 0.64,
    });
    ems.sum::<f64>() * size
}

/// Part of a text that an ellipsis replaces if the text is too wide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Cut {
    #[default]
    End,
    Middle,
    Start,
}

impl Cut {
    /// Cuts the text to a width.
    pub fn apply(self, text: &str, size: f64, width: f64) -> String {
        if text_width(text, size) <= width {
            return text.to_owned();
        }
        let all: Vec<char> = text.chars().collect();
        let part = |from: usize, to: usize| all[from..to].iter().collect::<String>();
        let short = |keep: usize| match self {
            Cut::End => part(0, keep).trim_end().to_owned() + "\u{2026}",
            Cut::Start => format!("\u{2026}{}", part(all.len() - keep, all.len())),
            Cut::Middle => {
                let (head, tail) = (part(0, keep.div_ceil(2)), keep / 2);
                let tail = part(all.len() - tail, all.len());
                format!("{}\u{2026}{}", head.trim_end(), tail.trim_start())
            }
        };
        (0..all.len())
            .rev()
            .map(short)
            .find(|short| text_width(short, size) <= width)
            .unwrap_or_else(|| "\u{2026}".to_owned())
    }
}

/// Wraps the text to at most two lines between words, and cuts the rest.
pub(crate) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut breaks = text.match_indices(' ').map(|(at, _)| at);
    let best = breaks.rfind(|at| text_width(&text[..*at], size) <= width);
    match best {
        Some(at) if text_width(text, size) > width => {
            let rest = Cut::End.apply(text[at..].trim_start(), size, width);
            vec![text[..at].to_string(), rest]
        }
        _ => vec![Cut::End.apply(text, size, width)],
    }
}

/// Wraps the text between words; an overlong word is cut in its middle.
pub(crate) fn lines(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // Non-breaking spaces do not match.
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(Cut::Middle.apply(word, size, width)),
        }
    }
    for line in &mut lines {
        *line = line.replace('\u{a0}', " ");
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cut_keeps_the_requested_ends() {
        let cut = |text: &str, width| Cut::Middle.apply(text, 11.0, width);
        assert_eq!(cut("friction", 500.0), "friction");
        let long = "lubricant.traction.friction_coefficient_at_40_degc";
        let short = cut(long, 150.0);
        assert!(
            short.starts_with("lubri") && short.ends_with("degc") && short.contains('\u{2026}'),
            "{short}"
        );
        assert!(text_width(&short, 11.0) <= 150.0 && short.chars().count() > 15);
        assert_eq!(cut(long, 0.0), "\u{2026}");
        let odd = cut("\u{e9}\u{1f697}\u{e9}\u{1f697}\u{e9}\u{1f697}\u{e9}", 40.0);
        assert_eq!(odd.matches('\u{2026}').count(), 1);
        assert!(Cut::Start.apply(long, 11.0, 150.0).ends_with("40_degc"));
        assert!(Cut::End.apply(long, 11.0, 150.0).starts_with("lubricant."));
    }

    #[test]
    fn notes_break_between_words() {
        let text = "the 7 of 30 factors with the largest total index";
        let broken = lines(text, 11.0, 120.0);
        assert!(broken.len() > 2 && broken.iter().all(|line| text_width(line, 11.0) <= 120.0));
        assert_eq!(broken.join(" "), text);
        assert!(lines("", 11.0, 100.0).is_empty());
    }
}
