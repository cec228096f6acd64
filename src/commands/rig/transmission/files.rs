//! Files of the tests of the transmission rig.

use cvtcycle::config::Problem;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::rig::{steady_columns, strip_columns, transient_columns, two_box_columns};
use cvtcycle::output::table::{Column, write_csv};
use cvtcycle::report::charts::rig_transmission::plots::{self, Picture, Subject};
use cvtcycle::report::charts::rig_transmission::strip_down;

use super::{RigPlan, RigResults};
use crate::print::WrittenFiles;

/// Writes all files under their names, or none.
pub fn write(
    mut dir: OutputDir,
    json: &str,
    plan: &RigPlan,
    found: &RigResults,
) -> Result<WrittenFiles, Problem> {
    dir.write("summary.json", |out| out.write_all(json.as_bytes()))?;
    let subject = Subject {
        vehicle: &plan.setup.name,
        conditions: &plan.conditions,
    };
    let mut pictures: Vec<Picture> = Vec::new();
    table(&mut dir, "steady.csv", &steady_columns(), &found.steady)?;
    pictures.extend(plots::steady(&found.steady, &subject));
    table(&mut dir, "loaded.csv", &steady_columns(), &found.loaded)?;
    pictures.extend(plots::loaded(&found.loaded, &subject));
    table(
        &mut dir,
        "strip_down.csv",
        &strip_columns(),
        &found.strip_down,
    )?;
    pictures.extend(strip_down::strip_down(&found.strip_down, &subject));
    let moments: Vec<_> = found
        .loops
        .iter()
        .flat_map(|l| l.moments.iter().map(|m| (l.ratio, *m)))
        .collect();
    table(&mut dir, "transient.csv", &transient_columns(), &moments)?;
    pictures.extend(plots::transients(&found.loops, &subject));
    table(
        &mut dir,
        "second_box.csv",
        &two_box_columns(),
        &found.second_box,
    )?;
    pictures.extend(plots::second_box(&found.second_box, &subject));
    for (name, svg) in pictures {
        dir.write(&name, |out| out.write_all(svg.as_bytes()))?;
    }
    WrittenFiles::commit(dir)
}

/// Writes a table if its test ran.
fn table<T>(
    dir: &mut OutputDir,
    name: &str,
    columns: &[Column<T>],
    rows: &[T],
) -> Result<(), Problem> {
    if rows.is_empty() {
        Ok(())
    } else {
        dir.write(name, |out| write_csv(out, columns, rows, &[]))
    }
}
