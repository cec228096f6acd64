//! Words to a checked grid on a bench.

use cvtcycle::config::setup::{self, Options, Setup};
use cvtcycle::config::{Bound, Problem, Problems};
use cvtcycle::model::bench::{Bench, solvable_ratios};
use cvtcycle::model::transmission::Transmission;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::loss_table::MapPart;
use cvtcycle::output::losses::{Axis, LossGrid, LossRow, MAX_POINTS, columns};
use cvtcycle::output::table::Column;

use super::Args;
use crate::args::ranges::{values, values_or_words};
use crate::args::{self as inputs, bad_value};
use crate::print::problem;

const SPEED: Bound = Bound::open_low(0.0, 10_000.0);
const TORQUE: Bound = Bound::closed(-5000.0, 5000.0);
/// Where the fluid models hold.
const TEMP: Bound = Bound::closed(-40.0, 160.0);
const PRESSURE: Bound = Bound::closed(0.0, 100.0);
const THROTTLE: Bound = Bound::closed(0.0, 1.0);

/// Everything that the command needs, checked.
pub struct Plan {
    pub setup: Setup,
    pub bench: Bench,
    pub grid: LossGrid,
    pub columns: Vec<Column<LossRow>>,
    pub formulation: &'static str,
    pub set: Vec<String>,
    pub map: Option<MapPart>,
    pub out: Option<OutputDir>,
}

impl Plan {
    /// Whether the box is a CVT.
    pub fn is_cvt(&self) -> bool {
        self.setup.transmission().is_cvt()
    }
}

/// Reads all arguments.
pub fn plan(args: &Args) -> Result<Plan, Problems> {
    let mut problems = Problems::default();
    let formulation = problems.take(inputs::word(
        "--formulation",
        &args.formulation,
        &Formulation::NAMES,
    ));
    let map = args
        .as_map
        .as_ref()
        .and_then(|word| problems.take(inputs::word("--as-map", word, &MapPart::NAMES)));
    let options = Options {
        lubricant: args.lubricant.clone(),
        set: args.set.clone(),
        formulation: formulation.unwrap_or_default(),
        ..Options::default()
    };
    let setup = problems.take(setup::load(&args.vehicle, "--vehicle", &options));
    let mut grid = LossGrid::default();
    common(args, &mut grid, &mut problems);
    match setup.as_ref().map(|setup| setup.transmission()) {
        Some(Transmission::Cvt(cvt)) => {
            let limits = solvable_ratios(&cvt.belt);
            let words = [("low", cvt.ratio.low), ("high", cvt.ratio.high)];
            let text = args.ratio.as_deref().unwrap_or("low");
            let found = values_or_words(
                "--ratio",
                text,
                Bound::closed(limits.0, limits.1),
                "",
                &words,
            );
            put(&mut grid, Axis::Ratio, problems.take(found));
            if args.gear.is_some() {
                problems.add(problem(
                    "--gear",
                    &format!("{} has a CVT, which has no gears", args.vehicle),
                    "use --ratio low, --ratio high or --ratio 1.0",
                ));
            }
            if formulation.is_some_and(|f| f != Formulation::Smooth) {
                printed_limits(grid.of(Axis::Ratio), &mut problems);
            }
        }
        Some(Transmission::Manual(manual)) => {
            no_belt(args, formulation, &mut problems);
            put(
                &mut grid,
                Axis::Ratio,
                problems.take(gears(args.gear.as_deref(), manual.overall.len())),
            );
        }
        None => {}
    }
    if let (Some(part), Some(setup)) = (map, &setup) {
        map_limits(args, part, setup, &grid, &mut problems);
    }
    if grid.size() > MAX_POINTS as f64 {
        problems.add(too_many(&grid));
    }
    let out = args
        .out
        .as_ref()
        .map(|dir| OutputDir::create(dir, args.force).map_err(Problems::from));
    let out = out.and_then(|dir| problems.take(dir));
    problems.finish()?;
    let Some(setup) = setup else {
        unreachable!("what is missing has left a problem")
    };
    let formulation = Formulation::NAMES
        .iter()
        .find(|(_, f)| Some(*f) == formulation)
        .map_or("", |(name, _)| *name);
    let columns = columns(setup.transmission());
    Ok(Plan {
        bench: Bench::as_printed(&setup),
        setup,
        grid,
        columns,
        formulation,
        set: args.set.clone(),
        map,
        out,
    })
}

fn put(grid: &mut LossGrid, axis: Axis, values: Option<Vec<f64>>) {
    grid.values[axis as usize] = values.unwrap_or_default();
}

/// Options that do not hang on the vehicle.
fn common(args: &Args, grid: &mut LossGrid, problems: &mut Problems) {
    let throttle = args.throttle.as_deref().unwrap_or("0");
    put(
        grid,
        Axis::Speed,
        problems.take(values("--speed", &args.speed, SPEED, "_rpm")),
    );
    put(
        grid,
        Axis::Torque,
        problems.take(values("--torque", &args.torque, TORQUE, "_nm")),
    );
    put(
        grid,
        Axis::Sump,
        problems.take(values("--temp", &args.temp, TEMP, "_degc")),
    );
    put(
        grid,
        Axis::Throttle,
        problems.take(values("--throttle", throttle, THROTTLE, "")),
    );
    if let Some(text) = &args.belt_temp {
        put(
            grid,
            Axis::Belt,
            problems.take(values("--belt-temp", text, TEMP, "_degc")),
        );
    }
    if let Some(text) = &args.pressure {
        put(
            grid,
            Axis::Pressure,
            problems.take(values("--pressure", text, PRESSURE, "_bar")),
        );
        if args.throttle.is_some() {
            problems.add(problem(
                "--throttle",
                "with --pressure the clamp law is not asked, so the throttle has no effect",
                "leave out one of the two",
            ));
        }
    }
}

/// Options that a manual box has no use for.
fn no_belt(args: &Args, formulation: Option<Formulation>, problems: &mut Problems) {
    let given = [
        (
            "--ratio",
            args.ratio.is_some(),
            "a belt ratio",
            "use --gear 3 or --gear 1..5",
        ),
        (
            "--belt-temp",
            args.belt_temp.is_some(),
            "a belt",
            "leave it out; --temp sets the oil",
        ),
        (
            "--pressure",
            args.pressure.is_some(),
            "a clamping pressure",
            "leave it out",
        ),
        (
            "--throttle",
            args.throttle.is_some(),
            "a clamp law that asks for the throttle",
            "leave it out",
        ),
        (
            "--formulation",
            formulation.is_some_and(|f| f != Formulation::Smooth),
            "a belt",
            "leave it out",
        ),
    ];
    for (option, _, what, hint) in given.into_iter().filter(|g| g.1) {
        problems.add(problem(
            option,
            &format!("{} has a manual box, which has not {what}", args.vehicle),
            hint,
        ));
    }
}

/// Gears, all where none is named.
fn gears(text: Option<&str>, count: usize) -> Result<Vec<f64>, Problems> {
    let all = format!("1..{count}");
    // A range of gears goes by ones.
    let by_ones = |part: &str| {
        if part.contains("..") && !part.contains(':') {
            format!("{part}:1")
        } else {
            part.to_owned()
        }
    };
    let text: Vec<String> = text.unwrap_or(&all).split(',').map(by_ones).collect();
    let found = values(
        "--gear",
        &text.join(","),
        Bound::closed(1.0, count as f64),
        "",
    )?;
    let bad = |x: &&f64| x.fract().abs() > 0.0;
    let problems: Problems = found
        .iter()
        .filter(bad)
        .map(|x| {
            bad_value(
                "--gear",
                &x.to_string(),
                &format!("whole numbers from 1 to {count}"),
                format!("`{x}` is no gear"),
                String::new(),
            )
        })
        .collect();
    if problems.is_empty() {
        Ok(found)
    } else {
        Err(problems)
    }
}

/// What the printed forms cannot answer.
fn printed_limits(ratios: &[f64], problems: &mut Problems) {
    if ratios.iter().any(|ratio| (ratio - 1.0).abs() <= 0.0) {
        let message = "the printed forms are not defined at a ratio of exactly 1: the tension step has no direction there".to_owned();
        let hint = "take 0.999 or 1.001, or --formulation smooth".to_owned();
        problems.add(bad_value("--ratio", "1", "above or below 1", message, hint));
    }
}

/// What a map cannot carry.
fn map_limits(args: &Args, part: MapPart, setup: &Setup, grid: &LossGrid, problems: &mut Problems) {
    let word = args.as_map.as_deref().unwrap_or_default();
    let cvt = setup.transmission().is_cvt();
    if part.of_cvt() != cvt {
        let hint = if cvt {
            "choose belt, pump, input_shaft, clutch_drag or final_drive"
        } else {
            "a manual box is mapped as a whole: --as-map box"
        };
        problems.add(problem(
            "--as-map",
            &format!("{} has no component `{word}`", args.vehicle),
            hint,
        ));
        return;
    }
    if args.formulation != "smooth" {
        problems.add(problem(
            "--as-map",
            "a map is for driving, where the printed forms have no answer everywhere",
            "leave out --formulation",
        ));
    }
    let mut single = vec![
        (
            Axis::Throttle,
            "--throttle",
            "give the pressures instead: --pressure 10..40:5",
        ),
        (Axis::Belt, "--belt-temp", "name one"),
    ];
    if part.torque_column().is_none() {
        single.push((
            Axis::Torque,
            "--torque",
            "this component's loss does not depend on it",
        ));
    }
    for (axis, option, hint) in single
        .into_iter()
        .filter(|(axis, ..)| grid.of(*axis).len() > 1)
    {
        let values = grid.of(axis).len();
        problems.add(problem(
            option,
            &format!("{values} values, but a map of `{word}` has no such axis"),
            hint,
        ));
    }
}

fn too_many(grid: &LossGrid) -> Problem {
    let options = [
        "--ratio or --gear",
        "--temp",
        "--belt-temp",
        "--throttle",
        "--pressure",
        "--torque",
        "--speed",
    ];
    let counts: Vec<String> = options
        .iter()
        .zip(&grid.values)
        .filter(|(_, v)| v.len() > 1)
        .map(|(option, v)| format!("{option} {}", v.len()))
        .collect();
    let message = format!("the grid has {:.0} points", grid.size());
    problem(
        "losses",
        &message,
        &format!(
            "take larger steps or do it in parts; values given: {}",
            counts.join(", ")
        ),
    )
    .allowed(format!("at most {MAX_POINTS} points"))
}
