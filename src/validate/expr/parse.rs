//! Words to an expression, every name looked up on the way.

use super::words::{What, Word, words};
use super::{Expr, Fault, Function, Gives, Loop, Order, Reduce, Reduction};
use crate::config::near;

/// The names that an expression may use.
pub trait Names {
    /// Names of all sources.
    fn sources(&self) -> Vec<&str>;
    /// Columns of a source, or of its totals.
    fn columns(&self, source: usize, totals: bool) -> Vec<&'static str>;
    /// Known keys of vehicles and fluids.
    fn keys(&self) -> &[String];
}

/// Brackets may nest this deep: more than anyone writes, few enough to recurse over.
const DEEPEST: usize = 40;

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
            Reduction::Slope | Reduction::R2 | Reduction::Rising | Reduction::Falling => (true, false),
            Reduction::Interp | Reduction::Cross => (true, true),
            _ => (false, false),
        }
    }

    fn name(self) -> &'static str {
        REDUCTIONS.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }
}

struct Parser<'a> {
    words: Vec<Word>,
    next: usize,
    names: &'a dyn Names,
    /// Columns in force, innermost reduction last.
    scopes: Vec<Vec<&'static str>>,
    variables: Vec<String>,
    depth: usize,
    /// Unknown names, which do not stop the parsing.
    faults: Vec<Fault>,
}

/// Parses a text.
///
/// # Errors
/// All unknown names, or the first place that cannot be read.
pub fn parse(text: &str, names: &dyn Names) -> Result<Expr, Vec<Fault>> {
    let words = words(text).map_err(|fault| vec![fault])?;
    let mut parser = Parser { words, next: 0, names, scopes: Vec::new(), variables: Vec::new(), depth: 0, faults: Vec::new() };
    let result = parser
        .any_of()
        .and_then(|expr| if parser.peek() == &What::End { Ok(expr) } else { Err(parser.unexpected("an operator or the end")) });
    match result {
        Ok(expr) if parser.faults.is_empty() => lone_ranges(&expr, true).map(|()| expr).map_err(|message| {
            vec![Fault {
                at: 0,
                width: text.chars().count().max(1),
                word: text.to_owned(),
                message,
                hint: "use min(...) or max(...) within a larger expression".to_owned(),
            }]
        }),
        Ok(_) => Err(parser.faults),
        Err(fault) => Err(parser.faults.into_iter().chain([fault]).collect()),
    }
}

/// A range may only be the whole expression: nothing can be computed with it.
fn lone_ranges(expr: &Expr, top: bool) -> Result<(), String> {
    if !top && expr.gives() == Gives::Range {
        return Err("`range` and `span` stand alone, they are no number to go on with".to_owned());
    }
    let parts: Vec<&Expr> = match expr {
        Expr::Previous(a) | Expr::Negate(a) | Expr::Not(a) | Expr::Loop(_, _, a) => vec![a],
        Expr::Binary(_, a, b) => vec![a, b],
        Expr::Compare(list, _) | Expr::And(list) | Expr::Or(list) | Expr::Call(_, list) => list.iter().collect(),
        Expr::Reduce(r) => [Some(&r.value), r.over.as_ref(), r.at.as_ref(), r.filter.as_ref()].into_iter().flatten().collect(),
        Expr::Number(_) | Expr::Column(_) | Expr::Variable(_) | Expr::Key(..) => Vec::new(),
    };
    parts.into_iter().try_for_each(|part| lone_ranges(part, false))
}

impl Parser<'_> {
    fn peek(&self) -> &What {
        self.words.get(self.next).map_or(&What::End, |word| &word.what)
    }

    fn word(&self) -> Word {
        self.words.get(self.next).cloned().unwrap_or(Word { what: What::End, at: 0, width: 1 })
    }

    fn take(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), What::Sign(s) if *s == sign);
        self.next += usize::from(found);
        found
    }

    fn take_name(&mut self, name: &str) -> bool {
        let found = matches!(self.peek(), What::Name(n) if n == name);
        self.next += usize::from(found);
        found
    }

    fn need(&mut self, sign: &str) -> Result<(), Fault> {
        if self.take(sign) { Ok(()) } else { Err(self.unexpected(&format!("`{sign}`"))) }
    }

    fn unexpected(&self, wanted: &str) -> Fault {
        let word = self.word();
        let text = match &word.what {
            What::Number(x) => x.to_string(),
            What::Name(name) => name.clone(),
            What::Sign(sign) => (*sign).to_owned(),
            What::End => String::new(),
        };
        let found = if text.is_empty() { "the end".to_owned() } else { format!("`{text}`") };
        let message = format!("expected {wanted}, found {found}");
        Fault { at: word.at, width: word.width, word: text, message, hint: String::new() }
    }

    /// Notes an unknown name and goes on.
    fn unknown(&mut self, word: &Word, name: &str, what: &str, known: &[&str]) {
        let close = near(name, known.iter().copied());
        let quoted: Vec<String> = close.iter().map(|n| format!("`{n}`")).collect();
        let hint = match (close.is_empty(), known.len()) {
            (false, _) => format!("did you mean {}?", quoted.join(" or ")),
            (true, 0) => String::new(),
            (true, _) => format!("known here: {}", known.iter().take(40).copied().collect::<Vec<_>>().join(", ")),
        };
        self.faults.push(Fault {
            at: word.at,
            width: word.width,
            word: name.to_owned(),
            message: format!("{what} `{name}` is not known"),
            hint,
        });
    }

    fn any_of(&mut self) -> Result<Expr, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Fault { message: "brackets nest too deep".to_owned(), ..self.unexpected("") });
        }
        let mut list = vec![self.all_of()?];
        while self.take_name("or") {
            list.push(self.all_of()?);
        }
        self.depth -= 1;
        Ok(if list.len() > 1 { Expr::Or(list) } else { list.remove(0) })
    }

    fn all_of(&mut self) -> Result<Expr, Fault> {
        let mut list = vec![self.compared()?];
        while self.take_name("and") {
            list.push(self.compared()?);
        }
        Ok(if list.len() > 1 { Expr::And(list) } else { list.remove(0) })
    }

    fn compared(&mut self) -> Result<Expr, Fault> {
        let mut denied = false;
        while self.take_name("not") {
            denied = !denied;
        }
        let inner = self.chain()?;
        Ok(if denied { Expr::Not(Box::new(inner)) } else { inner })
    }

    /// A chain of comparisons, or one sum.
    fn chain(&mut self) -> Result<Expr, Fault> {
        let mut list = vec![self.sum()?];
        let mut orders = Vec::new();
        while let Some(order) = self.order() {
            orders.push(order);
            list.push(self.sum()?);
        }
        Ok(if orders.is_empty() { list.remove(0) } else { Expr::Compare(list, orders) })
    }

    fn order(&mut self) -> Option<Order> {
        let orders = [
            ("<=", Order::AtMost),
            (">=", Order::AtLeast),
            ("==", Order::Equal),
            ("=", Order::Equal),
            ("<", Order::Less),
            (">", Order::More),
        ];
        orders.into_iter().find(|(sign, _)| self.take(sign)).map(|(_, order)| order)
    }

    fn binary(&mut self, signs: &[&'static str], part: fn(&mut Self) -> Result<Expr, Fault>) -> Result<Expr, Fault> {
        let mut left = part(self)?;
        while let Some(sign) = signs.iter().find(|sign| self.take(sign)) {
            let right = part(self)?;
            left = Expr::Binary(sign.chars().next().unwrap_or('+'), Box::new(left), Box::new(right));
        }
        Ok(left)
    }

    fn sum(&mut self) -> Result<Expr, Fault> {
        self.binary(&["+", "-"], Self::product)
    }

    fn product(&mut self) -> Result<Expr, Fault> {
        self.binary(&["*", "/"], Self::signed)
    }

    fn signed(&mut self) -> Result<Expr, Fault> {
        // A row of signs is counted, not recursed over.
        let mut minus = false;
        while self.take("-") {
            minus = !minus;
        }
        let power = self.binary(&["^"], Self::atom)?;
        Ok(if minus { Expr::Negate(Box::new(power)) } else { power })
    }

    fn atom(&mut self) -> Result<Expr, Fault> {
        let word = self.word();
        match &word.what {
            What::Number(x) => {
                self.next += 1;
                Ok(Expr::Number(*x))
            }
            What::Sign("(") => {
                self.next += 1;
                let inner = self.any_of()?;
                self.need(")")?;
                Ok(inner)
            }
            What::Name(name) => {
                self.next += 1;
                if self.take("(") {
                    let inner = self.called(&word, name)?;
                    self.need(")")?;
                    return Ok(inner);
                }
                Ok(self.named(&word, name))
            }
            _ => Err(self.unexpected("a number, a name or a bracket")),
        }
    }

    fn named(&mut self, word: &Word, name: &str) -> Expr {
        if name == "pi" {
            return Expr::Number(std::f64::consts::PI);
        }
        if let Some(k) = self.variables.iter().position(|variable| variable == name) {
            return Expr::Variable(k);
        }
        match self.scopes.last().cloned() {
            Some(columns) => match columns.iter().position(|column| *column == name) {
                Some(k) => return Expr::Column(k),
                None => self.unknown(word, name, "the column", &columns),
            },
            None => {
                let hint = "a name stands within a reduction such as max(SOURCE: COLUMN)".to_owned();
                let message = format!("`{name}` stands outside of any source");
                self.faults.push(Fault { at: word.at, width: word.width, word: name.to_owned(), message, hint });
            }
        }
        Expr::Number(f64::NAN)
    }

    fn called(&mut self, word: &Word, name: &str) -> Result<Expr, Fault> {
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
            let known: Vec<&str> =
                REDUCTIONS.iter().map(|r| r.0).chain(FUNCTIONS.iter().map(|f| f.0)).chain(["key", "prev", "each", "span"]).collect();
            if REDUCTIONS.iter().any(|(known, _)| *known == name) {
                return Err(Fault { hint: format!("write {name}(SOURCE: COLUMN)"), ..self.unexpected("the name of a source and `:`") });
            }
            self.unknown(word, name, "the function", &known);
            return Err(self.faults.pop().unwrap_or_else(|| self.unexpected("a function")));
        };
        let list = self.arguments()?;
        let several = matches!(function, Function::Min | Function::Max);
        if (list.len() == 1) == several {
            return Err(self.unexpected(if several { "more arguments, or `SOURCE:`" } else { "one argument" }));
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
        let columns = if known { self.names.columns(source, kind == Reduction::Total) } else { Vec::new() };
        let before = self.faults.len();
        self.scopes.push(columns);
        let mut parts = Reduce { kind, source, value: self.any_of()?, over: None, at: None, filter: None, by: Vec::new() };
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
            let form = match (over, at) {
                (true, true) => "VALUE over COLUMN at NUMBER",
                (true, false) => "VALUE over COLUMN",
                _ => "VALUE, without `over` and `at`",
            };
            return Err(Fault { hint: format!("write {}(SOURCE: {form})", kind.name()), ..self.unexpected("another form") });
        }
        Ok(Expr::Reduce(Box::new(parts)))
    }

    /// `key(PATH)`, `key(SOURCE: PATH)`, `key(SOURCE: PATH, INDEX)`.
    fn key(&mut self) -> Result<Expr, Fault> {
        let second = self.words.get(self.next + 1).map(|word| &word.what);
        let source = if second == Some(&What::Sign(":")) { Some(self.source()?) } else { None };
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
