//! Force along the path round both pulleys, and the losses of the belt at one point.

use super::point::{Answer, POINT, answers, numbers};
use super::reference::{RPM, Reference};
use crate::sketch::Anchor::{End, Middle, Start};
use crate::sketch::{Sketch, colour};

const CONVENTIONAL: &str = "2.417,2000,30,150";
const INVERTED: &str = "2.417,2000,30,40";

/// Figures by file name.
/// # Errors
/// A sentence, if the belt has no result.
pub fn figures(r: &Reference) -> Result<Vec<(&'static str, String)>, String> {
    let rows = answers(r, &[CONVENTIONAL, INVERTED, POINT])?;
    let pitch = r.cvt().belt.segment_thickness_m;
    Ok(vec![
        ("force_conventional", round(&rows[0], pitch, CONVENTIONAL)?),
        ("force_inverted", round(&rows[1], pitch, INVERTED)?),
        ("loss_chain", chain(&rows[2])?),
    ])
}

/// Left edge and width of the path, pixels.
const WAY: (f64, f64) = (52.0, 338.0);
/// Zero lines of compression and tension, and height of a panel, pixels.
const ZEROS: [f64; 2] = [172.0, 316.0];
const TALL: f64 = 92.0;

/// Path lengths: arc of the primary, strut, arc of the secondary, strut; pixels at their ends, including the start.
struct Way {
    ends: [f64; 5],
    per_m: f64,
}

impl Way {
    fn new(answer: &Answer) -> Self {
        let strut = answer.column("strut_length_m");
        let arc = |pulley: &str| {
            answer.column(&format!("{pulley}_radius_m"))
                * answer.column(&format!("{pulley}_wrap_rad"))
        };
        let parts = [arc("primary"), strut, arc("secondary"), strut];
        let per_m = WAY.1 / parts.iter().sum::<f64>();
        let mut ends = [WAY.0; 5];
        for (k, part) in parts.iter().enumerate() {
            ends[k + 1] = ends[k] + per_m * part;
        }
        Way { ends, per_m }
    }
}

/// Draws the pulleys, and idle and active arc of the loading one. Returns the place where these meet.
fn ground(s: &mut Sketch, way: &Way, active: f64, forward: bool) -> f64 {
    let [x0, x1, x2, x3, _] = way.ends;
    for (from, to, word) in [(x0, x1, "primary"), (x2, x3, "secondary")] {
        for zero in ZEROS {
            let corners = [
                (from, zero),
                (to, zero),
                (to, zero - TALL),
                (from, zero - TALL),
            ];
            s.area(&corners, colour::METAL);
        }
        s.text((0.5 * (from + to), 50.0), Middle, 12.5, colour::QUIET, word);
    }
    let loading = if forward { (x0, x1) } else { (x2, x3) };
    let split = loading.1 - active;
    let bar = [(loading.0, 64.0), (split, 64.0)];
    s.line(&bar, colour::BLUE, 5.0, "6 3");
    s.line(&[(split, 64.0), (loading.1, 64.0)], colour::FORCE, 5.0, "");
    split
}

/// Draws the forces of a point round both pulleys.
fn round(answer: &Answer, pitch_m: f64, row: &str) -> Result<String, String> {
    let [.., torque_nm] = numbers(row)?;
    let way = Way::new(answer);
    let [x0, x1, x2, x3, x4] = way.ends;
    let compression = answer.column("segment_compression_n");
    let active = way.per_m * pitch_m * answer.column("active_segments");
    let forward = compression > 0.0;
    let mut s = Sketch::new(400.0, 372.0);
    let name = if forward { "conventional" } else { "inverted" };
    let head = format!("{torque_nm:.0} Nm: {name} loading");
    s.text((8.0, 18.0), Start, 14.0, colour::INK, &head);
    let split = ground(&mut s, &way, active, forward);
    let most = compression.abs();
    let up = |zero: f64, share: f64| zero - 0.86 * TALL * share;
    let (none, full) = (ZEROS[0], up(ZEROS[0], 1.0));
    let path = if forward {
        [
            (x0, none),
            (split, none),
            (x1, full),
            (x2, full),
            (x3, none),
            (x4, none),
        ]
    } else {
        // The lower strut carries it, from the secondary on to the primary's end.
        [
            (x0, full),
            (x1, none),
            (x2, none),
            (split, none),
            (x3, full),
            (x4, full),
        ]
    };
    s.line(&path, colour::FORCE, 2.6, "");
    let place = if forward {
        0.5 * (x1 + x2)
    } else {
        0.5 * (x3 + x4)
    };
    let value = format!("{most:.0} N");
    s.text((place, full - 6.0), Middle, 12.5, colour::FORCE, &value);
    tension(&mut s, answer, &way);
    axes(&mut s, &way);
    let desc = "Compression between segments and tension of the bands along the belt, over the arc of the primary, a strut, the arc of the secondary and the other strut.";
    Ok(s.finish(&format!("Forces round both pulleys, {name} loading"), desc))
}

/// Tension of the bands: large before the primary and small behind it for a positive step.
fn tension(s: &mut Sketch, answer: &Answer, way: &Way) {
    let [x0, x1, x2, x3, x4] = way.ends;
    let (mean, step) = (
        0.5 * (answer.column("band_tension_1_n") + answer.column("band_tension_2_n")),
        answer.column("band_tension_step_n"),
    );
    let ends = [mean + 0.5 * step, mean - 0.5 * step];
    let most = ends[0].max(ends[1]);
    let [t1, t2] = ends.map(|t| ZEROS[1] - 0.86 * TALL * t / most);
    let path = [(x0, t1), (x1, t2), (x2, t2), (x3, t1), (x4, t1)];
    s.line(&path, colour::BLUE, 2.6, "");
    let words = |t: f64, n: u32| format!("$T_{n}$ = {t:.0} N");
    let (first, second) = (words(ends[0], 1), words(ends[1], 2));
    s.text(
        (0.5 * (x3 + x4), t1 - 6.0),
        Middle,
        12.5,
        colour::BLUE,
        &first,
    );
    s.text(
        (0.5 * (x1 + x2), t2 + 16.0),
        Middle,
        12.5,
        colour::BLUE,
        &second,
    );
}

fn axes(s: &mut Sketch, way: &Way) {
    for (zero, symbol) in ZEROS.into_iter().zip(["$C$", "$T$"]) {
        s.line(
            &[(WAY.0, zero), (way.ends[4] + 4.0, zero)],
            colour::INK,
            1.2,
            "",
        );
        s.line(&[(WAY.0, zero), (WAY.0, zero - TALL)], colour::INK, 1.2, "");
        s.text((44.0, zero + 4.0), End, 12.5, colour::INK, "0");
        s.text((40.0, zero - 0.5 * TALL), End, 15.0, colour::INK, symbol);
    }
    let foot = "along the belt, to scale: arc, strut, arc, strut";
    s.text((WAY.0, 338.0), Start, 12.5, colour::QUIET, foot);
    s.line(&[(WAY.0, 357.0), (74.0, 357.0)], colour::BLUE, 5.0, "6 3");
    s.text((80.0, 361.0), Start, 12.5, colour::INK, "idle arc");
    s.line(&[(146.0, 357.0), (168.0, 357.0)], colour::FORCE, 5.0, "");
    s.text(
        (174.0, 361.0),
        Start,
        12.5,
        colour::INK,
        "active arc: $C$ builds up",
    );
}

/// Losses in the order of the pages: name, label, columns to add.
const LOSSES: [(&str, &str, [&str; 2]); 4] = [
    (
        "bands",
        "BT-6",
        ["band_loss_primary_nm", "band_loss_secondary_nm"],
    ),
    (
        "slip",
        "SL-11",
        ["slip_loss_primary_nm", "slip_loss_secondary_nm"],
    ),
    (
        "wedging",
        "WE-3",
        ["wedge_loss_primary_nm", "wedge_loss_secondary_nm"],
    ),
    (
        "penetration",
        "PE-1",
        [
            "penetration_loss_primary_nm",
            "penetration_loss_secondary_nm",
        ],
    ),
];

/// Draws each loss as a bar that begins where the previous one ends.
fn bars(s: &mut Sketch, answer: &Answer, all_nm: f64) {
    let (left, wide) = (118.0, 190.0);
    let mut x = left;
    for (k, (name, label, columns)) in LOSSES.into_iter().enumerate() {
        let y = 84.0 + 34.0 * k as f64;
        let loss: f64 = columns.iter().map(|column| answer.column(column)).sum();
        let to = x + wide * loss / all_nm;
        s.text((8.0, y), Start, 13.0, colour::INK, name);
        s.text((8.0, y + 13.0), Start, 11.5, colour::QUIET, label);
        s.area(
            &[(x, y - 11.0), (to, y - 11.0), (to, y + 7.0), (x, y + 7.0)],
            colour::FORCE,
        );
        s.line(&[(to, y - 11.0), (to, y + 23.0)], colour::QUIET, 0.8, "");
        s.text(
            (392.0, y),
            End,
            13.0,
            colour::FORCE,
            &format!("+ {loss:.2} Nm"),
        );
        x = to;
    }
    s.line(&[(left, 66.0), (left, 211.0)], colour::QUIET, 0.8, "");
}

/// Draws the path from output to input torque, with a bar for each loss.
fn chain(answer: &Answer) -> Result<String, String> {
    let mut s = Sketch::new(400.0, 306.0);
    let [ratio, rpm, bar, output_nm] = numbers(POINT)?;
    let head = format!("I = {ratio}, {rpm} rpm, {bar} bar, {output_nm} Nm at the secondary");
    s.text((8.0, 18.0), Start, 13.0, colour::QUIET, &head);
    let rad_s = rpm * RPM;
    let slip = 0.01 * answer.column("slip_percent");
    let arrives_nm = output_nm / ratio * (1.0 - slip);
    let all_nm = answer.column("belt_loss_nm");
    let words = format!("leaves the secondary: {:.0} W", arrives_nm * rad_s);
    s.text((8.0, 48.0), Start, 13.0, colour::GREEN, &words);
    let nm = format!("{arrives_nm:.2} Nm");
    s.text((392.0, 48.0), End, 13.0, colour::GREEN, &nm);
    bars(&mut s, answer, all_nm);
    let all = format!("all of the belt: {:.0} W", all_nm * rad_s);
    s.text((8.0, 228.0), Start, 13.0, colour::FORCE, &all);
    s.text(
        (392.0, 228.0),
        End,
        13.0,
        colour::FORCE,
        &format!("= {all_nm:.2} Nm"),
    );
    s.line(&[(8.0, 240.0), (392.0, 240.0)], colour::INK, 1.0, "");
    let input_nm = arrives_nm + all_nm;
    let words = format!("the primary takes: {:.0} W", input_nm * rad_s);
    s.text((8.0, 262.0), Start, 13.0, colour::INK, &words);
    s.text(
        (392.0, 262.0),
        End,
        13.0,
        colour::INK,
        &format!("{input_nm:.2} Nm"),
    );
    let efficiency = format!(
        "efficiency of the belt {:.1} %",
        100.0 * arrives_nm / input_nm
    );
    s.text((8.0, 288.0), Start, 13.0, colour::QUIET, &efficiency);
    Ok(s.finish(
        "Losses of the belt at one point",
        "Torque at the primary shaft from what leaves the secondary over the losses of bands, slip, wedging and penetration to what the primary takes.",
    ))
}
