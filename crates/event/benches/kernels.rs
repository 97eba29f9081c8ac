//! What the parts of a step cost alone: `cargo bench -p corpuscle-event --bench kernels`. An item is one call.

#[path = "../tests/engine/common/mod.rs"]
mod common;

use common::{face_centred, run};
use corpuscle_event::{EventDriven, kernels};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

/// Hard spheres, `4 c^3` of them, at a packing fraction: cells at the first, lists at the last.
const SYSTEMS: [(usize, f64); 6] = [(7, 0.10), (7, 0.30), (7, 0.49), (14, 0.10), (14, 0.30), (14, 0.49)];

fn each(bencher: Bencher, (c, packing): (usize, f64), kernel: impl Fn(&mut EventDriven<3>, usize)) {
    let mut engine = face_centred(c, packing, 1);
    let n = engine.particle_count();
    run(&mut engine, 20 * n as u64);
    // In an order without system, as events come.
    let order: Vec<usize> = (0..n).map(|i| i * 1009 % n).collect();
    bencher.counter(ItemsCount::new(n)).bench_local(|| order.iter().for_each(|&i| kernel(&mut engine, i)));
}

#[divan::bench(args = SYSTEMS, sample_count = 25, sample_size = 1)]
fn search(bencher: Bencher, system: (usize, f64)) {
    each(bencher, system, kernels::search);
}

#[divan::bench(args = SYSTEMS, sample_count = 25, sample_size = 1)]
fn exit(bencher: Bencher, system: (usize, f64)) {
    each(bencher, system, kernels::exit);
}

/// A step there and one back.
#[divan::bench(args = SYSTEMS, sample_count = 25, sample_size = 1)]
fn two_steps(bencher: Bencher, system: (usize, f64)) {
    each(bencher, system, |engine, i| {
        kernels::step(engine, i, true);
        kernels::step(engine, i, false);
    });
}

/// One event taken, two scheduled.
#[divan::bench(args = [1372, 10_976, 1_000_000], sample_count = 25, sample_size = 1)]
fn calendar(bencher: Bencher, particles: usize) {
    let mut queue = kernels::Queue::new(particles);
    (0..2 * particles).for_each(|_| queue.step());
    bencher.counter(ItemsCount::new(10_000usize)).bench_local(|| (0..10_000).for_each(|_| queue.step()));
}
