//! Layout of the flows.

use super::super::TOP;
use super::{BAND, Branch, SHARE, Sankey, Stage};
use crate::charts::engine::WIDTH;

/// Minimum distance between the middles of two ends, pixels.
const PITCH: f64 = 19.0;

/// Minimum distance at the left, where a label has three lines.
const LEFT_PITCH: f64 = 60.0;

const GAP: f64 = 3.0;

/// A flow with its position: upper edge at either end.
pub(super) struct Ribbon<'a> {
    pub branch: &'a Branch,
    pub stage: usize,
    pub wide: f64,
    pub at_trunk: f64,
    pub at_end: f64,
}

impl Ribbon<'_> {
    /// Middle of the outer end.
    pub fn middle(&self) -> f64 {
        self.at_end + 0.5 * self.wide
    }
}

/// The trunk before a stage.
pub(super) struct Trunk {
    pub top: f64,
    pub bottom: f64,
    /// Energy that arrives at the stage, kJ/km.
    pub kj_km: f64,
}

/// All flows with their positions.
pub(super) struct Flows<'a> {
    pub sankey: &'a Sankey<'a>,
    pub trunk: Vec<Trunk>,
    pub leaving: Vec<Ribbon<'a>>,
    pub entering: Vec<Ribbon<'a>>,
    pub bottom: f64,
    /// Right ends of the ribbons, and right edges of the columns of energies and of shares.
    pub end: f64,
    pub energy: f64,
    pub shares: Vec<f64>,
}

/// Room between the names of the stages and the trunk for the labels of inflows above the source, pixels.
fn room_above(sankey: &Sankey, per_kj_km: f64) -> f64 {
    let room = |b: &Branch| (-b.kj_km * per_kj_km + GAP).max(LEFT_PITCH);
    let room: f64 = sankey.branches().filter(|b| b.kj_km < 0.0).map(room).sum();
    let tall = if room > 0.0 { LEFT_PITCH } else { 40.0 };
    room + (0.5 * (tall - sankey.source.kj_km * per_kj_km)).max(0.0)
}

pub(super) fn lay_out<'a>(sankey: &'a Sankey<'a>) -> Flows<'a> {
    let per_kj_km = sankey.scale();
    let wide = sankey.source.kj_km * per_kj_km;
    let first = TOP + BAND + room_above(sankey, per_kj_km);
    let (mut trunk, mut leaving, mut entering) = (Vec::new(), Vec::new(), Vec::new());
    let (mut top, mut bottom, mut kj_km) = (first, first + wide, sankey.source.kj_km);
    let mut left = (first, first + 0.5 * wide);
    for (stage, Stage { branches, .. }) in sankey.stages.iter().enumerate() {
        let came: f64 = branches.iter().map(|b| (-b.kj_km).max(0.0)).sum();
        trunk.push(Trunk {
            top,
            bottom,
            kj_km: kj_km + came,
        });
        for branch in branches {
            let wide = branch.kj_km.abs() * per_kj_km;
            kj_km -= branch.kj_km;
            let mut ribbon = Ribbon {
                branch,
                stage,
                wide,
                at_trunk: bottom - wide,
                at_end: bottom - wide,
            };
            if branch.kj_km < 0.0 {
                top -= wide;
                let end = (left.0 - GAP - wide).min(left.1 - LEFT_PITCH - 0.5 * wide);
                left = (end, end + 0.5 * wide);
                (ribbon.at_trunk, ribbon.at_end) = (top, end);
                entering.push(ribbon);
            } else {
                bottom -= wide;
                leaving.push(ribbon);
            }
        }
    }
    leaving.reverse();
    let lowest = part(&mut leaving).max(TOP + BAND + 90.0);
    let columns = sankey.shares_of.len().min(2);
    let right = |k: usize| WIDTH - 10.0 - SHARE * k as f64;
    Flows {
        sankey,
        trunk,
        leaving,
        entering,
        bottom: lowest.max(first + wide).max(first + 0.5 * wide + 24.0),
        end: right(columns) - 224.0,
        energy: right(columns),
        shares: (0..columns).rev().map(right).collect(),
    }
}

/// Moves the ends of ribbons apart to make room for their labels; returns the lowest edge.
fn part(leaving: &mut [Ribbon]) -> f64 {
    let mut free: Option<(f64, f64)> = None;
    for ribbon in leaving {
        if let Some((edge, middle)) = free {
            let apart = (edge + GAP).max(middle + PITCH - 0.5 * ribbon.wide);
            ribbon.at_end = ribbon.at_end.max(apart);
        }
        free = Some((ribbon.at_end + ribbon.wide, ribbon.middle()));
    }
    free.map_or(0.0, |(edge, middle)| edge.max(middle + 10.0))
}
