//! Column maps as text.

use super::{Column, ColumnMap, Frame, Meaning, Table, TimeUnit};
use crate::toml_text::{TomlText, quoted};

/// The text of a column map that reads back to the same map.
///
/// ```
/// use grouser_files::{Document, columns};
///
/// let map = columns::read(std::path::Path::new("../../examples/kobuki/columns.toml"))?;
/// let again = columns::parse(&Document::from_text("again.toml", columns::to_toml(&map))?)?;
/// assert_eq!(again, map);
/// # Ok::<(), grouser_files::Error>(())
/// ```
#[must_use]
pub fn to_toml(map: &ColumnMap) -> String {
    let mut out = TomlText::new(&[]);
    for table in &map.tables {
        write_table(&mut out, table);
    }
    out.finish()
}

pub(crate) fn write_table(out: &mut TomlText, table: &Table) {
    out.header("[[table]]");
    out.optional_text("file", table.file.as_deref());
    if table.separator == b'\t' {
        out.text("separator", "tab");
    } else {
        out.text("separator", &char::from(table.separator).to_string());
    }
    for (key, lines) in [
        ("header_lines", table.header_lines),
        ("names_line", table.names_line),
    ] {
        if (key, lines) != ("names_line", 0) {
            out.whole(key, lines);
        }
    }
    out.text("decimal", &char::from(table.decimal).to_string());
    out.texts("missing", &table.missing);
    out.flag("align_clock", table.align_clock);
    let unit = TimeUnit::NAMES
        .iter()
        .find(|(_, unit)| *unit == table.time.unit);
    out.line(&format!(
        "time = {{ column = {}, unit = \"{}\"{}{} }}",
        quoted(&table.time.column),
        unit.map_or("s", |(name, _)| *name),
        (table.time.nanoseconds.as_ref()).map_or_else(String::new, |column| format!(
            ", {} = {}",
            table.time.unit.second_key(),
            quoted(column)
        )),
        match table.time.offset_ns {
            0 => String::new(),
            offset => format!(", offset_s = {:?}", offset as f64 * 1e-9),
        }
    ));
    out.line("columns = [");
    for column in &table.columns {
        out.line(&format!(
            "    {{ column = {}, {}{} }},",
            quoted(&column.column),
            meaning(column, ", "),
            if column.is_optional {
                ", optional = true"
            } else {
                ""
            }
        ));
    }
    out.line("]");
}

/// The keys of a column's meaning, with `between` between them.
pub(crate) fn meaning(column: &Column, between: &str) -> String {
    let mut keys = vec![format!("meaning = \"{}\"", column.meaning.name())];
    keys.extend(
        column
            .wheel
            .iter()
            .map(|wheel| format!("wheel = {}", quoted(wheel))),
    );
    keys.extend((column.joint.iter()).map(|joint| format!("link = {}", quoted(&joint.link))));
    let all = Meaning::ALL.iter();
    let quantity =
        all.filter_map(|(_, own, quantity)| (*own == column.meaning).then_some(quantity));
    let units: Vec<_> = quantity.flat_map(|quantity| quantity.units()).collect();
    if let Some((unit, _)) = units.iter().find(|(_, factor)| *factor == column.factor) {
        keys.push(format!("unit = \"{unit}\""));
    } else if let Some((unit, _)) = units.first() {
        // The first unit is the SI one.
        keys.push(format!("unit = \"{unit}\""));
        keys.push(format!("scale = {:?}", column.factor));
    }
    if column.offset != 0.0 {
        keys.push(format!("offset_m = {:?}", column.offset));
    }
    let named = Frame::NAMES
        .iter()
        .find(|(_, frame)| *frame == column.frame);
    if let Some((name, _)) = named.filter(|(_, frame)| *frame != Frame::default()) {
        keys.push(format!("frame = \"{name}\""));
    }
    keys.join(between)
}
