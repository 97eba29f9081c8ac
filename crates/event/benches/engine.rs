//! How fast the engine is, as a whole: `cargo bench -p corpuscle-event`. An item is a collision.

#[path = "../tests/engine/common/mod.rs"]
mod common;

use common::{face_centred, periodic_fluid, run};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

const BATCH: u64 = 200_000;

/// Hard spheres, `4 c^3` of them: 1372, 10976.
#[divan::bench(args = [(7, 0.10), (7, 0.30), (7, 0.49), (14, 0.10), (14, 0.30), (14, 0.49)], sample_count = 9, sample_size = 1)]
fn spheres(bencher: Bencher, (c, packing): (usize, f64)) {
    let mut engine = face_centred(c, packing, 1);
    run(&mut engine, 50 * 4 * c.pow(3) as u64);
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| run(&mut engine, BATCH));
}

/// Hard discs.
#[divan::bench(args = [(1000, 0.05), (1000, 0.30), (1000, 0.70), (10_000, 0.30), (10_000, 0.70)], sample_count = 9, sample_size = 1)]
fn discs(bencher: Bencher, (n, packing): (usize, f64)) {
    let mut engine = periodic_fluid::<2>(n, packing, 1);
    run(&mut engine, 50 * n as u64);
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| run(&mut engine, BATCH));
}
