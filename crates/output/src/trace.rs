//! The trace of a run: its columns and its CSV file.
//!
//! Rows are in SI units; this table converts them to the units of the columns. See [`columns!`](crate::columns) for a new column.

use std::io::{self, Write};
use std::sync::LazyLock;

use crate::table::{Cell, Column, Scope, write_csv};
use crate::{Component, Row, columns};
use cvtcycle_model::keys::{ZERO_DEGC_K, rpm};

/// A column of the trace.
pub type TraceColumn = Column<Row>;

fn kmh(speed_m_s: f64) -> f64 {
    speed_m_s * 3.6
}

pub(crate) fn bar(pressure_pa: f64) -> f64 {
    pressure_pa / 1e5
}

pub(crate) fn degc(temperature_k: f64) -> f64 {
    temperature_k - ZERO_DEGC_K
}

/// All columns of a trace, in output order.
pub static COLUMNS: LazyLock<Vec<TraceColumn>> = LazyLock::new(|| {
    let mut list = columns! { Row;
        number "time_s", "s", "end of the step, from the start of the cycle; every other column is the mean over the step that ends here, temperatures are those at its end", r => r.time_s;
        number "dt_s", "s", "length of the step", r => r.dt_s;
        words "phase", "", "phase of the cycle", r => Cell::Phase(r.phase);
        number "speed_kmh", "km/h", "vehicle speed, mean over the step that ends at time_s", r => kmh(r.speed_m_s);
        number "accel_m_s2", "m/s2", "vehicle acceleration", r => r.accel_m_s2;
        number "wheel_torque_nm", "Nm", "demanded torque at the driven wheels", r => r.wheel_torque_nm;
        number "wheel_power_w", "W", "demanded power at the driven wheels", r => r.wheel_power_w;
        number "engine_speed_rpm", "rpm", "engine speed", r => rpm(r.engine_speed_rad_s);
        number "engine_torque_nm", "Nm", "torque at the flywheel into the transmission, without inertia", r => r.engine_torque_nm;
        number "throttle", "-", "engine torque with accessories over full-load torque at that speed", r => r.throttle;
        count "gear", "", "gear; 0 is neutral", r => u64::from(r.gear), Scope::Manual;
        number "belt_ratio", "-", "belt ratio, secondary over primary running radius", r => r.belt_ratio, Scope::Cvt;
        number "range_ratio", "-", "speed of the secondary over that into the final drive; 1 in the high range", r => r.range_ratio, Scope::Has(Component::RangeGear);
        number "overall_ratio", "-", "engine speed over wheel speed; empty at standstill", r => r.overall_ratio;
        number "primary_pressure_bar", "bar", "primary pulley pressure", r => bar(r.primary_pressure_pa), Scope::Cvt;
        number "secondary_pressure_bar", "bar", "secondary pulley pressure", r => bar(r.secondary_pressure_pa), Scope::Cvt;
        words "clamp_cause", "", "what decided the secondary pressure: law, control, clutch, belt, shift_down, shift_up or cap", r => Cell::Text(r.clamp_cause.name().into()), Scope::Cvt;
        number "slip_percent", "%", "belt slip", r => 100.0 * r.slip, Scope::Cvt;
        number "clamp_safety", "-", "torque capacity of the belt over its torque; empty at zero torque", r => r.clamp_safety, Scope::Cvt;
    };
    list.extend(Component::ALL.map(loss));
    list.extend(columns! { Row;
        number "accessories_w", "W", "power of the accessories", r => r.accessories_w;
        number "brake_w", "W", "power into the wheel brakes", r => r.brake_w;
        number "kinetic_w", "W", "change of the rotating kinetic energy of engine and transmission", r => r.kinetic_w;
        number "deficit_w", "W", "power that could not be delivered", r => r.deficit_w;
        number "fuel_g_s", "g/s", "fuel mass flow", r => 1000.0 * r.fuel_kg_s;
        number "fuel_power_w", "W", "fuel power, lower heating value", r => r.fuel_power_w;
        number "engine_heat_w", "W", "heat into the engine", r => r.engine_heat_w;
        number "exhaust_w", "W", "heat and unburnt fuel into the exhaust", r => r.exhaust_w;
        number "coolant_degc", "degC", "coolant and engine block at the end of the step", r => degc(r.coolant_k);
        number "engine_oil_degc", "degC", "engine oil at the end of the step", r => degc(r.engine_oil_k);
        number "transmission_sump_degc", "degC", "transmission oil in the sump at the end of the step", r => degc(r.sump_k);
        number "transmission_metal_degc", "degC", "transmission case and shafts at the end of the step", r => degc(r.metal_k);
        number "belt_spray_degc", "degC", "belt, pulleys and the oil sprayed off them at the end of the step", r => degc(r.belt_spray_k), Scope::Cvt;
        number "cooler_in_degc", "degC", "oil to the cooler; empty without one", r => degc(r.cooler_in_k);
        number "cooler_out_degc", "degC", "oil from the cooler; empty without one", r => degc(r.cooler_out_k);
        number "tyre_degc", "degC", "tyres at the end of the step", r => degc(r.tyre_k);
        number "stored_w", "W", "heat stored in the thermal nodes", r => r.stored_w;
        number "to_air_w", "W", "heat given to the air", r => r.to_air_w;
        number "power_ledger_error", "-", "power ledger: |in - out| over the sum of absolute terms", r => r.power_ledger_error;
        number "heat_ledger_error", "-", "heat ledger: |in - stored - to air| over the sum of absolute terms", r => r.heat_ledger_error;
        number "solve_residual", "-", "what the implicit solve left, as a fraction of full-load torque", r => r.solve_residual;
        count "iterations", "", "driveline evaluations of the implicit solve", r => u64::from(r.iterations);
        words "flags", "", "states and departures from validity", r => Cell::Flags(r.flags);
    });
    list
});

fn loss(component: Component) -> TraceColumn {
    let name = component.columns().loss_w;
    Column::number(name, "W", component.doc(), move |row: &Row| {
        row.loss_w[component]
    })
    .only(Scope::Has(component))
}

/// Columns of a run, in the order of the table.
pub fn columns_for(cvt: bool, components: &[Component]) -> Vec<&'static TraceColumn> {
    let has = |column: &&TraceColumn| column.scope.includes(cvt, components);
    COLUMNS.iter().filter(has).collect()
}

/// Looks up a column by name.
pub fn column(name: &str) -> Option<&'static TraceColumn> {
    COLUMNS.iter().find(|column| column.name == name)
}

/// The column of a component's loss power.
pub fn loss_column(component: Component) -> Option<&'static TraceColumn> {
    column(component.columns().loss_w)
}

/// Writes a header and one line per row. `phases` are the names that belong to [`Row::phase`].
///
/// Numbers read back to the same `f64`. A number that is not finite, and a phase without a name, become an empty field.
///
/// ```
/// use cvtcycle_output::Row;
/// use cvtcycle_output::trace::{column, write_trace};
/// let columns = ["time_s", "speed_kmh"].map(|name| column(name).expect("a column of every trace"));
/// let row = Row { time_s: 1.0, speed_m_s: 10.0, ..Row::default() };
/// let mut csv = Vec::new();
/// write_trace(&mut csv, &columns, &[row], &[])?;
/// assert_eq!(csv, b"time_s,speed_kmh\n1,36\n");
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// I/O errors of `out`.
pub fn write_trace<W: Write>(
    out: W,
    columns: &[&TraceColumn],
    rows: &[Row],
    phases: &[String],
) -> io::Result<()> {
    write_csv(out, columns, rows, phases)
}
