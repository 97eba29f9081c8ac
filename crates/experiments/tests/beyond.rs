//! The experiments beyond the paper against theory, over seeds.

mod common;

use common::{agrees_over_more_seeds, agrees_over_seeds, checks_on, refused, run};

/// Everything the run of one experiment says does not depend on where it stops or on how many threads there are.
fn repeats(experiment: &str, values: &[(&str, &str)]) {
    let whole = run(experiment, 3, values, 3).checks();
    assert_eq!(whole, run(experiment, 3, values, 29).checks(), "stops");
    assert_eq!(whole, checks_on(1, experiment, 3, values), "one thread");
    assert!(!whole.is_empty());
}

#[test]
fn atmosphere() {
    agrees_over_seeds("atmosphere", &[("replicas", "8"), ("duration", "30")]);
    repeats("atmosphere", &[("replicas", "3"), ("duration", "12")]);
    assert_eq!(refused("atmosphere", &[("gravity", "1")]), "gravity");
}

#[test]
fn atmosphere_of_spheres_over_an_insulating_floor() {
    let few = [("particles", "60"), ("heavy_particles", "40"), ("duration", "20"), ("replicas", "8")];
    agrees_over_seeds("atmosphere", &[&[("dimension", "3"), ("floor", "insulating")][..], &few].concat());
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
        agrees_over_more_seeds("billiard", &[("layout", layout), ("coverage", "0.3"), ("replicas", "12")], 24);
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
    agrees_over_more_seeds("granular", &[("crowd", "50"), ("replicas", "24")], 16);
    repeats("granular", &[("replicas", "3"), ("duration", "5"), ("crowd", "200")]);
    assert_eq!(refused("granular", &[("restitution", "1")]), "restitution");
}

#[test]
fn granular_spheres() {
    let few = [("particles", "100"), ("crowd", "50"), ("replicas", "8"), ("duration", "5")];
    agrees_over_more_seeds("granular", &[&[("dimension", "3"), ("restitution", "0.9")][..], &few].concat(), 16);
}

/// One agreement each of three kinds a run: fewer scores than the others, over more seeds.
#[test]
fn sound() {
    agrees_over_more_seeds("sound", &[("replicas", "12"), ("particles", "400")], 16);
    repeats("sound", &[("replicas", "3"), ("particles", "100"), ("duration", "0.6")]);
    assert_eq!(refused("sound", &[("packing_fraction", "0.7")]), "packing_fraction");
}

/// Fair, and forgetful in the long run: three agreements a run.
#[test]
fn galton() {
    agrees_over_more_seeds("galton", &[("balls", "200"), ("replicas", "16")], 16);
    repeats("galton", &[("replicas", "4"), ("balls", "120")]);
    assert_eq!(refused("galton", &[("ball_radius", "0.3")]), "ball_radius");
}

#[test]
fn diffusion() {
    agrees_over_more_seeds("diffusion", &[("particles", "600"), ("replicas", "12")], 12);
    repeats("diffusion", &[("replicas", "3"), ("particles", "200")]);
    assert_eq!(refused("diffusion", &[("dimension", "3"), ("packing_fraction", "0.6")]), "packing_fraction");
}

#[test]
fn diffusion_of_spheres() {
    for (packing, particles) in [("0.15", "1200"), ("0.25", "600")] {
        let values =
            [("dimension", "3"), ("packing_fraction", packing), ("particles", particles), ("replicas", "8"), ("duration", "1.5")];
        agrees_over_more_seeds("diffusion", &values, 16);
    }
}

#[test]
fn engines() {
    agrees_over_more_seeds("engines", &[("particles", "80"), ("replicas", "6")], 12);
    repeats("engines", &[("replicas", "3"), ("particles", "40"), ("duration", "8")]);
    assert_eq!(refused("engines", &[("hardness", "1")]), "hardness");
}

/// The liquid at five packings, and the crystal within the error of its published pressure.
#[test]
fn hard_disk_melting() {
    let few = [("side", "8"), ("packings", "0.3,0.4,0.5,0.56,0.6,0.8"), ("duration", "12")];
    agrees_over_more_seeds("hard-disk-melting", &few, 10);
    let fewer = [("side", "8"), ("small_side", "8"), ("packings", "0.6,0.7,0.8"), ("replicas", "2"), ("duration", "5")];
    repeats("hard-disk-melting", &fewer);
    assert_eq!(refused("hard-disk-melting", &[("side", "9")]), "side");
    assert_eq!(refused("hard-disk-melting", &[("packing_fraction", "0.8"), ("begin", "disorder")]), "packing_fraction");
}

/// Three agreements a run, each of a series that has to be long against its own correlations.
#[test]
fn lennard_jones() {
    let small = [("state", "solid"), ("particles", "256"), ("time_step", "0.008"), ("duration", "60")];
    agrees_over_more_seeds("lennard-jones", &small, 16);
    repeats("lennard-jones", &[("particles", "256"), ("duration", "8")]);
    assert_eq!(refused("lennard-jones", &[("state", "solid"), ("particles", "300")]), "particles");
}

/// Published values of liquids: the noise of their pressure takes long runs.
#[test]
#[ignore = "minutes: make soak"]
fn soak_lennard_jones_liquid() {
    agrees_over_more_seeds("lennard-jones", &[], 16);
}
