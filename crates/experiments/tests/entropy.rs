//! The experiment `entropy` against theory, over seeds.

mod common;

use common::{agrees_over_seeds, checks_on, refused, run};

#[test]
fn discs_agree_with_theory() {
    agrees_over_seeds("entropy", &[("replicas", "60")]);
}

#[test]
fn spheres_agree_with_theory() {
    let values = [("dimension", "3"), ("cells", "4"), ("replicas", "40"), ("duration", "400"), ("reverse_at", "15")];
    agrees_over_seeds("entropy", &values);
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
    assert_eq!(refused("entropy", &[("particles", "2"), ("packing_fraction", "0.3")]), "particles");
}
