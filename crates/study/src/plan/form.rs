//! Forms of a law (`[[form]]`): the factors that name one act in its draws alone.

use super::keys::FORM;
use super::{Design, Form, OfForm, Plan};
use cvtcycle_config::ProblemKind::{self, Conflict, Duplicate, Missing, OutOfRange, UnknownName};
use cvtcycle_config::{Document, Place, Problem, Problems, Reader, did_you_mean};
use cvtcycle_model::keys::Values;

/// Reads a form.
///
/// # Errors
/// All its problems.
pub(super) fn read(document: &Document) -> Result<Form, Problems> {
    let reader = Reader::new(document);
    let s = reader.root();
    let name = Values::text(&s, &FORM.name);
    let form = Form {
        title: Values::text_or(&s, &FORM.title, &name),
        weight: Values::number(&s, &FORM.weight),
        source: Values::text_or(&s, &FORM.source, ""),
        span: [0.0, 1.0],
        place: s.place("name"),
        name,
    };
    reader.finish().map(|_| form)
}

/// Gives forms their parts of the draws and factors those of their forms (DE-10); complains about what does not go together.
pub(super) fn join(plan: &mut Plan) -> Problems {
    let mut problems = Problems::new();
    let (forms, factors) = (&mut plan.forms, &mut plan.factors);
    let total: f64 = forms.iter().map(|form| form.weight).sum();
    if let (Some(last), false) = (forms.last(), total > 0.0) {
        let message = "the weights of the forms are all 0";
        let hint = "give at least one form a weight above 0";
        problems.push(problem(
            OutOfRange,
            &last.place,
            "form.weight",
            message,
            hint,
        ));
    }
    if let (Some(first), Design::Grid) = (forms.first(), &plan.design) {
        let (message, hint) = ("a grid draws no form", "use latin_hypercube");
        problems.push(problem(Conflict, &first.place, "form", message, hint));
    }
    let mut sum = 0.0;
    for k in 0..forms.len() {
        let from = sum / total;
        sum += forms[k].weight;
        forms[k].span = [from, sum / total]; // DE-10
        let (form, earlier) = (&forms[k], &forms[..k]);
        if let Some(other) = earlier.iter().find(|other| other.name == form.name) {
            let line = other.place.line;
            let message = format!("the form `{}` is in line {line} already", form.name);
            problems.push(problem(
                Duplicate,
                &form.place,
                "form.name",
                &message,
                "names are unique",
            ));
            continue;
        }
        let has_values = |of: &Option<OfForm>| of.as_ref().is_some_and(|of| of.name == form.name);
        if !factors.iter().any(|factor| has_values(&factor.form)) {
            let message = format!("the form `{}` has no values", form.name);
            let hint = format!("add `form = \"{}\"` to its [[factor]] tables", form.name);
            problems.push(problem(Missing, &form.place, "form.name", &message, &hint));
        }
    }
    for factor in factors {
        let Some(of) = &mut factor.form else { continue };
        match forms.iter().find(|form| form.name == of.name) {
            Some(form) => of.span = form.span,
            None => {
                let names = forms.iter().map(|form| form.name.as_str());
                let hint = did_you_mean(&of.name, names)
                    .unwrap_or_else(|| "add a [[form]] of that name".to_owned());
                let message = format!("factor {}: there is no form `{}`", factor.key, of.name);
                let place = factor.places.place("form");
                problems.push(problem(UnknownName, place, "form", &message, &hint));
            }
        }
    }
    problems
}

fn problem(kind: ProblemKind, place: &Place, key: &str, message: &str, hint: &str) -> Problem {
    let problem = Problem::new(kind, message).at(place.clone());
    problem.key(key).hint(hint)
}
