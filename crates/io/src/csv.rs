//! Series and tables as CSV: UTF-8, one header row of `name_unit`, numbers with the digits needed to read them back exactly.

use corpuscle_experiments::Table;
use corpuscle_observe::Chart;
use corpuscle_observe::chart::Axis;
use csv::Writer;

/// A chart in long format, one row a point: `series, <x>_<unit>, <y>_<unit>, standard_error`. The error is empty where
/// there is none.
pub fn chart(chart: &Chart) -> Vec<u8> {
    let mut rows = vec![vec!["series".to_owned(), header(&chart.x), header(&chart.y), "standard_error".to_owned()]];
    for series in &chart.series {
        for (index, (&x, &y)) in series.x.iter().zip(&series.y).enumerate() {
            let error = series.standard_error.get(index).copied().map(exact).unwrap_or_default();
            rows.push(vec![series.name.clone(), exact(x), exact(y), error]);
        }
    }
    lines(&rows)
}

/// A table, as it is.
pub fn table(table: &Table) -> Vec<u8> {
    let rows = table.rows.iter().map(|row| row.iter().copied().map(exact).collect());
    lines(&std::iter::once(table.columns.clone()).chain(rows).collect::<Vec<_>>())
}

/// The shortest digits that read back to the same bits; very large and very small values in scientific notation.
fn exact(value: f64) -> String {
    format!("{value:?}")
}

/// `mean_squared_displacement_m²` from a label and a unit: words joined by underscores, letters of any alphabet kept.
fn header(axis: &Axis) -> String {
    let mut name = String::new();
    for c in axis.label.chars() {
        if c.is_alphanumeric() {
            name.extend(c.to_lowercase());
        } else if !name.is_empty() && !name.ends_with('_') {
            name.push('_');
        }
    }
    let unit: String = axis.unit.split_whitespace().collect();
    let name = name.trim_end_matches('_');
    if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") }
}

/// The rows as one text; a row shorter than the header stays shorter rather than losing its neighbours' places.
fn lines(rows: &[Vec<String>]) -> Vec<u8> {
    let mut writer = Writer::from_writer(vec![]);
    for row in rows {
        // Writing into memory fails only on rows of unequal length, which a flexible writer allows; nothing to report.
        let _ = writer.write_record(row);
    }
    writer.into_inner().unwrap_or_default()
}
