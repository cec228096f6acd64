//! A place in the source that can be changed, what it can be changed to, and how both are written into one text.

use std::ops::Range;

/// The code at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shape {
    /// `left op right` of values: arithmetic.
    Values {
        /// Bytes of the operator.
        op: Range<usize>,
    },
    /// `left op right`, compared through references.
    Compared {
        /// Bytes of the operator.
        op: Range<usize>,
    },
    /// `left && right` or `left || right`.
    Logic {
        /// Bytes of the operator.
        op: Range<usize>,
        /// Whether it is `&&`.
        and: bool,
    },
    /// `place op= right`.
    Assigned {
        /// Bytes of the operator.
        op: Range<usize>,
    },
    /// `-value` or `!value`.
    Prefixed {
        /// Bytes of the operator.
        op: Range<usize>,
    },
    /// `left.max(right)` and other methods of two values.
    Method {
        /// Bytes from the end of the left value to the start of the right one.
        between: Range<usize>,
        /// End of the right value.
        right_end: usize,
    },
    /// `value.abs()`, `value.clamp(low, high)`: the value alone.
    Dropped {
        /// End of the value.
        value_end: usize,
    },
    /// `select(mask, yes, no)` or `mask.select(yes, no)`: the values exchanged.
    Swapped {
        /// The called function with its opening parenthesis; empty for a method.
        function: String,
        /// Name of the method; empty for a function.
        method: String,
        /// Mask, first and second value.
        values: [Range<usize>; 3],
    },
    /// A literal or a constant.
    Leaf,
    /// Condition of an `if`.
    Condition,
    /// The whole body of a function, from its brace on.
    Body,
}

/// One mutant: what is written in place of the original.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Number that switches it on; from 1.
    pub number: u32,
    /// What changes, as people read it: `+ -> -`.
    pub mutation: String,
    /// The replacing operator, method or expression.
    pub with: String,
}

/// A place and its mutants.
#[derive(Clone, Debug)]
pub struct Point {
    /// Path from the root of the repository.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Function around it, with its type and the last part of its module: `fuel::Willans::fuel`.
    pub item: String,
    /// The original expression, with single spaces.
    pub text: String,
    /// Number of earlier points with the same text in the same function.
    pub nth: usize,
    /// Bytes of the whole expression.
    pub span: Range<usize>,
    /// The code there.
    pub shape: Shape,
    /// The original operator, method or expression.
    pub was: String,
    /// The mutants.
    pub choices: Vec<Choice>,
}

impl Point {
    /// Name of a mutant that does not change with edits elsewhere, or when the file moves.
    #[must_use]
    pub fn key(&self, choice: &Choice) -> String {
        let nth = if self.nth > 0 {
            format!(" #{}", self.nth + 1)
        } else {
            String::new()
        };
        format!("{} | {}{nth} | {}", self.item, self.text, choice.mutation)
    }

    /// `if on(1) { a } else if on(2) { b } else { original }`, each written by `write`.
    fn chain(&self, write: impl Fn(&str) -> String) -> String {
        let mut out = String::new();
        for choice in &self.choices {
            out += &format!(
                "if crate::mutant::on({}) {{ {} }} else ",
                choice.number,
                write(&choice.with)
            );
        }
        out + &format!("{{ {} }}", write(&self.was))
    }

    /// The end of `(match (mask, yes, no`: a call with the values exchanged or as they were.
    fn exchanged(&self, function: &str, method: &str) -> String {
        let call = |yes: &str, no: &str| {
            if method.is_empty() {
                format!("{function}m_, {yes}, {no})")
            } else {
                format!("m_.{method}({yes}, {no})")
            }
        };
        let number = self.choices[0].number;
        let (swapped, same) = (call("n_", "y_"), call("y_", "n_"));
        format!(
            ") {{ (m_, y_, n_) => if crate::mutant::on({number}) {{ {swapped} }} else {{ {same} }} }})"
        )
    }

    /// The edits that write original and mutants in place of the original.
    #[must_use]
    pub fn edits(&self, source: &str) -> Vec<Edit> {
        let Range { start, end } = self.span;
        let edit = |range: Range<usize>, text: String| Edit {
            range,
            text,
            outer: self.span.clone(),
        };
        let open = |text: &str| edit(start..start, text.to_owned());
        let close = |text: String| edit(end..end, text);
        match &self.shape {
            Shape::Values { op } => {
                let arms = self.chain(|op| format!("l_ {op} r_"));
                vec![
                    open("(match ("),
                    edit(op.clone(), ",".into()),
                    close(format!(") {{ (l_, r_) => {arms} }})")),
                ]
            }
            Shape::Compared { op } => {
                let arms = self.chain(|op| format!("l_ {op} r_"));
                vec![
                    open("(match (&("),
                    edit(op.clone(), "), &(".into()),
                    close(format!(")) {{ (l_, r_) => {arms} }})")),
                ]
            }
            Shape::Logic { op, and } => {
                let sign = if *and { "!=" } else { "==" };
                let middle = format!(
                    ") {{ l_ => if l_ {sign} crate::mutant::on({}) {{",
                    self.choices[0].number
                );
                vec![
                    open("(match ("),
                    edit(op.clone(), middle),
                    close("} else { l_ } })".into()),
                ]
            }
            Shape::Assigned { op } => {
                let place = source[start..op.start].trim();
                let arms = self.chain(|op| format!("{place} {op} r_;"));
                vec![
                    edit(start..op.end, "(match (".into()),
                    close(format!(") {{ r_ => {arms} }})")),
                ]
            }
            Shape::Prefixed { op } => {
                let arms = self.chain(|op| format!("{op}v_"));
                vec![
                    open("(match ("),
                    edit(op.clone(), String::new()),
                    close(format!(") {{ v_ => {arms} }})")),
                ]
            }
            Shape::Method { between, right_end } => {
                let arms = self.chain(|name| format!("l_.{name}(r_)"));
                vec![
                    open("(match ("),
                    edit(between.clone(), ", ".into()),
                    edit(*right_end..end, format!(") {{ (l_, r_) => {arms} }})")),
                ]
            }
            Shape::Dropped { value_end } => {
                let number = self.choices[0].number;
                vec![
                    open("(match ("),
                    edit(
                        *value_end..*value_end,
                        format!(") {{ v_ => if crate::mutant::on({number}) {{ v_ }} else {{ v_"),
                    ),
                    close(" } })".into()),
                ]
            }
            Shape::Swapped {
                function,
                method,
                values: [mask, yes, no],
            } => {
                let close = self.exchanged(function, method);
                vec![
                    edit(start..mask.start, "(match (".into()),
                    edit(mask.end..yes.start, ", ".into()),
                    edit(yes.end..no.start, ", ".into()),
                    edit(no.end..end, close),
                ]
            }
            Shape::Leaf => vec![edit(start..end, format!("({})", self.chain(str::to_owned)))],
            Shape::Condition => vec![
                open(&format!(
                    "crate::mutant::on({}) != (",
                    self.choices[0].number
                )),
                close(")".into()),
            ],
            Shape::Body => vec![edit(start..start, self.returns())],
        }
    }

    /// `if on(1) { return a; } if on(2) { return b; }`.
    fn returns(&self) -> String {
        let one = |c: &Choice| {
            format!(
                " if crate::mutant::on({}) {{ return {}; }}",
                c.number, c.with
            )
        };
        self.choices.iter().map(one).collect()
    }
}

/// A piece of text in place of some bytes.
#[derive(Clone, Debug)]
pub struct Edit {
    /// Bytes that go.
    pub range: Range<usize>,
    /// What comes.
    pub text: String,
    /// The whole expression that it belongs to.
    pub outer: Range<usize>,
}

/// A file with all its mutants, and the place of each point in it.
#[derive(Debug)]
pub struct Written {
    /// The text.
    pub text: String,
    /// Byte ranges of the points in it, in their order.
    pub ranges: Vec<Range<usize>>,
}

/// Writes all points into the source of one file.
#[must_use]
pub fn write(source: &str, points: &[Point]) -> Written {
    let mut edits: Vec<(usize, Edit)> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        edits.extend(point.edits(source).into_iter().map(|e| (index, e)));
    }
    // At one place: first what ends there, inner before outer, then what begins there, outer before inner, then what is replaced.
    edits.sort_by_key(|(index, e)| {
        let (at, order) = (e.range.start as i64, *index as i64);
        let closes = e.range.end == e.outer.end && e.range.start > e.outer.start;
        if closes {
            (at, 0, -(e.outer.start as i64), -order)
        } else if e.range.is_empty() {
            (at, 1, -(e.outer.end as i64), order)
        } else {
            (at, 2, 0, order)
        }
    });
    let mut text = String::with_capacity(source.len() * 3);
    let mut ranges: Vec<Option<Range<usize>>> = vec![None; points.len()];
    let mut at = 0;
    for (index, e) in &edits {
        if e.range.start > at {
            text += &source[at..e.range.start];
        }
        let from = text.len();
        text += &e.text;
        at = at.max(e.range.end);
        let start = ranges[*index].as_ref().map_or(from, |r| r.start);
        ranges[*index] = Some(start..text.len());
    }
    text += &source[at..];
    Written {
        text,
        ranges: ranges.into_iter().map(Option::unwrap_or_default).collect(),
    }
}
