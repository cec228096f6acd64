//! Saved states as bytes: the inputs of each step since the start. Reading repeats these steps. So a restored state equals the
//! saved one bit by bit, and bytes of any origin give a reachable state or an error.
//!
//! Little endian: magic, kind, number of variables, steps; then numbers of 8 bytes: values, time, the start of the drive, the steps.

use cvtcycle_config::ProblemKind::Damaged;

use crate::unit::{INPUTS, MAX_TIME_S, StepInputs, is_valid_step};
use crate::variables::{Causality, Kind, car, forward};
use crate::{Refusal, Unit};

const MAGIC: [u8; 8] = *b"cvtcy-2\n";
/// Header: magic, kind and three counts of 8 bytes.
const HEAD: usize = 8 * 5;
const NUMBERS_PER_STEP: usize = 2 + INPUTS;

/// Error for bytes that are not a saved state.
fn damaged_state() -> Refusal {
    Refusal::new(Damaged, "the bytes are no state of this unit")
}

/// Reads a step from its numbers.
fn read_step(numbers: &[f64]) -> Option<StepInputs> {
    let (&[from_s, dt_s], inputs) = numbers.split_first_chunk::<2>()?;
    Some(StepInputs {
        from_s,
        dt_s,
        inputs: inputs.try_into().ok()?,
    })
}

impl Unit {
    /// Serialises the unit's state, with `saved` in place of its current one.
    #[must_use]
    pub fn to_bytes(&self, saved: &crate::unit::Saved) -> Vec<u8> {
        let start = saved.drive.as_ref().map(|drive| drive.start);
        let steps: &[StepInputs] = match &saved.drive {
            Some(drive) => &drive.steps,
            None => &[],
        };
        let counts = [
            self.kind() as u64,
            saved.values.len() as u64,
            u64::from(start.is_some()),
            steps.len() as u64,
        ];
        let mut bytes = MAGIC.to_vec();
        bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
        let step_numbers =
            |step: &StepInputs| [step.from_s, step.dt_s].into_iter().chain(step.inputs);
        let numbers = saved.values.iter().copied().chain([saved.time_s]);
        let numbers = numbers.chain(start.into_iter().flatten());
        let numbers = numbers.chain(steps.iter().flat_map(step_numbers));
        bytes.extend(numbers.flat_map(f64::to_le_bytes));
        bytes
    }

    /// Restores a state from bytes.
    /// # Errors
    /// Bytes that are not a state of this unit; the unit keeps its previous state.
    pub fn restore_bytes(&mut self, bytes: &[u8]) -> Result<(), Refusal> {
        let before = self.save();
        let read = self.read_bytes(bytes);
        if read.is_err() {
            self.restore(&before)?;
        }
        read
    }

    fn read_bytes(&mut self, bytes: &[u8]) -> Result<(), Refusal> {
        let (head, numbers) = bytes.split_at_checked(HEAD).ok_or_else(damaged_state)?;
        let (words, rest) = head.as_chunks::<8>();
        let (numbers, odd) = numbers.as_chunks::<8>();
        let [magic, counts @ ..] = words else {
            return Err(damaged_state());
        };
        let counts: Vec<u64> = counts
            .iter()
            .map(|word| u64::from_le_bytes(*word))
            .collect();
        let &[kind, values, started, steps] = counts.as_slice() else {
            return Err(damaged_state());
        };
        let own = [self.kind() as u64, self.variables().len() as u64];
        let whole = rest.is_empty() && odd.is_empty() && *magic == MAGIC;
        let count = steps
            .checked_mul(NUMBERS_PER_STEP as u64)
            .and_then(|count| count.checked_add(own[1] + 1 + 3 * started.min(1)));
        if !whole || [kind, values] != own || started > 1 || count != Some(numbers.len() as u64) {
            return Err(damaged_state());
        }
        let numbers: Vec<f64> = numbers
            .iter()
            .map(|word| f64::from_le_bytes(*word))
            .collect();
        let (values, rest) = numbers.split_at(self.variables().len());
        let (time, rest) = rest.split_at(1);
        self.reset();
        if let Some(start) = rest.first_chunk::<3>().filter(|_| started == 1) {
            self.replay(*start, &rest[3..])?;
        }
        let times_fit = time[0].abs() <= MAX_TIME_S;
        let is_free = |(variable, value): (&crate::Variable, &f64)| {
            let (low, high) = variable.range;
            match variable.causality {
                Causality::Input | Causality::Parameter => low <= *value && *value <= high,
                Causality::Independent | Causality::Output => value.is_finite(),
            }
        };
        if !times_fit || !self.variables().iter().zip(values).all(is_free) {
            return Err(damaged_state());
        }
        let saved = self.saved();
        saved.values = values.to_vec();
        saved.time_s = time[0];
        Ok(())
    }

    /// Repeats the steps of a state.
    fn replay(&mut self, start: [f64; 3], steps: &[f64]) -> Result<(), Refusal> {
        let variables = self.variables();
        let range = |place: usize, value: f64| {
            let (low, high) = variables[place].range;
            low <= value && value <= high
        };
        let steps: Option<Vec<StepInputs>> =
            steps.chunks(NUMBERS_PER_STEP).map(read_step).collect();
        let steps = steps.ok_or_else(damaged_state)?;
        let own: [usize; 3] = match self.kind() {
            Kind::Cvt => [forward::SPEED, forward::OIL, forward::COOLANT],
            _ => [car::SPEED, car::AMBIENT, car::START],
        };
        let gears = variables
            .get(car::GEAR)
            .filter(|own| own.causality == Causality::Input)
            .map_or((-1.0, -1.0), |own| own.range);
        let is_gear = |gear: f64| gears.0 <= gear && gear <= gears.1 && gear.fract().abs() <= 0.0;
        let is_in_range = |step: &StepInputs| match (self.kind(), step.inputs) {
            (Kind::Cvt, inputs) => inputs
                .iter()
                .zip(forward::TORQUE..)
                .all(|(value, place)| range(place, *value)),
            (_, [speed, grade, ambient, gear, _]) => {
                range(car::SPEED, speed)
                    && range(car::GRADE, grade)
                    && range(car::AMBIENT, ambient)
                    && is_gear(gear)
            }
        };
        let fits = own
            .iter()
            .zip(start)
            .all(|(place, value)| range(*place, value))
            && steps
                .iter()
                .all(|step| is_valid_step(step.from_s, step.dt_s) && is_in_range(step));
        if !fits {
            return Err(damaged_state());
        }
        match self.kind() {
            Kind::Cvt => self.begin_forward(start),
            _ => self.begin(start)?,
        }
        steps.iter().try_for_each(|step| self.advance(step))?;
        Ok(())
    }
}
