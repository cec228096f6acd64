//! Unit tests of `model::math::grid`.
use cvtcycle_model::math::{GRID_AXES, Grid};

fn plane(x: [f64; GRID_AXES]) -> f64 {
    1.0 + 2.0 * x[0] - 3.0 * x[1] + 0.5 * x[4] + x[0] * x[1]
}

#[test]
fn val_reproduces_a_bilinear_function() {
    let mut rows = Vec::new();
    for a in [0.0, 1.0, 4.0] {
        for b in [-1.0, 2.0] {
            for e in [10.0, 20.0] {
                let x = [a, b, 7.0, 0.0, e];
                rows.push((x, plane(x)));
            }
        }
    }
    rows.reverse();
    let grid = Grid::from_rows(&rows).expect("full grid");
    for x in [
        [0.3, 0.1, 0.0, 0.0, 12.0],
        [3.9, 1.9, 5.0, 1.0, 19.0],
        [4.0, 2.0, 7.0, 0.0, 20.0],
    ] {
        let (y, inside) = grid.at(x);
        assert!(
            (y - plane(x)).abs() < 1e-12 && inside,
            "{x:?}: {y} {}",
            plane(x)
        );
    }
    assert!(!grid.at([5.0, 0.0, 0.0, 0.0, 12.0]).1);
}

#[test]
fn refuses_holes_and_doubles() {
    let row = |a: f64, b: f64| ([a, b, 0.0, 0.0, 0.0], 1.0);
    assert!(Grid::from_rows(&[row(0.0, 0.0), row(1.0, 1.0)]).is_err());
    assert!(
        Grid::from_rows(&[row(0.0, 0.0), row(1.0, 1.0), row(0.0, 1.0), row(0.0, 0.0)]).is_err()
    );
}
