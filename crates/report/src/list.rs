//! The list of fields as it is written: one quantity a line.

/// Writes a [`Fields`](crate::Fields) as a table: each line has a key, words, views and a value.
///
/// - `"key" "words" = value;` is a quantity; before `=` may stand what people see of it, such as
///   `.shown("mm").decimals(1)`.
/// - `"key" "words" group(fields) = part;` is an object of its own, `null` for `None`.
/// - `"key" "words" rows(fields) = parts;` is a list of objects, `named(fields)` are objects by name.
/// - `"key" "words" values = named_values;` are values by name, `null` for `None`.
/// - `join(fields) = part;` has the quantities of a part at the same level.
/// - `declared(list) = part;` has those that the crate declares which computes the part.
/// - `also(fields) = part;` has them in results that have that part, and `None` leaves them out.
/// - `remark "label" = text;` is seen by people only.
///
/// ```
/// use grouser_report::{Fields, fields};
///
/// fn spread<'a>() -> Fields<'a, &'a [f64; 2]> {
///     fields! { |spread: &'a [f64; 2]|
///         "low" "minimum" = spread[0];
///         "high" "maximum" = spread[1];
///     }
/// }
/// let run = fields! { |slip: &[f64; 2]|
///     "mean" "mean slip" .shown("").decimals(2) = (slip[0] + slip[1]) / 2.0;
///     "slip" "slip" group(spread()) = slip;
/// };
/// assert_eq!(run.lines(&[0.1, 0.3]), "mean slip  0.20\n");
/// assert_eq!(run.object(&[0.1, 0.3])["slip"]["high"], 0.3);
/// ```
#[macro_export]
macro_rules! fields {
    (@ $made:expr, $of:ident: $type:ty;) => { $made };
    (@ $made:expr, $of:ident: $type:ty; join($part:expr) = $value:expr; $($rest:tt)*) => {
        $crate::fields!(@ $made.join($part, move |$of: $type| $value), $of: $type; $($rest)*)
    };
    (@ $made:expr, $of:ident: $type:ty; declared($part:expr) = $value:expr; $($rest:tt)*) => {
        $crate::fields!(@ $made.declared($part, move |$of: $type| $value), $of: $type; $($rest)*)
    };
    (@ $made:expr, $of:ident: $type:ty; also($part:expr) = $value:expr; $($rest:tt)*) => {
        $crate::fields!(@ $made.also($part, move |$of: $type| $value), $of: $type; $($rest)*)
    };
    (@ $made:expr, $of:ident: $type:ty; remark $label:literal $(.$view:ident($($argument:tt)*))* = $value:expr; $($rest:tt)*) => {
        $crate::fields!(
            @ $made.remark($label, move |$of: $type| $value)$(.$view($($argument)*))*,
            $of: $type; $($rest)*
        )
    };
    (@ $made:expr, $of:ident: $type:ty; $key:literal $words:literal values = $value:expr; $($rest:tt)*) => {
        $crate::fields!(@ $made.values($key, $words, move |$of: $type| $value), $of: $type; $($rest)*)
    };
    (@ $made:expr, $of:ident: $type:ty; $key:literal $words:literal $kind:ident($part:expr) $(.$view:ident($($argument:tt)*))* = $value:expr; $($rest:tt)*) => {
        $crate::fields!(
            @ $made.$kind($key, $words, $part, move |$of: $type| $value)$(.$view($($argument)*))*,
            $of: $type; $($rest)*
        )
    };
    (@ $made:expr, $of:ident: $type:ty; $key:literal $words:literal $(.$view:ident($($argument:tt)*))* = $value:expr; $($rest:tt)*) => {
        $crate::fields!(
            @ $made.field($key, $words, move |$of: $type| $value)$(.$view($($argument)*))*,
            $of: $type; $($rest)*
        )
    };
    (|$of:ident: $type:ty| $($rest:tt)*) => {
        $crate::fields!(@ $crate::Fields::<$type>::new(), $of: $type; $($rest)*)
    };
}
