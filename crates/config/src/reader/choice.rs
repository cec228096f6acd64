//! Choice of one of several options by the name of its table.
use crate::document::{Node, Table, Value};
use crate::problem::Problem;
use crate::reader::origin::Found;
use crate::reader::path::join;
use crate::reader::section::Section;
use crate::reader::value::{Lookup, default_option, options};
use cvtcycle_model::keys::Key;

/// How the choice came out.
enum Choice<'r> {
    Given(&'static str, Found<'r>),
    Default(&'static str),
    /// Reported already.
    Failed,
}

impl<'r> Section<'r> {
    /// The option of `key` and its table. An option is chosen by its table (`[….key.option]`) or by
    /// its name alone (`key = "option"`, with all its defaults); an assignment from the command line,
    /// to the key or to a key within an option, goes before the file. Without any, the default.
    /// After a problem it is the default or the first option, with a section that reports nothing missing.
    pub(crate) fn choose_option(&self, key: &Key<'_>) -> (&'static str, Section<'r>) {
        let name = key.name;
        let node = self
            .table
            .and_then(|table| table.entries.get(name))
            .map(|entry| &entry.node);
        let table = node.and_then(|node| match &node.value {
            Value::Table(table)
                if table.wrapped().is_none() || options(key).any(|option| option == "value") =>
            {
                Some(table)
            }
            _ => None,
        });
        self.announce(key, node.is_some() && table.is_none());
        let choice = match (node, table) {
            (None, _) => self.default_choice(key),
            (Some(node), None) => self.by_word(key, node),
            (Some(node), Some(table)) => self.by_table(key, node, table),
        };
        let failed = matches!(choice, Choice::Failed);
        let option = match choice {
            Choice::Given(option, found) => {
                self.given(name, &found, option, None);
                option
            }
            Choice::Default(option) => {
                self.defaulted(name, option, None);
                option
            }
            Choice::Failed => default_option(key)
                .or(options(key).next())
                .unwrap_or_default(),
        };
        let mut section = self.below(name);
        self.reader.record(|log| {
            let others = options(key).filter(|other| failed || *other != option);
            log.read
                .extend(others.map(|other| join(&section.path, other)));
        });
        section.header = node.map(|node| node.span.clone()).or(section.header);
        section.table = table.filter(|_| !failed);
        section.muted |= failed;
        (option, section.table(option))
    }

    /// Makes the choice and its options known.
    fn announce(&self, key: &Key<'_>, is_word: bool) {
        self.register(key);
        self.reader.record(|log| {
            let path = join(&self.path, key.name);
            if !is_word {
                log.read.remove(&path);
            }
            log.choices.insert(path.clone());
            log.tables
                .extend(options(key).map(|option| join(&path, option)));
            log.tables.insert(path);
        });
    }

    fn default_choice(&self, key: &Key<'_>) -> Choice<'r> {
        if let Some(default) = default_option(key) {
            return Choice::Default(default);
        }
        self.report_missing(key);
        Choice::Failed
    }

    /// The option that a word names.
    fn by_word(&self, key: &Key<'_>, node: &'r Node) -> Choice<'r> {
        let name = key.name;
        let Lookup::Found(found) = self.unwrap(name, node, false) else {
            return Choice::Failed;
        };
        let Value::Text(word) = &found.node.value else {
            self.wrong_type(name, found.node, "the name of an option or its table");
            return Choice::Failed;
        };
        if let Some(option) = options(key).find(|option| option == word) {
            return Choice::Given(option, found);
        }
        self.unknown_word(key, &found.node.span, word);
        Choice::Failed
    }

    /// The option whose table is present.
    fn by_table(&self, key: &Key<'_>, node: &'r Node, table: &'r Table) -> Choice<'r> {
        let entry = |option| Some((option, &table.entries.get(option)?.node));
        let present: Vec<(&'static str, &'r Node)> = options(key).filter_map(entry).collect();
        let touched: Vec<(&'static str, &'r Node)> = present
            .iter()
            .filter(|(_, node)| is_touched(node))
            .copied()
            .collect();
        if let Some(word) = &table.choice {
            let choice = self.by_word(key, word);
            return match (
                choice,
                touched.iter().find(|(option, _)| !names(word, option)),
            ) {
                (Choice::Given(option, _), Some(other)) => self.clash(key, (option, word), *other),
                (choice, _) => choice,
            };
        }
        match (touched.as_slice(), present.as_slice()) {
            ([one], _) => self.taken(key, *one, node),
            ([first, second, ..], _) => self.clash(key, *first, *second),
            ([], [one]) => self.taken(key, *one, node),
            ([], [first, second, ..]) => self.clash(key, *first, *second),
            ([], []) => self.default_choice(key),
        }
    }

    /// The option of a table, which may be set as a whole.
    fn taken(
        &self,
        key: &Key<'_>,
        (option, node): (&'static str, &'r Node),
        whole: &'r Node,
    ) -> Choice<'r> {
        if !matches!(node.value, Value::Table(_)) {
            self.wrong_type(&format!("{}.{option}", key.name), node, "a table");
            return Choice::Failed;
        }
        let found = Found::new(self.reader.document, node, "choice");
        let is_set = whole.span.is_set() || is_touched(node);
        Choice::Given(
            option,
            match is_set {
                true => found.set(),
                false => found,
            },
        )
    }

    /// Two options at once: the problem is at the later one and names the place of the other.
    fn clash(
        &self,
        key: &Key<'_>,
        first: (&'static str, &'r Node),
        second: (&'static str, &'r Node),
    ) -> Choice<'r> {
        let document = self.reader.document;
        let later = |node: &Node| (node.span.source, node.span.range.start);
        let (first, second) = if later(first.1) <= later(second.1) {
            (first, second)
        } else {
            (second, first)
        };
        let at = |node: &Node| {
            let place = document.place(&node.span);
            if place.line > 0 {
                format!("line {}", place.line)
            } else {
                place.input.to_string()
            }
        };
        let name = join(&self.path, key.name);
        let message = format!(
            "two options for `{name}`: `{}` ({}) and `{}` ({})",
            first.0,
            at(first.1),
            second.0,
            at(second.1)
        );
        let problem = Problem::conflict(message)
            .names_key()
            .allowed(key.allowed());
        self.report(&second.1.span, key.name, problem.hint("keep one of them"));
        Choice::Failed
    }
}

/// True if an assignment concerns the table of an option.
fn is_touched(node: &Node) -> bool {
    node.span.is_set()
        || matches!(&node.value, Value::Table(table) if table.is_touched() || table.choice.is_some())
}

fn names(word: &Node, option: &str) -> bool {
    matches!(&word.inner().value, Value::Text(text) if text == option)
}
