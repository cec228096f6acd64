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
