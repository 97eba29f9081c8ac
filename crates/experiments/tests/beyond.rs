//! The experiments beyond the paper against theory, over seeds.

mod common;

use common::{agrees_over_seeds, checks_on, refused, run};

/// Everything the run of one experiment says does not depend on where it stops or on how many threads there are.
fn repeats(experiment: &str, values: &[(&str, &str)]) {
    let whole = run(experiment, 3, values, 3).checks();
    assert_eq!(whole, run(experiment, 3, values, 29).checks(), "stops");
    assert_eq!(whole, checks_on(1, experiment, 3, values), "one thread");
    assert!(!whole.is_empty());
}

#[test]
fn atmosphere() {
    agrees_over_seeds("atmosphere", &[("replicas", "12")]);
    repeats("atmosphere", &[("replicas", "3"), ("duration", "12")]);
    assert_eq!(refused("atmosphere", &[("gravity", "1")]), "gravity");
}

#[test]
fn atmosphere_of_spheres_over_an_insulating_floor() {
    agrees_over_seeds("atmosphere", &[("dimension", "3"), ("floor", "insulating"), ("replicas", "12")]);
}

#[test]
fn billiard() {
    agrees_over_seeds("billiard", &[("replicas", "16")]);
    repeats("billiard", &[("replicas", "3"), ("duration", "10")]);
    assert_eq!(refused("billiard", &[("coverage", "0.5")]), "coverage");
}

#[test]
fn billiards_of_sinai() {
    for layout in ["square", "triangular"] {
        agrees_over_seeds("billiard", &[("layout", layout), ("coverage", "0.3"), ("replicas", "12")]);
    }
}

/// Nothing is left to chance: exact rules, with bounds of rounding and of the gap.
#[test]
fn newton_cradle() {
    for values in [
        &[][..],
        &[("balls", "7"), ("lifted", "3")],
        &[("lifted", "1"), ("restitution", "0.9"), ("duration", "200")],
        &[("masses", "8,4,2,1"), ("lifted", "1")],
        &[("masses", "1,3,0.5,2"), ("lifted", "1"), ("restitution", "0.8")],
    ] {
        let checks = run("newton-cradle", 1, values, 7).checks();
        assert!(checks.len() >= 2);
        for check in checks {
            println!("{check:?}");
            assert!(check.passed, "{check:?}");
        }
    }
    repeats("newton-cradle", &[("restitution", "0.95")]);
    assert_eq!(refused("newton-cradle", &[("lifted", "5")]), "lifted");
}

#[test]
fn granular() {
    agrees_over_seeds("granular", &[("crowd", "50")]);
    repeats("granular", &[("replicas", "3"), ("duration", "5"), ("crowd", "200")]);
    assert_eq!(refused("granular", &[("restitution", "1")]), "restitution");
}

#[test]
fn granular_spheres() {
    agrees_over_seeds("granular", &[("dimension", "3"), ("restitution", "0.95"), ("crowd", "50"), ("replicas", "24")]);
}
