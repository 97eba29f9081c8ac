//! `report.html`: one file that needs nothing else. It loads nothing, runs nothing, prints well, and follows the reader's
//! choice of a light or a dark screen.

mod axis;
mod chart;
mod html;
mod residuals;

use std::fmt::Write;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use corpuscle_experiments::{Table, Value};
use corpuscle_observe::{Chart, Check, Verdict};

use crate::number::{Rounded, grouped, rounded, significant, typeset};
use crate::{Ending, Picture, Record, VERSION};
use html::escape;

const STYLE: &str = include_str!("report/style.css");
/// Rows of a table that are shown; the CSV has all.
const ROWS_SHOWN: usize = 24;

/// The report as an HTML page.
pub fn html(record: &Record) -> String {
    let title = escape(record.scenario.title());
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n\
         <meta name=\"generator\" content=\"Corpuscle {VERSION}\">\n<title>{title} · Corpuscle</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n"
    );
    page += &header(record, &title);
    page += "<main>\n";
    page += &checks(&record.checks);
    page += &pictures(&record.pictures);
    page += &charts(record);
    page += &record.tables.iter().map(table).collect::<String>();
    page += "<section class=\"columns\">\n";
    page += &parameters(record);
    page += &honesty(record);
    page += "</section>\n";
    page += &reproduce(record);
    page += "</main>\n";
    let _ = write!(
        page,
        "<footer>Corpuscle {VERSION} · {} · seed {} · complete in itself: this page loads nothing.</footer>\n</body>\n</html>\n",
        escape(record.scenario.name()),
        record.scenario.settings.seed
    );
    page
}

/// A chart as an SVG file of its own, with the report's colours for light and dark screens.
pub fn chart_file(chart: &Chart) -> String {
    let drawn = chart::svg(chart);
    let inside = drawn.strip_prefix("<svg").unwrap_or(&drawn);
    let (attributes, rest) = inside.split_once('>').unwrap_or((inside, ""));
    let fonts = "font-family=\"Inter, 'Segoe UI', Helvetica, Arial, 'DejaVu Sans', sans-serif\" font-size=\"12.5\"";
    let height = chart::height(chart) + 16.0;
    let ground = format!("<rect x=\"-8\" y=\"-8\" width=\"656\" height=\"{height}\" style=\"fill: var(--paper)\"/>");
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" width=\"840\" {fonts}{attributes}>\n\
         <title>{}</title>\n<style>\n{STYLE}</style>\n{ground}{rest}\n",
        escape(&chart.title)
    )
}

fn header(record: &Record, title: &str) -> String {
    let (passed, all) = (record.passed(), record.checks.len());
    let (class, verdict) = match all {
        0 => ("good", "No checks in this run".to_owned()),
        1 if passed == 1 => ("good", "✓ The check passed".to_owned()),
        _ if passed == all => ("good", format!("✓ All {all} checks passed")),
        _ => ("bad", format!("✗ {} of {all} checks failed", all - passed)),
    };
    let mut out = format!(
        "<header>\n<p class=\"kicker\">Corpuscle · laboratory report</p>\n<h1>{title}</h1>\n<p class=\"lede\">{}</p>\n\
         <p class=\"verdict {class}\">{verdict}</p>\n",
        escape(record.scenario.summary())
    );
    let stopped = match &record.ending {
        Ending::Finished => None,
        Ending::Running => Some("This run is on its way.".to_owned()),
        Ending::Interrupted => Some("This run was interrupted.".to_owned()),
        Ending::Failed(failure) => Some(format!("This run could not be finished: {failure}.")),
    };
    if let Some(stopped) = stopped {
        let _ = writeln!(
            out,
            "<p class=\"notice\"><b>{}</b> It reached t = {} of {}; everything below is what had been measured by then.</p>",
            escape(&stopped),
            number(record.time),
            number(record.end)
        );
    }
    let mut facts = vec![("Physical time", number(record.time)), ("Seed", record.scenario.settings.seed.to_string())];
    let unit = capitalised(if record.honesty.work_unit.is_empty() { "work" } else { record.honesty.work_unit });
    facts.push((&unit, grouped(record.honesty.work)));
    if let Some(drift) = record.honesty.energy_drift {
        facts.push(("Relative energy drift", brief(drift)));
    }
    facts.push(("Time in the engine", format!("{} s", brief(record.wall.as_secs_f64()))));
    out += "<dl class=\"facts\">";
    for (name, value) in facts {
        let _ = write!(out, "<div><dt>{}</dt><dd>{}</dd></div>", escape(name), escape(&value));
    }
    out + "</dl>\n</header>\n"
}

fn checks(checks: &[Check]) -> String {
    if checks.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<section id=\"checks\">\n<h2>Measured beside theory</h2>\n<div class=\"scroll\"><table>\n<thead><tr><th></th><th>Quantity</th>\
         <th class=\"number\">Measured ± standard error</th><th class=\"number\">Expected</th><th class=\"number\">z</th>\
         <th></th></tr></thead>\n<tbody>\n",
    );
    for check in checks {
        let (class, mark) = if check.passed { ("good", "✓") } else { ("bad", "✗") };
        let unit = if check.unit.is_empty() { String::new() } else { format!(" {}", check.unit) };
        let measured = match check.verdict {
            Verdict::Agreement => typeset(&rounded(check.measured, check.standard_error)),
            Verdict::AtMost | Verdict::AtLeast => short(check.measured),
        } + &unit;
        let expected = match check.verdict {
            Verdict::Agreement => number(check.expected),
            Verdict::AtMost => format!("at most {}", short(check.expected)),
            Verdict::AtLeast => format!("at least {}", short(check.expected)),
        } + &unit;
        let z = check.z.map(|z| format!("{z:+.2}").replace('-', "−")).unwrap_or_default();
        let _ = writeln!(
            out,
            "<tr class=\"{class}\"><td class=\"mark\" aria-label=\"{}\">{mark}</td><td class=\"quantity\">{}<div class=\"reference\">{}</div></td>\
             <td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{z}</td><td>{}</td></tr>",
            if check.passed { "passed" } else { "failed" },
            escape(&check.quantity),
            escape(&check.reference),
            escape(&measured),
            escape(&expected),
            check.z.map(|z| gauge(z, check.passed)).unwrap_or_default()
        );
    }
    out + "</tbody></table></div>\n<p class=\"note\">z is the difference between measurement and expectation in standard errors, drawn from −4 to 4. Of \
           correct measurements 68 % lie within 1, 95 % within 2; one in 15,787 beyond 4, where a check counts as failed. Bounds on \
           numerical errors have no z.</p>\n</section>\n"
}

/// A scale from -4 to 4 standard errors with the measurement on it.
fn gauge(z: f64, passed: bool) -> String {
    let place = 56.0 + 12.0 * z.clamp(-4.4, 4.4);
    let place = if place.is_finite() { place } else { 108.8 };
    format!(
        "<svg class=\"gauge\" viewBox=\"0 0 112 16\" aria-hidden=\"true\"><rect class=\"range\" x=\"8\" y=\"4\" width=\"96\" height=\"8\" \
         rx=\"4\"/><rect class=\"core\" x=\"44\" y=\"4\" width=\"24\" height=\"8\"/><path d=\"M56 1v14\"/><circle class=\"{}\" \
         cx=\"{place:.1}\" cy=\"8\" r=\"4.2\"/></svg>",
        if passed { "good" } else { "bad" }
    )
}

fn pictures(pictures: &[Picture]) -> String {
    if pictures.is_empty() {
        return String::new();
    }
    let mut out = String::from("<section id=\"pictures\">\n<h2>The system</h2>\n<div class=\"pictures\">\n");
    for picture in pictures {
        // Gaps part a caption on its picture; in running text they close up.
        let caption = escape(&picture.caption.split("   ").collect::<Vec<_>>().join(" · "));
        // Many a caption begins with the time itself.
        let time = if caption.starts_with("t =") { String::new() } else { format!("<b>t = {}</b> ", number(picture.time)) };
        let _ = writeln!(
            out,
            "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\"><figcaption>{time}{caption}</figcaption></figure>",
            STANDARD.encode(&picture.png)
        );
    }
    out + "</div>\n</section>\n"
}

fn charts(record: &Record) -> String {
    if record.charts.is_empty() {
        return String::new();
    }
    let mut out = String::from("<section id=\"charts\">\n<h2>Charts</h2>\n<div class=\"charts\">\n");
    for chart in &record.charts {
        let _ = writeln!(
            out,
            "<figure class=\"chart\"><h3>{}</h3>{}<figcaption>{}</figcaption></figure>",
            escape(&chart.title),
            chart::svg(chart),
            escape(&chart.note)
        );
    }
    out + "</div>\n</section>\n"
}

fn table(table: &Table) -> String {
    let mut out = format!(
        "<section>\n<h2>{}</h2>\n<div class=\"scroll\"><table>\n<thead><tr>",
        escape(&capitalised(&table.name.replace('-', " ")))
    );
    for column in &table.columns {
        let _ = write!(out, "<th class=\"number\">{}</th>", escape(&column.replace('_', " ")));
    }
    out += "</tr></thead>\n<tbody>\n";
    for row in table.rows.iter().take(ROWS_SHOWN) {
        out += "<tr>";
        for &value in row {
            let _ = write!(out, "<td class=\"number\">{}</td>", number(value));
        }
        out += "</tr>\n";
    }
    out += "</tbody></table></div>\n";
    if let Some(more) = table.rows.len().checked_sub(ROWS_SHOWN).filter(|&more| more > 0) {
        let _ = writeln!(out, "<p class=\"note\">{more} more rows are in the CSV file.</p>");
    }
    out + "</section>\n"
}

fn parameters(record: &Record) -> String {
    if record.scenario.parameters().next().is_none() {
        return String::new();
    }
    let mut out = String::from(
        "<div id=\"parameters\"><h2>Parameters</h2>\n<div class=\"scroll\"><table><thead><tr><th>Key</th><th class=\"number\">Value</th>\
         <th>Meaning</th></tr></thead>\n<tbody>\n",
    );
    for (parameter, value, given) in record.scenario.parameters() {
        let value = match value {
            Value::List(list) if list.is_empty() => "(none)".to_owned(),
            value => value.to_string(),
        };
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
        let _ = writeln!(
            out,
            "<tr{}><td class=\"key\">{}</td><td class=\"number\">{}</td><td class=\"help\">{}</td></tr>",
            if given { " class=\"given\"" } else { "" },
            escape(parameter.name),
            escape(&(value + &unit)),
            escape(parameter.help)
        );
    }
    out + "</tbody></table></div></div>\n"
}

fn honesty(record: &Record) -> String {
    let honesty = &record.honesty;
    let share = |value: Option<f64>| value.map(brief);
    let rows = [
        ("Engine", Some(honesty.engine.clone()), "what moved the particles"),
        ("Energy", share(honesty.energy_drift), "largest relative drift seen"),
        ("Momentum", share(honesty.momentum_drift), "largest drift seen, over the sum of all |m v|"),
        ("Angular momentum", share(honesty.angular_momentum_drift), "largest relative drift seen"),
        ("Overlap", share(honesty.largest_overlap), "deepest seen, over the contact distance"),
        ("Stability number", share(honesty.stability_number), "time step times highest frequency"),
        (
            "Rejected events",
            honesty.rejected_events.map(grouped),
            "obsolete when their time came, since a partner had collided meanwhile",
        ),
        (
            "Precision horizon",
            honesty.precision_horizon.map(short),
            "time until which single paths are known; averages hold beyond",
        ),
        ("Rate", record.rate().map(|rate| format!("{} a second", brief(rate))), "on the clock, on this machine"),
    ];
    let mut out = String::from(
        "<div id=\"honesty\"><h2>Numerical honesty</h2>\n<div class=\"scroll\"><table><thead><tr><th>What</th><th class=\"number\">Value</th>\
         <th>Meaning</th></tr></thead>\n<tbody>\n",
    );
    for (what, value, meaning) in rows {
        let Some(value) = value else { continue };
        let _ =
            writeln!(out, "<tr><td>{what}</td><td class=\"number\">{}</td><td class=\"help\">{meaning}</td></tr>", escape(&value));
    }
    out + "</tbody></table></div></div>\n"
}

fn reproduce(record: &Record) -> String {
    format!(
        "<section id=\"reproduce\">\n<h2>The same again</h2>\n<p>This scenario gives the same run, bit for bit, with Corpuscle {VERSION}. \
         Save it as <code>scenario.toml</code> (it lies beside this report) and type <code>corpuscle run scenario.toml</code>.</p>\n\
         <pre>{}</pre>\n</section>\n",
        escape(&record.scenario.to_toml())
    )
}

fn number(value: f64) -> String {
    typeset(&Rounded { error: None, ..rounded(value, None) })
}

/// A bound, or what is held against one.
fn short(value: f64) -> String {
    number(significant(value, 3).parse().unwrap_or(value))
}

/// A number of which only the size matters.
fn brief(value: f64) -> String {
    number(significant(value, 2).parse().unwrap_or(value))
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests;
