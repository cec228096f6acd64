//! What follows a name and a bracket: functions, reductions, loops, keys.

use super::parse::Parser;
use super::words::{What, Word};
use super::{Expr, Fault, Function, Loop, Reduce, Reduction};
use cvtcycle_config::near;

const FUNCTIONS: [(&str, Function); 9] = [
    ("abs", Function::Abs),
    ("sqrt", Function::Sqrt),
    ("ln", Function::Ln),
    ("exp", Function::Exp),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("min", Function::Min),
    ("max", Function::Max),
];

const REDUCTIONS: [(&str, Reduction); 20] = [
    ("min", Reduction::Min),
    ("max", Reduction::Max),
    ("range", Reduction::Range),
    ("spread", Reduction::Spread),
    ("mean", Reduction::Mean),
    ("sum", Reduction::Sum),
    ("first", Reduction::First),
    ("last", Reduction::Last),
    ("one", Reduction::One),
    ("count", Reduction::Count),
    ("share", Reduction::Share),
    ("all", Reduction::All),
    ("any", Reduction::Any),
    ("slope", Reduction::Slope),
    ("r2", Reduction::R2),
    ("rising", Reduction::Rising),
    ("falling", Reduction::Falling),
    ("interp", Reduction::Interp),
    ("cross", Reduction::Cross),
    ("total", Reduction::Total),
];

impl Reduction {
    /// Whether it looks at a second column, and whether at a place or level.
    fn needs(self) -> (bool, bool) {
        match self {
            Reduction::Slope | Reduction::R2 | Reduction::Rising | Reduction::Falling => {
                (true, false)
            }
            Reduction::Interp | Reduction::Cross => (true, true),
            _ => (false, false),
        }
    }

    fn name(self) -> &'static str {
        REDUCTIONS
            .iter()
            .find(|(_, kind)| *kind == self)
            .map_or("", |(name, _)| name)
    }
}

impl Parser<'_> {
    pub(super) fn called(&mut self, word: &Word, name: &str) -> Result<Expr, Fault> {
        let second = self.words.get(self.next + 1).map(|word| &word.what);
        let of_source = matches!(self.peek(), What::Name(_)) && second == Some(&What::Sign(":"));
        match name {
            "key" => return self.key(),
            "prev" => return Ok(Expr::Previous(Box::new(self.any_of()?))),
            "each" => return self.looped(Loop::Each),
            "span" => return self.looped(Loop::Span),
            _ => {}
        }
        if of_source && let Some((_, kind)) = REDUCTIONS.iter().find(|(known, _)| *known == name) {
            return self.reduction(*kind);
        }
        let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
            let known: Vec<&str> = REDUCTIONS
                .iter()
                .map(|r| r.0)
                .chain(FUNCTIONS.iter().map(|f| f.0))
                .chain(["key", "prev", "each", "span"])
                .collect();
            if REDUCTIONS.iter().any(|(known, _)| *known == name) {
                return Err(Fault {
                    hint: format!("write {name}(SOURCE: COLUMN)"),
                    ..self.unexpected("the name of a source and `:`")
                });
            }
            self.unknown(word, name, "the function", &known);
            return Err(self
                .faults
                .pop()
                .unwrap_or_else(|| self.unexpected("a function")));
        };
        let list = self.arguments()?;
        let several = matches!(function, Function::Min | Function::Max);
        if (list.len() == 1) == several {
            return Err(self.unexpected(if several {
                "more arguments, or `SOURCE:`"
            } else {
                "one argument"
            }));
        }
        Ok(Expr::Call(*function, list))
    }

    fn arguments(&mut self) -> Result<Vec<Expr>, Fault> {
        let mut list = vec![self.any_of()?];
        while self.take(",") {
            list.push(self.any_of()?);
        }
        Ok(list)
    }

    /// `NAME in a, b, c: BODY`.
    fn looped(&mut self, kind: Loop) -> Result<Expr, Fault> {
        let What::Name(name) = self.peek().clone() else {
            return Err(self.unexpected("a name, as in each(t in 25, 95: ...)"));
        };
        self.next += 1;
        if !self.take_name("in") {
            return Err(self.unexpected("`in`"));
        }
        let values = self.arguments()?;
        self.need(":")?;
        self.variables.push(name);
        let body = self.any_of();
        self.variables.pop();
        Ok(Expr::Loop(kind, values, Box::new(body?)))
    }

    fn source(&mut self) -> Result<usize, Fault> {
        let word = self.word();
        let What::Name(name) = &word.what else {
            return Err(self.unexpected("the name of a source"));
        };
        self.next += 1;
        let names = self.names.sources();
        let found = names.iter().position(|known| known == name);
        if found.is_none() {
            self.unknown(&word, name, "the source", &names);
        }
        self.need(":")?;
        Ok(found.unwrap_or(usize::MAX))
    }

    /// `SOURCE: VALUE over X at Y where CONDITION by A, B`.
    fn reduction(&mut self, kind: Reduction) -> Result<Expr, Fault> {
        let source = self.source()?;
        let known = source != usize::MAX;
        let columns = if known {
            self.names.columns(source, kind == Reduction::Total)
        } else {
            Vec::new()
        };
        let before = self.faults.len();
        self.scopes.push(columns);
        let mut parts = Reduce {
            kind,
            source,
            value: self.any_of()?,
            over: None,
            at: None,
            filter: None,
            by: Vec::new(),
        };
        loop {
            if self.take_name("over") {
                parts.over = Some(self.sum()?);
            } else if self.take_name("at") {
                parts.at = Some(self.sum()?);
            } else if self.take_name("where") {
                parts.filter = Some(self.any_of()?);
            } else if self.take_name("by") {
                parts.by = self.arguments()?;
            } else {
                break;
            }
        }
        self.scopes.pop();
        if !known {
            // Columns of an unknown source cannot be judged.
            self.faults.truncate(before);
        }
        let (over, at) = kind.needs();
        if parts.over.is_some() != over || parts.at.is_some() != at {
            let (form, without) = match (over, at) {
                (true, true) => ("VALUE over COLUMN at NUMBER", ""),
                (true, false) => ("VALUE over COLUMN", ", without `at`"),
                _ => ("VALUE", ", without `over` and `at`"),
            };
            return Err(Fault {
                hint: format!("write {}(SOURCE: {form}){without}", kind.name()),
                ..self.unexpected("another form")
            });
        }
        Ok(Expr::Reduce(Box::new(parts)))
    }

    /// `key(PATH)`, `key(SOURCE: PATH)`, `key(SOURCE: PATH, INDEX)`.
    fn key(&mut self) -> Result<Expr, Fault> {
        let second = self.words.get(self.next + 1).map(|word| &word.what);
        let source = if second == Some(&What::Sign(":")) {
            Some(self.source()?)
        } else {
            None
        };
        let word = self.word();
        let What::Name(path) = &word.what else {
            return Err(self.unexpected("a key such as transmission.cvt.ratio.low"));
        };
        self.next += 1;
        if !self.names.keys().iter().any(|known| known == path) {
            let known: Vec<&str> = self.names.keys().iter().map(String::as_str).collect();
            let close: Vec<&str> = near(path, known.iter().copied());
            self.unknown(&word, path, "the key", &close);
        }
        let mut item = None;
        if self.take(",") {
            let What::Number(x) = *self.peek() else {
                return Err(self.unexpected("the number of an item, counted from 0"));
            };
            self.next += 1;
            item = Some(x as usize);
        }
        Ok(Expr::Key(source, path.clone(), item))
    }
}
