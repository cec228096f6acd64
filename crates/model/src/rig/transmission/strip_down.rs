//! Taking the box apart and finding its parts from the differences (thesis 5.3.5, 5.4).
//!
//! | label | statement | status |
//! |---|---|---|
//! | RT-3 | part = T_before - T_after - D (p_before - p_after), final drive, belt and clutch | source: thesis 5.4; D displacement of the pump per radian |
//! | RT-4 | clutch plates tested in low only, their loss taken for every ratio; shaft = the box without its pump; pump, with the rings of the primary, = T_belt_removed - clutch - shaft + D (p_complete - p_belt_removed) | source: thesis 5.3.5.3 to 5.3.5.5; the pump's correction derived like RT-3 |
//! | RT-5 | interaction = belt (complete) - belt (final drive removed): with the pressure at full torque, then with the torque at that pressure; the final drive seems larger by it, the belt smaller | derived: the belt's loss depends on pressure and on the torque it carries |
//! | RT-6 | pressure of a test or of the second box = factor x clamp law | source: thesis 5.3.4 and 5.4 in words; the tests' factors ASSUMED |
//!
//! The sum of the parts is the loss of the complete box exactly, whatever the pressures. What is left of a part after its true loss and
//! the interaction is the remainder: torque that goes with the pressure but not as D p, such as the primary's seal rings, the pump's friction C_f,
//! a dual-cavity or variable pump or a measured map. It is 0 without rings for a pump of fixed displacement with C_f = 0.

use super::conditions::Conditions;
use super::steady::Plan;
use crate::rig::{AtRatio, Bench, BenchAnswer, BenchPoint, KeptRatio, Parts};
use crate::transmission::component::Component;

/// Stages of the sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Stage {
    /// Nothing removed.
    Complete,
    /// Final drive removed.
    FinalDriveRemoved,
    /// Belt removed as well.
    BeltRemoved,
    /// Plates of the reverse clutch removed as well.
    ClutchRemoved,
    /// Pump removed as well: the input shaft alone.
    PumpRemoved,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 5] = [
        Stage::Complete,
        Stage::FinalDriveRemoved,
        Stage::BeltRemoved,
        Stage::ClutchRemoved,
        Stage::PumpRemoved,
    ];

    /// Name as in files.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Complete => "complete",
            Stage::FinalDriveRemoved => "final_drive_removed",
            Stage::BeltRemoved => "belt_removed",
            Stage::ClutchRemoved => "clutch_removed",
            Stage::PumpRemoved => "pump_removed",
        }
    }

    fn parts(self) -> Parts {
        let stage = self as usize;
        Parts {
            final_drive: stage < 1,
            belt: stage < 2,
            reverse_clutch: stage < 3,
            pump: stage < 4,
            seal_rings: true,
        }
    }

    fn factor(self, c: &Conditions) -> f64 {
        match self {
            Stage::Complete | Stage::PumpRemoved => 1.0,
            Stage::FinalDriveRemoved => c.pressure.final_drive_removed,
            Stage::BeltRemoved => c.pressure.belt_removed,
            Stage::ClutchRemoved => c.pressure.clutch_removed,
        }
    }
}

/// Piece whose loss the strip-down finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Piece {
    /// Oil pump, with the rings of the primary, which its oil presses.
    Pump,
    /// Input shaft.
    InputShaft,
    /// Drag of the reverse clutch.
    Clutch,
    /// Belt with pulleys: bearings of both shafts and rings of the secondary go with it.
    Belt,
    /// Final drive.
    FinalDrive,
}

impl Piece {
    /// All pieces in the order of the power flow.
    pub const ALL: [Piece; 5] = [
        Piece::Pump,
        Piece::InputShaft,
        Piece::Clutch,
        Piece::Belt,
        Piece::FinalDrive,
    ];

    /// Name as in files.
    pub fn name(self) -> &'static str {
        match self {
            Piece::Pump => "pump",
            Piece::InputShaft => "input_shaft",
            Piece::Clutch => "clutch_drag",
            Piece::Belt => "belt",
            Piece::FinalDrive => "final_drive",
        }
    }

    /// Loss of the piece in a bench's answer, Nm at the input shaft.
    pub fn loss_nm(self, answer: &BenchAnswer) -> f64 {
        match self {
            Piece::Pump => answer.part_nm(Component::Pump) + answer.primary_ring_nm,
            Piece::InputShaft => answer.part_nm(Component::InputShaft),
            Piece::Clutch => answer.part_nm(Component::ClutchDrag),
            Piece::Belt => {
                let ring_nm = answer.part_nm(Component::SealRing) - answer.primary_ring_nm;
                answer.belt_nm() + answer.part_nm(Component::PulleyBearing) + ring_nm
            }
            Piece::FinalDrive => answer.part_nm(Component::FinalDrive),
        }
    }
}

/// Loss of a piece by differences and by the model; Nm at the input shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Difference of the totals as they are.
    pub uncorrected_nm: f64,
    /// With the pressure correction (RT-3, RT-4).
    pub corrected_nm: f64,
    /// The model's own loss of the piece in the complete box.
    pub true_nm: f64,
    /// Part of the difference that is the belt's change with pressure (RT-5).
    pub by_pressure_nm: f64,
    /// Part of the difference that is the belt's change with the torque of the final drive (RT-5).
    pub by_torque_nm: f64,
}

impl Found {
    /// Interaction in all, Nm.
    pub fn interaction_nm(&self) -> f64 {
        self.by_pressure_nm + self.by_torque_nm
    }

    /// Remainder that neither the true loss nor the interaction explains, Nm.
    pub fn remainder_nm(&self) -> f64 {
        self.corrected_nm - self.true_nm - self.interaction_nm()
    }
}

/// The sequence at one ratio, speed and temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripDown {
    /// Ratio, speed and temperature.
    pub set: BenchPoint,
    /// LaneMask of the stages, by [`Stage`]; the clutch is removed in low ratio only, so is what is left after it.
    pub stages: [BenchAnswer; 5],
    /// Losses found, by [`Piece`].
    pub found: [Found; 5],
}

impl StripDown {
    /// Answer of a stage.
    pub fn stage(&self, stage: Stage) -> &BenchAnswer {
        &self.stages[stage as usize]
    }

    /// Losses found of a piece.
    pub fn piece(&self, piece: Piece) -> &Found {
        &self.found[piece as usize]
    }
}

/// The sequence at all points without load. None without a CVT on the bench.
pub fn strip_down(bench: &Bench, c: &Conditions, plan: &Plan) -> Vec<StripDown> {
    let Some(cvt) = bench.cvt() else {
        return Vec::new();
    };
    let displacement_m3_rad = cvt.pump.displacement_m3_rad;
    let low = bench.at_ratio(c.low_ratio);
    let mut own = KeptRatio::new(bench, c.low_ratio);
    plan.points(c)
        .map(|set| sequence([own.at(set.ratio), &low], c, set, displacement_m3_rad))
        .collect()
}

/// The sequence at a point; on the bench at its ratio, and in low.
fn sequence(
    [own, low]: [&AtRatio; 2],
    c: &Conditions,
    set: BenchPoint,
    displacement_m3_rad: f64,
) -> StripDown {
    let at = |stage: Stage, bench: &AtRatio| {
        bench.solve(&BenchPoint {
            parts: stage.parts(),
            pressure_factor: stage.factor(c),
            ..set
        }) // RT-6
    };
    // After the belt is out, nothing but the pressure knows of the ratio: the clutch is tested in low only (RT-4).
    let ratio_of = |stage: Stage| {
        if (stage as usize) < Stage::ClutchRemoved as usize {
            own
        } else {
            low
        }
    };
    let stages = Stage::ALL.map(|stage| at(stage, ratio_of(stage)));
    let [complete, no_drive, no_belt, no_clutch, shaft] = &stages;
    let low_no_belt = at(Stage::BeltRemoved, low);
    // The belt at the pressure of the second test, but with the final drive's torque.
    let between = own.solve(&BenchPoint {
        pressure_pa: Some(no_drive.secondary_pa),
        ..set
    });
    let belt_nm = |answer: &BenchAnswer| Piece::Belt.loss_nm(answer);
    let by_pressure_nm = belt_nm(complete) - belt_nm(&between); // RT-5
    let by_torque_nm = belt_nm(&between) - belt_nm(no_drive); // RT-5
    let difference = |before: &BenchAnswer, after: &BenchAnswer| {
        let raw = before.total_nm() - after.total_nm();
        (
            raw,
            raw - displacement_m3_rad * (before.secondary_pa - after.secondary_pa),
        ) // RT-3
    };
    let (final_drive, belt, clutch) = (
        difference(complete, no_drive),
        difference(no_drive, no_belt),
        difference(&low_no_belt, no_clutch),
    );
    let shaft_nm = shaft.total_nm();
    let pump = no_belt.total_nm() - clutch.1 - shaft_nm;
    let pump = (
        pump,
        pump + displacement_m3_rad * (complete.secondary_pa - no_belt.secondary_pa),
    ); // RT-4
    let found = Piece::ALL.map(|piece| {
        let (found, sign) = match piece {
            Piece::Pump => (pump, 0.0),
            Piece::InputShaft => ((shaft_nm, shaft_nm), 0.0),
            Piece::Clutch => (clutch, 0.0),
            Piece::Belt => (belt, -1.0),
            Piece::FinalDrive => (final_drive, 1.0),
        };
        Found {
            uncorrected_nm: found.0,
            corrected_nm: found.1,
            true_nm: piece.loss_nm(complete),
            by_pressure_nm: sign * by_pressure_nm,
            by_torque_nm: sign * by_torque_nm,
        }
    });
    StripDown { set, stages, found }
}
