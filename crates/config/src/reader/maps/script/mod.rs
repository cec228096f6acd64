//! Tables of numbers in a MATLAB script, as ADVISOR and the engine maps of the EPA have them.
//!
//! Read are assignments of numbers, matrices, ranges, sums and products of them, and the functions that such files use. Bodies of `if`, `for` and other
//! blocks are passed over, and a name whose value cannot be found has none.
//!
//! | file | content |
//! |---|---|
//! | `matrix` | matrices of numbers |
//! | `tokens` | statements in tokens |
//! | `parser` | values of expressions |
//! | `functions` | functions, and parts of matrices |

mod functions;
mod matrix;
mod parser;
mod tokens;

pub(super) use matrix::Matrix;

use matrix::MOST;
use parser::Parser;
use tokens::{Statement, Token, statements};

use std::collections::HashMap;

/// The values of a script.
#[derive(Debug, Default)]
pub(super) struct Script {
    values: HashMap<String, Matrix>,
    /// Line of the last assignment of each name that has no value.
    unread: HashMap<String, usize>,
    /// Line of an assignment of a name in a block.
    in_blocks: HashMap<String, usize>,
}

impl Script {
    /// Reads a script.
    pub fn new(text: &str) -> Script {
        let mut script = Script::default();
        let mut depth = 0usize;
        for statement in statements(text) {
            let first = statement.tokens.first().map(|(token, _)| token);
            if let Some(Token::Name(word)) = first {
                match word.as_str() {
                    "if" | "for" | "while" | "switch" | "try" | "function" | "parfor" => {
                        // A function of a file without `end` has the rest as its body.
                        depth += usize::from(word != "function");
                        let ends =
                            |(token, _): &(Token, usize)| *token == Token::Name("end".to_owned());
                        depth -= usize::from(
                            depth > 0
                                && statement.tokens.iter().skip(1).any(ends)
                                && word != "function",
                        );
                        continue;
                    }
                    "end" => {
                        depth = depth.saturating_sub(1);
                        continue;
                    }
                    _ => {}
                }
            }
            match (depth, statement.tokens.as_slice()) {
                (0, _) => script.run(&statement),
                (_, [(Token::Name(name), line), rest @ ..])
                    if rest.iter().any(|(token, _)| *token == Token::Sign('=')) =>
                {
                    script.in_blocks.insert(name.clone(), *line);
                }
                _ => {}
            }
        }
        script
    }

    /// The value of a name; with a `*` in front that of any name which ends so.
    pub fn find(&self, name: &str) -> Option<(&str, &Matrix)> {
        let end = name.strip_prefix('*');
        let mut found: Vec<(&String, &Matrix)> = self
            .values
            .iter()
            .filter(|(own, _)| match end {
                Some(end) => own.ends_with(end),
                None => *own == name,
            })
            .collect();
        found.sort_by_key(|(own, _)| *own);
        let (own, matrix) = found.first()?;
        Some((own.as_str(), matrix))
    }

    /// Line of a block in which a name gets another value, which is passed over.
    pub fn in_block(&self, name: &str) -> Option<usize> {
        self.in_blocks.get(name).copied()
    }

    /// Line at which a name gets a value that cannot be found.
    pub fn unread(&self, name: &str) -> Option<usize> {
        self.unread.get(name).copied()
    }

    /// The value of an expression of the script's names.
    pub fn value(&self, text: &str) -> Option<Matrix> {
        let statement = statements(text).into_iter().next()?;
        let mut parser = Parser::new(self, &statement.tokens);
        let value = parser.sum()?;
        parser.is_at_end().then_some(value)
    }

    fn run(&mut self, statement: &Statement) {
        let tokens = &statement.tokens;
        let Some(equals) = tokens
            .iter()
            .position(|(token, _)| *token == Token::Sign('='))
        else {
            return;
        };
        let (left, right) = (&tokens[..equals], &tokens[equals + 1..]);
        let line = tokens.first().map_or(0, |(_, line)| *line);
        let name_of = |tokens: &[(Token, usize)]| match tokens {
            [(Token::Name(name), _)] => Some(name.clone()),
            _ => None,
        };
        if let Some(name) = name_of(left) {
            let mut parser = Parser::new(self, right);
            let value = parser.sum().filter(|_| parser.is_at_end());
            match value {
                Some(value) => {
                    self.unread.remove(&name);
                    self.values.insert(name, value);
                }
                None => {
                    self.values.remove(&name);
                    self.unread.insert(name, line);
                }
            }
            return;
        }
        let names: Vec<&String> = left
            .iter()
            .filter_map(|(token, _)| match token {
                Token::Name(name) => Some(name),
                _ => None,
            })
            .collect();
        let is_call = matches!(right, [(Token::Name(word), _), ..] if word == "meshgrid");
        if let ([x, y], true) = (names.as_slice(), is_call) {
            let (x, y) = ((*x).clone(), (*y).clone());
            let mut parser = Parser::new(self, &right[1..]);
            if let Some([across, down]) = parser
                .arguments()
                .and_then(|all| <[Matrix; 2]>::try_from(all).ok())
            {
                let (columns, rows) = (across.values.len(), down.values.len());
                if rows * columns > MOST {
                    return;
                }
                let grid = |of: &dyn Fn(usize) -> f64| Matrix {
                    rows,
                    columns,
                    values: (0..rows * columns).map(of).collect(),
                    lines: vec![line; rows],
                };
                self.values.insert(x, grid(&|k| across.values[k % columns]));
                self.values.insert(y, grid(&|k| down.values[k / columns]));
                return;
            }
        }
        // A part of a matrix, or several values: what they were is not known any more.
        for name in left.iter().take(1).filter_map(|(token, _)| match token {
            Token::Name(name) => Some(name.clone()),
            _ => None,
        }) {
            self.values.remove(&name);
            self.unread.insert(name, line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand.
    #[test]
    fn expressions_have_their_values() {
        let script = Script::new(
            "% a comment\na=[1 2\n3 -4]; b = 2*pi/60;\nc=[0.5:0.5:2]*1000; % rpm\nd=a';\ne=[1 - 2, 3 -4 ...\n 5];\nf=a(1,:)/2; g=[a;5 6]; h='it''s';\n\
             [T,w]=meshgrid([1 2 3],[10 20]);\nk=T.*w/10;\nl=a(:,2)';\nm.n_Nm=[1,2;3,4];\nif 0\na=7;\nend\no=ones(2,3)*4;\np=unknown(3);\nq=flipud(a);\nr=c(end);\n",
        );
        let values = |name: &str| script.find(name).map(|(_, found)| found.values.clone());
        assert_eq!(values("a"), Some(vec![1.0, 2.0, 3.0, -4.0]));
        assert_eq!(
            script.find("a").map(|(_, a)| a.lines.clone()),
            Some(vec![2, 3])
        );
        assert_eq!(values("b"), Some(vec![std::f64::consts::PI * 2.0 / 60.0]));
        assert_eq!(values("c"), Some(vec![500.0, 1000.0, 1500.0, 2000.0]));
        assert_eq!(values("d"), Some(vec![1.0, 3.0, 2.0, -4.0]));
        assert_eq!(values("e"), Some(vec![-1.0, 3.0, -4.0, 5.0]));
        assert_eq!(values("f"), Some(vec![0.5, 1.0]));
        assert_eq!(values("g"), Some(vec![1.0, 2.0, 3.0, -4.0, 5.0, 6.0]));
        assert_eq!(values("k"), Some(vec![1.0, 2.0, 3.0, 2.0, 4.0, 6.0]));
        assert_eq!(values("l"), Some(vec![2.0, -4.0]));
        assert_eq!(values("*.n_Nm"), Some(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(values("o"), Some(vec![4.0; 6]));
        assert_eq!(values("q"), Some(vec![3.0, -4.0, 1.0, 2.0]));
        assert_eq!(values("r"), Some(vec![2000.0]));
        assert_eq!((values("p"), script.unread("p")), (None, Some(17)));
        assert_eq!(
            script.value("a/2").map(|a| a.values),
            Some(vec![0.5, 1.0, 1.5, -2.0])
        );
    }
}
