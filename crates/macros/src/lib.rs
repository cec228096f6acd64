//! Macros of `cvtcycle-model`: [`macro@physics`] for equations, [`macro@Gather`] for the records they read.

mod gather;
mod physics;

use proc_macro::TokenStream;
use syn::{DeriveInput, Item, parse_macro_input};

/// Inlines an equation into its callers: the function, or every function of the `impl` block or trait, and the closures that are passed on within them.
///
/// A function that is not inlined is compiled for a processor without wide vectors, and a group of runs becomes slower than one run after another.
/// A function with an `inline` attribute of its own keeps it: `#[inline(never)]` marks a large part that is called through `Real::vectorize`.
#[proc_macro_attribute]
pub fn physics(_: TokenStream, item: TokenStream) -> TokenStream {
    let item = parse_macro_input!(item as Item);
    physics::expand(item).into()
}

/// Implements `Gather` for a struct `Name<R: Real = f64>`: each run has its own value of a field, and shares those with `#[gather(same)]` with its group.
///
/// Runs that differ in a shared field are driven in groups of their own, so the equations may branch on it.
#[proc_macro_derive(Gather, attributes(gather))]
pub fn derive_gather(item: TokenStream) -> TokenStream {
    let item = parse_macro_input!(item as DeriveInput);
    gather::expand(&item)
        .unwrap_or_else(syn::Error::into_compile_error)
        .into()
}
