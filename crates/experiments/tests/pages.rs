//! Each experiment has its page in docs/, with the table of its parameters as they are declared.

use std::path::PathBuf;

use corpuscle_experiments::{REGISTRY, parameter};

const HEADING: &str = "## Parameters\n";

/// With `WRITE_PAGES` in the environment the tables are brought up to date, before `## Limits`.
#[test]
fn every_page_has_the_table_of_its_parameters() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/experiments");
    for experiment in REGISTRY {
        let path = folder.join(experiment.name).with_extension("md");
        let page = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let table = format!("{HEADING}{}\n", parameter::table(experiment.parameters));
        if page.contains(&table) {
            continue;
        }
        let limits = page.find("## Limits").unwrap_or(page.len());
        let start = page.find(HEADING).unwrap_or(limits);
        let end = page[start + 1..].find("\n## ").map_or(limits, |next| start + next + 2);
        let end = if start == limits { limits } else { end };
        let right = format!("{}{table}{}", &page[..start], &page[end..]);
        if std::env::var_os("WRITE_PAGES").is_some() {
            std::fs::write(&path, right).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        } else {
            panic!("the table of parameters on {} is not what is declared: WRITE_PAGES=1 mends it", path.display());
        }
    }
}
