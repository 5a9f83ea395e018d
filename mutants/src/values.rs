//! What a function may return in place of its result.

use syn::{Expr, GenericArgument, PathArguments, ReturnType, Signature, Type, parse_quote};

pub(crate) fn of_function(signature: &Signature) -> Vec<Expr> {
    match &signature.output {
        // it would call itself
        _ if signature.ident == "default" => vec![],
        ReturnType::Default => vec![parse_quote!(())],
        ReturnType::Type(_, returned) => of_type(returned),
    }
}

fn of_type(returned: &Type) -> Vec<Expr> {
    let wrapped =
        |values: Vec<Expr>, wrap: fn(Expr) -> Expr| values.into_iter().map(wrap).collect();
    match returned {
        Type::Path(path) => {
            let last = path.path.segments.last().unwrap();
            let inner = || match &last.arguments {
                PathArguments::AngleBracketed(of) => match of.args.first() {
                    Some(GenericArgument::Type(inner)) => of_type(inner),
                    _ => vec![],
                },
                _ => vec![parse_quote!(())],
            };
            match last.ident.to_string().as_str() {
                "bool" => vec![parse_quote!(true), parse_quote!(false)],
                "f64" | "f32" => vec![parse_quote!(0.0), parse_quote!(1.0), parse_quote!(-1.0)],
                "usize" | "u128" | "u64" | "u32" | "u16" | "u8" => {
                    vec![parse_quote!(0), parse_quote!(1)]
                }
                "isize" | "i128" | "i64" | "i32" | "i16" | "i8" => {
                    vec![parse_quote!(0), parse_quote!(1), parse_quote!(-1)]
                }
                "String" => vec![
                    parse_quote!(Default::default()),
                    parse_quote!("xyzzy".into()),
                ],
                "Option" => {
                    let mut values: Vec<Expr> =
                        wrapped(inner(), |value| parse_quote!(Some(#value)));
                    values.push(parse_quote!(None));
                    values
                }
                "Result" => wrapped(inner(), |value| parse_quote!(Ok(#value))),
                _ => vec![parse_quote!(Default::default())],
            }
        }
        Type::Tuple(tuple) => {
            let parts: Vec<Vec<Expr>> = tuple.elems.iter().map(of_type).collect();
            if parts.iter().any(Vec::is_empty) {
                return vec![];
            }
            let count = parts.iter().map(Vec::len).max().unwrap_or(1);
            let value = |index: usize| -> Expr {
                let each = parts
                    .iter()
                    .map(|values| &values[index.min(values.len() - 1)]);
                parse_quote!((#(#each),*))
            };
            (0..count).map(value).collect()
        }
        Type::Array(array) => {
            let len = &array.len;
            of_type(&array.elem)
                .into_iter()
                .map(|value| parse_quote!([#value; #len]))
                .collect()
        }
        Type::Reference(reference) if reference.mutability.is_none() => match &*reference.elem {
            Type::Slice(_) => vec![parse_quote!(&[])],
            Type::Path(path) if path.path.is_ident("str") => {
                vec![parse_quote!(""), parse_quote!("xyzzy")]
            }
            _ => vec![],
        },
        _ => vec![],
    }
}
