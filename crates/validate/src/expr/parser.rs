//! Tokens to an expression; every name is looked up on the way.

use super::functions::{Compute, FUNCTIONS, Form, NEGATIVE, OPERATORS, REDUCTIONS, Reduction};
use super::lexer::{Token, TokenKind, tokens};
use super::{Expr, Fault, Loop, Order, Reduce};
use cvtcycle_config::{did_you_mean, near};

/// Deepest nesting of brackets, which limits the recursion.
const MAX_DEPTH: usize = 40;
/// Most known names in a hint.
const MAX_LISTED: usize = 40;
/// The names that an expression may use.
pub trait Names {
    /// Names of all sources.
    fn sources(&self) -> Vec<&str>;
    /// Columns of a source, or of its totals.
    fn columns(&self, source: usize, totals: bool) -> Vec<&str>;
    /// Known keys of vehicles and fluids.
    fn keys(&self) -> &[String];
    /// Columns that may be named outside of any source: those of the row that is looked at.
    fn row(&self) -> Vec<&str> {
        Vec::new()
    }
}

/// Parses a text.
///
/// # Errors
/// All unknown names, or the first place that cannot be read.
pub fn parse(text: &str, names: &dyn Names) -> Result<Expr, Vec<Fault>> {
    let mut parser = Parser {
        tokens: tokens(text).map_err(|fault| vec![fault])?,
        next: 0,
        names,
        scopes: Some(names.row())
            .filter(|row| !row.is_empty())
            .into_iter()
            .collect(),
        variables: Vec::new(),
        depth: 0,
        faults: Vec::new(),
    };
    let result = parser.any_of().and_then(|expr| match parser.token().kind {
        TokenKind::End => Ok(expr),
        _ => Err(parser.unexpected("an operator or the end")),
    });
    match result {
        Ok(expr) if parser.faults.is_empty() && expr.has_inner_range() => Err(vec![Fault {
            at: 0,
            width: text.chars().count().max(1),
            word: text.to_owned(),
            message: "`range` and `span` are no part of a larger expression".to_owned(),
            hint: "use min(...) or max(...) within a larger expression".to_owned(),
        }]),
        Ok(expr) if parser.faults.is_empty() => Ok(expr),
        result => Err(parser.faults.into_iter().chain(result.err()).collect()),
    }
}

struct Parser<'a> {
    tokens: Vec<Token>,
    next: usize,
    names: &'a dyn Names,
    /// Columns of the reductions, the innermost last.
    scopes: Vec<Vec<&'a str>>,
    variables: Vec<String>,
    depth: usize,
    /// Unknown names, which do not stop the parsing.
    faults: Vec<Fault>,
}

impl<'a> Parser<'a> {
    fn token(&self) -> &Token {
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    /// True if a colon follows the next token.
    fn colon_follows(&self) -> bool {
        let second = self.tokens.get(self.next + 1);
        second.is_some_and(|token| token.text == ":")
    }

    /// Takes a sign or a word.
    fn take(&mut self, text: &str) -> bool {
        let found = self.token().text == text;
        self.next += usize::from(found);
        found
    }

    fn take_name(&mut self, wanted: &str) -> Result<Token, Fault> {
        let token = self.token().clone();
        if token.kind != TokenKind::Name {
            return Err(self.unexpected(wanted));
        }
        self.next += 1;
        Ok(token)
    }

    fn take_number(&mut self) -> Option<f64> {
        let TokenKind::Number(x) = self.token().kind else {
            return None;
        };
        self.next += 1;
        Some(x)
    }

    fn need(&mut self, text: &str) -> Result<(), Fault> {
        if self.take(text) {
            Ok(())
        } else {
            Err(self.unexpected(&format!("`{text}`")))
        }
    }

    fn unexpected(&self, wanted: &str) -> Fault {
        let token = self.token();
        let found = match token.kind {
            TokenKind::End => "the end".to_owned(),
            _ => format!("`{}`", token.text),
        };
        token.fault(format!("expected {wanted}, found {found}"), String::new())
    }

    /// A fault at the next token, with a remedy.
    fn refused(&self, wanted: &str, hint: String) -> Fault {
        Fault {
            hint,
            ..self.unexpected(wanted)
        }
    }

    /// The fault of an unknown name.
    fn unknown(token: &Token, what: &str, known: &[&str]) -> Fault {
        let name = &token.text;
        let listed = || match known.len() {
            0 => String::new(),
            n => format!("known here: {}", known[..n.min(MAX_LISTED)].join(", ")),
        };
        let hint = did_you_mean(name, known.iter().copied()).unwrap_or_else(listed);
        token.fault(format!("{what} `{name}` is not known"), hint)
    }

    fn any_of(&mut self) -> Result<Expr, Fault> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(Fault {
                message: "brackets nest too deep".to_owned(),
                ..self.unexpected("")
            });
        }
        let expr = self.joined("or", Self::all_of, Expr::Or)?;
        self.depth -= 1;
        Ok(expr)
    }

    fn all_of(&mut self) -> Result<Expr, Fault> {
        self.joined("and", Self::negated, Expr::And)
    }

    /// Parts with a word between them; a single part as it is.
    fn joined(
        &mut self,
        word: &str,
        part: fn(&mut Self) -> Result<Expr, Fault>,
        several: fn(Vec<Expr>) -> Expr,
    ) -> Result<Expr, Fault> {
        let first = part(self)?;
        let mut list = vec![first];
        while self.take(word) {
            list.push(part(self)?);
        }
        Ok(match list.len() {
            1 => list.remove(0),
            _ => several(list),
        })
    }

    fn negated(&mut self) -> Result<Expr, Fault> {
        let negated = self.is_odd("not");
        let inner = self.chain()?;
        Ok(match negated {
            true => Expr::Not(Box::new(inner)),
            false => inner,
        })
    }

    /// Takes repeated words or signs without recursion: true for an odd number of them.
    fn is_odd(&mut self, text: &str) -> bool {
        let mut odd = false;
        while self.take(text) {
            odd = !odd;
        }
        odd
    }

    /// A chain of comparisons, or one sum.
    fn chain(&mut self) -> Result<Expr, Fault> {
        let mut list = vec![self.sum()?];
        let mut orders = Vec::new();
        while let Some((_, order)) = Order::SIGNS.iter().find(|(sign, _)| self.take(sign)) {
            orders.push(*order);
            list.push(self.sum()?);
        }
        Ok(match orders.len() {
            0 => list.remove(0),
            _ => Expr::Compare(list, orders),
        })
    }

    fn sum(&mut self) -> Result<Expr, Fault> {
        self.arithmetic(0)
    }

    /// Numbers joined by the operators of a level and of those that bind more; the sign of a power comes before it.
    fn arithmetic(&mut self, level: usize) -> Result<Expr, Fault> {
        let Some(operators) = OPERATORS.get(level) else {
            return self.atom();
        };
        let negative = level + 1 == OPERATORS.len() && self.is_odd("-");
        let mut left = self.arithmetic(level + 1)?;
        while let Some(operator) = operators.iter().find(|operator| self.take(operator.name)) {
            let right = self.arithmetic(level + 1)?;
            left = Expr::Call(operator, vec![left, right]);
        }
        Ok(match negative {
            true => Expr::Call(&NEGATIVE, vec![left]),
            false => left,
        })
    }

    fn atom(&mut self) -> Result<Expr, Fault> {
        if let Some(x) = self.take_number() {
            return Ok(Expr::Number(x));
        }
        if self.take("(") {
            let inner = self.any_of()?;
            return self.need(")").map(|()| inner);
        }
        let name = self.take_name("a number, a name or a bracket")?;
        if self.take("(") {
            let inner = self.called(&name)?;
            return self.need(")").map(|()| inner);
        }
        Ok(self.named(&name))
    }

    /// A name without a bracket; a number after a fault.
    fn named(&mut self, token: &Token) -> Expr {
        let name = &token.text;
        if name == "pi" {
            return Expr::Number(std::f64::consts::PI);
        }
        if let Some(k) = self.variables.iter().position(|variable| variable == name) {
            return Expr::Variable(k);
        }
        let fault = match self.scopes.last() {
            Some(columns) => match columns.iter().position(|column| column == name) {
                Some(k) => return Expr::Column(k),
                None => Self::unknown(token, "the column", columns),
            },
            None => token.fault(
                format!("`{name}` is outside of any source"),
                "a name is written within a reduction such as max(SOURCE: COLUMN)".to_owned(),
            ),
        };
        self.faults.push(fault);
        Expr::Number(f64::NAN)
    }

    /// Everything with a name and a bracket.
    fn called(&mut self, token: &Token) -> Result<Expr, Fault> {
        let name = token.text.as_str();
        match name {
            "key" => return self.key(),
            "prev" => return Ok(Expr::Previous(Box::new(self.any_of()?))),
            "each" => return self.looped(Loop::Each),
            "span" => return self.looped(Loop::Span),
            _ => {}
        }
        let of_source = self.token().kind == TokenKind::Name && self.colon_follows();
        let reduction = REDUCTIONS.iter().find(|reduction| reduction.name == name);
        if let Some(reduction) = reduction.filter(|_| of_source) {
            return self.reduction(reduction);
        }
        let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) else {
            if reduction.is_some() {
                let hint = format!("write {name}(SOURCE: COLUMN)");
                return Err(self.refused("the name of a source and `:`", hint));
            }
            let known: Vec<&str> = (REDUCTIONS.iter().map(|r| r.name))
                .chain(FUNCTIONS.iter().map(|f| f.name))
                .chain(["key", "prev", "each", "span"])
                .collect();
            return Err(Self::unknown(token, "the function", &known));
        };
        let list = self.arguments()?;
        match function.compute {
            Compute::Several(_) if list.len() < 2 => {
                Err(self.unexpected("more arguments, or `SOURCE:`"))
            }
            Compute::One(_) if list.len() > 1 => Err(self.unexpected("one argument")),
            _ => Ok(Expr::Call(function, list)),
        }
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
        let name = self.take_name("a name, as in each(t in 25, 95: ...)")?;
        self.need("in")?;
        let values = self.arguments()?;
        self.need(":")?;
        self.variables.push(name.text);
        let body = self.any_of();
        self.variables.pop();
        Ok(Expr::Loop(kind, values, Box::new(body?)))
    }

    /// `NAME:`; none if there is no such source.
    fn source(&mut self) -> Result<Option<usize>, Fault> {
        let token = self.take_name("the name of a source")?;
        let names = self.names.sources();
        let found = names.iter().position(|known| *known == token.text);
        if found.is_none() {
            self.faults
                .push(Self::unknown(&token, "the source", &names));
        }
        self.need(":")?;
        Ok(found)
    }

    /// `SOURCE: VALUE over X at Y where CONDITION by A, B`.
    fn reduction(&mut self, of: &'static Reduction) -> Result<Expr, Fault> {
        let source = self.source()?;
        let totals = of.form == Form::Total;
        let columns = source.map(|source| self.names.columns(source, totals));
        let before = self.faults.len();
        self.scopes.push(columns.unwrap_or_default());
        let mut r = Reduce {
            of,
            source: source.unwrap_or(usize::MAX),
            value: self.any_of()?,
            over: None,
            at: None,
            filter: None,
            by: Vec::new(),
        };
        loop {
            if self.take("over") {
                r.over = Some(self.sum()?);
            } else if self.take("at") {
                r.at = Some(self.sum()?);
            } else if self.take("where") {
                r.filter = Some(self.any_of()?);
            } else if self.take("by") {
                r.by = self.arguments()?;
            } else {
                break;
            }
        }
        self.scopes.pop();
        if source.is_none() {
            // The columns of an unknown source are unknown, too.
            self.faults.truncate(before);
        }
        let (over, at, form) = match of.form {
            Form::OverAt => (true, true, "VALUE over COLUMN at NUMBER)"),
            Form::Over => (true, false, "VALUE over COLUMN), without `at`"),
            _ => (false, false, "VALUE), without `over` and `at`"),
        };
        if r.over.is_some() == over && r.at.is_some() == at {
            return Ok(Expr::Reduce(Box::new(r)));
        }
        let hint = format!("write {}(SOURCE: {form}", of.name);
        Err(self.refused("another form", hint))
    }

    /// `key(PATH)`, `key(SOURCE: PATH)`, `key(SOURCE: PATH, INDEX)`.
    fn key(&mut self) -> Result<Expr, Fault> {
        let source = match self.colon_follows() {
            true => self.source()?.or(Some(usize::MAX)),
            false => None,
        };
        let token = self.take_name("a key such as transmission.cvt.ratio.low")?;
        let keys = self.names.keys();
        if !keys.contains(&token.text) {
            let close = near(&token.text, keys.iter().map(String::as_str));
            self.faults.push(Self::unknown(&token, "the key", &close));
        }
        let item = match self.take(",") {
            true => match self.take_number() {
                Some(x) => Some(x as usize),
                None => return Err(self.unexpected("the number of an item, counted from 0")),
            },
            false => None,
        };
        Ok(Expr::Key(source, token.text, item))
    }
}
