//! Content of a report, independent of its form.

use cvtcycle_analysis::answer::Answer;
use std::collections::BTreeSet;

use crate::charts::Picture;
use crate::live_section::LiveSection;

/// A report.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// The answer behind it, where it was computed for the document.
    pub answer: Option<Box<Answer>>,
    /// Title.
    pub title: String,
    /// Subject, one line.
    pub subtitle: String,
    /// Cycle and conditions in a few words, for the header of each page.
    pub running: String,
    /// Author, organisation, date, as the user wrote them.
    pub byline: Vec<String>,
    /// The user's logo as a data URI, with its alternative text.
    pub logo: Option<(String, String)>,
    /// Sections.
    pub sections: Vec<Section>,
    /// Interactive section, if there is one.
    pub live: Option<LiveSection>,
    /// Descriptions of missing parts, for standard error.
    pub warnings: Vec<String>,
}

/// A section.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Name for links, unique within the document.
    pub id: String,
    /// Title.
    pub title: String,
    /// Parts.
    pub blocks: Vec<Block>,
    /// Additional parts of a full report.
    pub more: Vec<Block>,
}

/// A part of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// Question that the document answers.
    Question(String),
    /// Key sentence.
    Lead(String),
    /// Boxes in a row, each with a head and its lines.
    Boxes(Vec<(String, Vec<String>)>),
    /// A paragraph.
    Text(String),
    /// A prominent paragraph.
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
    /// A collapsed table.
    Folded(ReportTable),
    /// A figure.
    Figure(Figure),
}

/// A table. The first column names the row.
#[derive(Clone, Debug, Default)]
pub struct ReportTable {
    /// Caption.
    pub caption: String,
    /// Columns.
    pub columns: Vec<ReportColumn>,
    /// Cells, row by row.
    pub rows: Vec<ReportRow>,
    /// Note on the contents; may be empty.
    pub note: String,
}

/// Head of a column.
#[derive(Clone, Debug, Default)]
pub struct ReportColumn {
    /// Name.
    pub name: String,
    /// Unit; may be empty.
    pub unit: String,
    /// True for a column of numbers.
    pub number: bool,
}

/// A row of a table.
#[derive(Clone, Debug, Default)]
pub struct ReportRow {
    /// Cells.
    pub cells: Vec<String>,
    /// True for an emphasised row, such as a sum.
    pub strong: bool,
}

/// A figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name, the stem of its file name.
    pub name: String,
    /// Caption.
    pub caption: String,
    /// Drawing and numbers.
    pub picture: Picture,
    /// View that the figure belongs to; `None` for a separate figure.
    pub view: Option<View>,
}

/// One of several figures of which the page shows one at a time: the same quantity for another car.
#[derive(Clone, Debug)]
pub struct View {
    /// Name of the group of views.
    pub group: String,
    /// Label of this view: the car.
    pub label: String,
    /// True for the view shown first, and printed.
    pub first: bool,
    /// True if the other views are printed too.
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

    /// Adds a prominent paragraph.
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

    /// Adds a figure with its file name and caption.
    pub fn figure(
        &mut self,
        name: impl Into<String>,
        caption: impl Into<String>,
        picture: Picture,
    ) {
        self.blocks.push(Block::Figure(Figure {
            name: name.into(),
            caption: caption.into(),
            picture,
            view: None,
        }));
    }

    /// Adds the same figure of several cars, of which the page shows one at a time: car, file name, caption and figure. The first one is shown
    /// first.
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

    /// Adds a collapsed table.
    pub fn folded(&mut self, table: ReportTable) {
        self.blocks.push(Block::Folded(table));
    }
}

/// Maximum number of columns that fit on a phone.
const WIDE: usize = 3;

impl ReportTable {
    /// A table of a column of names and columns of numbers with their units.
    pub fn numeric(
        caption: &str,
        first: &str,
        columns: impl IntoIterator<Item = (impl Into<String>, impl Into<String>)>,
    ) -> Self {
        let rest = columns.into_iter().map(|(name, unit)| ReportColumn {
            name: name.into(),
            unit: unit.into(),
            number: true,
        });
        let mut table = Self::textual(caption, &[first]);
        table.columns.extend(rest);
        table
    }

    /// A table of words.
    pub fn textual(caption: &str, columns: &[&str]) -> Self {
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

    /// True for a table too wide for a phone, where each row becomes a card, and each cell repeats the head of its column.
    pub fn is_wide(&self) -> bool {
        self.columns.len() > WIDE
    }

    /// Name and unit of a column, for a cell of a card.
    pub fn head(&self, column: &usize) -> String {
        let column_head = self.columns.get(*column);
        column_head.map_or_else(String::new, |column_head| match column_head.unit.as_str() {
            "" => column_head.name.clone(),
            unit => format!("{} [{unit}]", column_head.name),
        })
    }

    /// True if all columns but the first hold numbers.
    pub fn all_numbers(&self) -> bool {
        self.columns.iter().skip(1).all(|column| column.number)
    }

    /// True if cells of a column need a mark as numbers, since other columns hold words.
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
    /// Numbers of the picture as a table, for the figure with that number.
    pub fn numbers(&self, number: &str) -> ReportTable {
        let table = &self.picture.table;
        let caption = format!("Numbers of figure {number}");
        let mut listed = ReportTable::textual(&caption, &[]);
        for (k, (name, unit)) in table.columns.iter().enumerate() {
            listed.columns.push(ReportColumn {
                name: name.clone(),
                unit: (*unit).to_owned(),
                number: table.numbers(k).is_some(),
            });
        }
        table
            .rows
            .iter()
            .for_each(|cells| listed.row(cells.clone()));
        listed.note.clone_from(&table.note);
        listed
    }
}

impl Document {
    /// Selects the body, or the full report; drops empty sections.
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

    /// Iterates over the figures with their file names, which are safe and unique.
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
            // Some file systems ignore case.
            let is_free = |name: &String| taken.insert(name.to_lowercase());
            let name = (1..).map(numbered).find(is_free).unwrap_or_default();
            (format!("{name}.svg"), figure)
        })
    }
}

/// Makes a name safe as a file name, without path components.
pub(crate) fn plain(name: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    name.chars()
        .map(|c| if plain(c) { c } else { '_' })
        .collect()
}
