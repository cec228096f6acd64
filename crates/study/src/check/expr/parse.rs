//! Tokens to an expression; every name is looked up on the way.

use super::functions::{FUNCTIONS, Form, REDUCTIONS, Reduction, function, reduction};
use super::lexer::{Token, TokenKind};
use super::parser::{Names, Parser, fault};
use super::syntax::{Expr, Fault, Gives, Loop, Order, Reduce};
use cvtcycle_config::near;

/// Deepest nesting of brackets, which limits the recursion.
const MAX_DEPTH: usize = 40;
/// Parses a text.
///
/// # Errors
/// All unknown names, or the first place that cannot be read.
pub fn parse(text: &str, names: &dyn Names) -> Result<Expr, Vec<Fault>> {
    let mut parser = Parser::new(text, names).map_err(|fault| vec![fault])?;
    let result = parser.any_of().and_then(|expr| match parser.peek() {
        TokenKind::End => Ok(expr),
        _ => Err(parser.unexpected("an operator or the end")),
    });
    match result {
        Ok(expr) if parser.faults.is_empty() && has_inner_range(&expr) => Err(vec![Fault {
            at: 0,
            width: text.chars().count().max(1),
            word: text.to_owned(),
            message: "`range` and `span` stand alone, they are no number to go on with".to_owned(),
            hint: "use min(...) or max(...) within a larger expression".to_owned(),
        }]),
        Ok(expr) if parser.faults.is_empty() => Ok(expr),
        Ok(_) => Err(parser.faults),
        Err(fault) => Err(parser.faults.into_iter().chain([fault]).collect()),
    }
}

/// True if a range is part of a larger expression: nothing can be computed with it.
fn has_inner_range(expr: &Expr) -> bool {
    let is_range = |part: &Expr| part.gives() == Gives::Range || has_inner_range(part);
    // The numbers of a loop and the columns of groups are not computed with.
    match expr {
        Expr::Loop(_, _, body) => is_range(body),
        Expr::Reduce(r) => [
            Some(&r.value),
            r.over.as_ref(),
            r.at.as_ref(),
            r.filter.as_ref(),
        ]
        .into_iter()
        .flatten()
        .any(is_range),
        _ => expr.parts().into_iter().any(is_range),
    }
}

/// A single part as it is, several as a list.
fn one_or(mut list: Vec<Expr>, several: fn(Vec<Expr>) -> Expr) -> Expr {
    if list.len() > 1 {
        several(list)
    } else {
        list.remove(0)
    }
}

impl Parser<'_> {
    fn any_of(&mut self) -> Result<Expr, Fault> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(Fault {
                message: "brackets nest too deep".to_owned(),
                ..self.unexpected("")
            });
        }
        let mut list = vec![self.all_of()?];
        while self.take_word("or") {
            list.push(self.all_of()?);
        }
        self.depth -= 1;
        Ok(one_or(list, Expr::Or))
    }

    fn all_of(&mut self) -> Result<Expr, Fault> {
        let mut list = vec![self.negated()?];
        while self.take_word("and") {
            list.push(self.negated()?);
        }
        Ok(one_or(list, Expr::And))
    }

    fn negated(&mut self) -> Result<Expr, Fault> {
        let mut negated = false;
        while self.take_word("not") {
            negated = !negated;
        }
        let inner = self.chain()?;
        Ok(if negated {
            Expr::Not(Box::new(inner))
        } else {
            inner
        })
    }

    /// A chain of comparisons, or one sum.
    fn chain(&mut self) -> Result<Expr, Fault> {
        let mut list = vec![self.sum()?];
        let mut orders = Vec::new();
        while let Some(order) = self.order() {
            orders.push(order);
            list.push(self.sum()?);
        }
        Ok(if orders.is_empty() {
            list.remove(0)
        } else {
            Expr::Compare(list, orders)
        })
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
        let found = orders.into_iter().find(|(sign, _)| self.take(sign));
        found.map(|(_, order)| order)
    }

    fn binary(
        &mut self,
        signs: &[&'static str],
        part: fn(&mut Self) -> Result<Expr, Fault>,
    ) -> Result<Expr, Fault> {
        let mut left = part(self)?;
        while let Some(sign) = signs.iter().find(|sign| self.take(sign)) {
            let right = part(self)?;
            let sign = sign.chars().next().unwrap_or('+');
            left = Expr::Binary(sign, Box::new(left), Box::new(right));
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
        // A sequence of signs is counted, without recursion.
        let mut minus = false;
        while self.take("-") {
            minus = !minus;
        }
        let power = self.binary(&["^"], Self::atom)?;
        Ok(if minus {
            Expr::Negate(Box::new(power))
        } else {
            power
        })
    }

    fn atom(&mut self) -> Result<Expr, Fault> {
        if let TokenKind::Number(x) = *self.peek() {
            self.next += 1;
            return Ok(Expr::Number(x));
        }
        if self.take("(") {
            let inner = self.any_of()?;
            self.need(")")?;
            return Ok(inner);
        }
        let (token, name) = self.take_name("a number, a name or a bracket")?;
        if self.take("(") {
            let inner = self.called(&token, &name)?;
            self.need(")")?;
            return Ok(inner);
        }
        Ok(self.named(&token, &name))
    }

    fn named(&mut self, token: &Token, name: &str) -> Expr {
        if name == "pi" {
            return Expr::Number(std::f64::consts::PI);
        }
        if let Some(k) = self.variables.iter().position(|variable| variable == name) {
            return Expr::Variable(k);
        }
        if let Some(columns) = self.scopes.last().cloned() {
            if let Some(k) = columns.iter().position(|column| *column == name) {
                return Expr::Column(k);
            }
            self.unknown(token, "the column", &columns);
        } else {
            let hint =
                "a name is written within a reduction such as max(SOURCE: COLUMN)".to_owned();
            let message = format!("`{name}` is outside of any source");
            self.faults.push(fault(token, name, message, hint));
        }
        Expr::Number(f64::NAN)
    }

    /// Everything with a name and a bracket.
    fn called(&mut self, token: &Token, name: &str) -> Result<Expr, Fault> {
        match name {
            "key" => return self.key(),
            "prev" => return Ok(Expr::Previous(Box::new(self.any_of()?))),
            "each" => return self.looped(Loop::Each),
            "span" => return self.looped(Loop::Span),
            _ => {}
        }
        let of_source = matches!(self.peek(), TokenKind::Name(_)) && self.colon_follows();
        let reduction = reduction(name);
        if let Some(reduction) = reduction.filter(|_| of_source) {
            return self.reduction(reduction);
        }
        let Some(function) = function(name) else {
            if reduction.is_some() {
                return Err(Fault {
                    hint: format!("write {name}(SOURCE: COLUMN)"),
                    ..self.unexpected("the name of a source and `:`")
                });
            }
            let known: Vec<&str> = (REDUCTIONS.iter().map(|r| r.name))
                .chain(FUNCTIONS.iter().map(|f| f.name))
                .chain(["key", "prev", "each", "span"])
                .collect();
            self.unknown(token, "the function", &known);
            let fault = self.faults.pop();
            return Err(fault.unwrap_or_else(|| self.unexpected("a function")));
        };
        let list = self.arguments()?;
        if (list.len() > 1) == function.several {
            return Ok(Expr::Call(function, list));
        }
        Err(self.unexpected(if function.several {
            "more arguments, or `SOURCE:`"
        } else {
            "one argument"
        }))
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
        let (_, name) = self.take_name("a name, as in each(t in 25, 95: ...)")?;
        if !self.take_word("in") {
            return Err(self.unexpected("`in`"));
        }
        let values = self.arguments()?;
        self.need(":")?;
        self.variables.push(name);
        let body = self.any_of();
        self.variables.pop();
        Ok(Expr::Loop(kind, values, Box::new(body?)))
    }

    /// `NAME:`; none if there is no such source.
    fn source(&mut self) -> Result<Option<usize>, Fault> {
        let (token, name) = self.take_name("the name of a source")?;
        let names = self.names.sources();
        let found = names.iter().position(|known| *known == name);
        if found.is_none() {
            self.unknown(&token, "the source", &names);
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
            if self.take_word("over") {
                r.over = Some(self.sum()?);
            } else if self.take_word("at") {
                r.at = Some(self.sum()?);
            } else if self.take_word("where") {
                r.filter = Some(self.any_of()?);
            } else if self.take_word("by") {
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
        Err(Fault {
            hint: format!("write {}(SOURCE: {form}", of.name),
            ..self.unexpected("another form")
        })
    }

    /// `key(PATH)`, `key(SOURCE: PATH)`, `key(SOURCE: PATH, INDEX)`.
    fn key(&mut self) -> Result<Expr, Fault> {
        let source = if self.colon_follows() {
            self.source()?.or(Some(usize::MAX))
        } else {
            None
        };
        let (token, path) = self.take_name("a key such as transmission.cvt.ratio.low")?;
        let keys = self.names.keys();
        if !keys.contains(&path) {
            let close = near(&path, keys.iter().map(String::as_str));
            self.unknown(&token, "the key", &close);
        }
        let mut item = None;
        if self.take(",") {
            let TokenKind::Number(x) = *self.peek() else {
                return Err(self.unexpected("the number of an item, counted from 0"));
            };
            self.next += 1;
            item = Some(x as usize);
        }
        Ok(Expr::Key(source, path, item))
    }
}
