//! Path of the belt, drawn to scale from the geometry.

use super::reference::Reference;
use crate::sketch::Anchor::{Middle, Start};
use crate::sketch::{Sketch, colour};
use cvtcycle::model::transmission::cvt::variator::Geometry;

/// Pixels per metre.
const SCALE: f64 = 1300.0;
/// Centre of the primary, pixels.
const CENTRE: (f64, f64) = (100.0, 148.0);

/// Figures by file name.
pub fn figures(r: &Reference) -> Vec<(&'static str, String)> {
    let (x, l) = (r.cvt().belt.centre_distance_m, r.cvt().belt.length_m);
    let path = |ratio: f64, word: &str| path(&Geometry::new(ratio, x, l), x, word);
    vec![
        ("geometry_path_low", path(r.cvt().ratio.low, "low")),
        ("geometry_path_high", path(r.cvt().ratio.high, "high")),
    ]
}

/// Draws one belt.
fn path(g: &Geometry, distance_m: f64, word: &str) -> String {
    let (cx, cy) = CENTRE;
    let sx = cx + SCALE * distance_m;
    let (rp, rs) = (SCALE * g.primary_radius_m, SCALE * g.secondary_radius_m);
    // Angle of the tangent points from the vertical: sin alpha = (R_s - R_p)/X.
    let alpha = (g.secondary_wrap_rad - std::f64::consts::PI) / 2.0;
    let (s, c) = alpha.sin_cos();
    let (px, py, qx, qy) = (cx - rp * s, rp * c, sx - rs * s, rs * c);
    let large = |wrap: f64| i32::from(wrap > std::f64::consts::PI);
    let (lp, ls) = (large(g.primary_wrap_rad), large(g.secondary_wrap_rad));
    let mut sketch = Sketch::new(400.0, 330.0);
    let head = format!(
        "$I$ = {:.3} ({word}), strut {:.1} mm",
        g.ratio,
        1e3 * g.strut_m
    );
    sketch.text((8.0, 18.0), Start, 14.0, colour::INK, &head);
    let belt = format!(
        "M{px:.1} {u:.1}L{qx:.1} {v:.1}A{rs:.1} {rs:.1} 0 {ls} 1 {qx:.1} {w:.1}L{px:.1} {d:.1}A{rp:.1} {rp:.1} 0 {lp} 1 {px:.1} {u:.1}Z",
        u = cy - py,
        v = cy - qy,
        w = cy + qy,
        d = cy + py
    );
    sketch.path(&belt, colour::INK, 4.0, "");
    sketch.line(&[(cx, cy), (sx, cy)], colour::QUIET, 1.2, "8 4");
    let middle = (0.5 * (cx + sx), cy - 6.0);
    sketch.text(middle, Middle, 15.0, colour::QUIET, "$X$");
    for (x, r, a, name, index, radius, wrap) in [
        (
            cx,
            rp,
            2.6,
            "primary",
            "p",
            g.primary_radius_m,
            g.primary_wrap_rad,
        ),
        (
            sx,
            rs,
            0.55_f64,
            "secondary",
            "s",
            g.secondary_radius_m,
            g.secondary_wrap_rad,
        ),
    ] {
        pulley(&mut sketch, (x, r, a), [name, index], (radius, wrap));
    }
    sketch.finish(
        &format!("Path of the belt in {word} ratio"),
        "Both pulleys with running radii, wrap angles and free struts, to scale.",
    )
}

/// Draws a pulley at `x` with its radius at an angle, labelled with name and index; radius in m, wrap in rad.
fn pulley(
    sketch: &mut Sketch,
    (x, r, a): (f64, f64, f64),
    [name, index]: [&str; 2],
    (radius, wrap): (f64, f64),
) {
    let cy = CENTRE.1;
    sketch.dot((x, cy), 3.5, colour::INK);
    let end = (x + r * f64::cos(a), cy - r * f64::sin(a));
    sketch.line(&[(x, cy), end], colour::FORCE, 2.0, "");
    let radius = format!("$R_{index}$ = {:.1} mm", 1e3 * radius);
    let wrap = format!("$\\beta_{index}$ = {:.0}\u{b0}", wrap.to_degrees());
    sketch.text((x, 284.0), Middle, 13.0, colour::INK, name);
    sketch.text((x, 302.0), Middle, 13.0, colour::FORCE, &radius);
    sketch.text((x, 320.0), Middle, 13.0, colour::BLUE, &wrap);
}
