//! A validation as tables.

use cvtcycle::output::table::{TextColumns, TextTable, distinct, wrapped};
use cvtcycle::report::validation::chapter_title;
use cvtcycle::validate::{
    Group, Judged, PowerReport, Report, RowPower, Strength, Verdict, computed_text, notes_line,
    unit_text,
};

use crate::print::colour::Paint;
use crate::print::sections;

/// Selection of rows.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Every row.
    All,
    /// Rows that differ, or whose verdict is not the recorded one.
    Differing,
}

/// Counts, and a table of each chapter with its notes.
pub fn tables(report: &Report, shown: Shown, paint: Paint) -> String {
    let candidate = &report.candidate;
    let heading = paint.heading("Published values compared with the model");
    let mut text = format!("{heading}  {}\n", candidate.vehicle);
    text.extend(candidate.set.iter().map(|set| format!("--set {set}\n")));
    let chapters = distinct(report.rows.iter().map(|j| j.row.chapter.as_str()));
    let of_chapter = |name| {
        let rows = report.rows.iter().filter(|j| {
            let is_shown = shown == Shown::All || j.verdict == Verdict::Differs || j.moved;
            j.row.chapter == name && is_shown
        });
        let rows: Vec<&Judged> = rows.collect();
        let table = match rows.is_empty() {
            true => String::new(),
            false => chapter(&rows, paint),
        };
        (chapter_title(name), table)
    };
    let counts = report.groups().into_iter().flat_map(|group| {
        let name = group.word();
        let held_out_title = format!(
            "Held out, {name}: rows that no calibration uses, without constants and identities"
        );
        [
            (format!("Rows by verdict, {name}"), counts(report, group)),
            (held_out_title, held_out(report, group)),
        ]
    });
    let rest = match shown {
        Shown::All => String::new(),
        Shown::Differing => {
            let below = "Below: rows that differ or whose verdict moved (--all: every row)";
            format!("\n{}", wrapped(below, ""))
        }
    };
    let counts = sections(counts, paint);
    let rows = sections(chapters.into_iter().map(of_chapter), paint);
    text + &counts + &rest + &rows
}

/// Colours the verdicts of a table.
fn painted(table: &str, paint: Paint) -> String {
    let at = table.lines().next().and_then(|heads| heads.find(VERDICT));
    let line = |line: &str| {
        let (Some(lead), Some(rest)) = (
            at.and_then(|at| line.get(..at)),
            at.and_then(|at| line.get(at..)),
        ) else {
            return format!("{line}\n");
        };
        let verdict = Verdict::ALL.into_iter().find_map(|verdict| {
            let after = rest.strip_prefix(verdict.word())?;
            Some((verdict, after))
        });
        match verdict {
            None => format!("{line}\n"),
            Some((verdict, after)) => {
                let word = verdict.word();
                let word = match verdict {
                    Verdict::Agrees => paint.good(word),
                    Verdict::Differs => paint.bad(word),
                    _ => paint.faint(word),
                };
                format!("{lead}{word}{after}\n")
            }
        }
    };
    table.lines().map(line).collect()
}

/// Heading of the column of verdicts.
const VERDICT: &str = "verdict";

fn chapter(rows: &[&Judged], paint: Paint) -> String {
    let mark = |judged: &Judged| if judged.moved { " !" } else { "" };
    let columns = TextColumns::new()
        .left("row", |j: &&Judged| j.row.id.clone())
        .left(VERDICT, |j| format!("{}{}", j.verdict.word(), mark(j)))
        .left("printed", |j| j.row.printed_text.clone())
        .left("computed", |j| computed_text(j))
        .left("unit", |j| unit_text(&j.row.unit))
        .left("what", |j| j.row.what.clone());
    let noted = |judged: &&&Judged| {
        judged.verdict == Verdict::Differs
            || judged.moved
            || judged.fleet().is_some()
            || judged.left_out + judged.outside > 0
    };
    let mut notes = TextTable::new("ll").indented();
    for judged in rows.iter().filter(noted) {
        let line = notes_line(judged);
        if !line.is_empty() {
            notes.row([&judged.row.id, &line]);
        }
    }
    let (table, notes) = (painted(&columns.text(rows), paint), notes.text());
    let between = if notes.is_empty() { "" } else { "\n" };
    table + between + &notes
}

fn list(lines: impl IntoIterator<Item = (&'static str, String)>) -> String {
    let mut table = TextTable::new("lr").indented();
    lines
        .into_iter()
        .for_each(|(name, value)| table.row([name, &value]));
    table.text()
}

fn counts(report: &Report, group: Group) -> String {
    let count_of = |verdict: Verdict| {
        let rows = report.of_group(group).filter(|j| j.verdict == verdict);
        (verdict.word(), rows.count().to_string())
    };
    let total = ("total", report.of_group(group).count().to_string());
    list(Verdict::ALL.into_iter().map(count_of).chain([total]))
}

fn held_out(report: &Report, group: Group) -> String {
    let found = report.held_out(group);
    let lines = [
        ("rows", found.rows),
        ("agree", found.agree),
        ("numbers among them", found.numbers),
        ("numbers that agree", found.numbers_agree),
    ];
    let lines = lines.map(|(name, n)| (name, n.to_string())).into_iter();
    let name = "median distance from the printed value, in tolerances";
    let median = found.median_off;
    let median = median.map(|median| (name, format!("{median:.2}")));
    list(lines.chain(median))
}

/// Maximum number of changes listed for a row.
const MAX_FLIPS: usize = 3;

/// Table of the rows with the changes that flip them, counts, and the rows that no change flips.
pub fn power(report: &Report, power: &PowerReport, paint: Paint) -> String {
    let candidate = &report.candidate;
    let heading = paint.heading("Changes of the cars that flip a verdict");
    let (tried, refused) = (power.tried, power.refused.len());
    let mut text = format!("{heading}  {}\n", candidate.vehicle);
    text.extend(candidate.set.iter().map(|set| format!("--set {set}\n")));
    text += &format!("{tried} changes tried, {refused} of them refused\n");
    let rows = TextColumns::new()
        .left("row", |row: &RowPower| row.id.clone())
        .left("verdict", |row| row.verdict.word())
        .left("power", |row| row.strength().word())
        .right("flips", |row| row.flips.len().to_string())
        .right("moves", |row| row.moved.to_string())
        .left("flipped by", |row| row.flips_text(MAX_FLIPS))
        .text(&power.rows);
    let count = |strength: Strength| {
        (
            strength.word(),
            power.rows_with(strength).count().to_string(),
        )
    };
    let counts = list(Strength::ALL.into_iter().map(count));
    let never = |verdict: Verdict| {
        let rows = power.rows_with(Strength::Never);
        let ids = rows.filter(|row| row.verdict == verdict);
        let ids: Vec<&str> = ids.map(|row| row.id.as_str()).collect();
        (!ids.is_empty()).then(|| [verdict.word().to_owned(), ids.join(" ")])
    };
    let mut nothing = TextTable::new("ll").indented();
    for line in Verdict::ALL.into_iter().filter_map(never) {
        nothing.row(line);
    }
    let parts = [
        ("Rows", rows),
        ("Rows by power", counts),
        ("Rows that nothing flips, by verdict", nothing.text()),
    ];
    text + &sections(parts, paint)
}

/// One line for each row with another verdict than the recorded one.
pub fn changed_verdicts(report: &Report) -> Vec<String> {
    let line = |judged: &Judged| {
        let row = &judged.row;
        let (id, unit, printed, place) =
            (&row.id, unit_text(&row.unit), &row.printed_text, &row.place);
        let (recorded, now) = (
            row.recorded.map_or("", Verdict::word),
            judged.verdict.word(),
        );
        let (file, line) = (&place.input, place.line);
        if let Some(why) = &judged.failure {
            return format!("row {id}: `{now}`: {why} ({file} line {line})");
        }
        let computed = computed_text(judged);
        format!(
            "row {id}: `{recorded}` recorded, now `{now}`: computed {computed} {unit}, printed {printed} ({file} line {line})"
        )
    };
    report.moved().map(line).collect()
}
