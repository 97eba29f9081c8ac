use std::time::Duration;

use super::*;
use crate::example::{OSCILLATOR, REGISTRY};
use crate::{Scenario, csv, summary};

fn record(scenario: &Scenario) -> Record<'_> {
    let mut simulation = scenario.start().unwrap();
    simulation.advance(2.0).unwrap();
    let mut record = Record::of(scenario, simulation.as_ref(), 2.0, Ending::Finished, Duration::from_millis(1500));
    record.pictures.push(Picture { time: 1.0, caption: "the <mass>".into(), png: vec![0x89, b'P', b'N', b'G'] });
    record
}

/// Names of the open tags at the end: a page whose tags match leaves none. Void elements and self-closed tags are skipped.
fn unclosed(page: &str) -> Vec<String> {
    let mut open: Vec<String> = vec![];
    let body = page.split_once("<body>").unwrap().1;
    for tag in body.split('<').skip(1) {
        let tag = tag.split('>').next().unwrap();
        let name: String = tag.trim_start_matches('/').chars().take_while(|c| c.is_alphanumeric()).collect();
        if tag.starts_with('/') {
            assert_eq!(open.pop().as_deref(), Some(name.as_str()), "</{name}> closes nothing");
        } else if !tag.ends_with('/') && name != "img" && name != "meta" {
            open.push(name);
        }
    }
    open
}

#[test]
fn a_report_holds_everything_escaped_and_in_one_file() {
    let scenario = Scenario::new(&OSCILLATOR);
    let page = html(&record(&scenario));
    assert!(unclosed(page.trim_end().trim_end_matches("</html>").trim_end().trim_end_matches("</body>")).is_empty());
    for part in [
        "<title>Harmonic &lt;oscillator&gt; · Corpuscle</title>",
        "All 2 checks passed",
        "period &lt;T&gt;",
        "1.0010 ± 0.0010 s",
        "at most 10⁻¹²",
        "+1.00",
        "Place &amp; time",
        "place &lt;x&gt; (m)",
        "measured, &quot;here&quot;",
        "data:image/png;base64,iVBORw",
        "the &lt;mass&gt;",
        "12\u{202f}345",
        "experiment = &quot;oscillator&quot;",
        "Turning points",
        "class=\"error\"",
    ] {
        assert!(page.contains(part), "{part} is not in the report");
    }
    for forbidden in ["<script", "http://", "https://", "<link", "@import", "url("] {
        assert!(!page.contains(forbidden), "{forbidden} is in the report");
    }
}

#[test]
fn an_unfinished_run_says_so() {
    let scenario = Scenario::new(&OSCILLATOR);
    let mut record = record(&scenario);
    record.ending = Ending::Failed(corpuscle_core::Failure { time: 1.0, particle: Some(3), cause: "<overflow>".into() });
    assert!(html(&record).contains("particle 3: &lt;overflow&gt;"));
    assert!(summary::json(&record).contains("\"ending\": \"failed\""));
    record.ending = Ending::Interrupted;
    assert!(html(&record).contains("This run was interrupted."));
}

#[test]
fn the_summary_keeps_its_contract() {
    let mut scenario = Scenario::new(&OSCILLATOR);
    scenario.set("frequency", "0.1").unwrap();
    let text = summary::json(&record(&scenario));
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["experiment"], "oscillator");
    assert_eq!(summary["seed"], 1);
    assert_eq!(summary["parameters"]["frequency"], 0.1);
    assert_eq!(summary["parameters"]["start"], "middle");
    assert_eq!(summary["engine"]["steps"], 12345);
    assert_eq!(summary["engine"]["wall_s"], 1.5);
    assert_eq!(summary["engine"]["rate"], 8230.0);
    assert_eq!(summary["checks"][0]["quantity"], "period <T>");
    assert_eq!(summary["checks"][0]["passed"], true);
    assert!(summary["checks"][1]["standard_error"].is_null());
    for key in ["quantity", "measured", "standard_error", "expected", "z", "passed", "reference"] {
        assert!(summary["checks"][0].get(key).is_some(), "{key}");
    }
}

#[test]
fn series_and_tables_keep_their_bits() {
    let scenario = Scenario::new(REGISTRY[0]);
    let record = record(&scenario);
    let text = String::from_utf8(csv::chart(&record.charts[0])).unwrap();
    assert!(text.starts_with("series,time_t_s,place_x_m,standard_error\n"), "{text}");
    let mut reader = ::csv::Reader::from_reader(text.as_bytes());
    let rows: Vec<(String, f64, f64, Option<f64>)> = reader.deserialize().map(Result::unwrap).collect();
    let series = &record.charts[0].series[1];
    let measured: Vec<_> = rows.into_iter().filter(|row| row.0 == series.name).collect();
    assert_eq!(measured.iter().map(|row| row.2).collect::<Vec<_>>(), series.y);
    assert!(measured.iter().all(|row| row.3 == Some(0.07)));
    let table = String::from_utf8(csv::table(&record.tables[0])).unwrap();
    assert_eq!(table, "time_s\n0.30000000000000004\nNaN\n");
}
