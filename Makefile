# Two commands do everything on a fresh Debian or Ubuntu machine that has Rust:
#   make run    install what is missing, build, open the laboratory; without a display run the five experiments
#   make test   the same, then every test
.DEFAULT_GOAL := help
.PHONY: help run reports test soak kill fuzz lint audit bench setup setup-test clean

CARGO ?= cargo
OUT   ?= results

help: ## Show what there is to make
	@awk -F':.*## ' '/^[a-z-]+:.*## /{printf "  make %-8s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

run: setup ## Build and open the laboratory; without a display, make the reports
	$(CARGO) build --release --locked
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ] || [ "$$(uname -s)" = Darwin ]; then target/release/corpuscle; \
	else scripts/run-all.sh target/release/corpuscle $(OUT); fi

reports: setup ## Run the five experiments, leave a report of each under results/
	$(CARGO) build --release --locked
	@scripts/run-all.sh target/release/corpuscle $(OUT)

test: setup-test ## Every test: units, physics against theory, pictures, the command
	$(CARGO) test --release --locked --workspace
	@scripts/check-rooms.sh

soak: ## An hour or so: 10^9 collisions, 10^8 contacts of grains, 10^5 periods of three bodies, sixteen liquids; nothing may drift, sink or stall
	$(CARGO) test --release --locked -p corpuscle-event --test engine -- soak --ignored --nocapture --test-threads=1
	$(CARGO) test --release --locked -p corpuscle-time --test engine -- soak --ignored --nocapture --test-threads=1
	$(CARGO) test --release --locked -p corpuscle-experiments --test beyond -- soak --ignored --nocapture

kill: setup-test ## A quarter of an hour: 200 kills at random moments, each run resumed to the same bits
	$(CARGO) test --release --locked -p corpuscle --test kill -- --ignored --nocapture

fuzz: setup ## Ten minutes or so: strangers' files, read or refused; tens of thousands of random systems, all invariants on
	FUZZ_FACTOR=30 $(CARGO) test --release --locked -p corpuscle-event --test engine invariants
	FUZZ_CASES=100000 $(CARGO) test --release --locked -p corpuscle-io --test fuzz -- --nocapture
	FUZZ_SYSTEMS=20000 $(CARGO) test --release --locked -p corpuscle-io --test systems -- --nocapture

lint: ## Format and house rules
	$(CARGO) fmt --all --check
	$(CARGO) clippy --release --locked --workspace --all-targets -- -D warnings

audit: ## Licences, sources and known faults of the dependencies; needs the network for RustSec's list
	@command -v cargo-deny >/dev/null || $(CARGO) install --locked cargo-deny
	$(CARGO) deny --locked check

bench: setup ## Time every kernel
	$(CARGO) bench --locked --workspace --benches

setup:
	@scripts/setup.sh run

setup-test:
	@scripts/setup.sh test

clean: ## Remove what was built and what was run
	$(CARGO) clean
	rm -rf results
