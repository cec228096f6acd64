//! Tokens one by one, and the faults found on the way.

use super::lexer::{Token, TokenKind, tokens};
use super::syntax::Fault;
use cvtcycle_config::did_you_mean;

/// The names that an expression may use.
pub trait Names {
    /// Names of all sources.
    fn sources(&self) -> Vec<&str>;
    /// Columns of a source, or of its totals.
    fn columns(&self, source: usize, totals: bool) -> Vec<&'static str>;
    /// Known keys of vehicles and fluids.
    fn keys(&self) -> &[String];
}

/// Most known names in a hint.
const MAX_LISTED: usize = 40;

pub struct Parser<'a> {
    pub tokens: Vec<Token>,
    pub next: usize,
    pub names: &'a dyn Names,
    /// Columns of the reductions, the innermost last.
    pub scopes: Vec<Vec<&'static str>>,
    pub variables: Vec<String>,
    pub depth: usize,
    /// Unknown names, which do not stop the parsing.
    pub faults: Vec<Fault>,
}

impl<'a> Parser<'a> {
    pub fn new(text: &str, names: &'a dyn Names) -> Result<Self, Fault> {
        Ok(Parser {
            tokens: tokens(text)?,
            next: 0,
            names,
            scopes: Vec::new(),
            variables: Vec::new(),
            depth: 0,
            faults: Vec::new(),
        })
    }

    pub fn token(&self) -> Token {
        self.tokens[self.next.min(self.tokens.len() - 1)].clone()
    }

    pub fn peek(&self) -> &TokenKind {
        &self.tokens[self.next.min(self.tokens.len() - 1)].kind
    }

    /// True if the token behind the next one is a colon.
    pub fn colon_follows(&self) -> bool {
        let second = self.tokens.get(self.next + 1);
        second.is_some_and(|token| token.kind == TokenKind::Sign(":"))
    }

    pub fn take(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), TokenKind::Sign(s) if *s == sign);
        self.next += usize::from(found);
        found
    }

    pub fn take_word(&mut self, word: &str) -> bool {
        let found = matches!(self.peek(), TokenKind::Name(n) if n == word);
        self.next += usize::from(found);
        found
    }

    /// Takes a name with its place.
    pub fn take_name(&mut self, wanted: &str) -> Result<(Token, String), Fault> {
        let token = self.token();
        let TokenKind::Name(name) = &token.kind else {
            return Err(self.unexpected(wanted));
        };
        let name = name.clone();
        self.next += 1;
        Ok((token, name))
    }

    pub fn need(&mut self, sign: &str) -> Result<(), Fault> {
        if self.take(sign) {
            Ok(())
        } else {
            Err(self.unexpected(&format!("`{sign}`")))
        }
    }

    pub fn unexpected(&self, wanted: &str) -> Fault {
        let token = self.token();
        let word = token.kind.text();
        let found = if word.is_empty() {
            "the end".to_owned()
        } else {
            format!("`{word}`")
        };
        let message = format!("expected {wanted}, found {found}");
        fault(&token, &word, message, String::new())
    }

    /// Records an unknown name; the parsing goes on.
    pub fn unknown(&mut self, token: &Token, what: &str, known: &[&str]) {
        let name = token.kind.text();
        let hint = match (did_you_mean(&name, known.iter().copied()), known.len()) {
            (Some(question), _) => question,
            (None, 0) => String::new(),
            (None, n) => format!("known here: {}", known[..n.min(MAX_LISTED)].join(", ")),
        };
        let message = format!("{what} `{name}` is not known");
        self.faults.push(fault(token, &name, message, hint));
    }
}

pub fn fault(token: &Token, word: &str, message: String, hint: String) -> Fault {
    Fault {
        at: token.at,
        width: token.width,
        word: word.to_owned(),
        message,
        hint,
    }
}
