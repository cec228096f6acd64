//! Words to an expression, every name looked up on the way.

use super::words::{What, Word, words};
use super::{Expr, Fault, Gives, Order};
use cvtcycle_config::near;

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

/// The state of the parsing.
pub struct Parser<'a> {
    pub(super) words: Vec<Word>,
    pub(super) next: usize,
    pub(super) names: &'a dyn Names,
    /// Columns in force, innermost reduction last.
    pub(super) scopes: Vec<Vec<&'static str>>,
    pub(super) variables: Vec<String>,
    depth: usize,
    /// Unknown names, which do not stop the parsing.
    pub(super) faults: Vec<Fault>,
}

/// Parses a text.
///
/// # Errors
/// All unknown names, or the first place that cannot be read.
pub fn parse(text: &str, names: &dyn Names) -> Result<Expr, Vec<Fault>> {
    let words = words(text).map_err(|fault| vec![fault])?;
    let mut parser = Parser {
        words,
        next: 0,
        names,
        scopes: Vec::new(),
        variables: Vec::new(),
        depth: 0,
        faults: Vec::new(),
    };
    let result = parser.any_of().and_then(|expr| {
        if parser.peek() == &What::End {
            Ok(expr)
        } else {
            Err(parser.unexpected("an operator or the end"))
        }
    });
    match result {
        Ok(expr) if parser.faults.is_empty() => {
            lone_ranges(&expr, true).map(|()| expr).map_err(|message| {
                vec![Fault {
                    at: 0,
                    width: text.chars().count().max(1),
                    word: text.to_owned(),
                    message,
                    hint: "use min(...) or max(...) within a larger expression".to_owned(),
                }]
            })
        }
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
        Expr::Compare(list, _) | Expr::And(list) | Expr::Or(list) | Expr::Call(_, list) => {
            list.iter().collect()
        }
        Expr::Reduce(r) => [
            Some(&r.value),
            r.over.as_ref(),
            r.at.as_ref(),
            r.filter.as_ref(),
        ]
        .into_iter()
        .flatten()
        .collect(),
        Expr::Number(_) | Expr::Column(_) | Expr::Variable(_) | Expr::Key(..) => Vec::new(),
    };
    parts
        .into_iter()
        .try_for_each(|part| lone_ranges(part, false))
}

impl Parser<'_> {
    pub(super) fn peek(&self) -> &What {
        self.words
            .get(self.next)
            .map_or(&What::End, |word| &word.what)
    }

    pub(super) fn word(&self) -> Word {
        self.words.get(self.next).cloned().unwrap_or(Word {
            what: What::End,
            at: 0,
            width: 1,
        })
    }

    pub(super) fn take(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), What::Sign(s) if *s == sign);
        self.next += usize::from(found);
        found
    }

    pub(super) fn take_name(&mut self, name: &str) -> bool {
        let found = matches!(self.peek(), What::Name(n) if n == name);
        self.next += usize::from(found);
        found
    }

    pub(super) fn need(&mut self, sign: &str) -> Result<(), Fault> {
        if self.take(sign) {
            Ok(())
        } else {
            Err(self.unexpected(&format!("`{sign}`")))
        }
    }

    pub(super) fn unexpected(&self, wanted: &str) -> Fault {
        let word = self.word();
        let text = match &word.what {
            What::Number(x) => x.to_string(),
            What::Name(name) => name.clone(),
            What::Sign(sign) => (*sign).to_owned(),
            What::End => String::new(),
        };
        let found = if text.is_empty() {
            "the end".to_owned()
        } else {
            format!("`{text}`")
        };
        let message = format!("expected {wanted}, found {found}");
        Fault {
            at: word.at,
            width: word.width,
            word: text,
            message,
            hint: String::new(),
        }
    }

    /// Notes an unknown name and goes on.
    pub(super) fn unknown(&mut self, word: &Word, name: &str, what: &str, known: &[&str]) {
        let close = near(name, known.iter().copied());
        let quoted: Vec<String> = close.iter().map(|n| format!("`{n}`")).collect();
        let hint = match (close.is_empty(), known.len()) {
            (false, _) => format!("did you mean {}?", quoted.join(" or ")),
            (true, 0) => String::new(),
            (true, _) => format!(
                "known here: {}",
                known
                    .iter()
                    .take(40)
                    .copied()
                    .collect::<Vec<_>>()
                    .join(", ")
            ),
        };
        self.faults.push(Fault {
            at: word.at,
            width: word.width,
            word: name.to_owned(),
            message: format!("{what} `{name}` is not known"),
            hint,
        });
    }

    pub(super) fn any_of(&mut self) -> Result<Expr, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Fault {
                message: "brackets nest too deep".to_owned(),
                ..self.unexpected("")
            });
        }
        let mut list = vec![self.all_of()?];
        while self.take_name("or") {
            list.push(self.all_of()?);
        }
        self.depth -= 1;
        Ok(if list.len() > 1 {
            Expr::Or(list)
        } else {
            list.remove(0)
        })
    }

    fn all_of(&mut self) -> Result<Expr, Fault> {
        let mut list = vec![self.compared()?];
        while self.take_name("and") {
            list.push(self.compared()?);
        }
        Ok(if list.len() > 1 {
            Expr::And(list)
        } else {
            list.remove(0)
        })
    }

    fn compared(&mut self) -> Result<Expr, Fault> {
        let mut denied = false;
        while self.take_name("not") {
            denied = !denied;
        }
        let inner = self.chain()?;
        Ok(if denied {
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
        orders
            .into_iter()
            .find(|(sign, _)| self.take(sign))
            .map(|(_, order)| order)
    }

    fn binary(
        &mut self,
        signs: &[&'static str],
        part: fn(&mut Self) -> Result<Expr, Fault>,
    ) -> Result<Expr, Fault> {
        let mut left = part(self)?;
        while let Some(sign) = signs.iter().find(|sign| self.take(sign)) {
            let right = part(self)?;
            left = Expr::Binary(
                sign.chars().next().unwrap_or('+'),
                Box::new(left),
                Box::new(right),
            );
        }
        Ok(left)
    }

    pub(super) fn sum(&mut self) -> Result<Expr, Fault> {
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
        Ok(if minus {
            Expr::Negate(Box::new(power))
        } else {
            power
        })
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
                let hint =
                    "a name stands within a reduction such as max(SOURCE: COLUMN)".to_owned();
                let message = format!("`{name}` stands outside of any source");
                self.faults.push(Fault {
                    at: word.at,
                    width: word.width,
                    word: name.to_owned(),
                    message,
                    hint,
                });
            }
        }
        Expr::Number(f64::NAN)
    }
}
