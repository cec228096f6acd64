//! Lines and fills that stay apart in black and white and for the colour-blind.
use super::figure::{Figure, UNITS};
use cvtcycle_output::Component;

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// Colour.
    pub colour: &'static str,
    /// Width, pixels.
    pub width: f64,
    /// Dash pattern, pixels; empty for a solid line.
    pub dash: &'static [f64],
}

/// The line of a plot with one series.
pub(super) const PLAIN: Stroke = Stroke {
    colour: "#1f3b73",
    width: 1.3,
    dash: &[],
};
/// A line that is only context.
pub(super) const CONTEXT: Stroke = Stroke {
    colour: "#777777",
    width: 1.0,
    dash: &[],
};

/// Secondary and primary pressure.
pub(super) const PRESSURES: [Stroke; 2] = [
    Stroke {
        colour: "#000000",
        width: 1.6,
        dash: &[],
    },
    Stroke {
        colour: "#d55e00",
        width: 1.3,
        dash: &[4.0, 2.0],
    },
];

/// Lines of a plot with several series: each differs in colour, lightness and dashes.
pub(super) const STROKES: [Stroke; 7] = [
    Stroke {
        colour: "#000000",
        width: 2.2,
        dash: &[],
    },
    Stroke {
        colour: "#d55e00",
        width: 1.5,
        dash: &[],
    },
    Stroke {
        colour: "#0072b2",
        width: 1.9,
        dash: &[9.0, 4.0],
    },
    Stroke {
        colour: "#009e73",
        width: 1.9,
        dash: &[9.0, 3.0, 2.0, 3.0],
    },
    Stroke {
        colour: "#aa4499",
        width: 1.7,
        dash: &[4.0, 2.5],
    },
    Stroke {
        colour: "#666666",
        width: 2.0,
        dash: &[1.5, 2.5],
    },
    Stroke {
        colour: "#4b2991",
        width: 1.5,
        dash: &[14.0, 3.0, 2.0, 3.0, 2.0, 3.0],
    },
];

impl Stroke {
    /// Its SVG attributes, in canvas units.
    pub fn attributes(&self) -> String {
        let width = self.width * UNITS;
        let mut text = format!(
            "fill=\"none\" stroke=\"{}\" stroke-width=\"{width:.1}\" stroke-linejoin=\"round\"",
            self.colour
        );
        if self.dash.is_empty() {
            text += " stroke-linecap=\"round\"";
        } else {
            let dashes: Vec<_> = self
                .dash
                .iter()
                .map(|d| format!("{:.0}", d * UNITS))
                .collect();
            text += &format!(" stroke-dasharray=\"{}\"", dashes.join(" "));
        }
        text
    }
}

/// Anchors of a ramp whose lightness rises evenly, and that the colour-blind see rising too.
const RAMP: [(f64, f64, f64); 7] = [
    (52.0, 20.0, 94.0),
    (69.0, 74.0, 139.0),
    (49.0, 113.0, 145.0),
    (36.0, 149.0, 139.0),
    (75.0, 187.0, 112.0),
    (155.0, 217.0, 75.0),
    (245.0, 230.0, 90.0),
];

/// Anchors of a second ramp of the same kind, for the parts of a manual box beside those of a CVT.
const WARM: [(f64, f64, f64); 5] = [
    (82.0, 8.0, 24.0),
    (152.0, 38.0, 18.0),
    (208.0, 88.0, 28.0),
    (238.0, 156.0, 62.0),
    (250.0, 222.0, 150.0),
];

/// Colour of the ramp at a share of 0 to 1.
pub(super) fn ramp(share: f64) -> String {
    between(&RAMP, share)
}

/// Colour between anchors at a share of 0 to 1.
pub(super) fn between(anchors: &[(f64, f64, f64)], share: f64) -> String {
    let place = share.clamp(0.0, 1.0) * (anchors.len() - 1) as f64;
    let cell = (place.floor() as usize).min(anchors.len() - 2);
    let (a, b, t) = (anchors[cell], anchors[cell + 1], place - cell as f64);
    let mix = |a: f64, b: f64| (a + (b - a) * t).round() as u8;
    format!(
        "#{:02x}{:02x}{:02x}",
        mix(a.0, b.0),
        mix(a.1, b.1),
        mix(a.2, b.2)
    )
}

/// Defines the fill `index` of `count` under names that begin with `plot`; returns its paint.
///
/// Lightness rises with the index; neighbours differ in their hatch too.
pub(super) fn fill(figure: &mut Figure, plot: &str, index: usize, count: usize) -> String {
    let share = if count > 1 {
        index as f64 / (count - 1) as f64
    } else {
        0.4
    };
    hatched(
        figure,
        &format!("{plot}-{index}"),
        &ramp(share),
        share,
        index,
    )
}

/// Defines the fill of a component, the same in every picture, under a name that begins with `plot`; returns its paint.
pub(super) fn component_fill(figure: &mut Figure, plot: &str, component: Component) -> String {
    use Component as C;
    // Places on two ramps: within a car lightness rises in the order of the power flow.
    let (anchors, index, last): (&[_], usize, f64) = match component {
        C::LaunchClutch => (&RAMP, 0, 9.0),
        C::Pump => (&RAMP, 1, 9.0),
        C::InputShaft => (&RAMP, 2, 9.0),
        C::ClutchDrag => (&RAMP, 3, 9.0),
        C::BeltBand | C::BeltMap => (&RAMP, 4, 9.0),
        C::BeltFilm => (&RAMP, 5, 9.0),
        C::BeltSlip => (&RAMP, 6, 9.0),
        C::BeltWedge => (&RAMP, 7, 9.0),
        C::BeltPenetration => (&RAMP, 8, 9.0),
        C::FinalDrive => (&RAMP, 9, 9.0),
        C::GearMesh | C::BoxMap => (&WARM, 1, 4.0),
        C::Bearing => (&WARM, 2, 4.0),
        C::Churning => (&WARM, 3, 4.0),
        C::Seal => (&WARM, 4, 4.0),
    };
    let share = index as f64 / last;
    hatched(
        figure,
        &format!("{plot}-{}", component.name()),
        &between(anchors, share),
        share,
        index,
    )
}

fn hatched(figure: &mut Figure, id: &str, base: &str, share: f64, index: usize) -> String {
    let ink = if share < 0.55 { "#ffffff" } else { "#000000" };
    let marks = match index % 5 {
        0 => return base.to_owned(),
        1 => "<path d=\"M-6 6L6 -6M0 24L24 0M18 30L30 18\"/>",
        2 => "<path d=\"M5 6h2M17 18h2\" stroke-linecap=\"round\" stroke-width=\"6\"/>",
        3 => "<path d=\"M-6 18L6 30M0 0L24 24M18 -6L30 6\"/>",
        _ => "<path d=\"M0 6H24M0 18H24\"/>",
    };
    figure.define(&format!(
        "<pattern id=\"{id}\" width=\"24\" height=\"24\" patternUnits=\"userSpaceOnUse\">\
         <rect width=\"24\" height=\"24\" fill=\"{base}\"/>\
         <g stroke=\"{ink}\" stroke-opacity=\"0.7\" stroke-width=\"2\" fill=\"none\">{marks}</g></pattern>\n"
    ));
    format!("url(#{id})")
}
