//! The derive of `Gather`.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Attribute, Data, DeriveInput, Error, Fields, Ident, Result};

/// Writes the implementation for a struct with named fields.
pub fn expand(item: &DeriveInput) -> Result<TokenStream> {
    let fields = match &item.data {
        Data::Struct(data) => match &data.fields {
            Fields::Named(fields) => &fields.named,
            _ => return Err(Error::new_spanned(item, "`Gather` needs named fields")),
        },
        _ => return Err(Error::new_spanned(item, "`Gather` needs a struct")),
    };
    let (mut own, mut same): (Vec<&Ident>, Vec<&Ident>) = Default::default();
    for field in fields {
        let Some(name) = &field.ident else { continue };
        if is_same(&field.attrs)? {
            same.push(name);
        } else {
            own.push(name);
        }
    }
    let name = &item.ident;
    Ok(quote! {
        impl ::cvtcycle_model::math::Gather for #name {
            type Together<R: ::cvtcycle_model::math::Real> = #name<R>;

            fn gather<R: ::cvtcycle_model::math::Real>(like: R, runs: &[&Self]) -> #name<R> {
                #name {
                    #(#own: {
                        let values: ::std::vec::Vec<_> = runs.iter().map(|run| &run.#own).collect();
                        ::cvtcycle_model::math::Gather::gather(like, &values)
                    },)*
                    #(#same: runs[0].#same.clone(),)*
                }
            }

            fn lane<R: ::cvtcycle_model::math::Real>(together: &#name<R>, lane: usize) -> Self {
                #name {
                    #(#own: ::cvtcycle_model::math::Gather::lane::<R>(&together.#own, lane),)*
                    #(#same: together.#same.clone(),)*
                }
            }

            fn groups_with(&self, other: &Self) -> bool {
                true
                    #(&& ::cvtcycle_model::math::Gather::groups_with(&self.#own, &other.#own))*
                    #(&& self.#same == other.#same)*
            }
        }
    })
}

/// Reads `#[gather(same)]`.
fn is_same(attributes: &[Attribute]) -> Result<bool> {
    let mut same = false;
    for attribute in attributes.iter().filter(|a| a.path().is_ident("gather")) {
        attribute.parse_nested_meta(|meta| {
            if !meta.path.is_ident("same") {
                return Err(meta.error("the option is `same`"));
            }
            same = true;
            Ok(())
        })?;
    }
    Ok(same)
}
