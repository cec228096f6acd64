//! The attribute `physics`.

use proc_macro2::TokenStream;
use quote::ToTokens;
use syn::visit_mut::{self, VisitMut};
use syn::{
    Attribute, Error, Expr, ExprArray, ExprCall, ExprMethodCall, ImplItemFn, Item, ItemFn,
    TraitItemFn, parse_quote,
};

/// Adds the attributes of inlining to an item.
pub fn expand(mut item: Item) -> TokenStream {
    match &mut item {
        Item::Fn(function) => Inline.visit_item_fn_mut(function),
        Item::Impl(block) => Inline.visit_item_impl_mut(block),
        Item::Trait(block) => Inline.visit_item_trait_mut(block),
        other => {
            let message = "`physics` applies to a function, an `impl` block or a trait";
            return Error::new_spanned(other, message).into_compile_error();
        }
    }
    item.into_token_stream()
}

/// Marks functions with bodies, and closures that are arguments: elsewhere the language allows no attribute on an expression.
struct Inline;

impl Inline {
    fn mark(attributes: &mut Vec<Attribute>) {
        if !attributes.iter().any(|a| a.path().is_ident("inline")) {
            attributes.push(parse_quote!(#[inline(always)]));
        }
    }

    fn mark_closures<'a>(arguments: impl Iterator<Item = &'a mut Expr>) {
        for argument in arguments {
            if let Expr::Closure(closure) = argument {
                Self::mark(&mut closure.attrs);
            }
        }
    }
}

impl VisitMut for Inline {
    fn visit_item_fn_mut(&mut self, function: &mut ItemFn) {
        Self::mark(&mut function.attrs);
        visit_mut::visit_item_fn_mut(self, function);
    }

    fn visit_impl_item_fn_mut(&mut self, function: &mut ImplItemFn) {
        Self::mark(&mut function.attrs);
        visit_mut::visit_impl_item_fn_mut(self, function);
    }

    fn visit_trait_item_fn_mut(&mut self, function: &mut TraitItemFn) {
        if function.default.is_some() {
            Self::mark(&mut function.attrs);
        }
        visit_mut::visit_trait_item_fn_mut(self, function);
    }

    fn visit_expr_call_mut(&mut self, call: &mut ExprCall) {
        Self::mark_closures(call.args.iter_mut());
        visit_mut::visit_expr_call_mut(self, call);
    }

    fn visit_expr_method_call_mut(&mut self, call: &mut ExprMethodCall) {
        Self::mark_closures(call.args.iter_mut());
        visit_mut::visit_expr_method_call_mut(self, call);
    }

    fn visit_expr_array_mut(&mut self, array: &mut ExprArray) {
        Self::mark_closures(array.elems.iter_mut());
        visit_mut::visit_expr_array_mut(self, array);
    }
}
