//! The experiment `entropy` against theory, over seeds.

mod common;

use common::{agrees_over_more_seeds, agrees_over_seeds, checks_on, refused, run};

#[test]
fn discs_agree_with_theory() {
    agrees_over_seeds("entropy", &[("replicas", "60")]);
}

#[test]
fn spheres_agree_with_theory() {
    let values = [("dimension", "3"), ("cells", "4"), ("replicas", "40"), ("duration", "400"), ("reverse_at", "15")];
    agrees_over_seeds("entropy", &values);
}

/// Every other process in the plane and in space, small; few checks a run, so more seeds.
#[test]
fn loschmidts_echo() {
    let few = [("process", "echo"), ("particles", "60"), ("replicas", "16"), ("perturbations", "1e-12")];
    agrees_over_more_seeds("entropy", &few, 40);
    for check in run("entropy", 1, &[&few[..], &[("dimension", "3")]].concat(), 1).checks() {
        assert!(check.passed, "{check:?}");
    }
}

#[test]
fn effusion() {
    let few = [("process", "effusion"), ("particles", "60"), ("replicas", "12")];
    agrees_over_more_seeds("entropy", &few, 20);
    agrees_over_more_seeds("entropy", &[&few[..], &[("dimension", "3"), ("particles", "120")]].concat(), 20);
}

#[test]
fn recurrence() {
    let few = [("process", "recurrence"), ("particles", "7"), ("replicas", "40")];
    agrees_over_seeds("entropy", &few);
    agrees_over_seeds("entropy", &[&few[..], &[("dimension", "3")]].concat());
}

#[test]
fn relaxation() {
    let few = [("process", "relaxation"), ("particles", "60"), ("replicas", "30")];
    agrees_over_seeds("entropy", &few);
    agrees_over_seeds("entropy", &[&few[..], &[("dimension", "3")]].concat());
}

#[test]
fn maxwells_demon() {
    let few = [("process", "demon"), ("particles", "40"), ("replicas", "12")];
    agrees_over_more_seeds("entropy", &few, 40);
    for check in run("entropy", 1, &[&few[..], &[("rule", "fast")]].concat(), 1).checks() {
        assert!(check.passed, "{check:?}");
    }
}

#[test]
fn every_process_repeats() {
    for process in ["echo", "effusion", "recurrence", "relaxation", "demon"] {
        let values = [("process", process), ("particles", "30"), ("replicas", "3")];
        let whole = run("entropy", 3, &values, 1);
        let stopped = run("entropy", 3, &values, 29);
        assert_eq!(format!("{:?}", whole.charts()), format!("{:?}", stopped.charts()), "{process}");
        assert_eq!(whole.checks(), checks_on(1, "entropy", 3, &values), "{process}");
        assert!(!whole.charts().is_empty());
    }
}

#[test]
fn stopping_on_the_way_changes_nothing() {
    let values = [("replicas", "4"), ("duration", "200"), ("process", "mixing")];
    assert_eq!(run("entropy", 3, &values, 1).checks(), run("entropy", 3, &values, 97).checks());
}

#[test]
fn threads_change_nothing() {
    let values = [("replicas", "6"), ("duration", "100"), ("reverse_at", "30")];
    assert_eq!(checks_on(1, "entropy", 3, &values), checks_on(2, "entropy", 3, &values));
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    assert_eq!(refused("entropy", &[("cells", "7")]), "cells");
    assert_eq!(refused("entropy", &[("hole_width", "0.9")]), "hole_width");
    assert_eq!(refused("entropy", &[("hole_width", "1000")]), "hole_width");
    assert_eq!(refused("entropy", &[("reverse_at", "900")]), "reverse_at");
    assert_eq!(refused("entropy", &[("process", "demon"), ("hole_width", "0.9")]), "hole_width");
    assert_eq!(refused("entropy", &[("process", "effusion"), ("particles", "4"), ("packing_fraction", "0.1")]), "hole_width");
    assert_eq!(refused("entropy", &[("process", "echo"), ("perturbations", "1")]), "perturbations");
    assert_eq!(refused("entropy", &[("particles", "2"), ("packing_fraction", "0.3")]), "particles");
}
