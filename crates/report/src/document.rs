//! What a report consists of, without its form.

use std::collections::BTreeSet;

use crate::charts::Picture;
use crate::live_section::LiveSection;

/// A report.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// Title.
    pub title: String,
    /// What it is about, one line.
    pub subtitle: String,
    /// Cycle and conditions in a few words, for the head of each page.
    pub running: String,
    /// Author, organisation, date, as the user wrote them.
    pub byline: Vec<String>,
    /// The user's logo as a data URI, with its words.
    pub logo: Option<(String, String)>,
    /// Sections.
    pub sections: Vec<Section>,
    /// The section that can be driven again, if there is one.
    pub live: Option<LiveSection>,
    /// What is incomplete, for standard error.
    pub warnings: Vec<String>,
}

/// A section.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Name for links, unique within the document.
    pub id: String,
    /// Title.
    pub title: String,
    /// Its parts.
    pub blocks: Vec<Block>,
    /// What only a full report has besides.
    pub more: Vec<Block>,
}

/// A part of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// The question that the document answers.
    Question(String),
    /// A sentence that says what matters.
    Lead(String),
    /// Boxes side by side, each with a head and its lines.
    Boxes(Vec<(String, Vec<String>)>),
    /// A paragraph.
    Text(String),
    /// A paragraph that must not be missed.
    Alert(String),
    /// The user's own words.
    Remark(String),
    /// A heading within the section.
    Heading(String),
    /// Points.
    List(Vec<String>),
    /// Names and values.
    Facts(Vec<(String, String)>),
    /// A table.
    Table(ReportTable),
    /// A table that is folded away.
    Folded(ReportTable),
    /// A figure.
    Figure(Figure),
}

/// A table. The first column names the row.
#[derive(Clone, Debug, Default)]
pub struct ReportTable {
    /// What it holds.
    pub caption: String,
    /// Columns.
    pub columns: Vec<ReportColumn>,
    /// Cells, row by row.
    pub rows: Vec<ReportRow>,
    /// What has to be known of it; may be empty.
    pub note: String,
}

/// Head of a column.
#[derive(Clone, Debug, Default)]
pub struct ReportColumn {
    /// Name.
    pub name: String,
    /// Unit; may be empty.
    pub unit: String,
    /// Whether it holds numbers.
    pub number: bool,
}

/// A row of a table.
#[derive(Clone, Debug, Default)]
pub struct ReportRow {
    /// Cells.
    pub cells: Vec<String>,
    /// Whether it is emphasised, for example as a sum.
    pub strong: bool,
}

/// A figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name, from which that of its file is made.
    pub name: String,
    /// What is to be seen.
    pub caption: String,
    /// Drawing and numbers.
    pub picture: Picture,
    /// Which of several views it is; none for a figure of its own.
    pub view: Option<View>,
}

/// One of several figures of which the page shows one at a time: the same of another car.
#[derive(Clone, Debug)]
pub struct View {
    /// Name of the views, the same for all of them.
    pub group: String,
    /// What distinguishes this one: the car.
    pub label: String,
    /// Whether it is the one that is shown first, and that paper has.
    pub first: bool,
    /// Whether paper has the others too.
    pub paper: bool,
}

impl Section {
    /// An empty section.
    pub fn new(id: &str, title: &str) -> Self {
        Section {
            id: id.to_owned(),
            title: title.to_owned(),
            blocks: Vec::new(),
            more: Vec::new(),
        }
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(text.into()));
    }

    /// Adds a paragraph that must not be missed.
    pub fn alert(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Alert(text.into()));
    }

    /// Adds a heading.
    pub fn heading(&mut self, text: &str) {
        self.blocks.push(Block::Heading(text.to_owned()));
    }

    /// Adds names and values.
    pub fn facts(&mut self, facts: Vec<(String, String)>) {
        self.blocks.push(Block::Facts(facts));
    }

    /// Adds a figure under the name of its file, with what is to be seen.
    pub fn figure(&mut self, name: impl Into<String>, caption: impl Into<String>, of: Picture) {
        self.blocks.push(Block::Figure(Figure {
            name: name.into(),
            caption: caption.into(),
            picture: of,
            view: None,
        }));
    }

    /// Adds the same figure of several cars, of which the page shows one at a time: the car, the name of the file, what is to be seen, and the
    /// figure. The first one is shown first.
    pub fn views(
        &mut self,
        group: &str,
        all: impl IntoIterator<Item = (String, String, String, Picture)>,
    ) {
        let all: Vec<_> = all.into_iter().collect();
        let several = all.len() > 1;
        for (k, (label, name, caption, picture)) in all.into_iter().enumerate() {
            let view = View {
                group: group.to_owned(),
                label,
                first: k == 0,
                paper: false,
            };
            self.blocks.push(Block::Figure(Figure {
                name,
                caption,
                picture,
                view: several.then_some(view),
            }));
        }
    }

    /// Adds a table.
    pub fn table(&mut self, table: ReportTable) {
        self.blocks.push(Block::Table(table));
    }

    /// Adds a table that is folded away.
    pub fn folded(&mut self, table: ReportTable) {
        self.blocks.push(Block::Folded(table));
    }
}

/// Columns that a phone has room for.
const WIDE: usize = 3;

impl ReportTable {
    /// A table of a column of names and columns of numbers with their units.
    pub fn of_numbers(
        caption: &str,
        first: &str,
        columns: impl IntoIterator<Item = (impl Into<String>, impl Into<String>)>,
    ) -> Self {
        let rest = columns.into_iter().map(|(name, unit)| ReportColumn {
            name: name.into(),
            unit: unit.into(),
            number: true,
        });
        let mut table = Self::of_words(caption, &[first]);
        table.columns.extend(rest);
        table
    }

    /// A table of words.
    pub fn of_words(caption: &str, columns: &[&str]) -> Self {
        let column = |name: &&str| ReportColumn {
            name: (*name).to_owned(),
            ..ReportColumn::default()
        };
        ReportTable {
            caption: caption.to_owned(),
            columns: columns.iter().map(column).collect(),
            ..ReportTable::default()
        }
    }

    /// Whether it is too wide for a phone: there each row is a card, and each cell has the head of its column.
    pub fn is_wide(&self) -> bool {
        self.columns.len() > WIDE
    }

    /// Name and unit of a column, for a cell of a card.
    pub fn head(&self, column: &usize) -> String {
        let of = self.columns.get(*column);
        of.map_or_else(String::new, |of| match of.unit.as_str() {
            "" => of.name.clone(),
            unit => format!("{} [{unit}]", of.name),
        })
    }

    /// Whether every column but the first holds numbers.
    pub fn all_numbers(&self) -> bool {
        self.columns.iter().skip(1).all(|column| column.number)
    }

    /// Whether the cells of a column have to be marked as numbers, since not all columns hold some.
    pub fn marked(&self, column: &usize) -> bool {
        let own = self.columns.get(*column);
        !self.all_numbers() && own.is_some_and(|column| column.number)
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        let (cells, strong) = (cells.into_iter().collect(), false);
        self.rows.push(ReportRow { cells, strong });
    }

    /// Adds a row that begins with its name.
    pub fn named(&mut self, name: impl Into<String>, cells: impl IntoIterator<Item = String>) {
        self.row([name.into()].into_iter().chain(cells));
    }

    /// Adds an emphasised row that begins with its name.
    pub fn strong(&mut self, name: impl Into<String>, cells: impl IntoIterator<Item = String>) {
        self.named(name, cells);
        self.emphasise(true);
    }

    /// Makes the last row emphasised or not.
    pub(crate) fn emphasise(&mut self, strong: bool) {
        if let Some(row) = self.rows.last_mut() {
            row.strong = strong;
        }
    }
}

impl Figure {
    /// The numbers of the picture as a table, for the figure of that number.
    pub fn numbers(&self, number: &str) -> ReportTable {
        let table = &self.picture.table;
        let caption = format!("Numbers of figure {number}");
        let mut of = ReportTable::of_words(&caption, &[]);
        for (k, (name, unit)) in table.columns.iter().enumerate() {
            of.columns.push(ReportColumn {
                name: name.clone(),
                unit: (*unit).to_owned(),
                number: table.numbers(k).is_some(),
            });
        }
        table.rows.iter().for_each(|cells| of.row(cells.clone()));
        of.note.clone_from(&table.note);
        of
    }
}

impl Document {
    /// The body alone, or all of it: sections without anything to show are left out.
    #[must_use]
    pub fn shown(mut self, full: bool) -> Self {
        for section in &mut self.sections {
            let mut more = std::mem::take(&mut section.more);
            for block in &mut more {
                if let Block::Figure(Figure {
                    view: Some(view), ..
                }) = block
                {
                    view.paper = true;
                }
            }
            section.blocks.extend(more.into_iter().filter(|_| full));
        }
        self.sections.retain(|section| !section.blocks.is_empty());
        self
    }

    /// The figures, each with the name of its file, which is plain and no other figure has.
    pub fn figures(&self) -> impl Iterator<Item = (String, &Figure)> {
        let blocks = self.sections.iter().flat_map(|section| &section.blocks);
        let figures = blocks.filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        });
        let mut taken = BTreeSet::new();
        figures.map(move |figure| {
            let name = plain(&figure.name);
            let numbered = |k: usize| match k {
                1 => name.clone(),
                k => format!("{name}_{k}"),
            };
            // Not all file systems tell upper from lower case.
            let is_free = |name: &String| taken.insert(name.to_lowercase());
            let name = (1..).map(numbered).find(is_free).unwrap_or_default();
            (format!("{name}.svg"), figure)
        })
    }
}

/// A name without anything that leads elsewhere.
pub(crate) fn plain(name: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    name.chars()
        .map(|c| if plain(c) { c } else { '_' })
        .collect()
}
