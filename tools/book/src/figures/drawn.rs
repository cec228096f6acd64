//! The belt's path, drawn to scale from the geometry.

use super::reference::Reference;
use cvtcycle::model::transmission::cvt::variator::Geometry;
use std::fmt::Write as _;

/// Pixels in a metre.
const SCALE: f64 = 1250.0;
const SIZE: (f64, f64) = (940.0, 310.0);

/// All of them, by file name.
pub fn figures(r: &Reference) -> Vec<(&'static str, String)> {
    let (x, l) = (r.cvt().belt.centre_distance_m, r.cvt().belt.length_m);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<title>Path of the belt in low and high ratio</title>\n\
         <desc>Both pulleys with running radii, wrap angles and free struts, to scale.</desc>\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
        w = SIZE.0,
        h = SIZE.1
    );
    path(
        &mut svg,
        &Geometry::new(r.cvt().ratio.low, x, l),
        (110.0, 150.0),
        x,
        "low",
    );
    path(
        &mut svg,
        &Geometry::new(r.cvt().ratio.high, x, l),
        (610.0, 150.0),
        x,
        "high",
    );
    svg.push_str("</svg>\n");
    vec![("geometry_path", svg)]
}

/// One belt with the primary's centre at `centre`.
fn path(svg: &mut String, g: &Geometry, centre: (f64, f64), distance_m: f64, name: &str) {
    let (cx, cy) = centre;
    let sx = cx + SCALE * distance_m;
    let (rp, rs) = (SCALE * g.primary_radius_m, SCALE * g.secondary_radius_m);
    // Angle of the tangent points from the vertical: sin alpha = (R_s - R_p)/X.
    let alpha = (g.secondary_wrap_rad - std::f64::consts::PI) / 2.0;
    let (s, c) = alpha.sin_cos();
    let (px, py, qx, qy) = (cx - rp * s, rp * c, sx - rs * s, rs * c);
    let large = |wrap: f64| i32::from(wrap > std::f64::consts::PI);
    let (lp, ls) = (large(g.primary_wrap_rad), large(g.secondary_wrap_rad));
    // Writing into a String cannot fail.
    let _ = writeln!(
        svg,
        "<path d=\"M{px:.1} {u:.1}L{qx:.1} {v:.1}A{rs:.1} {rs:.1} 0 {ls} 1 {qx:.1} {w:.1}L{px:.1} {d:.1}A{rp:.1} {rp:.1} 0 {lp} 1 {px:.1} {u:.1}Z\" \
         fill=\"none\" stroke=\"#000000\" stroke-width=\"4\"/>",
        u = cy - py,
        v = cy - qy,
        w = cy + qy,
        d = cy + py
    );
    for (x, r, label, radius, wrap) in [
        (cx, rp, "R_p", g.primary_radius_m, g.primary_wrap_rad),
        (sx, rs, "R_s", g.secondary_radius_m, g.secondary_wrap_rad),
    ] {
        let a: f64 = if label == "R_p" { 2.6 } else { 0.55 };
        let (ex, ey) = (x + r * a.cos(), cy - r * a.sin());
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{cy}\" r=\"3.5\" fill=\"#000000\"/>\n<path d=\"M{x:.1} {cy}L{ex:.1} {ey:.1}\" stroke=\"#d55e00\" stroke-width=\"2\"/>\n\
             <text x=\"{x:.1}\" y=\"280\" text-anchor=\"middle\" fill=\"#b34700\">{label} = {mm:.1} mm</text>\n\
             <text x=\"{x:.1}\" y=\"299\" text-anchor=\"middle\" fill=\"#005c94\">wrap {deg:.0}\u{b0}</text>",
            mm = 1e3 * radius,
            deg = wrap.to_degrees()
        );
    }
    let middle = 0.5 * (cx + sx);
    let _ = writeln!(
        svg,
        "<path d=\"M{cx:.1} {cy}H{sx:.1}\" stroke=\"#555555\" stroke-dasharray=\"8 4\"/>\n\
         <text x=\"{middle:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" fill=\"#555555\">X</text>\n\
         <text x=\"{middle:.1}\" y=\"24\" text-anchor=\"middle\" font-size=\"15\" font-weight=\"bold\">I = {ratio:.3} ({name}), strut {strut:.1} mm</text>\n\
         <text x=\"{cx:.1}\" y=\"261\" text-anchor=\"middle\">primary</text>\n<text x=\"{sx:.1}\" y=\"261\" text-anchor=\"middle\">secondary</text>",
        y = cy - 5.0,
        ratio = g.ratio,
        strut = 1e3 * g.strut_m
    );
}
