//! CSV tables by column name, for the tests of belt points.

/// Table without quotes.
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub fn new(text: &str) -> Self {
        let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines();
        let names = split(lines.next().expect("a line of names"));
        let rows: Vec<Vec<String>> = lines.map(split).collect();
        assert!(rows.iter().all(|row| row.len() == names.len()), "{text}");
        Table { names, rows }
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn names(&self) -> &[String] {
        &self.names
    }

    pub fn cell(&self, row: usize, name: &str) -> &str {
        let column = self
            .names
            .iter()
            .position(|known| known == name)
            .unwrap_or_else(|| panic!("no column {name}"));
        &self.rows[row][column]
    }

    pub fn number(&self, row: usize, name: &str) -> f64 {
        self.cell(row, name)
            .parse()
            .unwrap_or_else(|_| panic!("{name}: {}", self.cell(row, name)))
    }
}

/// Tests equality within a relative plus an equal absolute tolerance.
pub fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * (1.0 + b.abs())
}

/// Rows of `appendix_c` outside the smoothed regions: |C_x| above three blend widths of 120 N, |ln I| above three widths of 0.015,
/// no gross slip.
pub fn away_from_changes(golden: &Table, row: usize) -> bool {
    golden.cell(row, "formulation") == "appendix_c"
        && golden.cell(row, "status") == "ok"
        && golden.number(row, "segment_compression_n").abs() > 360.0
        && golden.number(row, "ratio").ln().abs() > 0.045
}

/// Mean, 95th percentile and maximum.
pub fn spread(numbers: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    let place = (0.95 * count as f64).ceil() as usize - 1;
    [
        sorted.iter().sum::<f64>() / count as f64,
        sorted[place],
        sorted[count - 1],
    ]
}
