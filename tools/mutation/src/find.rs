//! Finds the places of one file that can be changed.

use crate::config::Methods;
use crate::point::{Choice, Point, Shape};
use proc_macro2::Span;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use syn::spanned::Spanned as _;
use syn::visit::{self, Visit};
use syn::{BinOp, Expr, Lit, ReturnType, Type, UnOp};

/// What is known of a file before its points are looked for.
pub struct Source<'a> {
    /// Path from the root of the repository.
    pub file: &'a str,
    /// Its text.
    pub text: &'a str,
    /// Names of all constants of type f64.
    pub constants: &'a BTreeSet<String>,
    /// Methods that are changed.
    pub methods: &'a Methods,
    /// Whether literals are left alone: in files that read input they are bounds and defaults.
    pub keep_literals: bool,
}

/// All points of a file, in the order of their numbers, which begin at `first`.
///
/// # Errors
/// The file is no Rust.
pub fn points(source: &Source, first: u32) -> Result<Vec<Point>, String> {
    let tree = syn::parse_file(source.text).map_err(|e| format!("{}: {e}", source.file))?;
    let mut finder = Finder {
        source,
        function: Vec::new(),
        points: Vec::new(),
        next: first,
        seen: HashMap::new(),
    };
    finder.visit_file(&tree);
    Ok(finder.points)
}

/// The last part of the module path of a file.
fn module(file: &str) -> &str {
    let path = file.trim_end_matches(".rs").trim_end_matches("/mod");
    path.rsplit('/').next().unwrap_or(path)
}

/// Names of constants of type f64 in a file.
#[must_use]
pub fn constants(text: &str) -> Vec<String> {
    let names = text.lines().filter_map(|line| {
        let (_, rest) = line.split_once("const ")?;
        let (name, kind) = rest.split_once(':')?;
        kind.trim_start()
            .starts_with("f64")
            .then(|| name.trim().to_owned())
    });
    names.collect()
}

struct Finder<'a> {
    source: &'a Source<'a>,
    /// Type and function around.
    function: Vec<String>,
    points: Vec<Point>,
    next: u32,
    seen: HashMap<(String, String), usize>,
}

impl Finder<'_> {
    fn add(
        &mut self,
        span: Range<usize>,
        text: &str,
        shape: Shape,
        was: &str,
        with: &[(&str, String)],
    ) {
        let file = self.source.file.to_owned();
        let item = format!("{}::{}", module(&file), self.function.join("::"));
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let text = if text.chars().count() > 90 {
            text.chars().take(87).collect::<String>() + "..."
        } else {
            text
        };
        let line = self.source.text[..span.start].matches('\n').count() + 1;
        let kind = with.first().map_or("", |w| &w.1);
        let seen = self
            .seen
            .entry((item.clone(), format!("{text}{kind}")))
            .or_default();
        let nth = *seen;
        *seen += 1;
        let mut choices = Vec::new();
        for (with, mutation) in with {
            choices.push(Choice {
                number: self.next,
                mutation: mutation.clone(),
                with: (*with).to_owned(),
            });
            self.next += 1;
        }
        self.points.push(Point {
            file,
            line,
            item,
            text,
            nth,
            span,
            shape,
            was: was.to_owned(),
            choices,
        });
    }

    fn text(&self, range: &Range<usize>) -> String {
        self.source.text[range.clone()].to_owned()
    }

    /// Adds an expression whose mutants replace one operator or name by another.
    fn replace(&mut self, node: &Expr, shape: Shape, was: &str, with: &[&str]) {
        let span = bytes(node.span());
        let text = self.text(&span);
        let word = |w: &str| {
            if w.trim().is_empty() {
                "nothing".to_owned()
            } else {
                w.to_owned()
            }
        };
        let with: Vec<_> = with
            .iter()
            .map(|w| (*w, format!("{was} -> {}", word(w))))
            .collect();
        self.add(span, &text, shape, was, &with);
    }

    fn binary(&mut self, node: &syn::ExprBinary, whole: &Expr) {
        let op = bytes(node.op.span());
        let was = self.text(&op);
        let with: &[&str] = match node.op {
            BinOp::Add(_) => &["-"],
            BinOp::Sub(_) => &["+"],
            BinOp::Mul(_) => &["/"],
            BinOp::Div(_) => &["*"],
            BinOp::Rem(_) => &["/"],
            BinOp::Lt(_) => &["<=", ">="],
            BinOp::Le(_) => &["<", ">"],
            BinOp::Gt(_) => &[">=", "<="],
            BinOp::Ge(_) => &[">", "<"],
            BinOp::Eq(_) => &["!="],
            BinOp::Ne(_) => &["=="],
            BinOp::And(_) => &["||"],
            BinOp::Or(_) => &["&&"],
            BinOp::BitAnd(_) => &["|"],
            BinOp::BitOr(_) => &["&"],
            BinOp::AddAssign(_) => &["-="],
            BinOp::SubAssign(_) => &["+="],
            BinOp::MulAssign(_) => &["/="],
            BinOp::DivAssign(_) => &["*="],
            _ => return,
        };
        let shape = match node.op {
            BinOp::Add(_)
            | BinOp::Sub(_)
            | BinOp::Mul(_)
            | BinOp::Div(_)
            | BinOp::Rem(_)
            | BinOp::BitAnd(_)
            | BinOp::BitOr(_) => Shape::Values { op },
            BinOp::And(_) | BinOp::Or(_) => Shape::Logic {
                op,
                and: matches!(node.op, BinOp::And(_)),
            },
            BinOp::AddAssign(_)
            | BinOp::SubAssign(_)
            | BinOp::MulAssign(_)
            | BinOp::DivAssign(_) => Shape::Assigned { op },
            _ => Shape::Compared { op },
        };
        self.replace(whole, shape, &was, with);
    }

    fn method(&mut self, node: &syn::ExprMethodCall, whole: &Expr) {
        let name = node.method.to_string();
        let value = bytes(node.receiver.span());
        let arguments: Vec<Range<usize>> = node.args.iter().map(|a| bytes(a.span())).collect();
        let methods = self.source.methods;
        match (name.as_str(), arguments.as_slice()) {
            (_, [right]) if methods.replace.contains_key(&name) => {
                let shape = Shape::Method {
                    between: value.end..right.start,
                    right_end: right.end,
                };
                let with: Vec<&str> = methods.replace[&name].iter().map(String::as_str).collect();
                self.replace(whole, shape, &name, &with);
            }
            (_, [yes, no]) if methods.swap.contains(&name) => {
                let values = [value, yes.clone(), no.clone()];
                let (function, method) = (String::new(), name.clone());
                self.swapped(whole, function, method, values);
            }
            ("powi", [exponent]) if !self.source.keep_literals => {
                let was = self.text(exponent);
                let more = format!("{was} + 1");
                let text = self.text(&bytes(whole.span()));
                self.add(
                    exponent.clone(),
                    &text,
                    Shape::Leaf,
                    &was,
                    &[(&more, format!("power {was} -> {more}"))],
                );
            }
            _ if methods.drop.contains(&name) => {
                let value_end = value.end;
                self.replace(whole, Shape::Dropped { value_end }, &name, &[""]);
            }
            _ => {}
        }
    }

    /// `R::select(mask, yes, no)`: the method by its path.
    fn call(&mut self, node: &syn::ExprCall, whole: &Expr) {
        let Expr::Path(path) = &*node.func else {
            return;
        };
        let name = path.path.segments.last().map(|s| s.ident.to_string());
        let values: Vec<Range<usize>> = node.args.iter().map(|a| bytes(a.span())).collect();
        if let (Some(name), [mask, yes, no]) = (name, values.as_slice())
            && self.source.methods.swap.contains(&name)
        {
            let function = self.text(&(bytes(whole.span()).start..mask.start));
            let values = [mask.clone(), yes.clone(), no.clone()];
            self.swapped(whole, function, String::new(), values);
        }
    }

    fn swapped(
        &mut self,
        whole: &Expr,
        function: String,
        method: String,
        values: [Range<usize>; 3],
    ) {
        let span = bytes(whole.span());
        let text = self.text(&span);
        let shape = Shape::Swapped {
            function,
            method,
            values,
        };
        self.add(span, &text, shape, "", &[("", "values exchanged".into())]);
    }

    fn literal(&mut self, node: &syn::ExprLit, whole: &Expr) {
        if self.source.keep_literals {
            return;
        }
        let span = bytes(node.span());
        let was = self.text(&span);
        match &node.lit {
            Lit::Float(value) if value.base10_parse::<f64>().is_ok_and(|v| v > 0.0) => {
                self.larger(whole);
            }
            Lit::Bool(value) => self.replace(
                whole,
                Shape::Leaf,
                &was,
                &[if value.value { "false" } else { "true" }],
            ),
            _ => {}
        }
    }

    /// Adds a number that becomes 1.05 times as large. By a function: in generic code the type of the product would have to be guessed.
    fn larger(&mut self, whole: &Expr) {
        let span = bytes(whole.span());
        let was = self.text(&span);
        let with = format!("crate::mutant::larger({was})");
        let words = format!("{was} -> {was} * 1.05");
        self.add(span, &was, Shape::Leaf, &was, &[(&with, words)]);
    }

    fn constant(&mut self, node: &syn::ExprPath, whole: &Expr) {
        let known = node
            .path
            .segments
            .last()
            .is_some_and(|s| self.source.constants.contains(&s.ident.to_string()));
        let std = self.text(&bytes(node.span())).contains("consts::");
        if (known || std) && !self.source.keep_literals {
            self.larger(whole);
        }
    }

    fn condition(&mut self, cond: &Expr) {
        let plain = matches!(
            cond,
            Expr::MethodCall(_) | Expr::Call(_) | Expr::Path(_) | Expr::Field(_) | Expr::Macro(_)
        );
        if plain {
            let span = bytes(cond.span());
            let text = self.text(&span);
            self.add(
                span,
                &text,
                Shape::Condition,
                "",
                &[("", "condition -> its opposite".into())],
            );
        }
    }

    fn body(&mut self, sig: &syn::Signature, block: &syn::Block) {
        let open = bytes(block.brace_token.span.open()).end;
        let close = bytes(block.brace_token.span.close()).start;
        let with: &[&str] = match &sig.output {
            ReturnType::Default => &["()"],
            ReturnType::Type(_, kind) => match (&**kind, self.text(&bytes(kind.span())).as_str()) {
                (_, "f64") => &["0.0", "1.0", "-1.0"],
                (_, "bool") => &["true", "false"],
                (Type::Path(p), _)
                    if p.path.segments.last().is_some_and(|s| s.ident == "Option") =>
                {
                    &["None"]
                }
                _ => return,
            },
        };
        if block.stmts.is_empty() {
            return;
        }
        let with: Vec<_> = with.iter().map(|w| (*w, format!("body -> {w}"))).collect();
        self.add(open..close, "fn", Shape::Body, "", &with);
    }

    fn function(&mut self, attrs: &[syn::Attribute], sig: &syn::Signature, block: &syn::Block) {
        if sig.constness.is_some() || for_tests(attrs) {
            return;
        }
        self.function.push(sig.ident.to_string());
        self.body(sig, block);
        visit::visit_block(self, block);
        self.function.pop();
    }
}

/// Byte range of a span.
fn bytes(span: Span) -> Range<usize> {
    span.byte_range()
}

fn for_tests(attrs: &[syn::Attribute]) -> bool {
    attrs.iter().any(|a| {
        let test = a.path().is_ident("test");
        let cfg = a.path().is_ident("cfg")
            && a.meta
                .require_list()
                .is_ok_and(|l| l.tokens.to_string() == "test");
        test || cfg
    })
}

/// Whether a condition binds names: it cannot be split then.
fn binds(e: &Expr) -> bool {
    match e {
        Expr::Let(_) => true,
        Expr::Binary(b) => binds(&b.left) || binds(&b.right),
        Expr::Paren(p) => binds(&p.expr),
        _ => false,
    }
}

fn assigns(op: &BinOp) -> bool {
    matches!(
        op,
        BinOp::AddAssign(_) | BinOp::SubAssign(_) | BinOp::MulAssign(_) | BinOp::DivAssign(_)
    )
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item_fn(&mut self, node: &'ast syn::ItemFn) {
        self.function(&node.attrs, &node.sig, &node.block);
    }

    fn visit_impl_item_fn(&mut self, node: &'ast syn::ImplItemFn) {
        self.function(&node.attrs, &node.sig, &node.block);
    }

    fn visit_trait_item_fn(&mut self, node: &'ast syn::TraitItemFn) {
        if let Some(block) = &node.default {
            self.function(&node.attrs, &node.sig, block);
        }
    }

    fn visit_item_impl(&mut self, node: &'ast syn::ItemImpl) {
        let name = self.source.text[bytes(node.self_ty.span())].to_owned();
        self.function.push(name);
        visit::visit_item_impl(self, node);
        self.function.pop();
    }

    fn visit_item_mod(&mut self, node: &'ast syn::ItemMod) {
        if !for_tests(&node.attrs) {
            visit::visit_item_mod(self, node);
        }
    }

    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_item_macro(&mut self, _: &'ast syn::ItemMacro) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_type(&mut self, _: &'ast Type) {}
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}

    fn visit_expr_repeat(&mut self, node: &'ast syn::ExprRepeat) {
        self.visit_expr(&node.expr);
    }

    fn visit_expr(&mut self, node: &'ast Expr) {
        match node {
            Expr::Binary(b) if !binds(node) => {
                self.binary(b, node);
                if assigns(&b.op) {
                    self.visit_expr(&b.right); // the place is written twice and stays as it is
                    return;
                }
            }
            Expr::Unary(u) if matches!(u.op, UnOp::Neg(_)) => {
                self.replace(
                    node,
                    Shape::Prefixed {
                        op: bytes(u.op.span()),
                    },
                    "-",
                    &[""],
                );
            }
            Expr::Unary(u) if matches!(u.op, UnOp::Not(_)) => {
                self.replace(
                    node,
                    Shape::Prefixed {
                        op: bytes(u.op.span()),
                    },
                    "!",
                    &[""],
                );
            }
            Expr::MethodCall(m) => self.method(m, node),
            Expr::Call(c) => self.call(c, node),
            Expr::Lit(l) => self.literal(l, node),
            Expr::Path(p) => self.constant(p, node),
            Expr::If(i) => self.condition(&i.cond),
            _ => {}
        }
        visit::visit_expr(self, node);
    }
}
