//! Drawings inside their page instead of files that it shows, so that its theme gives their colours and its font their symbols.

/// Width up to which a drawing fits a phone as it is, pixels; a wider one is scrolled there.
const NARROW: f64 = 480.0;

/// The page with its lines `![words](drawing.svg)` replaced by the drawings; neighbouring ones share a row where there is room.
///
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

/// File that a line shows, if it is a drawing and nothing else.
fn drawing(line: &str) -> Option<&str> {
    let (_, target) = line.trim_end().strip_prefix("![")?.split_once("](")?;
    target
        .strip_suffix(')')
        .filter(|name| name.ends_with(".svg"))
}

/// A drawing on one line, without a blank one that would end it for Markdown.
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
