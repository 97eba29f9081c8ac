//! What a run has shown, in words and as a table.

use corpuscle_io::number::{plain, rounded, significant};
use corpuscle_io::{Ending, Record};
use corpuscle_observe::{Check, Verdict};

use crate::table::{Align, table};

/// How it ended and what became of the checks, in a line.
pub(crate) fn verdict(record: &Record) -> String {
    let (passed, all) = (record.passed(), record.checks.len());
    let checks = match all {
        0 => "nothing was checked: no conservation law and no theory applies to what was measured".into(),
        1 if passed == 1 => format!("the one check passed: {}", record.checks[0].quantity),
        _ if passed == all => format!("all {all} checks passed"),
        _ => format!("{} of {all} checks failed", all - passed),
    };
    match record.ending {
        Ending::Finished => checks,
        Ending::Interrupted | Ending::Running => {
            format!("interrupted at t = {}; of what was measured, {checks}", significant(record.time, 5))
        }
        Ending::Failed(_) => {
            format!("could not be finished; of what was measured until t = {}, {checks}", significant(record.time, 5))
        }
    }
}

/// The checks as a table.
pub(crate) fn checks(checks: &[Check]) -> String {
    let head = ["", "quantity", "measured", "expected", "z"].map(String::from).to_vec();
    let rows = checks.iter().map(|check| {
        let unit = if check.unit.is_empty() { String::new() } else { format!(" {}", check.unit) };
        let sign = match check.verdict {
            Verdict::Agreement => "",
            Verdict::AtMost => "≤ ",
            Verdict::AtLeast => "≥ ",
        };
        vec![
            if check.passed { "✓" } else { "✗" }.into(),
            check.quantity.clone(),
            match check.verdict {
                Verdict::Agreement => plain(&rounded(check.measured, check.standard_error)),
                Verdict::AtMost | Verdict::AtLeast => significant(check.measured, 3),
            } + &unit,
            format!("{sign}{}{unit}", significant(check.expected, if check.verdict == Verdict::Agreement { 6 } else { 3 })),
            check.z.map(|z| format!("{z:+.2}")).unwrap_or_default(),
        ]
    });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    table(&[Align::Left, Align::Left, Align::Right, Align::Right, Align::Right], &rows)
}
