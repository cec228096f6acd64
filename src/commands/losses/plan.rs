//! Arguments of `losses` to a checked grid of operating points.

use cvtcycle::config::setup::Setup;
use cvtcycle::config::{Bound, Problem, Problems};
use cvtcycle::model::rig::Bench;
use cvtcycle::model::transmission::Transmission;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::loss_forms::{MapForm, gem_grid};
use cvtcycle::output::loss_table::MapPart;
use cvtcycle::output::losses::{Axis, LossGrid, LossTable, MAX_POINTS};

use super::LossesArgs;
use crate::args::one_of;
use crate::args::problems::{bad_value, problem};
use crate::args::ranges::{values, values_or_words};

/// Name of the option of an axis.
fn axis_option(axis: Axis) -> &'static str {
    match axis {
        Axis::Ratio => "--ratio or --gear",
        Axis::Sump => "--temp",
        Axis::Belt => "--belt-temp",
        Axis::Throttle => "--throttle",
        Axis::Pressure => "--pressure",
        Axis::Torque => "--torque",
        Axis::InputTorque => "--input-torque",
        Axis::Speed => "--speed",
    }
}

/// Checked input of `losses`.
pub struct LossesPlan {
    pub losses: LossTable,
    pub map: Option<MapPart>,
    /// Form of the map.
    pub form: MapForm,
    pub out: Option<OutputDir>,
}

/// Checks all arguments.
pub fn plan(args: &LossesArgs, problems: &mut Problems) -> Option<LossesPlan> {
    let formulation = args.formulation.get(problems);
    let map = args.as_map.as_ref();
    let map = map.and_then(|word| problems.take(one_of("--as-map", word, &MapPart::NAMES)));
    let form = problems.take(one_of("--map-form", &args.map_form, &MapForm::NAMES));
    let setup = args.car.load(formulation, problems);
    let mut grid = LossGrid::default();
    fill_axes(args, &mut grid, problems);
    if let Some(setup) = &setup {
        let ratios = ratios(args, setup, formulation, problems);
        grid.values[Axis::Ratio as usize] = ratios;
        if let Some(part) = map {
            check_map(args, part, setup.transmission().is_cvt(), &grid, problems);
        }
    }
    let form = form.unwrap_or(MapForm::Csv);
    check_form(args, map, form, &grid, problems);
    let bench = setup.as_ref().map(|setup| Bench::as_printed(setup));
    if let Some(bench) = bench.as_ref().filter(|_| form == MapForm::Gem) {
        fill_gem(args, bench, &mut grid);
    }
    if grid.size() > MAX_POINTS as f64 {
        problems.add(too_many(&grid));
    }
    let out = args.out.dir(problems);
    let setup = setup?;
    let losses = LossTable {
        bench: bench?,
        setup,
        grid,
        formulation: args.formulation.formulation.clone(),
        set: args.car.set.clone(),
    };
    Some(LossesPlan {
        losses,
        map,
        form,
        out,
    })
}

/// Ratios of a CVT or gears of a manual box; rejects options of the other kind.
fn ratios(
    args: &LossesArgs,
    setup: &Setup,
    formulation: Formulation,
    problems: &mut Problems,
) -> Vec<f64> {
    match setup.transmission() {
        Transmission::Cvt(cvt) => {
            let (range, _) = Axis::Ratio.range_in(setup.transmission());
            let words = [("low", cvt.ratio.low), ("high", cvt.ratio.high)];
            let text = args.ratio.as_deref().unwrap_or("low");
            let ratios = values_or_words("--ratio", text, range, "", &words);
            let ratios = problems.take(ratios).unwrap_or_default();
            check_cvt(args, formulation, &ratios, problems);
            ratios
        }
        Transmission::Manual(manual) => {
            check_manual(args, formulation, problems);
            let gears = gears(args.gear.as_deref(), manual.overall.len());
            problems.take(gears).unwrap_or_default()
        }
    }
}

/// Fills the axes common to all transmissions.
fn fill_axes(args: &LossesArgs, grid: &mut LossGrid, problems: &mut Problems) {
    let mut fill = |axis: Axis, text: Option<&str>| {
        let (option, (range, suffix)) = (axis_option(axis), axis.range());
        let found = text.and_then(|text| problems.take(values(option, text, range, suffix)));
        grid.values[axis as usize] = found.unwrap_or_default();
    };
    fill(Axis::Speed, args.speed.as_deref().or(Some("2500")));
    let output = args.torque.as_deref().or(Some("0"));
    fill(Axis::Torque, output.filter(|_| args.input_torque.is_none()));
    fill(Axis::InputTorque, args.input_torque.as_deref());
    fill(Axis::Sump, args.temp.as_deref().or(Some("80")));
    let throttle = args.throttle.as_deref().or(Some("0"));
    fill(
        Axis::Throttle,
        throttle.filter(|_| args.input_torque.is_none()),
    );
    // Leaves two axes empty by default: belt in steady state without --belt-temp, clamping law without --pressure.
    fill(Axis::Belt, args.belt_temp.as_deref());
    fill(Axis::Pressure, args.pressure.as_deref());
    if args.input_torque.is_some() && args.throttle.is_some() {
        let message = "with --input-torque the clamping law sees that torque over full load";
        problems.add(problem("--throttle", message, "leave out one of the two"));
    }
    if args.pressure.is_some() && args.throttle.is_some() {
        let message = "with --pressure the clamping law is not used, so the throttle has no effect";
        problems.add(problem("--throttle", message, "leave out one of the two"));
    }
}

/// Rejects options that a CVT lacks, and ratios at which the printed formulations are undefined.
fn check_cvt(args: &LossesArgs, formulation: Formulation, ratios: &[f64], problems: &mut Problems) {
    if args.gear.is_some() {
        let message = format!("{} has a CVT, which has no gears", args.car.vehicle);
        let hint = "use --ratio low, --ratio high or --ratio 1.0";
        problems.add(problem("--gear", &message, hint));
    }
    if formulation != Formulation::Smooth && ratios.iter().any(|ratio| (ratio - 1.0).abs() <= 0.0) {
        let message = "the printed formulations are not defined at ratio 1, where the tension step has no direction";
        let hint = "use 0.999 or 1.001, or --formulation smooth";
        problems.add(bad_value("--ratio", "1", "above or below 1", message, hint));
    }
}

/// Rejects options that a manual gearbox lacks.
fn check_manual(args: &LossesArgs, formulation: Formulation, problems: &mut Problems) {
    let law = "clamping law that depends on the throttle";
    let is_printed = formulation != Formulation::Smooth;
    let given = [
        ("--ratio", args.ratio.is_some(), "belt ratio"),
        ("--belt-temp", args.belt_temp.is_some(), "belt"),
        ("--pressure", args.pressure.is_some(), "clamping pressure"),
        ("--throttle", args.throttle.is_some(), law),
        ("--formulation", is_printed, "belt"),
    ];
    for (option, _, part) in given.into_iter().filter(|(_, is_given, _)| *is_given) {
        let vehicle = &args.car.vehicle;
        let message = format!("{vehicle} has a manual gearbox, which has no {part}");
        let hint = match option {
            "--ratio" => "use --gear 3 or --gear 1..5",
            "--belt-temp" => "leave it out; --temp is the oil temperature",
            _ => "leave it out",
        };
        problems.add(problem(option, &message, hint));
    }
}

/// Parses gears; the default is all of them.
fn gears(text: Option<&str>, count: usize) -> Result<Vec<f64>, Problems> {
    let all = format!("1..{count}");
    // A range of gears has step 1.
    let by_ones = |part: &str| match part.contains("..") && !part.contains(':') {
        true => format!("{part}:1"),
        false => part.to_owned(),
    };
    let text: Vec<String> = text.unwrap_or(&all).split(',').map(by_ones).collect();
    let range = Bound::closed(1.0, count as f64);
    let found = values("--gear", &text.join(","), range, "")?;
    let allowed = format!("whole numbers from 1 to {count}");
    let no_gear = |x: &&f64| x.fract().abs() > 0.0;
    let bad = |x: &f64| {
        let (value, message) = (x.to_string(), format!("`{x}` is no gear"));
        bad_value("--gear", &value, &allowed, &message, "")
    };
    let problems: Problems = found.iter().filter(no_gear).map(bad).collect();
    problems.finish().map(|()| found)
}

/// Rejects options that a form of a map excludes.
fn check_form(
    args: &LossesArgs,
    map: Option<MapPart>,
    form: MapForm,
    grid: &LossGrid,
    problems: &mut Problems,
) {
    if form == MapForm::Csv {
        return;
    }
    if map != Some(MapPart::Box) {
        let message = "this form is one of a map of the whole box";
        problems.add(problem("--map-form", message, "add --as-map box"));
    }
    for axis in form.single() {
        let count = grid.axis_values(*axis).len();
        if count > 1 {
            let message = format!("{count} values, but `{}` has one", args.map_form);
            let hint = "give one value; another map has the next";
            problems.add(problem(axis_option(*axis), &message, hint));
        }
    }
}

/// Fills axes without options by the grid of 40 CFR 1037.565.
fn fill_gem(args: &LossesArgs, bench: &Bench, grid: &mut LossGrid) {
    for (axis, values) in gem_grid(bench) {
        let given = match axis {
            Axis::Speed => &args.speed,
            Axis::Torque => &args.torque,
            _ => &args.temp,
        };
        if given.is_none() {
            grid.values[axis as usize] = values;
        }
    }
}

/// Rejects options that a map of the component excludes.
fn check_map(
    args: &LossesArgs,
    part: MapPart,
    cvt: bool,
    grid: &LossGrid,
    problems: &mut Problems,
) {
    let word = args.as_map.as_deref().unwrap_or_default();
    if part.is_cvt_only() && !cvt {
        let hint = "a manual gearbox has one map: --as-map box";
        let message = format!("{} has no component `{word}`", args.car.vehicle);
        problems.add(problem("--as-map", &message, hint));
        return;
    }
    if args.formulation.formulation != "smooth" {
        let message =
            "a map is for driving, for which the printed formulations are not defined everywhere";
        problems.add(problem("--as-map", message, "leave out --formulation"));
    }
    if args.input_torque.is_some() {
        let message = "the torque of a map is that of the component itself: of the whole box, that at its input";
        problems.add(problem("--input-torque", message, "use --torque"));
    }
    let mut single = |axis: Axis, hint: &str| {
        let count = grid.axis_values(axis).len();
        if count > 1 {
            let message = format!("{count} values, but a map of `{word}` has no such axis");
            problems.add(problem(axis_option(axis), &message, hint));
        }
    };
    let pressures = "give the pressures instead: --pressure 10..40:5";
    single(Axis::Throttle, pressures);
    single(Axis::Belt, "give one value");
    if part == MapPart::Box {
        single(
            Axis::Pressure,
            "a map of the whole box has the pressure of the clamp law",
        );
    }
    if part.torque_column().is_none() {
        let hint = "the loss of this component does not depend on it";
        single(Axis::Torque, hint);
    }
}

fn too_many(grid: &LossGrid) -> Problem {
    let count = |axis: Axis| format!("{} {}", axis_option(axis), grid.axis_values(axis).len());
    let counts: Vec<String> = grid.varied().into_iter().map(count).collect();
    let counts = counts.join(", ");
    let hint = format!("use larger steps or several runs; values given: {counts}");
    let message = format!("the grid has {:.0} points", grid.size());
    let allowed = format!("at most {MAX_POINTS} points");
    bad_value("losses", "", &allowed, &message, &hint)
}
