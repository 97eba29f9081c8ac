//! The `corpuscle` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    corpuscle::main(corpuscle_experiments::REGISTRY)
}
