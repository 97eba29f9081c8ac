//! The same fluid in LAMMPS: same start, exported by us and read by it; energies and pressures step by step.
//!
//! Runs where LAMMPS is installed: the environment variable `LAMMPS` names the program, otherwise `lmp` is tried.

use std::fmt::Write as _;
use std::process::Command;

use corpuscle_core::{Boundary, Engine, Particles, Random, Vector, placement};
use corpuscle_time::{
    Bonds, FiniteExtension, Force, Integrator, LennardJones, PairForce, PairPotential, TimeDriven, WeeksChandlerAndersen,
};

const DT: f64 = 0.005;
const STEPS: usize = 20;

/// Relative to the sum of the sizes of an energy's or a pressure's two parts, kinetic and potential. Both programs round
/// forces to about 1e-12; an exponent of 1 a time unit and 0.1 time units leave them there.
const AGREEMENT: f64 = 1e-9;

fn melted<const D: usize>(count: usize, density: f64, temperature: f64, potential: impl PairPotential + 'static) -> TimeDriven<D> {
    let boundary = Boundary::periodic(libm::pow(count as f64 / density, 1.0 / D as f64));
    let mut random = Random::new(11, 0);
    let mut particles = Particles::new();
    for place in placement::lattice(&boundary, count, 0.0, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    placement::maxwell(&mut particles, temperature, true, &mut random);
    let forces = || -> Vec<Box<dyn Force<D>>> { vec![Box::new(PairForce::new(potential).unshifted())] };
    after_a_while(boundary, particles, forces)
}

fn after_a_while<const D: usize>(
    boundary: Boundary<D>,
    particles: Particles<D>,
    forces: impl Fn() -> Vec<Box<dyn Force<D>>>,
) -> TimeDriven<D> {
    let mut fluid = TimeDriven::new(boundary.clone(), particles, forces(), Integrator::VelocityVerlet { dt: DT }).unwrap();
    fluid.advance(2.0, &mut ()).unwrap();
    TimeDriven::new(boundary, fluid.snapshot(), forces(), Integrator::VelocityVerlet { dt: DT }).unwrap()
}

/// Beads of a chain of Kremer and Grest.
const CHAIN: usize = 20;

/// Chains along the columns of a lattice, at the density 0.5.
fn chains() -> TimeDriven<3> {
    let (columns, spacing) = (8usize, 0.97f64);
    let width = columns as f64 * (1.0 / (0.5 * spacing)).sqrt();
    let height = (CHAIN + 1) as f64 * spacing;
    let mut beads = Particles::new();
    let mut ends = vec![];
    for column in 0..columns * columns {
        let [x, y] = [column % columns, column / columns].map(|n| (n as f64 + 0.5) * width / columns as f64);
        for bead in 0..CHAIN {
            let bead = beads.push(Vector([x, y, bead as f64 * spacing]), Vector::ZERO, 1.0, 0.5, 0);
            ends.extend((bead % CHAIN > 0).then(|| (bead - 1, bead)));
        }
    }
    placement::maxwell(&mut beads, 1.0, true, &mut Random::new(12, 0));
    let mut boundary = Boundary::periodic(width);
    (boundary.lower[2], boundary.upper[2]) = (0.0, height);
    let forces = || -> Vec<Box<dyn Force<3>>> {
        let bonds = Bonds::new(FiniteExtension { stiffness: 30.0, longest: 1.5 }, ends.clone());
        vec![Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0))), Box::new(bonds)]
    };
    after_a_while(boundary, beads, forces)
}

/// What LAMMPS is told of the forces.
struct Told {
    /// Bonds of neighbours in chains of so many beads.
    chain: Option<usize>,
    /// Its commands.
    forces: String,
}

impl Told {
    fn lennard_jones(cutoff: f64) -> Self {
        let forces = format!("pair_style lj/cut {cutoff:?}\npair_coeff 1 1 1.0 1.0\n");
        Self { chain: None, forces }
    }
}
fn program() -> Option<String> {
    let name = std::env::var("LAMMPS").unwrap_or_else(|_| "lmp".into());
    Command::new(&name).arg("-help").output().is_ok_and(|output| output.status.success()).then_some(name)
}

/// Kinetic and potential energy and pressure after each step, as LAMMPS finds them.
fn lammps<const D: usize>(program: &str, fluid: &TimeDriven<D>, told: &Told) -> Vec<[f64; 3]> {
    let (particles, side) = (fluid.particles(), fluid.boundary().extent());
    let bonded = |i: usize| told.chain.is_some_and(|beads| !i.is_multiple_of(beads));
    let bonds = (0..particles.len()).filter(|&i| bonded(i)).count();
    let mut data = format!("start\n\n{} atoms\n1 atom types\n", particles.len());
    if bonds > 0 {
        writeln!(data, "{bonds} bonds\n1 bond types\n2 extra bond per atom").unwrap();
    }
    for (k, axis) in ["x", "y", "z"].iter().enumerate() {
        let (low, high) = if k < D { (0.0, side[k]) } else { (-0.5, 0.5) };
        writeln!(data, "{low:?} {high:?} {axis}lo {axis}hi").unwrap();
    }
    let style = if bonds > 0 { "bond" } else { "atomic" };
    write!(data, "\nMasses\n\n1 1.0\n\nAtoms # {style}\n\n").unwrap();
    for (i, r) in particles.position.iter().enumerate() {
        let [x, y, z] = r.to_three();
        let molecule = told.chain.map_or(String::new(), |beads| format!("{} ", i / beads + 1));
        writeln!(data, "{} {molecule}1 {x:?} {y:?} {z:?}", i + 1).unwrap();
    }
    data += "\nVelocities\n\n";
    for (i, v) in particles.velocity.iter().enumerate() {
        let [x, y, z] = v.to_three();
        writeln!(data, "{} {x:?} {y:?} {z:?}", i + 1).unwrap();
    }
    if bonds > 0 {
        data += "\nBonds\n\n";
        for (number, i) in (0..particles.len()).filter(|&i| bonded(i)).enumerate() {
            writeln!(data, "{} 1 {i} {}", number + 1, i + 1).unwrap();
        }
    }
    let forces = &told.forces;
    let input = format!(
        "units lj\ndimension {D}\natom_style {style}\nread_data data.txt\n{forces}\
         neighbor 0.3 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve\ntimestep {DT}\n\
         thermo 1\nthermo_style custom step ke pe press\nthermo_modify norm no format float %.17g\nrun {STEPS}\n"
    );
    let folder = std::env::temp_dir().join(format!("corpuscle-lammps-{}-{D}-{bonds}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("data.txt"), data).unwrap();
    std::fs::write(folder.join("in.txt"), input).unwrap();
    let output = Command::new(program).args(["-in", "in.txt", "-log", "none"]).current_dir(&folder).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}");
    std::fs::remove_dir_all(&folder).unwrap();
    let rows = text.lines().skip_while(|line| !line.trim_start().starts_with("Step")).skip(1);
    let numbers = |line: &str| line.split_whitespace().map(str::parse::<f64>).collect::<Result<Vec<_>, _>>().ok();
    rows.map_while(numbers).filter(|row| row.len() == 4).map(|row| [row[1], row[2], row[3]]).collect()
}

fn compare<const D: usize>(mut fluid: TimeDriven<D>, told: &Told) {
    let Some(program) = program() else {
        println!("LAMMPS is not installed: nothing compared");
        return;
    };
    let theirs = lammps(&program, &fluid, told);
    assert_eq!(theirs.len(), STEPS + 1);
    let volume = fluid.boundary().volume();
    for (step, [kinetic, potential, pressure]) in theirs.into_iter().enumerate() {
        fluid.advance(step as f64 * DT, &mut ()).unwrap();
        let ideal = 2.0 * fluid.kinetic_energy() / (D as f64 * volume);
        let excess = fluid.virial() / (D as f64 * volume);
        let off = [
            (fluid.kinetic_energy() - kinetic).abs() / kinetic,
            (fluid.potential_energy() - potential).abs() / potential.abs(),
            (ideal + excess - pressure).abs() / (ideal.abs() + excess.abs()),
        ];
        println!("step {step}: relative differences {off:?}");
        assert!(off.iter().all(|&off| off < AGREEMENT), "step {step}: {off:?}");
    }
}

#[test]
fn a_lennard_jones_melt_goes_the_same_way_in_lammps() {
    let potential = LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 };
    compare(melted::<3>(500, 0.8442, 1.44, potential), &Told::lennard_jones(potential.cutoff));
}

#[test]
fn soft_discs_go_the_same_way_in_lammps() {
    // Not shifted in LAMMPS: its energy is lower by one for each pair within range, as is the plain Lennard-Jones here.
    let cutoff = WeeksChandlerAndersen::new(1.0, 1.0).cutoff();
    compare(melted::<2>(400, 0.6, 1.0, LennardJones { epsilon: 1.0, sigma: 1.0, cutoff }), &Told::lennard_jones(cutoff));
}

/// Bonded beads repel each other as all others do: in LAMMPS that repulsion belongs to the bond.
#[test]
fn polymers_go_the_same_way_in_lammps() {
    let cutoff = WeeksChandlerAndersen::new(1.0, 1.0).cutoff();
    let forces = format!(
        "special_bonds fene\nbond_style fene\nbond_coeff 1 30.0 1.5 1.0 1.0\n\
         pair_style lj/cut {cutoff:?}\npair_modify shift yes\npair_coeff 1 1 1.0 1.0\n"
    );
    compare(chains(), &Told { chain: Some(CHAIN), forces });
}
