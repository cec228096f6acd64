//! Writes the labels of a panel.

use super::chart::Panel;
use super::place::{Anchor, Label, Place};
use super::style::{Style, marks};
use super::svg::{Point, Rect, Svg, units};
use super::text::text_width;

/// Writes a label; of one that is cut the full text shows under the pointer.
pub(super) fn draw_label(svg: &mut Svg, panel: &Panel, label: &Label) {
    let Some((x, y)) = pixel(panel, label.at).filter(|_| !label.text.is_empty()) else {
        return;
    };
    let text = label.cut.apply(&label.text, label.size, label.room);
    if label.ground {
        let half = 0.5 * text_width(&text, label.size) + 1.0;
        let ground = Rect::new(x - half, y - 11.0, 2.0 * half, 14.0);
        let paint = Style::colour("#ffffff").fill_opacity(0.85).attributes(svg);
        svg.rect(ground, &paint);
    }
    let anchor = match label.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let [x, y, size] = [x, y, label.size].map(units);
    let mut paint = marks(label.class, label.row);
    paint += &format!(
        "text-anchor=\"{anchor}\" font-family=\"sans-serif\" font-size=\"{size}\" fill=\"{}\"",
        label.colour
    );
    if label.bold {
        paint += " font-weight=\"bold\"";
    }
    if label.turned {
        paint += &format!(" transform=\"rotate(-90 {x} {y})\"");
    }
    let cut = text != label.text;
    if cut {
        svg.open_titled(&label.text);
    }
    svg.text_element(&[("x", &x), ("y", &y)], &paint, &text);
    if cut {
        svg.close();
    }
}

/// A place in pixels, if it is finite.
pub(super) fn pixel(panel: &Panel, place: Place) -> Option<Point> {
    let (x, y) = (panel.px(place.x) + place.dx, panel.py(place.y) + place.dy);
    (x.is_finite() && y.is_finite()).then_some((x, y))
}
