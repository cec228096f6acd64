//! Effects of the factors of a study as tables.

use crate::print::colour::Paint;
use crate::print::sections;
use cvtcycle::output::number::{NONE, fixed, signed};
use cvtcycle::output::table::{TextColumns, TextTable, wrapped};
use cvtcycle::study::answer::{GridMatrix, Information, MinimumOver, OutputAnswer};
use cvtcycle::study::execute::outputs::EXCESS;
use cvtcycle::study::statistics::{
    Confidence, Estimate, FactorIndices, Group, Groups, SobolIndices, Tornado,
};
use cvtcycle::study::{Answer, StudyManifest};

/// Maximum number of factors listed for an output.
const MAX_FACTORS: usize = 10;
/// Maximum number of factors above chance listed.
const MAX_CAUSES: usize = 5;
/// Maximum rows and columns of a printed matrix.
const MATRIX: [usize; 2] = [40, 10];

/// Tables of factors for the first output of the subject, and for the difference to each baseline.
pub(super) fn factors(answer: &Answer, outline: &StudyManifest, paint: Paint) -> String {
    let Some(first) = answer.outputs.first() else {
        return String::new();
    };
    let is_first = |o: &OutputAnswer| o.output == first.output && o.car == first.car;
    let is_shown = |o: &&OutputAnswer| o.output == EXCESS || is_first(o);
    let section = |o: &OutputAnswer| {
        let heading = format!("Effects on {} ({}), {}", o.output, o.unit, o.car);
        (heading, effects(o, outline, answer.confidence))
    };
    sections(answer.outputs.iter().filter(is_shown).map(section), paint)
}

fn effects(output: &OutputAnswer, outline: &StudyManifest, confidence: Confidence) -> String {
    let known = output.information.as_ref();
    let known = known.map_or_else(String::new, |indices| {
        information(indices, confidence, &output.unit)
    });
    match (output.sobol.last(), &output.tornado) {
        (Some(indices), _) => sobol(outline, indices, confidence) + &known,
        (None, Some(found)) => tornado(found),
        // The matrix contains the means of its rows and columns.
        (None, None) if output.matrix.is_some() => grid(output),
        (None, None) => known + &rank(output) + &levels(output),
    }
}

/// Matrix of a grid of two factors, with a mark at the minimum of all cells, of each row or of each column.
fn grid(output: &OutputAnswer) -> String {
    let Some(matrix) = &output.matrix else {
        return String::new();
    };
    let [of_rows, of_columns] = &matrix.factors;
    let (high, wide) = (matrix.rows.len(), matrix.columns.len());
    if wide > MATRIX[1] || high > MATRIX[0] {
        return format!("  {of_rows} by {of_columns}: {high} by {wide} numbers, in matrix.csv\n");
    }
    let mut table = TextTable::new(&("l".to_owned() + &"r".repeat(wide))).indented();
    let columns = matrix.columns.iter().cloned();
    table.row(
        [format!("{of_rows} \\ {of_columns}")]
            .into_iter()
            .chain(columns),
    );
    for (i, (name, row)) in matrix.rows.iter().zip(&matrix.cells).enumerate() {
        let cell = |(k, x): (usize, &Option<f64>)| {
            let mark = if matrix.least.contains(&[i, k]) {
                "*"
            } else {
                ""
            };
            let of_cell = matrix.ends.get(i).and_then(|row| *row.get(k)?);
            let ends = of_cell.map_or_else(String::new, |[low, high]| {
                format!(" [{}, {}]", fixed(low, 3), fixed(high, 3))
            });
            format!("{mark}{}{ends}", fixed(*x, 3))
        };
        let cells = row.iter().enumerate().map(cell);
        table.row([name.clone()].into_iter().chain(cells));
    }
    let scope = match matrix.least_of {
        MinimumOver::All => "",
        MinimumOver::Row => " of its row",
        MinimumOver::Column => " of its column",
    };
    let ranges = match matrix.ends.is_empty() {
        true => "",
        false => "; [what is known of the frictions, two standard deviations]",
    };
    let pairs = pairs(output, matrix);
    format!("{}  * least{scope}{ranges}\n{pairs}", table.text())
}

/// Each choice less each other one, in each condition.
fn pairs(output: &OutputAnswer, matrix: &GridMatrix) -> String {
    let Some([conditions, _]) = matrix.conditions() else {
        return String::new();
    };
    if matrix.pairs.len() > MATRIX[0] || conditions.len() > MATRIX[1] {
        return "  pairs of choices in pairs.csv\n".to_owned();
    }
    let mut table = TextTable::new(&("l".to_owned() + &"r".repeat(conditions.len()))).indented();
    let head = format!("A less B, {}", output.unit);
    table.row([head].into_iter().chain(conditions.iter().cloned()));
    let mut is_any_sure = false;
    for pair in &matrix.pairs {
        let cell = |(x, ends): (&Option<f64>, &Option<[f64; 2]>)| match ends {
            Some(ends @ [low, high]) => {
                let is_sure = ends[0] > 0.0 || ends[1] < 0.0;
                let mark = if is_sure { "!" } else { "" };
                let [x, low, high] = [*x, Some(*low), Some(*high)].map(|x| fixed(x, 3));
                (is_sure, format!("{mark}{x} [{low}, {high}]"))
            }
            None => (false, fixed(*x, 3)),
        };
        let cells: Vec<(bool, String)> =
            pair.differences.iter().zip(&pair.ends).map(cell).collect();
        is_any_sure |= cells.iter().any(|(is_sure, _)| *is_sure);
        let name = pair.choices.join(" less ");
        let cells = cells.into_iter().map(|(_, text)| text);
        table.row([name].into_iter().chain(cells));
    }
    let sure = match (matrix.ends.is_empty(), is_any_sure) {
        (true, _) => "",
        (false, true) => "  ! the frictions leave its sign certain\n",
        (false, false) => "  the frictions leave every sign open\n",
    };
    format!("\n{}{sure}", table.text())
}

/// Every level of each factor, ordered by the width of the bar.
fn tornado(tornado: &Tornado) -> String {
    let mut table = TextTable::new("llrrr").indented();
    table.row(["factor", "level", "value", "effect", "swing"]);
    for bar in &tornado.bars {
        for (k, level) in bar.entries.iter().enumerate() {
            let [name, swing] = match k {
                0 => [bar.name.clone(), fixed(bar.swing, 3)],
                _ => [String::new(), String::new()],
            };
            let (value, effect) = (fixed(level.output, 3), signed(level.effect, 3));
            table.row([name, level.label.clone(), value, effect, swing]);
        }
    }
    let base = fixed(tornado.base, 3);
    format!("  base {base}\n{}", table.text())
}

/// Spread that remains after learning a factor, for the factors above chance, and the number of others.
fn information(found: &Information, confidence: Confidence, unit: &str) -> String {
    let mut table = TextTable::new("lrrl").indented();
    let left = format!("sd left, {unit}");
    table.row(["if this were known", "% of variance", &left, "next test"]);
    let causes: Vec<_> = found.causes().take(MAX_CAUSES).collect();
    for factor in &causes {
        // An estimate of a share may lie beyond what a share can be.
        let percent = |x: f64| fixed(100.0 * x.clamp(0.0, 1.0), 0);
        let share = match factor.share.interval {
            Some([low, high]) => format!(
                "{} ({} to {})",
                percent(factor.share.value),
                percent(low),
                percent(high)
            ),
            None => percent(factor.share.value),
        };
        let left = fixed(factor.sd_left.value, 3);
        table.row([factor.name.clone(), share, left, factor.test.clone()]);
    }
    let rest = found.factors.len() - causes.len();
    let (percent, level) = (fixed(100.0 * found.noise, 1), confidence.percent());
    let noise = format!(
        "by groups of draws the largest of as many idle factors stays below {percent} % of the variance in {level} of 100 cases"
    );
    let [sd, head] = [fixed(found.sd, 3), wrapped(&noise, "  ")];
    let more = match (causes.len(), rest) {
        (_, 0) => String::new(),
        (0, n) => format!("  none of {n} factors is above chance\n"),
        (_, n) => format!("  {n} others: each less, or no more than chance gives\n"),
    };
    let rows = if causes.is_empty() {
        String::new()
    } else {
        table.text()
    };
    format!("  sd now {sd} {unit}\n{rows}{more}{head}")
}

fn rank(output: &OutputAnswer) -> String {
    let Some(rank) = &output.rank else {
        return String::new();
    };
    let factors = rank.factors.iter().zip(&rank.of.factors);
    let mut list: Vec<(&String, &Estimate)> =
        factors.map(|(name, f)| (name, &f.spearman)).collect();
    list.sort_by(|a, b| b.1.value.abs().total_cmp(&a.1.value.abs()));
    let end = |e: &Estimate, k: usize| signed(e.interval.map(|ends| ends[k]), 2);
    TextColumns::new()
        .left("factor", |(name, _): &(&String, &Estimate)| (*name).clone())
        .right("rank correlation", |(_, e)| signed(e.value, 2))
        .right("from", |(_, e)| end(e, 0))
        .right("to", |(_, e)| end(e, 1))
        .table(list.iter().take(MAX_FACTORS))
        .indented()
        .text()
}

fn levels(output: &OutputAnswer) -> String {
    let table = |(name, levels): &(String, Groups)| {
        TextColumns::new()
            .left(name, |g: &Group| g.label.clone())
            .right("n", |g| g.n.to_string())
            .number("mean", 3, |g| g.mean)
            .number("min", 3, |g| g.min)
            .number("max", 3, |g| g.max)
            .table(&levels.groups)
            .indented()
            .text()
    };
    output.levels.iter().map(table).collect()
}

fn sobol(outline: &StudyManifest, indices: &SobolIndices, confidence: Confidence) -> String {
    let head = format!("{} % interval", confidence.percent());
    let factors = outline.plan.factors.iter().zip(&indices.factors);
    let known = factors.filter(|(_, indices)| indices.total.value.is_finite());
    let mut ranked: Vec<(String, &FactorIndices)> = known
        .map(|(factor, indices)| (factor.name.clone(), indices))
        .collect();
    ranked.sort_by(|a, b| b.1.total.value.abs().total_cmp(&a.1.total.value.abs()));
    if ranked.is_empty() {
        return "  the output does not vary\n".to_owned();
    }
    let span = |e: &Estimate| match e.interval {
        Some([a, b]) => format!("{} .. {}", fixed(a, 3), fixed(b, 3)),
        None => NONE.to_owned(),
    };
    let rows = &ranked[..ranked.len().min(MAX_FACTORS)];
    let mut text = TextColumns::new()
        .left("factor", |(name, _): &(String, &FactorIndices)| {
            name.clone()
        })
        .number("first order", 3, |(_, f)| f.first.value)
        .right(&head, |(_, f)| span(&f.first))
        .number("total", 3, |(_, f)| f.total.value)
        .right(&head, |(_, f)| span(&f.total))
        .table(rows)
        .indented()
        .text();
    let rest = ranked.len().saturating_sub(MAX_FACTORS);
    if rest > 0 {
        text += &format!("  {rest} more factors have a smaller total index\n");
    }
    let sum = fixed(indices.sum_first.value, 3);
    text + &format!("  sum of first-order indices {sum}\n")
}
