//! Inlines drawings into their page, so that its theme colours them and its font draws their symbols.

/// Maximum width of a drawing that fits a phone, pixels; wider ones are scrolled there.
const NARROW: f64 = 480.0;

/// Replaces lines `![words](drawing.svg)` of a page by the drawings. Adjacent ones share a row if there is room.
/// # Errors
/// A sentence for each drawing that `read` does not find or that has no width.
pub fn page(markdown: &str, read: impl Fn(&str) -> Option<String>) -> Result<String, Vec<String>> {
    let (mut out, mut problems) = (String::with_capacity(markdown.len()), Vec::new());
    let (mut fenced, mut row) = (false, false);
    for line in markdown.split_inclusive('\n') {
        fenced ^= line.starts_with("```");
        let drawing = drawing(line).filter(|_| !fenced);
        if row && drawing.is_none() {
            out.push_str("</div>\n");
        }
        match drawing {
            Some(name) => {
                if !row {
                    out.push_str("<div class=\"figures\">\n");
                }
                match read(name).as_deref().map(figure) {
                    Some(Some(text)) => out.push_str(&text),
                    Some(None) => problems.push(format!("{name}: a drawing without width")),
                    None => problems.push(format!("{name}: no such drawing")),
                }
            }
            None => out.push_str(line),
        }
        row = drawing.is_some();
    }
    if row {
        out.push_str("</div>\n");
    }
    if problems.is_empty() {
        Ok(out)
    } else {
        Err(problems)
    }
}

/// File of a line that consists of a drawing only.
fn drawing(line: &str) -> Option<&str> {
    let (_, target) = line.trim_end().strip_prefix("![")?.split_once("](")?;
    target
        .strip_suffix(')')
        .filter(|name| name.ends_with(".svg"))
}

/// Puts a drawing on one line, since Markdown would end it at a blank line.
fn figure(svg: &str) -> Option<String> {
    let (_, rest) = svg.split_once(" width=\"")?;
    let width: f64 = rest.split_once('"')?.0.parse().ok()?;
    let body: String = svg.lines().map(str::trim).collect();
    Some(if width <= NARROW {
        format!("<figure class=\"sketch\">{body}</figure>\n")
    } else {
        format!("<figure class=\"chart\" tabindex=\"0\">{body}</figure>\n")
    })
}
