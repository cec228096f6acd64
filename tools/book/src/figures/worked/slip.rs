//! Steps for slip: both branches and their blend.

use super::{Forces, Point, Step};

/// Forces on a segment, N; pairs are primary, secondary.
struct Contact {
    /// Maximum friction of the flanks.
    grip: [f64; 2],
    /// Pull of the bands on the shoulder.
    shoulder: [f64; 2],
    /// Number of segments in the arc.
    count: [f64; 2],
}

/// Slip of one branch, relative to the belt's speed.
struct Branch {
    gap: f64,
    idle: f64,
    load: f64,
    other: f64,
}

impl Contact {
    /// Branch with a sum of gaps over an idle arc, m, loading pulley `p`, and the compression carried by the other (SL-5, SL-6).
    fn branch(&self, gaps: f64, idle_arc: f64, p: usize, compression: f64) -> Branch {
        let (sign, o) = (if p == 0 { 1.0 } else { -1.0 }, 1 - p);
        let gap = gaps / idle_arc;
        let idle = gap * sign * self.shoulder[p] / self.grip[p];
        let load = gap + idle;
        let n = self.count[o];
        let other = load * (compression + sign * n * self.shoulder[o]) / (n * self.grip[o]);
        Branch {
            gap,
            idle,
            load,
            other,
        }
    }
}

fn um(m: f64) -> f64 {
    1e6 * m
}

fn percent(x: f64) -> String {
    format!("{:.4}\\ \\%", 100.0 * x)
}

impl Point<'_> {
    fn contact(&self, f: &Forces) -> Contact {
        let (g, pitch) = (&self.at.geometry, self.belt.segment_thickness_m);
        let shoulder = |radius: f64| f.step_n * pitch / (radius * self.small_rad());
        Contact {
            grip: self.normals().map(|n| self.friction.segment * n),
            shoulder: [shoulder(g.primary_radius_m), shoulder(g.secondary_radius_m)],
            count: self.arcs().map(|arc| arc / pitch),
        }
    }

    /// Arc lengths of both pulleys, m.
    fn arcs(&self) -> [f64; 2] {
        let g = &self.at.geometry;
        [
            g.primary_radius_m * g.primary_wrap_rad,
            g.secondary_radius_m * g.secondary_wrap_rad,
        ]
    }

    pub(super) fn slip(&self, f: &Forces) -> Vec<Step> {
        let (g, belt, mu) = (&self.at.geometry, self.belt, self.friction.segment);
        let (pitch, cx) = (belt.segment_thickness_m, f.compression_n);
        let (c, arcs) = (self.contact(f), self.arcs());
        let ([np, _], [dp, _]) = (self.normals(), c.shoulder);
        let k = cx / (c.grip[0] - dp);
        let stretch = f.mean_n * belt.length_m / (belt.youngs_pa * belt.band_area_m2());
        let area = 1.74142e-6 + 1.56364e-9 * cx - 1.74032e-13 * cx * cx;
        let squeeze = cx / belt.youngs_pa
            * (g.strut_m / belt.strut_area_m2 + (k * pitch + arcs[1]) / (2.0 * area));
        let (slack, idle_arc) = (stretch + belt.initial_gap_m, arcs[0] - k * pitch);
        let conventional = c.branch(slack + squeeze, idle_arc, 0, cx);
        // Without own compression the inverted branch idles on the whole arc of the secondary.
        let inverted = c.branch(slack, arcs[1], 1, 0.0);
        let squeezed = format!(
            "A_\\text{{arc}} = {:.3}\\ \\text{{mm²}} \\text{{ in SL-3}}",
            um(area)
        );
        let gaps = format!(
            "({:.1} + {:.1} + {:.1})\\ \\text{{µm}} / {:.2}\\ \\text{{mm}}",
            um(stretch),
            um(belt.initial_gap_m),
            um(squeeze),
            1e3 * idle_arc
        );
        let band = format!(
            "{:.1} \\cdot {:.4} / ({:.2} \\cdot 10^{{11}} \\cdot {:.2} \\cdot 10^{{-6}})",
            f.mean_n,
            belt.length_m,
            1e-11 * belt.youngs_pa,
            um(belt.band_area_m2())
        );
        let count = format!("{cx:.1} / ({mu} \\cdot {np:.1} - {dp:.2})");
        let mut steps = self.on_a_segment(f, np, dp).to_vec();
        steps.extend([
            self.step("k", "SL-4", count, k)
                .compare("active_segments", self, 1.0)
                .unit("segments"),
            self.step("e_\\text{band}", "SL-1", band, um(stretch))
                .unit("µm"),
            self.step("e_\\text{segs}", "SL-2", squeezed, um(squeeze))
                .unit("µm"),
            self.step("s_\\text{gap}", "SL-5", gaps, conventional.gap)
                .percent(),
        ]);
        steps.extend(self.conventional(&c, &conventional, cx));
        steps.extend(self.blended(f, &conventional, &inverted));
        steps
    }

    /// Steps for the forces on a segment in the primary.
    fn on_a_segment(&self, f: &Forces, normal_n: f64, shoulder_n: f64) -> [Step; 2] {
        let (belt, fp) = (self.belt, self.clamps()[0]);
        let (pitch, radius) = (belt.segment_thickness_m, self.at.geometry.primary_radius_m);
        let normal = format!(
            "2 \\cdot {fp:.0} \\cdot {pitch} / ({:.5} \\cdot {:.4})",
            self.arcs()[0],
            belt.cos_wedge
        );
        let pull = format!(
            "{:.1} \\cdot {pitch} / ({radius:.5} \\cdot {:.3})",
            f.step_n,
            self.small_rad()
        );
        [
            self.step("N_p", "SL-4", normal, normal_n).unit("N"),
            self.step("\\Delta T_p", "SL-4", pull, shoulder_n).unit("N"),
        ]
    }

    /// Steps for the slip of the conventional branch.
    fn conventional(&self, c: &Contact, branch: &Branch, cx: f64) -> [Step; 3] {
        let (n, [dp, ds], [gp, gs]) = (c.count[1], c.shoulder, c.grip);
        let idle = format!("{} \\cdot {dp:.2} / {gp:.2}", percent(branch.gap));
        let load = format!("{} + {}", percent(branch.gap), percent(branch.idle));
        let other = format!(
            "{} \\cdot \\frac{{{cx:.1} + {n:.1} \\cdot {ds:.2}}}{{{n:.1} \\cdot {gs:.2}}}",
            percent(branch.load)
        );
        [
            self.step("s_\\text{idle}", "SL-6", idle, branch.idle)
                .percent(),
            self.step("s_\\text{load}", "SL-6", load, branch.load)
                .percent(),
            self.step("s_\\text{other}", "SL-6", other, branch.other)
                .percent(),
        ]
    }

    /// Steps for the blend with the inverted branch, and the loss.
    fn blended(&self, f: &Forces, conventional: &Branch, inverted: &Branch) -> Vec<Step> {
        let (cx, width) = (f.compression_n, self.belt.blend_n);
        let w = 0.5 * (1.0 + (cx / width).tanh());
        let mix = |one: f64, two: f64| w * one + (1.0 - w) * two;
        let primary = mix(conventional.load, -inverted.other);
        let secondary = mix(conventional.other.abs(), -inverted.load);
        let mixed = |one: f64, two: f64| {
            let sign = if two < 0.0 { '-' } else { '+' };
            format!(
                "{w:.4} \\cdot {} {sign} {:.4} \\cdot {}",
                percent(one),
                1.0 - w,
                percent(two.abs())
            )
        };
        let slip = primary + secondary;
        let speed = |column: &str| self.answer.column(column) / f.speed_m_s;
        let lost = format!("{slip:.6} \\cdot {} / {}", self.output_nm, self.ratio);
        let lost_nm = slip * self.output_nm / self.ratio;
        let weight = format!("(1 + \\tanh({cx:.1}/{width:.0}))/2");
        let of_primary = mixed(conventional.load, -inverted.other);
        let of_secondary = mixed(conventional.other, -inverted.load);
        let sum = format!("{} + {}", percent(primary), percent(secondary));
        vec![
            self.step("w", "SL-8", weight, w).unit(""),
            self.step("s_p", "SL-8", of_primary, primary)
                .compare_value(speed("primary_slip_m_s"))
                .percent(),
            self.step("s_s", "SL-8", of_secondary, secondary)
                .compare_value(speed("secondary_slip_m_s"))
                .percent(),
            self.step("s", "VA-1", sum, slip)
                .compare("slip_percent", self, 0.01)
                .percent(),
            self.step("T_\\text{slip}", "SL-11", lost, lost_nm)
                .compare_value(
                    self.answer.column("slip_loss_primary_nm")
                        + self.answer.column("slip_loss_secondary_nm"),
                )
                .unit("Nm"),
        ]
    }
}
