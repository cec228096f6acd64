//! Worked example of the belt's pages at one operating point: each equation with its numbers, evaluated here by the page's
//! equations, next to the program's result.

mod losses;
mod slip;

use super::point::{Answer, HEAD, POINT, answers, numbers};
use super::reference::{RPM, Reference};
use cvtcycle::model::lubricant::Friction;
use cvtcycle::model::transmission::cvt::variator::{Belt, BeltAtRatio};
use std::fmt::Write as _;

/// Line of a worked example.
#[derive(Clone)]
struct Step {
    /// Symbol, in LaTeX.
    symbol: &'static str,
    /// Label of the equation, or source of the number.
    by: &'static str,
    /// The equation with its numbers, in LaTeX.
    worked: String,
    /// Result of the equation on the page.
    value: f64,
    /// Result of the program, if it prints one.
    program: Option<f64>,
    /// Factor to the displayed unit, and the unit.
    shown: (f64, &'static str),
}

/// Result of the page's equations, and of the program.
pub struct Checked {
    /// Page and symbol.
    pub name: String,
    /// Result of the equations of the page.
    pub worked: f64,
    /// Result of the program.
    pub program: f64,
}

/// All results that the program prints too.
/// # Errors
/// A sentence, if the belt has no result.
pub fn checked() -> Result<Vec<Checked>, String> {
    let pages = pages(&Reference::load()?)?;
    let of_page = |(page, steps): (&'static str, Vec<Step>)| {
        let checked = steps.into_iter().filter_map(move |step| {
            let name = format!("{page}: {}", step.symbol);
            step.program.map(|program| Checked {
                name,
                worked: step.value,
                program,
            })
        });
        checked.collect::<Vec<_>>()
    };
    Ok(pages.into_iter().flat_map(of_page).collect())
}

/// Worked pages: name, steps.
fn pages(r: &Reference) -> Result<Vec<(&'static str, Vec<Step>)>, String> {
    let point = Point::new(r)?;
    let forces = point.forces();
    Ok(vec![
        ("geometry", point.geometry()),
        ("tension", point.tension(&forces)),
        ("slip", point.slip(&forces)),
        ("bands", point.bands(&forces)),
        ("deflection", point.deflection()),
        ("belt", point.sum(&forces)),
    ])
}

/// Include files: one table per page, and the table of the exercise.
/// # Errors
/// A sentence, if the belt has no result.
pub fn files(r: &Reference) -> Result<Vec<(String, String)>, String> {
    let mut files = Vec::new();
    for (page, steps) in pages(r)? {
        files.push((format!("generated/worked_{page}.md"), table(&steps)));
    }
    files.push(("generated/exercise.md".to_owned(), exercise(r)?));
    Ok(files)
}

fn table(steps: &[Step]) -> String {
    let mut text = "<!-- Written by `tools/docs` from `cvtcycle belt`. -->\n\n\
        | symbol | result | with the numbers | by |\n|---|---:|---|---|\n"
        .to_owned();
    for step in steps {
        // Writing to a String is infallible.
        let _ = writeln!(
            text,
            "| ${}$ | {} | ${}$ | {} |",
            step.symbol,
            format!("{} {}", digits(step.value * step.shown.0), step.shown.1).trim_end(),
            step.worked,
            linked(step.by)
        );
    }
    text
}

/// Links a label to its page.
fn linked(by: &str) -> String {
    let page = match by.get(..2) {
        Some("GE") => "geometry",
        Some("TE") => "tension",
        Some("SL") => "slip",
        Some("BT") => "bands",
        Some("WE" | "PE") => "deflection",
        Some("VA") => "belt",
        _ => return by.to_owned(),
    };
    format!("[{by}]({page}.md#{by})")
}

/// Formats four significant digits.
fn digits(x: f64) -> String {
    let whole = x.abs().max(1e-9).log10().floor() as i32 + 1;
    let places = usize::try_from(4 - whole).unwrap_or(0);
    format!("{x:.places$}").replace('-', "\u{2212}")
}

/// Operating point with the initial values of its pages.
struct Point<'r> {
    r: &'r Reference,
    belt: &'r Belt,
    friction: Friction,
    at: BeltAtRatio,
    answer: Answer,
    ratio: f64,
    bar: f64,
    output_nm: f64,
    rad_s: f64,
}

/// Forces from the equations of earlier pages, used by later ones.
struct Forces {
    /// Mean tension without compression, N: A of TE-7.
    bare_n: f64,
    speed_m_s: f64,
    sigma: f64,
    compression_n: f64,
    mean_n: f64,
    step_n: f64,
    /// Torque of the bands at the primary, Nm.
    band_nm: f64,
}

impl<'r> Point<'r> {
    fn new(r: &'r Reference) -> Result<Self, String> {
        let belt = &r.cvt().belt;
        let [ratio, rpm, bar, output_nm] = numbers(POINT)?;
        let answer = answers(r, &[POINT])?.pop().ok_or("no answer")?;
        Ok(Point {
            r,
            belt,
            friction: r.oil().friction,
            at: BeltAtRatio::new(belt, ratio),
            answer,
            ratio,
            bar,
            output_nm,
            rad_s: rpm * RPM,
        })
    }

    /// Clamping forces from the wraps, N: primary, secondary.
    fn clamps(&self) -> [f64; 2] {
        let value = |name: &str| self.answer.column(name);
        let secondary = value("secondary_clamp_n");
        let wraps = [value("primary_wrap_rad"), value("secondary_wrap_rad")];
        [secondary * wraps[0] / wraps[1], secondary]
    }

    /// Normal force on a segment, N: primary, secondary (SL-4).
    fn normals(&self) -> [f64; 2] {
        let (g, belt) = (&self.at.geometry, self.belt);
        let [fp, fs] = self.clamps();
        let normal = |clamp: f64, radius: f64, wrap: f64| {
            2.0 * clamp * belt.segment_thickness_m / (radius * wrap * belt.cos_wedge)
        };
        [
            normal(fp, g.primary_radius_m, g.primary_wrap_rad),
            normal(fs, g.secondary_radius_m, g.secondary_wrap_rad),
        ]
    }

    /// Smaller wrap angle, rad.
    fn small_rad(&self) -> f64 {
        let g = &self.at.geometry;
        g.primary_wrap_rad.min(g.secondary_wrap_rad)
    }

    fn forces(&self) -> Forces {
        let (g, belt) = (&self.at.geometry, self.belt);
        let [primary, secondary] = self.clamps();
        let speed_m_s = self.rad_s * g.primary_radius_m;
        let bare_n = primary * belt.tan_wedge / g.primary_wrap_rad
            + secondary * belt.tan_wedge / g.secondary_wrap_rad
            + belt.masses_kg_m()[0] * speed_m_s * speed_m_s;
        let sigma = -(self.ratio.ln() / belt.unity_width).tanh();
        let grip = self.friction.band * self.small_rad();
        let z = self.output_nm / g.secondary_radius_m + sigma * grip * bare_n;
        let compression_n = z / (1.0 - sigma * z.signum() * 0.5 * grip);
        let mean_n = bare_n + 0.5 * compression_n.abs();
        let step_n = -sigma * grip * mean_n;
        let lever = belt.band_offset_m + belt.band_thickness_m * 0.5 * (belt.band_count - 1.0);
        let band_nm = sigma.abs() * grip * mean_n * (1.0 / self.ratio - 1.0).abs() * lever;
        Forces {
            bare_n,
            speed_m_s,
            sigma,
            compression_n,
            mean_n,
            step_n,
            band_nm,
        }
    }

    fn step(&self, symbol: &'static str, by: &'static str, worked: String, value: f64) -> Step {
        Step {
            symbol,
            by,
            worked,
            value,
            program: None,
            shown: (1.0, ""),
        }
    }

    fn geometry(&self) -> Vec<Step> {
        let g = &self.at.geometry;
        let (x, l) = (1e3 * self.belt.centre_distance_m, 1e3 * self.belt.length_m);
        let (rp, rs) = (1e3 * g.primary_radius_m, 1e3 * g.secondary_radius_m);
        let alpha = ((rs - rp) / x).asin();
        let wraps = [1.0, -1.0].map(|s| std::f64::consts::PI - s * 2.0 * alpha);
        let strut = (x * x - (rs - rp).powi(2)).sqrt();
        let sum = rp * wraps[0] + rs * wraps[1] + 2.0 * strut;
        let root = format!("f({rs:.2}\\ \\text{{mm}}) = 0, \\quad X = {x:.1}, \\ L = {l:.1}");
        let mut steps = vec![
            self.step("R_s", "GE-4", root, rs)
                .compare("secondary_radius_m", self, 1e3)
                .mm(),
            self.step(
                "R_p",
                "GE-1",
                format!("{rs:.2} / {}", self.ratio),
                rs / self.ratio,
            )
            .compare("primary_radius_m", self, 1e3)
            .mm(),
        ];
        steps.extend(self.wraps(alpha, wraps, [rp, rs, x]));
        steps.extend([
            self.step(
                "\\ell_\\text{strut}",
                "GE-3",
                format!("\\sqrt{{{x:.1}^2 - {:.2}^2}}", rs - rp),
                strut,
            )
            .compare("strut_length_m", self, 1e3)
            .mm(),
            self.step(
                "L",
                "GE-3",
                format!(
                    "{rp:.2} \\cdot {:.4} + {rs:.2} \\cdot {:.4} + 2 \\cdot {strut:.2}",
                    wraps[0], wraps[1]
                ),
                sum,
            )
            .compare_value(l)
            .mm(),
        ]);
        steps
    }

    /// Inclination of the struts and wraps, from both radii and the centre distance, mm.
    fn wraps(&self, alpha: f64, wraps: [f64; 2], [rp, rs, x]: [f64; 3]) -> [Step; 3] {
        [
            self.step(
                "\\alpha",
                "GE-2",
                format!("\\arcsin\\frac{{{rs:.2} - {rp:.2}}}{{{x:.1}}}"),
                alpha,
            )
            .unit("rad"),
            self.step(
                "\\beta_p",
                "GE-2",
                format!("\\pi - 2 \\cdot {alpha:.4}"),
                wraps[0],
            )
            .compare("primary_wrap_rad", self, 1.0)
            .unit("rad"),
            self.step(
                "\\beta_s",
                "GE-2",
                format!("\\pi + 2 \\cdot {alpha:.4}"),
                wraps[1],
            )
            .compare("secondary_wrap_rad", self, 1.0)
            .unit("rad"),
        ]
    }

    fn tension(&self, f: &Forces) -> Vec<Step> {
        let mut steps = self.clamping(f).to_vec();
        steps.extend(self.compression(f));
        steps
    }

    /// Steps from the pressure to the mean tension without compression.
    fn clamping(&self, f: &Forces) -> [Step; 4] {
        let (g, belt) = (&self.at.geometry, self.belt);
        let ([fp, fs], tan) = (self.clamps(), belt.tan_wedge);
        let mass = belt.masses_kg_m()[0];
        let (bp, bs) = (g.primary_wrap_rad, g.secondary_wrap_rad);
        let wedge = (fp * tan / bp, fs * tan / bs);
        [
            self.step(
                "F_s",
                "VA-3",
                "p_s A_s + F_\\text{spring} + \\ldots".to_owned(),
                fs,
            )
            .compare("secondary_clamp_n", self, 1.0)
            .unit("N"),
            self.step(
                "F_p",
                "TE-1",
                format!("{fs:.0} \\cdot {bp:.3} / {bs:.3}"),
                fp,
            )
            .compare("primary_clamp_n", self, 1.0)
            .unit("N"),
            self.step(
                "v",
                "",
                format!("{:.2} \\cdot {:.5}", self.rad_s, g.primary_radius_m),
                f.speed_m_s,
            )
            .compare("belt_speed_m_s", self, 1.0)
            .unit("m/s"),
            self.step(
                "A",
                "TE-7",
                format!(
                    "{:.1} + {:.1} + {mass:.3} \\cdot {:.3}^2",
                    wedge.0, wedge.1, f.speed_m_s
                ),
                f.bare_n,
            )
            .unit("N"),
        ]
    }

    /// Steps for compression and tension step.
    fn compression(&self, f: &Forces) -> [Step; 4] {
        let g = &self.at.geometry;
        let (mu, small) = (self.friction.band, self.small_rad());
        let z = self.output_nm / g.secondary_radius_m + f.sigma * mu * small * f.bare_n;
        let c = 0.5 * mu * small;
        [
            self.step(
                "Z",
                "TE-7",
                format!(
                    "{} / {:.5} - {mu} \\cdot {small:.3} \\cdot {:.1}",
                    self.output_nm, g.secondary_radius_m, f.bare_n
                ),
                z,
            )
            .unit("N"),
            self.step(
                "C_x",
                "TE-7",
                format!("{z:.1} / (1 + {c:.4})"),
                f.compression_n,
            )
            .compare("segment_compression_n", self, 1.0)
            .unit("N"),
            self.step(
                "T_m",
                "TE-7",
                format!("{:.1} + {:.1} / 2", f.bare_n, f.compression_n),
                f.mean_n,
            )
            .compare_value(
                0.5 * (self.answer.column("band_tension_1_n")
                    + self.answer.column("band_tension_2_n")),
            )
            .unit("N"),
            self.step(
                "\\Delta T",
                "TE-7",
                format!("{mu} \\cdot {small:.3} \\cdot {:.1}", f.mean_n),
                f.step_n,
            )
            .compare("band_tension_step_n", self, 1.0)
            .unit("N"),
        ]
    }
}

impl Step {
    /// Compares with a column of `cvtcycle belt`, times a factor.
    fn compare(self, column: &str, point: &Point, factor: f64) -> Self {
        self.compare_value(factor * point.answer.column(column))
    }

    /// Compares with a number of the program.
    fn compare_value(self, program: f64) -> Self {
        Step {
            program: Some(program),
            ..self
        }
    }

    fn unit(self, unit: &'static str) -> Self {
        Step {
            shown: (1.0, unit),
            ..self
        }
    }

    fn mm(self) -> Self {
        self.unit("mm")
    }

    fn percent(self) -> Self {
        Step {
            shown: (100.0, "%"),
            ..self
        }
    }
}

/// Exercise: a table that a reader can make, and its solution.
fn exercise(r: &Reference) -> Result<String, String> {
    let rows = [
        POINT,
        "2.417,2000,30,40",
        "1.0,2000,20,60",
        "0.5,2000,11,40",
    ];
    let columns = [
        ("segment_compression_n", "$C_x$ N"),
        ("active_segments", "$k$"),
        ("slip_percent", "$s$ %"),
        ("belt_loss_nm", "loss Nm"),
    ];
    let mut text = format!(
        "<!-- Written by `tools/docs` from `cvtcycle belt`. -->\n\n```text\n$ cat points.csv\n{HEAD}\n{}\n$ cvtcycle belt --points points.csv --out belt.csv\n```\n\n",
        rows.join("\n")
    );
    let heads: Vec<&str> = columns.iter().map(|(_, head)| *head).collect();
    let _ = writeln!(
        text,
        "<details>\n<summary>Answers</summary>\n\n| ratio, speed rpm, pressure bar, torque Nm | {} |\n|---|---|---|---|---|",
        heads.join(" | ")
    );
    for (row, answer) in rows.iter().zip(answers(r, &rows)?) {
        let cells: Vec<String> = columns
            .iter()
            .map(|(column, _)| digits(answer.column(column)))
            .collect();
        let _ = writeln!(
            text,
            "| {} | {} |",
            row.replace(',', ", "),
            cells.join(" | ")
        );
    }
    text.push_str("\n</details>\n");
    Ok(text)
}
