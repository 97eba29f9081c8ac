//! The lab notebook: rows of chosen quantities, a straight line through two of its columns, and CSV.

use corpuscle_experiments::{Table, Value};
use corpuscle_io::Scenario;
use corpuscle_observe::{Check, fit};

use crate::runner::{Measured, Snapshot};

/// What a column holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Physical time of the row.
    Time,
    /// The run's seed.
    Seed,
    /// A parameter, by its key.
    Parameter(String),
    /// A measured quantity, by the name of its check, with its error.
    Measured(String),
}

/// A value with its standard error, where it has one; not a number where the quantity was not at hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: Option<f64>,
}

/// Rows of recorded quantities.
#[derive(Clone, Debug, Default)]
pub struct Notebook {
    columns: Vec<Quantity>,
    rows: Vec<Vec<Entry>>,
    /// Places of the abscissa and the ordinate of the fit.
    pub axes: Option<(usize, usize)>,
}

/// A fitted line through two columns.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The line.
    pub line: fit::Line,
    /// Whether the ordinates' own errors weighed the points; otherwise their scatter gave the errors.
    pub weighted: bool,
    /// Number of points.
    pub points: usize,
}

impl Notebook {
    /// What can be recorded of this run, in the order in which it is offered.
    pub fn offered(scenario: &Scenario, measured: &Measured) -> Vec<Quantity> {
        let numeric = |value: &Value| matches!(value, Value::Real(_) | Value::Whole(_) | Value::Flag(_));
        let parameters = scenario.parameters().filter(|(_, value, _)| numeric(value));
        let mut offered = vec![Quantity::Time, Quantity::Seed];
        offered.extend(parameters.map(|(parameter, ..)| Quantity::Parameter(parameter.name.into())));
        offered.extend(measured.checks.iter().map(|check| Quantity::Measured(check.quantity.clone())));
        offered
    }

    /// The columns.
    pub fn columns(&self) -> &[Quantity] {
        &self.columns
    }

    /// The rows, each as long as the columns.
    pub fn rows(&self) -> &[Vec<Entry>] {
        &self.rows
    }

    /// Adds a column, or takes it away with all its entries.
    pub fn toggle(&mut self, quantity: &Quantity) {
        if let Some(place) = self.columns.iter().position(|column| column == quantity) {
            self.columns.remove(place);
            for row in &mut self.rows {
                row.remove(place);
            }
            self.axes = None;
        } else {
            self.columns.push(quantity.clone());
            self.rows.iter_mut().for_each(|row| row.push(Entry { value: f64::NAN, error: None }));
        }
    }

    /// Records what the columns ask for. A notebook without columns begins with the time and the first two measurements.
    pub fn record(&mut self, scenario: &Scenario, snapshot: &Snapshot) {
        let measured = &snapshot.measured;
        if self.columns.is_empty() {
            self.columns.push(Quantity::Time);
            let first = measured.checks.iter().filter(|check| check.standard_error.is_some()).take(2);
            self.columns.extend(first.map(|check| Quantity::Measured(check.quantity.clone())));
        }
        let row = self.columns.iter().map(|quantity| entry(quantity, scenario, snapshot)).collect();
        self.rows.push(row);
    }

    /// Takes a row away.
    pub fn remove(&mut self, row: usize) {
        if row < self.rows.len() {
            self.rows.remove(row);
        }
    }

    /// Takes all rows away, and leaves the columns.
    pub fn clear(&mut self) {
        self.rows.clear();
    }

    /// The straight line through the chosen axes, weighted by the ordinates' errors where every point has one.
    pub fn fit(&self) -> Option<Fit> {
        let (x, y) = self.axes?;
        let points: Vec<(Entry, Entry)> = self
            .rows
            .iter()
            .filter_map(|row| Some((*row.get(x)?, *row.get(y)?)))
            .filter(|(x, y)| x.value.is_finite() && y.value.is_finite())
            .collect();
        let errors: Option<Vec<_>> =
            points.iter().map(|(x, y)| y.error.filter(|e| *e > 0.0 && e.is_finite()).map(|e| (x.value, y.value, e))).collect();
        if let Some(weighted) = errors
            && weighted.len() > 2
        {
            return fit::line(&weighted).map(|line| Fit { line, weighted: true, points: weighted.len() });
        }
        let plain: Vec<_> = points.iter().map(|(x, y)| (x.value, y.value)).collect();
        (plain.len() > 2).then(|| fit::line_by_scatter(&plain)).flatten().map(|line| Fit {
            line,
            weighted: false,
            points: plain.len(),
        })
    }

    /// The notebook as a table, errors in columns of their own.
    pub fn table(&self) -> Table {
        let has_error = |column: usize| self.rows.iter().any(|row| row[column].error.is_some());
        let mut table = Table { name: "notebook".into(), columns: vec![], rows: vec![vec![]; self.rows.len()] };
        for (place, quantity) in self.columns.iter().enumerate() {
            table.columns.push(quantity.header());
            let with_error = has_error(place);
            if with_error {
                table.columns.push(format!("{}_standard_error", quantity.header()));
            }
            for (row, entries) in table.rows.iter_mut().zip(&self.rows) {
                row.push(entries[place].value);
                if with_error {
                    row.push(entries[place].error.unwrap_or(f64::NAN));
                }
            }
        }
        table
    }
}

impl Quantity {
    /// Name of the column in a file: words joined by underscores.
    fn header(&self) -> String {
        match self {
            Self::Time => "time".into(),
            Self::Seed => "seed".into(),
            Self::Parameter(key) => key.clone(),
            Self::Measured(name) => {
                let words: Vec<String> =
                    name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_lowercase).collect();
                words.join("_")
            }
        }
    }
}

fn entry(quantity: &Quantity, scenario: &Scenario, snapshot: &Snapshot) -> Entry {
    let exact = |value: f64| Entry { value, error: None };
    match quantity {
        Quantity::Time => exact(snapshot.time),
        Quantity::Seed => exact(scenario.settings.seed as f64),
        Quantity::Parameter(key) => {
            let value = scenario.parameters().find(|(parameter, ..)| parameter.name == key).map(|(_, value, _)| value.clone());
            exact(match value {
                Some(Value::Real(x)) => x,
                Some(Value::Whole(n)) => n as f64,
                Some(Value::Flag(on)) => f64::from(u8::from(on)),
                _ => f64::NAN,
            })
        }
        Quantity::Measured(name) => {
            let found: Option<&Check> = snapshot.measured.checks.iter().find(|check| check.quantity == *name);
            found.map_or(exact(f64::NAN), |check| Entry { value: check.measured, error: check.standard_error })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn notebook(rows: &[(f64, f64, Option<f64>)]) -> Notebook {
        let columns = vec![Quantity::Parameter("temperature".into()), Quantity::Measured("pressure P".into())];
        let entries = |&(x, y, error): &(f64, f64, Option<f64>)| vec![Entry { value: x, error: None }, Entry { value: y, error }];
        Notebook { columns, rows: rows.iter().map(entries).collect(), axes: Some((0, 1)) }
    }

    #[test]
    fn a_line_through_exact_points_is_found() {
        let fit = notebook(&[(1.0, 3.0, Some(0.1)), (2.0, 5.0, Some(0.2)), (3.0, 7.0, Some(0.1))]).fit().unwrap();
        assert!(fit.weighted && fit.points == 3);
        assert!((fit.line.slope.mean - 2.0).abs() < 1e-12 && (fit.line.intercept.mean - 1.0).abs() < 1e-12);
    }

    #[test]
    fn without_errors_the_scatter_gives_them() {
        let fit = notebook(&[(1.0, 3.1, None), (2.0, 4.9, None), (3.0, 7.0, Some(0.1)), (4.0, 9.0, None)]).fit().unwrap();
        assert!(!fit.weighted && fit.line.slope.standard_error > 0.0);
        assert!(notebook(&[(1.0, 3.0, None), (2.0, 5.0, None)]).fit().is_none(), "two points leave nothing to judge by");
        assert!(notebook(&[(1.0, f64::NAN, None), (2.0, 5.0, None), (3.0, 7.0, None)]).fit().is_none());
    }

    #[test]
    fn columns_come_and_go_with_their_entries() {
        let mut book = notebook(&[(1.0, 3.0, Some(0.1))]);
        book.toggle(&Quantity::Time);
        assert!(book.rows()[0][2].value.is_nan());
        book.toggle(&Quantity::Parameter("temperature".into()));
        assert_eq!(book.rows()[0][0].value, 3.0);
        assert_eq!(book.table().columns, ["pressure_p", "pressure_p_standard_error", "time"]);
    }
}
