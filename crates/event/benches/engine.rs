//! How fast the engine is, whole and in parts: `cargo bench -p corpuscle-event`.

use corpuscle_event as _;

fn main() {
    divan::main();
}
