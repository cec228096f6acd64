//! Choice of one of several options by the name of its table.
use super::document::{Node, Table, Value};
use super::near::{one_of, suggest};
use super::reader::join;
use super::section::Section;
use super::value::{Found, Lazy, Lookup};

/// How the choice came out.
enum Choice<'r> {
    Given(&'static str, Found<'r>),
    Default(&'static str),
    /// Reported already.
    Failed,
}

/// The question: what is asked for and what may be answered.
struct Question<'a> {
    name: &'a str,
    options: &'a [&'static str],
    default: Option<&'static str>,
}

impl<'r> Section<'r> {
    /// The option under `name` and its table. An option is chosen by its table (`[….name.option]`) or by
    /// its name alone (`name = "option"`, with all its defaults); an assignment from the command line,
    /// to the name or to a key within an option, goes before the file. Without any, `default`.
    /// After a problem it is the default or the first option, with a section that reports nothing missing.
    ///
    /// # Panics
    /// If `options` is empty.
    pub fn choose(
        &self,
        name: &str,
        options: &[&'static str],
        default: Option<&'static str>,
        doc: &str,
    ) -> (&'static str, Section<'r>) {
        let question = Question {
            name,
            options,
            default,
        };
        let node = self
            .table
            .and_then(|table| table.entries.get(name))
            .map(|entry| &entry.node);
        let table = node.and_then(|node| match &node.value {
            Value::Table(table) if table.wrapped().is_none() || options.contains(&"value") => {
                Some(table)
            }
            _ => None,
        });
        self.announce(&question, doc, node.is_some() && table.is_none());
        let choice = match (node, table) {
            (None, _) => self.default_choice(&question),
            (Some(node), None) => self.by_word(&question, node),
            (Some(node), Some(table)) => self.by_table(&question, node, table),
        };
        let (option, failed) = match choice {
            Choice::Given(option, found) => {
                self.given(name, &found, option, None);
                (option, false)
            }
            Choice::Default(option) => {
                self.defaulted(name, option, None);
                (option, false)
            }
            Choice::Failed => (default.unwrap_or(options[0]), true),
        };
        let mut section = self.below(name);
        let others = options.iter().filter(|other| failed || **other != option);
        self.reader.note(|log| {
            log.read
                .extend(others.map(|other| join(&section.path, other)))
        });
        section.header = node.map(|node| node.span.clone()).or(section.header);
        section.table = table.filter(|_| !failed);
        section.muted |= failed;
        (option, section.table(option))
    }

    /// Makes the choice and its options known.
    fn announce(&self, question: &Question<'_>, doc: &str, is_word: bool) {
        if self.reader.is_silent() {
            return;
        }
        // Looked up in an empty table: the options' tables are no value, but the key is to be known.
        let empty = Section {
            table: None,
            ..self.clone()
        };
        let _ = empty.open(question.name, Lazy(|| one_of(question.options)), doc);
        self.reader.note(|log| {
            let path = join(&self.path, question.name);
            if !is_word {
                log.read.remove(&path);
            }
            log.choices.insert(path.clone());
            log.tables
                .extend(question.options.iter().map(|option| join(&path, option)));
            log.tables.insert(path);
        });
    }

    fn default_choice(&self, question: &Question<'_>) -> Choice<'r> {
        if let Some(default) = question.default {
            return Choice::Default(default);
        }
        self.missing(question.name, Lazy(|| one_of(question.options)));
        Choice::Failed
    }

    /// The option that a word names.
    fn by_word(&self, question: &Question<'_>, node: &'r Node) -> Choice<'r> {
        let Question { name, options, .. } = *question;
        let Lookup::Found(found) = self.unwrap(name, node) else {
            return Choice::Failed;
        };
        let Value::Text(word) = &found.node.value else {
            self.wrong_type(name, found.node, "the name of an option or its table");
            return Choice::Failed;
        };
        match options.iter().find(|option| *option == word) {
            Some(option) => Choice::Given(option, found),
            None => {
                let message = format!("`{word}` is not known for `{}`", join(&self.path, name));
                self.report(
                    &found.node.span,
                    name,
                    &one_of(options),
                    message,
                    suggest(word, options),
                );
                Choice::Failed
            }
        }
    }

    /// The option whose table is present.
    fn by_table(&self, question: &Question<'_>, node: &'r Node, table: &'r Table) -> Choice<'r> {
        let present: Vec<(&'static str, &'r Node)> = question
            .options
            .iter()
            .filter_map(|option| {
                table
                    .entries
                    .get(*option)
                    .map(|entry| (*option, &entry.node))
            })
            .collect();
        let touched: Vec<(&'static str, &'r Node)> = present
            .iter()
            .filter(|(_, node)| is_touched(node))
            .copied()
            .collect();
        if let Some(word) = &table.choice {
            let choice = self.by_word(question, word);
            return match (
                choice,
                touched.iter().find(|(option, _)| !names(word, option)),
            ) {
                (Choice::Given(option, _), Some(other)) => {
                    self.clash(question, (option, word), *other)
                }
                (choice, _) => choice,
            };
        }
        match (touched.as_slice(), present.as_slice()) {
            ([one], _) => self.taken(question, *one, "set"),
            ([first, second, ..], _) => self.clash(question, *first, *second),
            ([], [one]) => self.taken(
                question,
                *one,
                if node.span.is_set() { "set" } else { "choice" },
            ),
            ([], [first, second, ..]) => self.clash(question, *first, *second),
            ([], []) => self.default_choice(question),
        }
    }

    fn taken(
        &self,
        question: &Question<'_>,
        (option, node): (&'static str, &'r Node),
        status: &'static str,
    ) -> Choice<'r> {
        if !matches!(node.value, Value::Table(_)) {
            self.wrong_type(&format!("{}.{option}", question.name), node, "a table");
            return Choice::Failed;
        }
        let source = if status == "set" { "command line" } else { "" };
        Choice::Given(
            option,
            Found {
                node,
                status,
                source,
                note: "",
            },
        )
    }

    /// Two options at once: the message stands at the later one and names the place of the other.
    fn clash(
        &self,
        question: &Question<'_>,
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
                place.file
            }
        };
        let name = join(&self.path, question.name);
        let message = format!(
            "two options for `{name}`: `{}` ({}) and `{}` ({})",
            first.0,
            at(first.1),
            second.0,
            at(second.1)
        );
        let hint = format!("keep one of them, or choose with --set {name}={}", first.0);
        self.report(
            &second.1.span,
            question.name,
            &one_of(question.options),
            message,
            hint,
        );
        Choice::Failed
    }
}

/// Whether an assignment concerns the table of an option.
fn is_touched(node: &Node) -> bool {
    node.span.is_set()
        || matches!(&node.value, Value::Table(table) if table.is_touched() || table.choice.is_some())
}

fn names(word: &Node, option: &str) -> bool {
    match &word.value {
        Value::Text(text) => text == option,
        Value::Table(table) => table.wrapped().is_some_and(|node| names(node, option)),
        _ => false,
    }
}
