//! The experiment `brownian` against theory, over seeds.

mod common;

use common::{agrees_over_more_seeds, agrees_over_seeds, checks_on, refused, run};

#[test]
fn discs_agree_with_theory() {
    agrees_over_seeds("brownian", &[("replicas", "24")]);
}

#[test]
fn spheres_agree_with_theory() {
    agrees_over_seeds("brownian", &[("dimension", "3"), ("radius", "1.5"), ("replicas", "24"), ("duration", "40")]);
}

#[test]
fn between_walls_the_heavy_particle_has_the_temperature_of_the_bath() {
    let checks = run("brownian", 1, &[("boundary", "walls"), ("replicas", "24"), ("duration", "20")], 1).checks();
    assert!(checks.iter().any(|check| check.z.is_some()));
    for check in checks {
        assert!(check.passed, "{check:?}");
    }
}

#[test]
fn between_walls_the_displacement_saturates() {
    let few = [("boundary", "walls"), ("particles", "60"), ("radius", "1.5"), ("replicas", "16"), ("duration", "60")];
    let checks = run("brownian", 1, &few, 1).checks();
    assert!(checks.iter().any(|check| check.quantity.contains("saturated")), "{checks:?}");
    agrees_over_more_seeds("brownian", &few, 20);
}

#[test]
fn sweeps_agree_with_theory() {
    let few = [("replicas", "24")];
    agrees_over_seeds("brownian", &[&few[..], &[("sweep", "mass"), ("masses", "15,30")]].concat());
    agrees_over_seeds("brownian", &[&few[..], &[("sweep", "radius"), ("radii", "1,2")]].concat());
}

#[test]
fn a_sweep_repeats() {
    let values = [("sweep", "radius"), ("radii", "1,2"), ("replicas", "3"), ("duration", "22"), ("particles", "60")];
    let whole = run("brownian", 3, &values, 1);
    assert_eq!(whole.checks(), run("brownian", 3, &values, 31).checks());
    assert_eq!(whole.checks(), checks_on(1, "brownian", 3, &values));
}

#[test]
fn stopping_on_the_way_changes_nothing() {
    let values = [("replicas", "4"), ("duration", "22"), ("particles", "100")];
    assert_eq!(run("brownian", 3, &values, 1).checks(), run("brownian", 3, &values, 97).checks());
}

#[test]
fn threads_change_nothing() {
    let values = [("replicas", "6"), ("duration", "6"), ("particles", "100")];
    assert_eq!(checks_on(1, "brownian", 3, &values), checks_on(2, "brownian", 3, &values));
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    assert_eq!(refused("brownian", &[("radius", "100")]), "radius");
    assert_eq!(refused("brownian", &[("particles", "3"), ("packing_fraction", "0.4")]), "radius");
    assert_eq!(refused("brownian", &[("sweep", "radius"), ("radii", "1,100")]), "radius");
    assert_eq!(refused("brownian", &[("sweep", "mass"), ("masses", "")]), "masses");
    assert_eq!(refused("brownian", &[("replicas", "1")]), "replicas");
    assert_eq!(refused("brownian", &[("temperature", "-1")]), "temperature");
    assert_eq!(refused("brownian", &[("mass", "NaN")]), "mass");
}
