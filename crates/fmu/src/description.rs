//! modelDescription.xml and the documentation page, generated from the table of variables.

use std::fmt::Write;

use cvtcycle_output::PROGRAM;
use cvtcycle_output::escape::xml;

use crate::variables::{Causality, Get, Kind, UNITS, Variable};

/// Version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fmi {
    /// 2.0.
    Two,
    /// 3.0.
    Three,
}

impl Fmi {
    /// Names on the command line.
    pub const NAMES: [(&'static str, Fmi); 2] = [("2", Fmi::Two), ("3", Fmi::Three)];
}

/// Contents of a description besides the variables.
#[derive(Clone, Copy, Debug)]
pub struct About<'a> {
    /// Kind of unit.
    pub kind: Kind,
    /// Title of the car.
    pub title: &'a str,
    /// Name of the shared library, without its ending.
    pub identifier: &'a str,
    /// Token shared by description and resources, which detects mixed-up files.
    pub token: &'a str,
}

/// Version of the program and of the model.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Appends formatted text. Writing to a string is infallible.
macro_rules! push {
    ($text:expr, $($what:tt)*) => { let _ = write!($text, $($what)*); };
}

/// Categories of log messages.
const LOG_CATEGORIES: [&str; 3] = ["logStatusWarning", "logStatusError", "logStatusFatal"];

/// Writes modelDescription.xml.
#[must_use]
pub fn model_description(fmi: Fmi, about: &About, variables: &[Variable]) -> String {
    let (identifier, token) = (xml(about.identifier), xml(about.token));
    let name = xml(&format!("{} ({})", about.title, about.kind.name()));
    let words = xml(about.kind.words());
    let common = format!(
        "modelName=\"{name}\" description=\"{words}\" version=\"{VERSION}\" generationTool=\"{PROGRAM}\" variableNamingConvention=\"flat\""
    );
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let head = match fmi {
        Fmi::Two => format!(
            "<fmiModelDescription fmiVersion=\"2.0\" guid=\"{token}\" numberOfEventIndicators=\"0\" {common}>\n  \
             <CoSimulation modelIdentifier=\"{identifier}\" canHandleVariableCommunicationStepSize=\"true\" \
             canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"/>\n"
        ),
        Fmi::Three => format!(
            "<fmiModelDescription fmiVersion=\"3.0\" instantiationToken=\"{token}\" {common}>\n  \
             <CoSimulation modelIdentifier=\"{identifier}\" canHandleVariableCommunicationStepSize=\"true\" \
             canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>\n"
        ),
    };
    text += &head;
    units(variables, &mut text);
    text += "  <LogCategories>";
    for category in LOG_CATEGORIES {
        push!(text, "<Category name=\"{category}\"/>");
    }
    text += "</LogCategories>\n";
    text += "  <DefaultExperiment startTime=\"0\" stepSize=\"1\"/>\n  <ModelVariables>\n";
    for (reference, variable) in variables.iter().enumerate() {
        match fmi {
            Fmi::Two => variable_2(reference, variable, &mut text),
            Fmi::Three => variable_3(reference, variable, &mut text),
        }
    }
    text += "  </ModelVariables>\n  <ModelStructure>\n";
    structure(fmi, variables, &mut text);
    text + "  </ModelStructure>\n</fmiModelDescription>\n"
}

fn units(variables: &[Variable], text: &mut String) {
    *text += "  <UnitDefinitions>\n";
    let used = |unit: &str| variables.iter().any(|variable| variable.unit == unit);
    for (unit, exponents) in UNITS.iter().filter(|(unit, _)| used(unit)) {
        push!(text, "    <Unit name=\"{unit}\"><BaseUnit");
        let base = ["kg", "m", "s", "K", "rad"].iter().zip(exponents);
        for (base, exponent) in base.filter(|(_, exponent)| **exponent != 0) {
            push!(text, " {base}=\"{exponent}\"");
        }
        *text += "/></Unit>\n";
    }
    *text += "  </UnitDefinitions>\n";
}

/// Causality, and the variability of integers and reals.
fn role(variable: &Variable) -> (&'static str, &'static str) {
    let of_number = if variable.whole {
        "discrete"
    } else {
        "continuous"
    };
    match variable.causality {
        Causality::Independent => ("independent", "continuous"),
        Causality::Parameter => ("parameter", "fixed"),
        Causality::Input => ("input", of_number),
        Causality::Output => ("output", of_number),
    }
}

fn is_set(variable: &Variable) -> bool {
    matches!(variable.causality, Causality::Input | Causality::Parameter)
}

/// Unit, and start and range of settable variables.
fn values(variable: &Variable, text: &mut String) {
    if is_set(variable) {
        let (start, (low, high)) = (variable.start, variable.range);
        push!(text, " start=\"{start}\" min=\"{low}\" max=\"{high}\"");
    }
    if !variable.whole && variable.unit != "1" {
        push!(text, " unit=\"{}\"", variable.unit);
    }
}

fn initial(variable: &Variable) -> &'static str {
    match variable.causality {
        Causality::Output => " initial=\"calculated\"",
        _ => "",
    }
}

fn variable_2(reference: usize, variable: &Variable, text: &mut String) {
    let (causality, variability) = role(variable);
    let (name, words) = (xml(&variable.name), xml(&variable.description));
    let initial = initial(variable);
    push!(
        text,
        "    <ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\"{initial} description=\"{words}\"><{}",
        if variable.whole { "Integer" } else { "Real" }
    );
    values(variable, text);
    *text += "/></ScalarVariable>\n";
}

fn variable_3(reference: usize, variable: &Variable, text: &mut String) {
    let (causality, variability) = role(variable);
    let (name, words) = (xml(&variable.name), xml(&variable.description));
    let (kind, initial) = (
        if variable.whole { "Int32" } else { "Float64" },
        initial(variable),
    );
    push!(
        text,
        "    <{kind} name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\"{initial} description=\"{words}\""
    );
    values(variable, text);
    *text += "/>\n";
}

fn structure(fmi: Fmi, variables: &[Variable], text: &mut String) {
    let outputs = || {
        let all = variables.iter().enumerate();
        all.filter(|(_, variable)| variable.causality == Causality::Output)
    };
    match fmi {
        Fmi::Two => {
            // The standard counts from 1.
            for part in ["Outputs", "InitialUnknowns"] {
                push!(text, "    <{part}>");
                outputs().for_each(|(place, _)| {
                    push!(text, "<Unknown index=\"{}\"/>", place + 1);
                });
                push!(text, "</{part}>\n");
            }
        }
        Fmi::Three => {
            for part in ["Output", "InitialUnknown"] {
                *text += "    ";
                outputs().for_each(|(place, _)| {
                    push!(text, "<{part} valueReference=\"{place}\"/>");
                });
                *text += "\n";
            }
        }
    }
}

/// Requirements for the master, one sentence each.
fn master_requirements(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Car => &[
            "Before each step set the speed that the car has at its end; the speed is linear within a step.",
            "A communication step of 1 s is the step of `cvtcycle run`; a longer one is divided into steps of at most 1 s.",
            "Outputs are means over the last step, temperatures those at its end; before the first step all but the temperatures are 0.",
            "An output that has no value (a ratio while the engine is off) keeps its last one.",
            "The trace ahead is unknown: start-stop starts the engine with the step in which the car moves, and a manual box has the gear that is set, or shifts by its shift speeds.",
        ],
        Kind::Losses => &[
            "Outputs follow the inputs at once, between steps as well; a step only moves the time.",
            "The launch device is locked and the belt is in steady state above the oil.",
            "Heat leaves the box through Qf_HYD_PNT_W and Qf_GB_PNT_W; the oil temperature comes back as T_oil_AT_PNT_in_K.",
        ],
        Kind::Cvt => &[
            "Before each step set the torque of the engine in it and the speed that the drive shafts have at its end; the speed is linear within a step.",
            "Outputs are means over the last step, temperature and ratio those at its end; before the first step all are 0.",
            "The engine's speed is an output: engine, flywheel and primary shaft are one inertia in the unit. The clutch is controlled by the unit, pressure by the clamp law of the box.",
            "A torque that box and engine of the file cannot have (below what holds idle speed, above full load) is replaced by the nearest; trq_FW_PNT_out_Nm says which.",
            "Heat leaves the box through Qf_HYD_PNT_W and Qf_GB_PNT_W; the oil temperature comes back as T_oil_AT_PNT_in_K.",
        ],
    }
}

/// Writes the documentation page of the FMU.
#[must_use]
pub fn documentation(about: &About, variables: &[Variable]) -> String {
    let title = xml(&format!("{}: {}", about.title, about.kind.words()));
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title></head><body>\n<h1>{title}</h1>\n<p>Written by {PROGRAM}.</p>\n<ul>\n"
    );
    for sentence in master_requirements(about.kind) {
        push!(text, "<li>{}</li>\n", xml(sentence));
    }
    text += "</ul>\n<table>\n<tr><th>variable</th><th></th><th>unit</th><th>start</th><th>meaning</th></tr>\n";
    for variable in variables {
        let start = if is_set(variable) {
            variable.start.to_string()
        } else {
            String::new()
        };
        let component = match variable.get {
            Get::Loss(_) => " (loss power)",
            _ => "",
        };
        push!(
            text,
            "<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{start}</td><td>{}{component}</td></tr>\n",
            xml(&variable.name),
            role(variable).0,
            variable.unit,
            xml(&variable.description)
        );
    }
    text + "</table>\n</body></html>\n"
}
