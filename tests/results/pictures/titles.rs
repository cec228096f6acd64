//! Titles are sentences with numbers of their table.

use cvtcycle::output::{Component, History, Row};
use cvtcycle::report::charts::figures::{
    CarEnergy, CarLosses, DifferenceTerm, EnergyDifference, OverlayPanel, PhaseLosses,
    TraceDifference, difference_bars, energy_flow, loss_by_component, loss_by_phase,
    trace_difference, transmission_flow,
};
use cvtcycle::report::charts::{
    Picture, PlotRun, fuel_bars, losses, operating_points, pressure, temperatures,
};

use super::svg_checks::{check, numbers};
use crate::fixtures::{FUEL_KJ, history, phases, rows, run};
use crate::titles::{number, written};

/// Title, without the subject on request.
fn title(picture: &Picture) -> String {
    crate::titles::title(&picture.svg)
}

/// Numbers of a text.
fn numbers_in(text: &str) -> Vec<f64> {
    written(text).iter().map(|text| number(text)).collect()
}

/// Sum of a column over rows.
fn sum<'a>(rows: impl Iterator<Item = &'a Vec<String>>, column: usize) -> f64 {
    rows.map(|row| numbers(&row[column])).sum()
}

/// Truth: the sums of the rows of the drive, as fuel of that energy.
#[test]
fn the_losses_over_time_are_those_of_the_drive() {
    let drives = [rows(1180, 1.0, true), rows(1180, 1.0, false)];
    let [a, b] = [0, 1].map(|k| history(k == 0, &drives[k], &phases()));
    let lost = |history: &History, k: usize| {
        let parts = history.components();
        let of = |row: &Row| parts.iter().map(|part| row.loss_w[*part]).sum::<f64>() * row.dt_s;
        drives[k].iter().map(of).sum::<f64>() / 1e3
    };
    let litres = |run: &PlotRun, kj: f64| kj * run.group_fuel[2].1 / FUEL_KJ;
    let runs = [run("A", &a), run("B", &b)];
    let picture = losses(&runs);
    check(&picture);
    let wanted = [0, 1].map(|k| litres(&runs[k], lost(runs[k].history, k)));
    let last = picture.table.rows.last().unwrap();
    let cell = |name: &str| {
        let names = picture.table.columns.iter();
        numbers(
            &last[names
                .map(|(own, _)| own)
                .position(|own| own == name)
                .unwrap()],
        )
    };
    let said = numbers_in(title(&picture).split(':').next().unwrap());
    // "A loses 0.61 L/100 km, B 0.32": the unit has a number as well.
    assert_eq!((said.len(), said[1]), (3, 100.0), "{}", title(&picture));
    for (k, name) in [(0, "A: all"), (1, "B: all")] {
        assert!(
            (cell(name) - wanted[k]).abs() < 2e-3 * wanted[k] + 1e-3,
            "{} {wanted:?}",
            cell(name)
        );
        assert!(
            (said[2 * k] - wanted[k]).abs() < 0.006 * wanted[k] + 0.006,
            "{said:?} {wanted:?}"
        );
    }
    // Each line rises and has its name with its last number.
    let rises = |column: usize| {
        let of = picture.table.rows.iter().map(|row| numbers(&row[column]));
        of.filter(|x| x.is_finite()).collect::<Vec<_>>().is_sorted()
    };
    assert!((2..picture.table.columns.len()).all(rises));
    assert!(picture.svg.contains(">All "));
    let own = losses(&runs[..1]);
    let most = title(&own).contains("most of it in");
    let largest = title(&own).contains("the largest part in");
    let said = numbers_in(title(&own).split(':').next().unwrap());
    let (whole, part) = (said[0], said[2]);
    assert!(
        most != largest && most == (part > 0.5 * whole),
        "{}",
        title(&own)
    );
}

#[test]
fn temperatures_pressures_and_fuel_of_a_title_are_those_of_the_table() {
    let history = history(true, &rows(1180, 1.0, true), &phases());
    let car = run("car", &history);
    let column = |picture: &Picture, name: &str| {
        picture
            .table
            .columns
            .iter()
            .position(|(own, _)| own == name)
            .unwrap()
    };
    let picture = temperatures(&[run("car", &history)]);
    let last = picture.table.rows.last().unwrap();
    let ends =
        ["Transmission sump", "Engine oil"].map(|name| numbers(&last[column(&picture, name)]));
    let said = numbers_in(&title(&picture));
    assert!(
        (said[0] - ends[0]).abs() < 0.56 && (said[1] - ends[1]).abs() < 0.56,
        "{said:?} {ends:?}"
    );

    let picture = pressure(&car);
    // The table lists every second step; the title uses all.
    let finite = |column: &str| {
        let all = history.column(column).iter().copied();
        all.filter(|x| x.is_finite()).collect::<Vec<_>>()
    };
    let least = finite("clamp_safety")
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    let most = finite("secondary_pressure_bar")
        .into_iter()
        .fold(0.0, f64::max);
    let used = 100.0 / least;
    let listed = column(&picture, "Clamping used");
    let listed = picture.table.rows.iter().map(|row| numbers(&row[listed]));
    let listed = listed.filter(|x| x.is_finite()).fold(0.0, f64::max);
    assert!(listed > 0.0 && listed <= used + 0.06, "{listed} {used}");
    let said = numbers_in(&title(&picture));
    assert!(
        (said[0] - used).abs() < 0.56 && (said[1] - most).abs() < 0.06,
        "{said:?} {used} {most}"
    );

    let other = run("other", &history);
    let mut dear = run("car", &history);
    dear.group_fuel[2].1 = 8.0;
    let picture = fuel_bars(&[dear, other]);
    let fuel = |car: &str| {
        let own = |row: &&Vec<String>| row[0] == "total" && row[1] == car;
        numbers(&picture.table.rows.iter().find(own).unwrap()[2])
    };
    let said = title(&picture);
    let more = 100.0 * (fuel("car") / fuel("other") - 1.0);
    let [own, against] = [0, 1].map(|k| numbers_in(said.split(": ").nth(k).unwrap())[0]);
    assert!(said.contains("more than other"), "{said}");
    assert!(
        (own - 8.0).abs() < 0.005 && (against - more).abs() < 0.1,
        "{said}"
    );
}

#[test]
fn the_stretch_of_most_fuel_is_that_of_the_cells() {
    let history = history(true, &rows(1180, 1.0, true), &phases());
    let picture = operating_points(&[run("car", &history)]);
    check(&picture);
    let said = numbers_in(title(&picture).split(": ").next().unwrap());
    let [share, from, to] = said[..3] else {
        panic!("{said:?}")
    };
    let within = |row: &&Vec<String>| {
        let cell = numbers_in(&row[0]);
        cell[0] >= from - 1e-6 && cell[1] <= to + 1e-6
    };
    let all = sum(picture.table.rows.iter(), 3);
    let own = sum(picture.table.rows.iter().filter(within), 3);
    assert!(
        (100.0 * own / all - share).abs() < 0.6,
        "{share} {own} {all}"
    );
}

fn energy() -> CarEnergy {
    CarEnergy {
        subject: "car".to_owned(),
        conditions: "NEDC, ambient \u{2212}10 \u{b0}C".into(),
        fuel_kj_km: 27_000.0,
        exhaust_kj_km: 9000.0,
        engine_heat_kj_km: 12_500.0,
        accessories_kj_km: 562.0,
        kinetic_kj_km: 0.8,
        losses_kj_km: vec![(Component::Pump, 1700.0), (Component::BeltBand, 500.0)],
        brake_kj_km: 300.0,
        wheels_kj_km: 2437.2,
        largest_kj_km: [54_000.0, 0.0],
    }
}

#[test]
fn shares_of_a_flow_are_those_of_its_table() {
    let row = |picture: &Picture, name: &str, column: usize| {
        let own = |row: &&Vec<String>| row[0] == name;
        numbers(&picture.table.rows.iter().find(own).unwrap()[column])
    };
    let picture = energy_flow(&energy());
    let said = numbers_in(&title(&picture));
    assert!(
        (said[0] - row(&picture, "Rolling and air", 3)).abs() < 0.06,
        "{said:?}"
    );
    assert!(
        (said[1] - row(&picture, "Transmission losses", 3)).abs() < 0.06,
        "{said:?}"
    );
    let picture = transmission_flow(&energy());
    let passed = row(&picture, "Rolling and air", 3) + row(&picture, "Brakes", 3);
    assert!(
        (numbers_in(&title(&picture))[0] - passed).abs() < 0.06,
        "{passed}"
    );
}

#[test]
fn the_largest_losses_of_a_title_have_their_share() {
    let car = CarLosses {
        name: "car".to_owned(),
        losses_kj: energy().losses_kj_km,
        distance_km: 11.0,
    };
    let picture = loss_by_component(&[car], "conditions");
    assert!(
        title(&picture).starts_with("Pump and belt band are 100 %"),
        "{}",
        title(&picture)
    );
    let phases = PhaseLosses {
        subject: "s".to_owned(),
        cars: vec!["car".to_owned()],
        groups: vec![(
            "ECE15".to_owned(),
            vec![vec![(Component::Pump, 40.0), (Component::BeltBand, 2.5)]],
        )],
    };
    let picture = loss_by_phase(&phases);
    assert!(
        title(&picture).starts_with("car loses 42.5 kJ/km in ECE15"),
        "{}",
        title(&picture)
    );
    assert!((sum(picture.table.rows.iter(), 3) - 42.5).abs() < 1e-9);
}

#[test]
fn differences_of_a_title_are_those_of_the_table() {
    let difference = EnergyDifference {
        names: ["a".to_owned(), "b".to_owned()],
        fuel_kj_per_l: [31_000.0; 2],
        distance_km: [11.0; 2],
        fuel_kj: [27_000.0, 26_900.0],
        terms: vec![
            DifferenceTerm::component(Component::BeltBand, [500.0, 420.0]),
            DifferenceTerm::component(Component::Pump, [900.0, 899.9]),
            DifferenceTerm::component(Component::Seal, [90.0, 90.1]),
        ],
    };
    let picture = difference_bars(&difference);
    check(&picture);
    let said = title(&picture);
    assert!(
        said.starts_with("B burns 100 kJ less than A, most of it belt band (-80.0 kJ)"),
        "{said}"
    );
    assert!(picture.svg.contains("2 others"), "small terms are one bar");
    let rows = &picture.table.rows;
    assert!(
        rows.iter().any(|row| row[0] == "Seal") && rows.iter().any(|row| row[0] == "Pump"),
        "the table has each"
    );
}

#[test]
fn fuel_that_one_run_has_burnt_more_grows_to_that_of_the_title() {
    let flow = |g_s: f64| {
        (1..=100)
            .map(|t| (f64::from(t), 1.0, g_s))
            .collect::<Vec<_>>()
    };
    let difference = TraceDifference {
        names: ["a".to_owned(), "b".to_owned()],
        speed_kmh: vec![(1.0, 0.0), (100.0, 50.0)],
        fuel_g_s: [flow(0.5), flow(0.45)],
        panels: vec![OverlayPanel {
            title: "Sump".to_owned(),
            unit: "degC",
            runs: [
                vec![(1.0, 20.0), (100.0, 40.0)],
                vec![(1.0, 20.0), (100.0, 38.0)],
            ],
        }],
    };
    let picture = trace_difference(&difference);
    check(&picture);
    let said = numbers_in(title(&picture).split(": ").next().unwrap());
    let last = picture.table.rows.last().unwrap();
    assert!(
        (said[0] + numbers(&last[1])).abs() < 0.006,
        "{said:?} {last:?}"
    );
    let half = picture
        .table
        .rows
        .iter()
        .find(|row| numbers(&row[0]) >= said[1])
        .unwrap();
    assert!(
        (numbers(&half[1]) / numbers(&last[1]) - 0.5).abs() < 0.02,
        "{half:?}"
    );
    check(&trace_difference(&TraceDifference::default()));
}
