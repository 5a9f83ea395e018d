//! The list of a result's quantities and its views.

use std::borrow::Borrow;

use grouser_real::{FieldValue, ReadField, ResultField};
use serde_json::Value;

use crate::datum::Datum;
use crate::field::{Digits, Field, Place, Shown};
use crate::{Object, Table, schema};

/// The quantities of a `T`, each named once; a `T` is a reference or small: each quantity takes a clone of it.
///
/// ```
/// use grouser_report::Fields;
///
/// let log = (12.5, vec![("left".to_owned(), 0.2)]);
/// let wheel = Fields::new().field("slip", "slip", |slip: f64| slip);
/// let run = Fields::new()
///     .field("duration_s", "length of the run", |run: &(f64, Vec<(String, f64)>)| run.0)
///     .named("wheels", "each wheel", wheel, |run| run.1.iter().cloned());
/// let object = run.object(&log);
/// assert_eq!(object["wheels"]["left"]["slip"], 0.2);
/// ```
pub struct Fields<'a, T> {
    list: Vec<Field<'a, T>>,
}

impl<T> Default for Fields<'_, T> {
    fn default() -> Self {
        Self { list: Vec::new() }
    }
}

impl<'a, T: Clone + 'a> Fields<'a, T> {
    /// An empty list.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The quantities of a part, at the same level, as the crate that computes it declares them.
    ///
    /// ```
    /// use grouser_real::ResultField;
    /// use grouser_report::Fields;
    ///
    /// const FIELDS: &[ResultField<f64>] = &[ResultField::number("load_n", "load", |load| *load).shown("N")];
    /// let fields = Fields::new().declared(FIELDS, |load: &f64| Some(load));
    /// assert_eq!(fields.object(&80.0)["load_n"], 80.0);
    /// ```
    #[must_use]
    pub fn declared<U: 'static, B: Borrow<U>>(
        mut self,
        list: &'static [ResultField<U>],
        of: impl Fn(T) -> Option<B> + Clone + 'a,
    ) -> Self {
        for field in list {
            let schema = match field.read {
                ReadField::Number(_) | ReadField::Optional(_) => f64::schema(),
                ReadField::Whole(_) => u32::schema(),
                ReadField::Text(_) => String::schema(),
                ReadField::Texts(_) => Vec::<String>::schema(),
            };
            let of = of.clone();
            self = self.with(field.key, field.words, schema, move |whole| {
                of(whole).map_or(Value::Null, |part| json(field, part.borrow()))
            });
            if let Some((unit, missing)) = field.shown {
                self = self.shown(unit);
                if let Some(words) = missing {
                    self = self.missing(words);
                }
            }
        }
        self
    }

    /// A quantity.
    #[must_use]
    pub fn field<D: Datum>(
        self,
        key: &'static str,
        words: &'static str,
        value: impl Fn(T) -> D + 'a,
    ) -> Self {
        self.with(key, words, D::schema(), move |of| value(of).json())
    }

    /// Quantities that belong together, as an object of their own; `null` where there are none.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let spread = Fields::new().field("median", "median", |spread: [f64; 2]| spread[0]);
    /// let run = Fields::new().group("slip", "slip", spread, |run: [f64; 2]| Some(run));
    /// assert_eq!(run.object([0.1, 0.2])["slip"]["median"], 0.1);
    /// ```
    #[must_use]
    pub fn group<U: Clone + 'a, R: Into<Option<U>>>(
        self,
        key: &'static str,
        words: &'static str,
        fields: Fields<'a, U>,
        value: impl Fn(T) -> R + 'a,
    ) -> Self {
        let schema = schema::or_null(fields.schema());
        self.with(key, words, schema, move |of| {
            let value: Option<U> = value(of).into();
            value.map_or(Value::Null, |value| Value::Object(fields.object(value)))
        })
    }

    /// A list of objects.
    #[must_use]
    pub fn rows<U: Clone + 'a, I: IntoIterator<Item = U>>(
        self,
        key: &'static str,
        words: &'static str,
        fields: Fields<'a, U>,
        rows: impl Fn(T) -> I + 'a,
    ) -> Self {
        let schema = schema::list(&fields.schema());
        let mut list = self.maybe_rows(key, words, fields, move |of| Some(rows(of)));
        list.set_schema(schema);
        list
    }

    /// Objects by name.
    #[must_use]
    pub fn named<U: Clone + 'a, N: Into<String>, I: IntoIterator<Item = (N, U)>>(
        self,
        key: &'static str,
        words: &'static str,
        fields: Fields<'a, U>,
        items: impl Fn(T) -> I + 'a,
    ) -> Self {
        let schema = schema::named(&fields.schema());
        let mut list = self.maybe_named(key, words, fields, move |of| Some(items(of)));
        list.set_schema(schema);
        list
    }

    /// A list of objects, or `null`.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let point = || Fields::new().field("slip", "slip", |slip: f64| slip);
    /// let run = Fields::new().maybe_rows("front", "front", point(), |front: Option<[f64; 2]>| front);
    /// assert!(run.object(None)["front"].is_null());
    /// ```
    #[must_use]
    pub fn maybe_rows<U: Clone + 'a, I: IntoIterator<Item = U>>(
        self,
        key: &'static str,
        words: &'static str,
        fields: Fields<'a, U>,
        rows: impl Fn(T) -> Option<I> + 'a,
    ) -> Self {
        let schema = schema::or_null(schema::list(&fields.schema()));
        self.with(key, words, schema, move |of| match rows(of) {
            Some(rows) => rows
                .into_iter()
                .map(|row| Value::Object(fields.object(row)))
                .collect(),
            None => Value::Null,
        })
    }

    /// Objects by name, or `null`.
    #[must_use]
    pub fn maybe_named<U: Clone + 'a, N: Into<String>, I: IntoIterator<Item = (N, U)>>(
        self,
        key: &'static str,
        words: &'static str,
        fields: Fields<'a, U>,
        items: impl Fn(T) -> Option<I> + 'a,
    ) -> Self {
        let schema = schema::or_null(schema::named(&fields.schema()));
        self.with(key, words, schema, move |of| match items(of) {
            Some(items) => {
                let items = items.into_iter();
                let object = items.map(|(name, item)| (name.into(), fields.object(item).into()));
                Value::Object(object.collect())
            }
            None => Value::Null,
        })
    }

    /// Values by name; `null` where there are none.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let point = Fields::new().values("x", "variables", |x: f64| Some([("radius_m", x)]));
    /// assert_eq!(point.object(0.1)["x"]["radius_m"], 0.1);
    /// ```
    #[must_use]
    pub fn values<D: Datum, N: Into<String>, I: IntoIterator<Item = (N, D)>>(
        self,
        key: &'static str,
        words: &'static str,
        values: impl Fn(T) -> Option<I> + 'a,
    ) -> Self {
        let schema = schema::or_null(schema::named(&D::schema()));
        self.with(key, words, schema, move |of| match values(of) {
            Some(values) => {
                let values = values.into_iter();
                Value::Object(values.map(|(name, v)| (name.into(), v.json())).collect())
            }
            None => Value::Null,
        })
    }

    /// The quantities of a part, at the same level.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let force = Fields::new().field("load_n", "load", |load: f64| load);
    /// let wheel = Fields::new().join(force, |wheel: [f64; 2]| wheel[0]);
    /// assert_eq!(wheel.object([80.0, 0.1])["load_n"], 80.0);
    /// ```
    #[must_use]
    pub fn join<U: Clone + 'a>(
        mut self,
        part: Fields<'a, U>,
        of: impl Fn(T) -> U + Clone + 'a,
    ) -> Self {
        for field in part.list {
            let place = field.place;
            let of = of.clone();
            self.take(field, place, move |whole| Some(of(whole)));
        }
        self
    }

    /// The quantities of a part, at the same level, in results that have that part.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let slope = Fields::new().field("slope_deg", "slope", |slope: f64| slope);
    /// let wheel = Fields::new().also(slope, |slope: Option<f64>| slope);
    /// assert!(wheel.object(None).is_empty());
    /// // a remark stays what people see
    /// let remark = Fields::new().remark("state", |_: f64| "drives");
    /// let wheel = Fields::new().also(remark, |slope: Option<f64>| slope);
    /// assert!(wheel.object(Some(0.5)).is_empty());
    /// ```
    #[must_use]
    pub fn also<U: Clone + 'a>(
        mut self,
        part: Fields<'a, U>,
        of: impl Fn(T) -> Option<U> + Clone + 'a,
    ) -> Self {
        for field in part.list {
            let place = match field.place {
                Place::Text => Place::Text,
                _ => Place::Sometimes,
            };
            self.take(field, place, of.clone());
        }
        self
    }

    /// People see the last quantity too, in this unit (its key's, `mm` for m, `%` for a share, `deg` for rad).
    #[must_use]
    pub fn shown(mut self, unit: &'static str) -> Self {
        if let Some(field) = self.list.last_mut() {
            field.shown = Some(Shown {
                label: field.words,
                unit,
                digits: Digits::Significant,
                missing: "-",
                at_right: field.is_number(),
                is_detail: false,
            });
        }
        self
    }

    /// People see the last quantity under another name.
    #[must_use]
    pub fn label(self, label: &'static str) -> Self {
        self.seen(|shown| shown.label = label)
    }

    /// People see the last quantity among the details only.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let fields = Fields::new().field("checks", "checks", |n: u32| n).shown("").detail();
    /// assert_eq!(fields.lines(7), "");
    /// ```
    #[must_use]
    pub fn detail(self) -> Self {
        self.seen(|shown| shown.is_detail = true)
    }

    /// People see the last quantity with this many decimal places.
    #[must_use]
    pub fn decimals(self, places: usize) -> Self {
        self.seen(|shown| shown.digits = Digits::Decimals(places))
    }

    /// People see the last quantity with as many digits as it needs.
    #[must_use]
    pub fn all_digits(self) -> Self {
        self.seen(|shown| shown.digits = Digits::All)
    }

    /// What people see where the last quantity has no value; a dash by default.
    #[must_use]
    pub fn missing(self, words: &'static str) -> Self {
        self.seen(|shown| shown.missing = words)
    }

    /// People see the text of the last quantity as a number: at the right of its column.
    #[must_use]
    pub fn as_number(self) -> Self {
        self.seen(|shown| shown.at_right = true)
    }

    /// The last quantity was given, not computed: a CSV table repeats it with as few digits as it needs.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let fields = Fields::new().field("radius_m", "radius", |r: f64| r).given();
    /// assert_eq!(fields.csv([0.1]), "radius_m\n0.1\n");
    /// ```
    #[must_use]
    pub fn given(mut self) -> Self {
        if let Some(field) = self.list.last_mut() {
            field.is_given = true;
        }
        self
    }

    /// The last quantity stands in the JSON object only where it has a value.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let fields = Fields::new().field("file", "file", |file: Option<u8>| file).optional();
    /// assert!(fields.object(None).is_empty());
    /// ```
    #[must_use]
    pub fn optional(mut self) -> Self {
        if let Some(mut field) = self.list.pop() {
            let value = field.value;
            field.value = Box::new(move |of| value(of).filter(|value| !value.is_null()));
            field.place = Place::Sometimes;
            self.list.push(field);
        }
        self
    }

    /// Words that only people see: a line or a column that programs find in other quantities.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let fields = Fields::new().remark("state", |slip: f64| if slip < 1.0 { "drives" } else { "spins" });
    /// assert_eq!(fields.table([0.5]), "state\ndrives\n");
    /// assert!(fields.object(0.5).is_empty());
    /// ```
    #[must_use]
    pub fn remark<S: Into<String>>(self, label: &'static str, text: impl Fn(T) -> S + 'a) -> Self {
        let mut fields = self
            .with(label, label, String::schema(), move |of| {
                Value::String(text(of).into())
            })
            .shown("");
        if let Some(field) = fields.list.last_mut() {
            field.place = Place::Text;
        }
        fields
    }

    /// Makes the quantity with this key the last one, for another view of it.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let fields = Fields::new().field("a", "a", |x: f64| x).shown("").field("b", "b", |x: f64| x);
    /// assert_eq!(fields.at("a").label("first").lines(0.5), "first  0.5\n");
    /// ```
    #[must_use]
    pub fn at(mut self, key: &str) -> Self {
        if let Some(place) = self.list.iter().position(|field| field.key == key) {
            let field = self.list.remove(place);
            self.list.push(field);
        }
        self
    }

    /// The quantities with these keys, in this order.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let fields = Fields::new().field("a", "a", |x: f64| x).field("b", "b", |x: f64| x);
    /// assert_eq!(fields.pick(&["b"]).csv([0.5]), "b\n0.5\n");
    /// ```
    #[must_use]
    pub fn pick(mut self, keys: &[&str]) -> Self {
        let place = |field: &Field<'_, T>| keys.iter().position(|key| *key == field.key);
        self.list.retain(|field| place(field).is_some());
        self.list.sort_by_key(place);
        self
    }

    /// All quantities as a JSON object.
    #[must_use]
    pub fn object(&self, of: T) -> Object {
        let mut object = Object::new();
        for field in self.list.iter().filter(|field| field.place != Place::Text) {
            if let Some(value) = (field.value)(of.clone()) {
                object.insert(field.key.to_owned(), value);
            }
        }
        object
    }

    /// The JSON schema of [`Fields::object`].
    #[must_use]
    pub fn schema(&self) -> Value {
        schema::object(&self.list)
    }

    /// What people see: a line for each quantity, with its value and unit.
    #[must_use]
    pub fn lines(&self, of: T) -> String {
        let mut table = Table::new().text("").number("").text("");
        self.add_lines(&mut table, of);
        table.render_body()
    }

    /// The same, as rows of a table with the columns name, value and unit.
    pub fn add_lines(&self, table: &mut Table, of: T) {
        for field in &self.list {
            let shown = field.shown.filter(Shown::is_printed);
            if let (Some(shown), Some(value)) = (shown, (field.value)(of.clone())) {
                table.row([shown.label, &field.cell(&value), shown.unit]);
            }
        }
    }

    /// What people see of many: a column for each quantity, its unit in the header.
    ///
    /// ```
    /// use grouser_report::Fields;
    ///
    /// let fields = Fields::new().field("sinkage_m", "sinkage", |z: f64| z).shown("mm");
    /// assert_eq!(fields.table([0.01, 0.02]), "sinkage mm\n        10\n        20\n");
    /// ```
    #[must_use]
    pub fn table(&self, rows: impl IntoIterator<Item = T>) -> String {
        let is_seen = |field: &&Field<'a, T>| field.shown.is_some_and(|shown| shown.is_printed());
        let seen = || self.list.iter().filter(is_seen);
        let mut table = Table::new();
        for shown in seen().filter_map(|field| field.shown) {
            let header = format!("{} {}", shown.label, shown.unit);
            table = if shown.at_right {
                table.number(header.trim_end())
            } else {
                table.text(header.trim_end())
            };
        }
        for row in rows {
            table.row(
                seen().map(|field| field.cell(&(field.value)(row.clone()).unwrap_or_default())),
            );
        }
        table.render()
    }

    /// A CSV table: the keys, then the values with all their digits.
    #[must_use]
    pub fn csv(&self, rows: impl IntoIterator<Item = T>) -> String {
        let columns = || self.list.iter().filter(|field| field.place != Place::Text);
        let mut text = columns()
            .map(|field| field.key)
            .collect::<Vec<_>>()
            .join(",")
            + "\n";
        for row in rows {
            let cells = columns()
                .map(|field| field.csv_cell(&(field.value)(row.clone()).unwrap_or_default()));
            text.push_str(&cells.collect::<Vec<_>>().join(","));
            text.push('\n');
        }
        text
    }

    fn take<U: 'a>(&mut self, part: Field<'a, U>, place: Place, of: impl Fn(T) -> Option<U> + 'a) {
        let value = part.value;
        self.list.push(Field {
            key: part.key,
            words: part.words,
            schema: part.schema,
            value: Box::new(move |whole| value(of(whole)?)),
            shown: part.shown,
            is_given: part.is_given,
            place,
        });
    }

    fn with(
        mut self,
        key: &'static str,
        words: &'static str,
        schema: Value,
        value: impl Fn(T) -> Value + 'a,
    ) -> Self {
        self.list.push(Field {
            key,
            words,
            schema,
            value: Box::new(move |of| Some(value(of))),
            shown: None,
            is_given: false,
            place: Place::Everywhere,
        });
        self
    }

    fn set_schema(&mut self, schema: Value) {
        if let Some(field) = self.list.last_mut() {
            field.schema = schema;
        }
    }

    fn seen(mut self, change: impl Fn(&mut Shown)) -> Self {
        if let Some(shown) = self.list.last_mut().and_then(|field| field.shown.as_mut()) {
            change(shown);
        }
        self
    }
}

/// The value of a declared field as JSON.
pub(crate) fn json<U>(field: &ResultField<U>, of: &U) -> Value {
    match field.value(of) {
        FieldValue::Missing => Value::Null,
        FieldValue::Number(number) => number.json(),
        FieldValue::Whole(number) => number.into(),
        FieldValue::Text(text) => text.into(),
        FieldValue::Texts => {
            let mut all = Vec::new();
            if let ReadField::Texts(read) = field.read {
                read(of, &mut |text| all.push(Value::from(text)));
            }
            all.into()
        }
    }
}
