//! Forces, bonds and heat baths of soft systems.

use super::*;

/// 64 soft balls of two names in a periodic box of density 0.37.
const BALLS: &str = "engine = 'time'\nduration = 4.0\n[box]\nlower = [0.0, 0.0, 0.0]\nupper = [7.0, 7.0, 7.0]\nfaces = 'periodic'\n\
                     [[species]]\nname = 'A'\ncount = 64\nradius = 0.5\n[[species]]\nname = 'B'\ncount = 64\nradius = 0.5\n";
const VERLET: &str = "[integrator]\nname = 'velocity-verlet'\ntime_step = 0.002\n";

/// Every pair potential, alone and as a table by names, keeps energy and momentum.
#[test]
fn every_potential_conserves_energy_and_momentum() {
    let tables = [
        "[forces.lennard_jones]\ncutoff = 3.0\nforce_shifted = true\n",
        "[forces.lennard_jones]\n[[forces.lennard_jones.between]]\nnames = ['A', 'B']\nepsilon = 1.5\nsigma = 0.8\n\
         [[forces.lennard_jones.between]]\nnames = ['B', 'B']\nepsilon = 0.5\nsigma = 0.88\n",
        "[forces.wca]\nbetween = [{ names = ['B', 'A'], sigma = 1.1 }]\n",
        "[forces.inverse_power]\nexponent = 12\n",
        "[forces.yukawa]\nepsilon = 3.0\nscreening_length = 0.4\ncutoff = 3.0\n",
        "[forces.harmonic_repulsion]\nstiffness = 80.0\ndiameter = 1.2\n",
        "[forces.morse]\nequilibrium = 1.1\nsteepness = 4.0\n",
        "[forces.wca]\n[forces.coulomb]\naccuracy = 1e-6\ncharges = { A = 0.7, B = -0.7 }\n",
    ];
    for table in tables {
        let simulation = run(&(BALLS.to_owned() + VERLET + table), 3).unwrap_or_else(|failure| panic!("{failure}\n{table}"));
        let energy = check(&*simulation, "largest energy error");
        assert!(energy.passed && energy.measured > 0.0, "{table}: {energy:?}");
        assert!(check(&*simulation, "largest momentum").passed, "{table}: {:?}", check(&*simulation, "largest momentum"));
    }
}

/// Names of a table act between the particles that have them.
#[test]
fn numbers_between_two_names_act_between_these() {
    let pair = |table: &str| {
        let text = format!(
            "engine = 'time'\nduration = 0.01\n[box]\nlower = [-5.0, -5.0]\nupper = [5.0, 5.0]\nfaces = 'open'\n\
             [[particle]]\nname = 'A'\nposition = [0.0, 0.0]\n[[particle]]\nname = 'B'\nposition = [1.0, 0.0]\n{VERLET}{table}"
        );
        let simulation = started(&text, 1);
        let energy = simulation.charts().iter().find(|chart| chart.name == "energy").cloned().unwrap();
        energy.series.iter().find(|series| series.name == "potential").map_or(0.0, |series| series.y[0])
    };
    // 4 epsilon (1/r^12 - 1/r^6) vanishes at r = 1; sigma = 1.1 gives 4 x 2 (1.1^12 - 1.1^6), less its value at the cutoff.
    let lennard_jones = |epsilon: f64, s: f64| 4.0 * epsilon * (s.powi(12) - s.powi(6));
    let between =
        |names: &str| pair(&format!("[forces.lennard_jones]\nbetween = [{{ names = {names}, epsilon = 2.0, sigma = 1.1 }}]\n"));
    let expected = |epsilon: f64, sigma: f64| lennard_jones(epsilon, sigma) - lennard_jones(epsilon, 1.0 / 2.5);
    for (names, expected) in
        [("['A', 'B']", expected(2.0, 1.1)), ("['B', 'A']", expected(2.0, 1.1)), ("['A', 'A']", expected(1.0, 1.0))]
    {
        assert!((between(names) - expected).abs() < 1e-9, "{names}: {} {expected}", between(names));
    }
    // Charges by name: k q q'/r in open space.
    assert!((pair("[forces.coulomb]\nconstant = 3.0\ncharges = { A = 1.5, B = -0.5 }\n") + 2.25).abs() < 1e-12);
}

/// A row of bonds is as many bonds written one by one.
#[test]
fn a_row_of_bonds_is_the_same_as_its_bonds() {
    let beads = (0..6).map(|i| format!("[[particle]]\nposition = [{i}.0, {}.0]\n", i % 2)).collect::<Vec<_>>().concat();
    let text = format!(
        "engine = 'time'\nduration = 3.0\n[box]\nlower = [-9.0, -9.0]\nupper = [9.0, 9.0]\nfaces = 'open'\n{beads}{VERLET}"
    );
    for law in [
        "[[spring]]\nstiffness = 20.0\nrest_length = 1.0\nquadratic = 0.3\ncubic = 0.2\n",
        "[[fene]]\nstiffness = 20.0\nlongest = 2.0\n",
        "[[toda]]\nstiffness = 20.0\nsteepness = 1.5\nrest_length = 1.0\n",
    ] {
        let row = format!("{text}{law}first = 0\nsecond = 1\ncount = 5\n");
        let each = (0..5).map(|i| format!("{law}first = {i}\nsecond = {}\n", i + 1)).collect::<Vec<_>>().concat();
        let (row, each) = (run(&row, 1).unwrap(), run(&(text.clone() + &each), 1).unwrap());
        assert_eq!(fingerprint(&*row), fingerprint(&*each));
        assert!(check(&*row, "largest energy error").passed && check(&*row, "largest energy error").measured > 0.0);
        assert!(check(&*row, "largest momentum").passed);
    }
}

#[test]
fn a_trap_holds_drag_stills_and_a_shaker_drives() {
    let text = "engine = 'time'\nduration = 6.0\n[box]\nlower = [-9.0, -9.0]\nupper = [9.0, 9.0]\nfaces = 'open'\n\
                [[particle]]\nposition = [1.0, 0.0]\nvelocity = [0.0, 0.5]\n";
    let at = |simulation: &dyn Simulation| simulation.frame().unwrap().particles.position[0];
    let trap = format!("{text}{VERLET}[forces.central]\ncentre = [0.0, 0.0]\nstrength = 4.0\n");
    // cos 2t, and 0.5 sin(2t)/2, to the error (omega dt)^2/24 of the frequency.
    let simulation = run(&trap, 1).unwrap();
    let place = at(&*simulation);
    assert!((place[0] - 12f64.cos()).abs() < 1e-5 && (place[1] - 0.25 * 12f64.sin()).abs() < 1e-5, "{place:?}");
    assert!(check(&*simulation, "largest energy error").passed);
    let drag = run(&format!("{text}{VERLET}[forces.drag]\nrate = 0.5\n"), 1).unwrap();
    assert!((at(&*drag)[1] - (1.0 - (-3f64).exp())).abs() < 1e-5);
    assert!(check(&*drag, "largest rise of the energy").passed);
    let shaken =
        run(&format!("{text}{VERLET}[[drive]]\nparticle = 0\naxis = 'y'\namplitude = 0.5\nangular_frequency = 1.5\n"), 1).unwrap();
    assert!((at(&*shaken)[1] - 0.5 * 9f64.sin()).abs() < 1e-9);
    assert!(shaken.checks().is_empty(), "a drive gives energy that is not counted");
    let pushed = "[[forces.push]]\nparticle = 0\ndirection = [0.0, 2.0]\namplitude = 0.5\nangular_frequency = 0.0\nphase = 1.5707963267948966\n";
    let pushed = run(&format!("{text}{VERLET}{pushed}"), 1).unwrap();
    assert!((at(&*pushed)[1] - (3.0 + 18.0)).abs() < 1e-9, "{:?}", at(&*pushed));
}

/// All baths keep their temperature, at a density where the particles feel each other; the chain keeps its own energy, too.
#[test]
fn heat_baths_keep_their_temperature() {
    let text =
        BALLS.replace("duration = 4.0", "duration = 300.0\nsample_interval = 0.2\nobserve = ['temperature', 'pressure', 'speeds']");
    for bath in [
        "name = 'langevin'\nfriction = 1.0\n",
        "name = 'stochastic-rescaling'\nrelaxation_time = 0.5\n",
        "name = 'nose-hoover'\nrelaxation_time = 0.5\n",
    ] {
        let text = format!("{text}[forces.wca]\n[integrator]\n{bath}time_step = 0.004\ntemperature = 1.4\n");
        let simulation = run(&text, 5).unwrap();
        let temperature = check(&*simulation, "kinetic temperature");
        assert!(temperature.passed && temperature.expected == 1.4 && temperature.z.is_some(), "{bath}: {temperature:?}");
        assert_eq!(simulation.checks().iter().any(|check| check.quantity.starts_with("largest energy")), bath.contains("nose"));
        assert!(simulation.checks().iter().all(|check| check.passed), "{bath}: {:?}", simulation.checks());
    }
}

/// In a trap `m omega^2 r^2/2` is `D/2 k T` in Brownian dynamics as in any other.
#[test]
fn brownian_particles_fill_a_trap_as_boltzmann_says() {
    let text = "engine = 'time'\nduration = 200.0\nobserve = ['mean-squared-displacement']\n\
                [box]\nlower = [-50.0, -50.0]\nupper = [50.0, 50.0]\nfaces = 'open'\n\
                [[species]]\ncount = 50\nradius = 0.1\nlower = [-2.0, -2.0]\nupper = [2.0, 2.0]\n\
                [forces.central]\ncentre = [0.0, 0.0]\nstrength = 1.5\n\
                [integrator]\nname = 'brownian'\ntime_step = 0.02\ntemperature = 0.8\nfriction = 2.0\n";
    let simulation = run(text, 5).unwrap();
    let frame = simulation.frame().unwrap();
    let squares: Vec<f64> = frame.particles.position.iter().map(|r| r[0] * r[0] + r[1] * r[1]).collect();
    let estimate = corpuscle_observe::Estimate::from_replicas(&squares);
    // After 200 relaxation times of 4/3 the particles are independent of their start and of each other.
    let z = estimate.score(2.0 * 0.8 / 1.5);
    assert!(z.abs() < 4.0, "{estimate:?}, z = {z}");
    assert!(simulation.checks().is_empty());
}

#[test]
fn a_force_is_refused_by_its_key() {
    let cases = [
        ("[forces.yukawa]\nscreening_length = 0.0\ncutoff = 3.0\n", "forces.yukawa.screening_length"),
        ("[forces.yukawa]\nscreening_length = 1.0\ncutoff = 4.0\n", "forces.yukawa.cutoff"),
        ("[forces.inverse_power]\nexponent = 0\n", "forces.inverse_power.exponent"),
        ("[forces.morse]\nsteepness = -1.0\n", "forces.morse.steepness"),
        ("[forces.harmonic_repulsion]\nstiffness = nan\n", "forces.harmonic_repulsion.stiffness"),
        ("[forces.lennard_jones]\nbetween = [{ names = ['A', 'C'] }]\n", "forces.lennard_jones.between[0].names"),
        ("[forces.wca]\nsigma = 4.0\n", "forces.wca.sigma"),
        ("[forces.wca]\nforce_shifted = true\n", "forces.wca.force_shifted"),
        ("[forces.coulomb]\ncharges = { C = 1.0 }\n", "forces.coulomb.charges.C"),
        ("[forces.coulomb]\ncharges = { A = 1.0 }\naccuracy = 2.0\n", "forces.coulomb.accuracy"),
        ("[forces.central]\ncentre = [1.0, 1.0, 1.0]\nstrength = 1.0\n", "box.faces"),
        ("[forces.gravity]\nopening_angle = 0.5\n", "box.faces"),
        ("[forces.drag]\nrate = -1.0\n", "forces.drag.rate"),
        (
            "[[forces.push]]\nparticle = 999\ndirection = [1.0, 0.0, 0.0]\namplitude = 1.0\nangular_frequency = 1.0\n",
            "forces.push[0].particle",
        ),
        ("[[fene]]\nfirst = 0\nsecond = 127\nstiffness = 30.0\nlongest = 1.5\n", "fene[0]"),
        ("[[fene]]\nfirst = 0\nsecond = 1\ncount = 128\nstiffness = 30.0\nlongest = 1.5\n", "fene[0].count"),
        ("[[fene]]\nfirst = 0\nsecond = 1\nstiffness = 30.0\nlongest = 4.0\n", "fene[0].longest"),
        (
            "[[spring]]\nfirst = 0\nsecond = 1\ncount = 9\nstiffness = 1.0\n\
             [[spring]]\nfirst = 20\nsecond = 21\nstiffness = 1.0\nrest_length = 5.0\n",
            "spring[1].rest_length",
        ),
        ("[[toda]]\nfirst = 3\nsecond = 3\nstiffness = 1.0\nsteepness = 1.0\nrest_length = 1.0\n", "toda[0].second"),
        ("[[spring]]\nfirst = 0\nsecond = 1\nstiffness = 1.0\nrest_length = 5.0\n", "spring[0].rest_length"),
        ("[[drive]]\nparticle = 0\naxis = 'x'\namplitude = 1.0\nangular_frequency = 1.0\n", "drive[0].axis"),
    ];
    for (table, key) in cases {
        let error = start(&read(&(BALLS.to_owned() + VERLET + table)), 1).err().unwrap_or_else(|| panic!("{table} is taken"));
        assert_eq!(error.key, key, "{table}: {error}");
    }
}

#[test]
fn a_bath_is_refused_by_its_key() {
    let cases = [
        ("name = 'langevin'\ntime_step = 0.002\ntemperature = 1.0\n", "integrator.friction"),
        ("name = 'langevin'\ntime_step = 0.002\nfriction = 1.0\n", "integrator.temperature"),
        ("name = 'langevin'\ntemperature = 1.0\nfriction = 1.0\n", "integrator.time_step"),
        ("name = 'langevin'\ntime_step = 0.002\ntemperature = 1.0\nfriction = 1.0\nlinks = 2\n", "integrator.links"),
        ("name = 'brownian'\ntime_step = 0.002\ntemperature = 1.0\nfriction = 0.0\n", "integrator.friction"),
        ("name = 'nose-hoover'\ntime_step = 0.002\ntemperature = 1.0\nrelaxation_time = 1.0\nlinks = 99\n", "integrator.links"),
        ("name = 'nose-hoover'\ntime_step = 0.002\ntemperature = 0.0\nrelaxation_time = 1.0\n", "integrator.temperature"),
        (
            "name = 'stochastic-rescaling'\ntime_step = 0.002\ntemperature = 1.0\nrelaxation_time = 1.0\nlinks = 3\n",
            "integrator.links",
        ),
        ("name = 'velocity-verlet'\ntime_step = 0.002\ntemperature = 1.0\n", "integrator.temperature"),
        ("name = 'velocity-verlet'\ntime_step = 0.002\ntolerance = 1e-9\n", "integrator.tolerance"),
        ("name = 'gauss-radau-15'\ntolerance = 0.0\n", "integrator.tolerance"),
        ("name = 'langevine'\ntime_step = 0.002\n", "integrator.name"),
    ];
    for (integrator, key) in cases {
        let text = format!("{BALLS}[forces.wca]\n[integrator]\n{integrator}");
        let error = start(&read(&text), 1).err().unwrap_or_else(|| panic!("{integrator} is taken"));
        assert_eq!(error.key, key, "{integrator}: {error}");
    }
    // A motion of the whole would be heated with the rest.
    let moving = BALLS.replace(
        "[[species]]\nname = 'B'\ncount = 64\nradius = 0.5\n",
        "[[particle]]\nposition = [0.1, 0.1, 0.1]\nvelocity = [9.0, 0.0, 0.0]\n",
    ) + "[forces.wca]\n[integrator]\nname = 'nose-hoover'\ntime_step = 0.002\ntemperature = 1.0\nrelaxation_time = 1.0\n";
    assert_eq!(start(&read(&moving), 1).err().map(|error| error.key), Some("integrator.name".into()));
    let asked = format!(
        "observe = ['speeds']\n{BALLS}[forces.wca]\n[integrator]\nname = 'brownian'\ntime_step = 0.002\ntemperature = 1.0\nfriction = 1.0\n"
    );
    assert_eq!(start(&read(&asked), 1).err().map(|error| error.key), Some("observe".into()));
}
