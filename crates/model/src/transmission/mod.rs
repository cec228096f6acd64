//! From the wheels to the engine's flywheel: transmissions as the loop over a cycle sees them.

pub mod box_map;
pub mod clamp_cause;
pub mod component;
pub mod coupling;
pub mod cvt;
pub mod gear_train;
pub mod loss_factor;
pub mod viscous_self_heating;
pub mod manual;
mod step;

pub(crate) use step::set_flag;
pub use step::{DrivelineState, StepInput, StepOutput};

use self::component::{Component, Part};
use self::coupling::Coupling;
use self::cvt::CvtState;
use self::cvt::variator::Belt;
use self::loss_factor::LossFactors;
use crate::cycle::{GearCommand, Step, Trace};
use crate::maps::LossMap;
use crate::math::{Real, physics};
use crate::prime_mover::PrimeMover;
use crate::road::WheelDemand;
use std::fmt::Debug;

/// A transmission of either kind.
#[derive(Clone, Debug)]
pub enum Transmission {
    /// Pushing-belt CVT.
    Cvt(Box<cvt::Cvt>),
    /// Manual box.
    Manual(Box<manual::Manual>),
}

/// A transmission as the loop over a cycle sees it, of one run or of several side by side.
pub trait Driveline<R: Real = f64> {
    /// State between steps.
    type State: Clone + Debug;

    /// State at the beginning of a cycle.
    fn start<P: PrimeMover<R>>(&self, input: &StepInput<P, R>) -> Self::State;

    /// Solves one step, filling an output at rest: none is copied.
    fn solve_into<P: PrimeMover<R>>(
        &self,
        input: &StepInput<P, R>,
        state: &mut Self::State,
        output: &mut StepOutput<R>,
    );

    /// Engine speed before a step, rad/s.
    fn engine_rad_s(state: &Self::State) -> R;

    /// True for a CVT, which drives the automatic trace.
    fn is_cvt(&self) -> bool;

    /// Engine speeds at the beginning and end of a step in overrun as far as they are known before it, rad/s: with gears those of the wheels in the gear of
    /// the step; with a CVT that of the engine, up to the one in the lowest gear. Wheels with their speeds at both ends over the mean.
    fn overrun_rad_s(
        &self,
        state: Option<&Self::State>,
        wheel: (&WheelDemand<R>, [f64; 2]),
        gear: Option<GearCommand>,
        engine_rad_s: R,
    ) -> [R; 2];

    /// Share of a step at rest that the box is in neutral (SE-1, SE-2); `running_s`: how long the engine has run since its start.
    fn neutral_share(
        &self,
        state: Option<&Self::State>,
        trace: Option<&Trace>,
        step: &Step,
        running_s: f64,
    ) -> R;

    /// Factor on the loss of its coupling (LC-6); none where it loses what its model says.
    fn coupling_factor(&self) -> Option<R>;
}

#[physics]
impl Driveline for Transmission {
    type State = TransmissionState;

    #[inline]
    fn start<P: PrimeMover>(&self, input: &StepInput<P>) -> TransmissionState {
        match self {
            Transmission::Cvt(cvt) => {
                let (state, driveline) = cvt.start(input);
                TransmissionState {
                    cvt: Some(state),
                    driveline,
                }
            }
            Transmission::Manual(manual) => TransmissionState {
                cvt: None,
                driveline: manual.begin(input),
            },
        }
    }

    #[inline]
    fn solve_into<P: PrimeMover>(
        &self,
        input: &StepInput<P>,
        state: &mut TransmissionState,
        output: &mut StepOutput,
    ) {
        let TransmissionState { cvt, driveline } = state;
        match (self, cvt) {
            (Transmission::Cvt(cvt), Some(own)) => cvt.solve(input, own, driveline, output),
            (Transmission::Cvt(_), None) => (),
            (Transmission::Manual(manual), _) => manual.solve(input, driveline, output),
        }
    }

    fn engine_rad_s(state: &TransmissionState) -> f64 {
        state.driveline.engine_rad_s
    }

    fn is_cvt(&self) -> bool {
        matches!(self, Transmission::Cvt(_))
    }

    fn overrun_rad_s(
        &self,
        state: Option<&TransmissionState>,
        wheel: (&WheelDemand, [f64; 2]),
        gear: Option<GearCommand>,
        engine_rad_s: f64,
    ) -> [f64; 2] {
        match self {
            Transmission::Cvt(cvt) => cvt.in_overrun_rad_s(wheel, engine_rad_s),
            Transmission::Manual(manual) => {
                manual.in_overrun_rad_s(state.map(|state| &state.driveline), wheel, gear)
            }
        }
    }

    fn neutral_share(
        &self,
        state: Option<&TransmissionState>,
        trace: Option<&Trace>,
        step: &Step,
        running_s: f64,
    ) -> f64 {
        match self {
            Transmission::Cvt(cvt) => {
                let rested_s = state.map_or(0.0, |state| state.driveline.rested_s);
                cvt.neutral_share_after(rested_s, trace, step, running_s)
            }
            Transmission::Manual(_) => 0.0,
        }
    }

    fn coupling_factor(&self) -> Option<f64> {
        self.coupling().loss_factor()
    }
}

/// State of a transmission between steps.
#[derive(Clone, Copy, Debug)]
pub struct TransmissionState {
    /// CVT: its belt and the start of its solve.
    pub cvt: Option<CvtState>,
    /// Everything else.
    pub driveline: DrivelineState,
}

impl Transmission {
    /// State at the beginning of a cycle.
    pub fn start<P: PrimeMover>(&self, input: &StepInput<P>) -> TransmissionState {
        Driveline::start(self, input)
    }

    /// Solves one step.
    pub fn solve<P: PrimeMover>(
        &self,
        input: &StepInput<P>,
        state: &mut TransmissionState,
    ) -> StepOutput {
        let mut output = StepOutput::at_rest();
        self.solve_into(input, state, &mut output);
        output
    }

    /// True for a CVT, which drives the automatic trace.
    pub fn is_cvt(&self) -> bool {
        matches!(self, Transmission::Cvt(_))
    }

    /// Measured maps in place of models, with the component whose loss each gives.
    pub fn maps(&self) -> impl Iterator<Item = (Component, &LossMap)> {
        Component::ALL.into_iter().filter_map(move |component| {
            let map = match self {
                Transmission::Cvt(cvt) => cvt.changes.as_ref()?.maps[component].as_ref(),
                Transmission::Manual(manual) => {
                    let own = component.part() == Part::BoxMap;
                    manual.map.as_ref().filter(|_| own)
                }
            };
            Some((component, map?))
        })
    }

    /// Loss components of the transmission, in the order of the power flow.
    pub fn components(&self) -> Vec<Component> {
        let mapped = self.maps().map(|(component, _)| component.part());
        let kind = match self {
            Transmission::Cvt(cvt) => BoxKind::of_cvt(&cvt.belt, cvt.ranges.is_some()),
            Transmission::Manual(_) => BoxKind::Manual,
        };
        components(kind, &mapped.collect::<Vec<_>>())
    }

    /// The coupling between engine and box.
    #[inline]
    pub fn coupling(&self) -> &dyn Coupling {
        match self {
            Transmission::Cvt(cvt) => &cvt.coupling,
            Transmission::Manual(manual) => &manual.coupling,
        }
    }

    /// Factors on the losses, of the vehicle file and of [`Transmission::scale_losses`] together.
    pub fn loss_factors(&self) -> LossFactors {
        let mut factors = match self {
            Transmission::Cvt(cvt) => cvt.loss_factors(),
            Transmission::Manual(manual) => manual.loss_factors(),
        };
        factors[Component::LaunchClutch] = self.coupling().loss_factor().unwrap_or(1.0);
        factors
    }

    /// Multiplies each loss by a factor (CV-7, MB-6, LC-6); all else follows from the drive.
    pub fn scale_losses(&mut self, factors: &LossFactors) {
        match self {
            Transmission::Cvt(cvt) => cvt.scale_losses(factors),
            Transmission::Manual(manual) => manual.scale_losses(factors),
        }
    }
}

/// What has the power in a box.
#[derive(Clone, Copy, PartialEq)]
enum BoxKind {
    Manual,
    Cvt { chain: bool, ranges: bool },
}

impl BoxKind {
    /// A CVT by its belt, and whether it has two ranges.
    fn of_cvt(belt: &Belt, ranges: bool) -> Self {
        BoxKind::Cvt {
            chain: belt.chain.is_some(),
            ranges,
        }
    }
}

/// Loss components of a CVT or of a manual box, of which the parts `mapped` are measured maps.
fn components(kind: BoxKind, mapped: &[Part]) -> Vec<Component> {
    let (cvt, chain, ranges) = match kind {
        BoxKind::Manual => (false, false, false),
        BoxKind::Cvt { chain, ranges } => (true, chain, ranges),
    };
    let [belt, whole] = [Part::BeltMap, Part::BoxMap].map(|part| mapped.contains(&part));
    Component::ALL
        .into_iter()
        .filter(|component| match component.part() {
            Part::Coupling => true,
            Part::Cvt => cvt && !whole,
            Part::Belt => cvt && !whole && !belt,
            Part::Bands => cvt && !chain && !whole && !belt,
            Part::Chain => chain && !whole && !belt,
            Part::Ranges => ranges && !whole,
            Part::BeltMap => cvt && !whole && belt,
            Part::Manual => !cvt && !whole,
            Part::BoxMap => whole,
        })
        .collect()
}
