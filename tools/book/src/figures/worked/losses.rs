//! Steps for bands, deflection of the pulleys, and the sum.

use super::super::reference::{At, RPM};
use super::{Forces, Point, Step};

impl Point<'_> {
    pub(super) fn bands(&self, f: &Forces) -> Vec<Step> {
        let belt = self.belt;
        let lever = belt.band_offset_m + belt.band_thickness_m * 0.5 * (belt.band_count - 1.0);
        let spread = (1.0 / self.ratio - 1.0).abs();
        let (d, t) = (1e3 * belt.band_offset_m, 1e3 * belt.band_thickness_m);
        let force = self.friction.band * self.small_rad() * f.mean_n;
        vec![
            self.step(
                "\\lvert 1/I - 1 \\rvert",
                "BT-7",
                format!("\\lvert 1/{} - 1 \\rvert", self.ratio),
                spread,
            )
            .unit(""),
            self.step(
                "\\delta v_1",
                "BT-7",
                format!(
                    "{spread:.4} \\cdot {:.4} \\cdot {:.2}",
                    belt.band_offset_m, self.rad_s
                ),
                spread * belt.band_offset_m * self.rad_s,
            )
            .unit("m/s"),
            self.step(
                "\\mu_b T_m \\beta_\\text{min}",
                "BT-6",
                format!(
                    "{} \\cdot {:.1} \\cdot {:.3}",
                    self.friction.band,
                    f.mean_n,
                    self.small_rad()
                ),
                force,
            )
            .unit("N"),
            self.step(
                "d + t_b (n-1)/2",
                "BT-6",
                format!("{d:.1} + {t:.3} \\cdot {} / 2", belt.band_count - 1.0),
                1e3 * lever,
            )
            .mm(),
            self.step(
                "T_\\text{band}",
                "BT-6",
                format!("{force:.1} \\cdot {spread:.4} \\cdot {lever:.6}"),
                f.band_nm,
            )
            .compare_value(
                self.answer.column("band_loss_primary_nm")
                    + self.answer.column("band_loss_secondary_nm"),
            )
            .unit("Nm"),
        ]
    }

    pub(super) fn deflection(&self) -> Vec<Step> {
        let (g, belt, mu) = (&self.at.geometry, self.belt, self.friction.flank);
        let fs = self.clamps()[1];
        let (rs, pitch) = (g.secondary_radius_m, belt.segment_thickness_m);
        let delta = rs * fs * belt.secondary_compliance_per_n;
        let q = delta / (2.0 * belt.tan_wedge);
        let chord = (q * (2.0 * rs + q)).sqrt();
        let slide = (2.0 * (rs + q) * q).sqrt();
        let [np, ns] = self.normals();
        let wedge = mu * 0.5 * np * chord / pitch * slide / self.ratio;
        let pushed = 2.0 * mu * ns * delta * g.primary_radius_m / pitch;
        vec![
            self.step("\\delta_p", "WE-4", "\\text{on its end stop}".to_owned(), 0.0).unit("mm"),
            self.step("\\delta_s", "WE-1", format!("{rs:.5} \\cdot {fs:.0} / (5 \\cdot 10^7)"), 1e3 * delta).mm(),
            self.step("q_s", "WE-2", format!("{:.5} / (2 \\cdot {:.4})", 1e3 * delta, belt.tan_wedge), 1e3 * q).mm(),
            self.step("\\ell_\\text{chord,s}", "WE-2", format!("\\sqrt{{{:.4} (2 \\cdot {:.2} + {:.4})}}", 1e3 * q, 1e3 * rs, 1e3 * q), 1e3 * chord).mm(),
            self.step(
                "T_\\text{wedge,s}",
                "WE-3",
                format!("\\frac{{1}}{{{}}} {mu} \\cdot \\frac{{{np:.1}}}{{2}} \\cdot \\frac{{{:.3}}}{{{:.2}}} \\cdot {:.6}", self.ratio, 1e3 * chord, 1e3 * pitch, slide),
                wedge,
            )
            .compare_value(self.answer.column("wedge_loss_primary_nm") + self.answer.column("wedge_loss_secondary_nm"))
            .unit("Nm"),
            self.step(
                "T_\\text{pen}",
                "PE-1",
                format!("2 \\cdot {mu} \\cdot {ns:.1} \\cdot {:.3} \\cdot 10^{{-6}} \\cdot {:.5} / {pitch}", 1e6 * delta, g.primary_radius_m),
                pushed,
            )
            .compare_value(self.answer.column("penetration_loss_primary_nm") + self.answer.column("penetration_loss_secondary_nm"))
            .unit("Nm"),
        ]
    }

    pub(super) fn sum(&self, f: &Forces) -> Vec<Step> {
        let value = |name: &str| self.answer.column(name);
        let slip = 0.01 * value("slip_percent");
        let slip_nm = slip * self.output_nm / self.ratio;
        let wedge = value("wedge_loss_primary_nm") + value("wedge_loss_secondary_nm");
        let pen = value("penetration_loss_primary_nm") + value("penetration_loss_secondary_nm");
        let all = f.band_nm + slip_nm + wedge + pen;
        let net = self.output_nm / self.ratio;
        let input = net * (1.0 - slip) + all;
        let mut steps = vec![
            self.step(
                "T_\\text{out}/I",
                "",
                format!("{} / {}", self.output_nm, self.ratio),
                net,
            )
            .unit("Nm"),
            self.step(
                "\\sum T",
                "VA-1",
                format!(
                    "{:.4} + 0 + {slip_nm:.4} + {wedge:.4} + {pen:.4}",
                    f.band_nm
                ),
                all,
            )
            .compare("belt_loss_nm", self, 1.0)
            .unit("Nm"),
            self.step(
                "T_\\text{in}",
                "VA-1",
                format!("{net:.3} (1 - {:.6}) + {all:.4}", slip),
                input,
            )
            .unit("Nm"),
            self.step(
                "T_\\text{in}",
                "statics",
                format!("{net:.3} + {:.4} + {wedge:.4} + {pen:.4}", f.band_nm),
                net + f.band_nm + wedge + pen,
            )
            .compare_value(input)
            .unit("Nm"),
        ];
        steps.extend(self.worth(all, input));
        steps
    }

    /// Losses in W and relative to the input, and the torque capacity of the clamping.
    fn worth(&self, all: f64, input: f64) -> [Step; 3] {
        let rs = self.at.geometry.secondary_radius_m;
        let least = self.clamps()[0].min(self.clamps()[1]);
        let mu = self.friction.capacity;
        [
            self.step(
                "P_\\text{loss}",
                "",
                format!("{all:.4} \\cdot {:.2}", self.rad_s),
                all * self.rad_s,
            )
            .unit("W"),
            self.step(
                "\\eta",
                "",
                format!("1 - {all:.4} / {input:.3}"),
                1.0 - all / input,
            )
            .percent(),
            self.step(
                "T_\\text{cap}",
                "VA-4",
                format!(
                    "2 \\cdot {mu} \\cdot {rs:.5} \\cdot {least:.0} / {:.4}",
                    self.belt.cos_wedge
                ),
                2.0 * mu * rs * least / self.belt.cos_wedge,
            )
            .compare_value(self.capacity_nm())
            .unit("Nm"),
        ]
    }

    /// Torque capacity computed by the program, Nm.
    fn capacity_nm(&self) -> f64 {
        let at = At {
            ratio: self.ratio,
            rpm: self.rad_s / RPM,
            output_nm: self.output_nm,
            bar: self.bar,
        };
        self.r.boundary(self.belt, at).losses.capacity_nm
    }
}
