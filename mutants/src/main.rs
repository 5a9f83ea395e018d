//! Writes every mutant of a crate into its sources, each behind a run-time switch, so that one build holds them all.
//!
//! `mutants SOURCES LIST EXCLUDED` rewrites each file of the folder SOURCES and writes one line for each mutant to LIST:
//! its number, file, line and column, function and mutation. The file EXCLUDED names what does not compile: mutants as
//! `FILE:LINE:COLUMN MUTATION`, and functions that must stay `const` as `const NAME`. Numbers do not depend on it.
//!
//! Mutants are those of cargo-mutants: another operator, an operator less, another result of a function, a match arm
//! less, a guard that is always true or false. Tests, constants and macros are left alone.

mod values;

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use proc_macro2::{Literal, Span};
use quote::{ToTokens, quote};
use syn::spanned::Spanned;
use syn::visit_mut::{self, VisitMut};
use syn::{Attribute, BinOp, Block, Expr, Item, Signature, Type, UnOp, parse_quote};

struct Mutator {
    file: String,
    /// Types and functions around the present place.
    path: Vec<String>,
    count: u32,
    list: String,
    excluded: HashSet<String>,
}

impl Mutator {
    /// The condition under which a new mutant is active; `None` where it is excluded.
    fn switch(&mut self, span: Span, mutation: &str) -> Option<Expr> {
        let start = span.start();
        let place = format!("{}:{}:{}", self.file, start.line, start.column + 1);
        self.count += 1;
        if self.excluded.contains(&format!("{place} {mutation}")) {
            return None;
        }
        let (number, path) = (self.count, self.path.join("::"));
        writeln!(self.list, "{number}\t{place}\t{path}\t{mutation}").unwrap();
        let number = Literal::u32_suffixed(number);
        Some(parse_quote!(crate::mutant::active(#number)))
    }

    fn function(&mut self, signature: &mut Signature, block: &mut Block) {
        let name = signature.ident.to_string();
        if signature.constness.is_some() && self.excluded.contains(&format!("const {name}")) {
            return;
        }
        signature.constness = None;
        self.path.push(name);
        visit_mut::visit_block_mut(self, block);
        let mut returns = Vec::new();
        for value in values::of_function(signature) {
            let mutation = format!("return {}", value.to_token_stream());
            if let Some(active) = self.switch(signature.ident.span(), &mutation) {
                returns.push(quote!(if #active { return #value; }));
            }
        }
        let statements = &block.stmts;
        *block = parse_quote!({ #(#returns)* #(#statements)* });
        self.path.pop();
    }

    /// The operator of `left op right` or one of its mutants, on operands that are evaluated once.
    fn binary(&mut self, binary: &syn::ExprBinary) -> Option<Expr> {
        let (left, op, right) = (&binary.left, &binary.op, &binary.right);
        let span = op.span();
        if let BinOp::And(_) | BinOp::Or(_) = op {
            if has_let(left) || has_let(right) {
                return None;
            }
            let is_and = matches!(op, BinOp::And(_));
            let active = self.switch(span, if is_and { "&& -> ||" } else { "|| -> &&" })?;
            // the right side is evaluated where the left one has this value
            let goes_on: BinOp = if is_and {
                parse_quote!(!=)
            } else {
                parse_quote!(==)
            };
            return Some(
                parse_quote!((match #left { l => if l #goes_on #active { #right } else { l } })),
            );
        }
        let is_comparison = others(op, COMPARISONS).next().is_some();
        let is_assignment = others(op, ASSIGNMENTS).next().is_some();
        let applied = |op: &BinOp| -> Expr {
            match (is_comparison, is_assignment) {
                (true, _) => parse_quote!(*l #op *r),
                (_, true) => parse_quote!({ #left #op r; }),
                _ => parse_quote!(l #op r),
            }
        };
        let mut chosen = applied(op);
        let before = self.list.len();
        for other in others(op, COMPARISONS)
            .chain(others(op, ASSIGNMENTS))
            .chain(others(op, OPERATORS))
        {
            let mutation = format!("{} -> {}", op.to_token_stream(), other.to_token_stream());
            if let Some(active) = self.switch(span, &mutation) {
                let mutant = applied(&other);
                chosen = parse_quote!(if #active { #mutant } else { #chosen });
            }
        }
        if self.list.len() == before {
            return None;
        }
        Some(match (is_comparison, is_assignment) {
            (true, _) => parse_quote!((match (&(#left), &(#right)) { (l, r) => #chosen })),
            (_, true) => parse_quote!((match #right { r => #chosen })),
            _ => parse_quote!((match (#left, #right) { (l, r) => #chosen })),
        })
    }

    fn unary(&mut self, unary: &syn::ExprUnary) -> Option<Expr> {
        let (op, inner) = (&unary.op, &unary.expr);
        if !matches!(op, UnOp::Not(_) | UnOp::Neg(_)) || has_let(inner) {
            return None;
        }
        let active = self.switch(op.span(), &format!("delete {}", op.to_token_stream()))?;
        // a literal may be the least integer, which has no positive one
        Some(if let Expr::Lit(_) = **inner {
            parse_quote!((if #active { #inner } else { #op #inner }))
        } else {
            parse_quote!((match #inner { v => if #active { v } else { #op v } }))
        })
    }
}

/// An operator and what it is replaced with.
type Operators = &'static [(&'static str, &'static [&'static str])];

const COMPARISONS: Operators = &[
    ("==", &["!="]),
    ("!=", &["=="]),
    ("<", &["==", ">", "<="]),
    (">", &["==", "<", ">="]),
    ("<=", &[">", "<"]),
    (">=", &["<", ">"]),
];
const ASSIGNMENTS: Operators = &[
    ("+=", &["-=", "*="]),
    ("-=", &["+=", "/="]),
    ("*=", &["+=", "/="]),
    ("/=", &["%=", "*="]),
    ("%=", &["/=", "+="]),
    ("<<=", &[">>="]),
    (">>=", &["<<="]),
    ("&=", &["|=", "^="]),
    ("|=", &["&=", "^="]),
    ("^=", &["|=", "&="]),
];
const OPERATORS: Operators = &[
    ("+", &["-", "*"]),
    ("-", &["+", "/"]),
    ("*", &["+", "/"]),
    ("/", &["%", "*"]),
    ("%", &["/", "+"]),
    ("<<", &[">>"]),
    (">>", &["<<"]),
    ("&", &["|", "^"]),
    ("|", &["&", "^"]),
    ("^", &["|", "&"]),
];

fn others(op: &BinOp, table: Operators) -> impl Iterator<Item = BinOp> {
    let text = op.to_token_stream().to_string();
    let entry = table.iter().find(|(from, _)| *from == text);
    let others = entry.into_iter().flat_map(|(_, others)| *others);
    others.map(|other| syn::parse_str(other).unwrap())
}

/// Is it, or a part of a chain of conditions, a `let`?
fn has_let(condition: &Expr) -> bool {
    match condition {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let text = attribute.to_token_stream().to_string().replace(' ', "");
        text == "#[test]" || text.starts_with("#[cfg(test)") || text.starts_with("#[cfg(all(test")
    })
}

impl VisitMut for Mutator {
    fn visit_item_mut(&mut self, item: &mut Item) {
        match item {
            Item::Mod(module) if !is_test(&module.attrs) => {
                visit_mut::visit_item_mod_mut(self, module)
            }
            Item::Fn(function) if !is_test(&function.attrs) => {
                self.function(&mut function.sig, &mut function.block);
            }
            Item::Impl(block) if !is_test(&block.attrs) => {
                self.path
                    .push(block.self_ty.to_token_stream().to_string().replace(' ', ""));
                for item in &mut block.items {
                    if let syn::ImplItem::Fn(function) = item
                        && !is_test(&function.attrs)
                    {
                        self.function(&mut function.sig, &mut function.block);
                    }
                }
                self.path.pop();
            }
            Item::Trait(declared) => {
                self.path.push(declared.ident.to_string());
                for item in &mut declared.items {
                    if let syn::TraitItem::Fn(function) = item
                        && let Some(block) = &mut function.default
                    {
                        self.function(&mut function.sig, block);
                    }
                }
                self.path.pop();
            }
            _ => {}
        }
    }

    // what is evaluated by the compiler
    fn visit_type_mut(&mut self, _: &mut Type) {}
    fn visit_pat_mut(&mut self, _: &mut syn::Pat) {}
    fn visit_path_mut(&mut self, _: &mut syn::Path) {}
    fn visit_expr_const_mut(&mut self, _: &mut syn::ExprConst) {}
    fn visit_attribute_mut(&mut self, _: &mut Attribute) {}
    fn visit_expr_repeat_mut(&mut self, repeat: &mut syn::ExprRepeat) {
        self.visit_expr_mut(&mut repeat.expr);
    }

    fn visit_expr_match_mut(&mut self, matched: &mut syn::ExprMatch) {
        self.visit_expr_mut(&mut matched.expr);
        let is_wild = |arm: &syn::Arm| matches!(arm.pat, syn::Pat::Wild(_)) && arm.guard.is_none();
        let has_wild = matched.arms.iter().any(is_wild);
        for arm in &mut matched.arms {
            self.visit_expr_mut(&mut arm.body);
            let span = arm.pat.span();
            let may_go = has_wild && !is_wild(arm);
            let mut guard = arm.guard.take();
            if let Some((_, condition)) = &mut guard
                && !has_let(condition)
            {
                self.visit_expr_mut(condition);
                if let Some(active) = self.switch(span, "guard false") {
                    **condition = parse_quote!((!#active && #condition));
                }
                if let Some(active) = self.switch(span, "guard true") {
                    **condition = parse_quote!((#active || #condition));
                }
            }
            let has_let = guard
                .as_ref()
                .is_some_and(|(_, condition)| has_let(condition));
            if may_go
                && !has_let
                && let Some(active) = self.switch(span, "delete arm")
            {
                let condition =
                    guard.map_or_else(|| parse_quote!(true), |(_, condition)| condition);
                guard = Some((Default::default(), parse_quote!((!#active && #condition))));
            }
            arm.guard = guard;
        }
    }

    fn visit_expr_mut(&mut self, expression: &mut Expr) {
        visit_mut::visit_expr_mut(self, expression);
        let mutated = match expression {
            Expr::Binary(binary) => self.binary(binary),
            Expr::Unary(unary) => self.unary(unary),
            _ => None,
        };
        if let Some(mutated) = mutated {
            *expression = mutated;
        }
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut entries: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let each = entries.into_iter().flat_map(|path| {
        if path.is_dir() {
            files(&path)
        } else {
            vec![path]
        }
    });
    each.filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect()
}

fn main() {
    let [sources, list, excluded] = std::env::args()
        .skip(1)
        .collect::<Vec<_>>()
        .try_into()
        .unwrap();
    let sources = Path::new(&sources);
    let excluded = std::fs::read_to_string(excluded).unwrap_or_default();
    let mut mutator = Mutator {
        file: String::new(),
        path: Vec::new(),
        count: 0,
        list: String::new(),
        excluded: excluded.lines().map(str::to_owned).collect(),
    };
    for path in files(sources) {
        let place = path.strip_prefix(sources).unwrap();
        if place.to_string_lossy().ends_with("tests.rs") || place.iter().any(|part| part == "tests")
        {
            continue;
        }
        let mut file = syn::parse_file(&std::fs::read_to_string(&path).unwrap()).unwrap();
        mutator.file = place.display().to_string();
        mutator.visit_file_mut(&mut file);
        if mutator.file == "lib.rs" {
            file.items.push(parse_quote!(
                #[doc(hidden)]
                pub mod mutant;
            ));
        }
        std::fs::write(&path, prettyplease::unparse(&file)).unwrap();
    }
    std::fs::write(sources.join("mutant.rs"), include_str!("switch.rs")).unwrap();
    std::fs::write(list, mutator.list).unwrap();
}
