//! Filter in front of a stream. Text of files and of the command line is displayed and cannot act: hidden characters become U+FFFD,
//! or `\uXXXX` in JSON. The bytes do not depend on the terminal, except for the program's own styles and the width to which
//! tables and sentences are wrapped.

use std::io::{self, Write};

use cvtcycle::config::is_hidden;
use cvtcycle::output::escape::push_escaped;

use super::colour::{Paint, STYLE_END};

/// Format of a stream.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// Text, with or without styles.
    Text(Paint),
    /// JSON, where hidden characters occur within strings only.
    Json,
}

/// Writer that escapes hidden characters.
pub struct Screen<W> {
    out: W,
    form: Form,
    /// True while a style is open.
    open: bool,
    /// First bytes of an incomplete character.
    rest: Vec<u8>,
}

impl<W: Write> Screen<W> {
    /// Wraps a stream.
    pub fn new(out: W, form: Form) -> Self {
        Screen {
            out,
            form,
            open: false,
            rest: Vec::new(),
        }
    }

    fn shown(&mut self, text: &str) -> String {
        let mut shown = String::with_capacity(text.len());
        for c in text.chars() {
            match self.form {
                Form::Json if is_hidden(c) => push_escaped(&mut shown, c),
                Form::Text(paint) => match paint.code(c) {
                    Some(code) => {
                        shown.push_str(code);
                        self.open = c != STYLE_END;
                    }
                    None => {
                        // Styles end with their line.
                        if c == '\n' && std::mem::take(&mut self.open) {
                            shown.push_str(paint.code(STYLE_END).unwrap_or_default());
                        }
                        shown.push(if is_hidden(c) { '\u{fffd}' } else { c });
                    }
                },
                Form::Json => shown.push(c),
            }
        }
        shown
    }
}

impl<W: Write> Write for Screen<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.rest.extend_from_slice(bytes);
        let whole = match std::str::from_utf8(&self.rest) {
            Err(cut) if cut.error_len().is_none() => cut.valid_up_to(),
            _ => self.rest.len(),
        };
        let rest = self.rest.split_off(whole);
        let text = std::mem::replace(&mut self.rest, rest);
        let shown = self.shown(&String::from_utf8_lossy(&text));
        self.out.write_all(shown.as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use clap::ColorChoice;

    use super::super::colour::Terminal;
    use super::*;

    fn through(form: Form, text: &str, lot: usize) -> String {
        let mut out = Vec::new();
        let mut screen = Screen::new(&mut out, form);
        for bytes in text.as_bytes().chunks(lot) {
            screen.write_all(bytes).expect("written");
        }
        String::from_utf8(out).expect("text")
    }

    #[test]
    fn nothing_hidden_passes_and_styles_end_with_their_line() {
        let off = Paint::NONE;
        let on = Terminal::new(ColorChoice::Always).stdout;
        let text = "a\u{1b}[8mb\u{9b}\u{202e}c\u{fdd0}ü\n\tend";
        for lot in 1..=text.len() {
            let shown = through(Form::Text(off), text, lot);
            assert_eq!(shown, "a\u{fffd}[8mb\u{fffd}\u{fffd}c\u{fffd}ü\n\tend");
        }
        assert_eq!(
            through(Form::Text(on), &on.heading("x"), 1),
            "\u{1b}[1mx\u{1b}[0m"
        );
        assert_eq!(
            through(Form::Text(on), &on.bad("x"), 2),
            "\u{1b}[1;31mx\u{1b}[0m"
        );
        assert_eq!(off.heading("x"), "x");
        assert_eq!(
            through(Form::Text(on), "\u{fdd1}x\ny", 3),
            "\u{1b}[1;31mx\u{1b}[0m\ny"
        );
        let json = "{\"a\":\"\u{7f}\u{202e}\"}\n";
        assert_eq!(through(Form::Json, json, 2), "{\"a\":\"\\u007f\\u202e\"}\n");
    }
}
