//! Converts equations of a Markdown page, `$...$` and `$$...$$`, to MathML.

use pulldown_latex::config::DisplayMode;
use pulldown_latex::{Parser, RenderConfig, Storage, push_mathml};

/// Converts the equations of a page to MathML and adds an anchor at every labelled one.
/// # Errors
/// A sentence for each equation that cannot be parsed, with its text.
pub fn page(markdown: &str) -> Result<String, Vec<String>> {
    let mut out = String::with_capacity(2 * markdown.len());
    let mut problems = Vec::new();
    let mut rest = markdown;
    while let Some(at) = rest.find(['$', '`', '\n', '\\']) {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        let used = if let Some(body) = rest.strip_prefix("$$") {
            let (length, text) = equation(body, "$$", DisplayMode::Block, &mut problems);
            out.push_str(&format!("\n<div class=\"equation\">{text}</div>\n"));
            2 + length
        } else if let Some(body) = rest.strip_prefix('$') {
            let (length, text) = equation(body, "$", DisplayMode::Inline, &mut problems);
            out.push_str(&text);
            1 + length
        } else if rest.starts_with('`') {
            let code = code_span(rest);
            out.push_str(&rest[..code]);
            code
        } else if rest.starts_with("\\$") {
            out.push('$');
            2
        } else if let Some(label) = rest.strip_prefix('\n').and_then(label) {
            out.push_str(&format!("\n<a id=\"{label}\"></a>"));
            1
        } else {
            out.push_str(&rest[..1]);
            1
        };
        rest = &rest[used..];
    }
    out.push_str(rest);
    if problems.is_empty() {
        Ok(out)
    } else {
        Err(problems)
    }
}

/// Label of a line `**BT-3** (derived)`.
pub fn label(line: &str) -> Option<&str> {
    let (label, rest) = line.strip_prefix("**")?.split_once("** (")?;
    let (letters, digits) = label.split_once('-')?;
    let known = letters.len() == 2
        && letters.bytes().all(|b| b.is_ascii_uppercase())
        && digits.bytes().all(|b| b.is_ascii_digit());
    (known && !digits.is_empty() && rest.lines().next()?.contains(')')).then_some(label)
}

/// Length of a code span or fenced block that starts here; at least 1, for the backtick.
fn code_span(text: &str) -> usize {
    let ticks = text.bytes().take_while(|b| *b == b'`').count();
    let mark = &text[..ticks];
    text[ticks..]
        .find(mark)
        .map_or(ticks, |end| 2 * ticks + end)
}

/// Length of an equation with its closing mark, and its MathML.
fn equation(
    body: &str,
    mark: &str,
    mode: DisplayMode,
    problems: &mut Vec<String>,
) -> (usize, String) {
    let Some(end) = body.find(mark) else {
        problems.push(format!(
            "equation without end: {}",
            body.lines().next().unwrap_or_default()
        ));
        return (body.len(), String::new());
    };
    let tex = body[..end].trim();
    if tex.contains("\n\n") {
        problems.push(format!(
            "equation over a blank line: {}",
            tex.lines().next().unwrap_or_default()
        ));
    }
    let storage = Storage::new();
    let mut events = Vec::new();
    for event in Parser::new(tex, &storage) {
        match event {
            Ok(event) => events.push(Ok::<_, std::convert::Infallible>(event)),
            Err(why) => problems.push(format!("{tex}: {why}")),
        }
    }
    let mut mathml = String::new();
    let config = RenderConfig {
        display_mode: mode,
        xml: true,
        ..RenderConfig::default()
    };
    if let Err(why) = push_mathml(&mut mathml, events.into_iter(), config) {
        problems.push(format!("{tex}: {why}"));
    }
    (end + mark.len(), plain_for_markdown(&sound(&mathml)))
}

/// Makes the MathML well-formed XML: the crate (0.8) leaves comparison signs unescaped, omits a blank between attributes, and
/// writes a blank as an entity that XML does not define.
fn sound(mathml: &str) -> String {
    mathml
        .replace("<mo><</mo>", "<mo>&lt;</mo>")
        .replace("<mo>></mo>", "<mo>&gt;</mo>")
        .replace("\"minsize=", "\" minsize=")
        .replace("&amp;nbsp;", "\u{a0}")
        .replace("&nbsp;", "\u{a0}")
}

/// Escapes characters of the MathML that Markdown would interpret.
fn plain_for_markdown(mathml: &str) -> String {
    let mut out = String::with_capacity(mathml.len());
    let mut tag = false;
    for c in mathml.chars() {
        match c {
            '<' => tag = true,
            '>' => tag = false,
            _ => {}
        }
        match c {
            '\n' | '\r' => out.push(' '),
            '*' | '_' | '|' | '\\' | '`' | '[' | ']' | '~' if !tag => {
                out.push_str(&format!("&#{};", u32::from(c)))
            }
            c => out.push(c),
        }
    }
    out
}
