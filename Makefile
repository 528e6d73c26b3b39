# The README begins with `serve --demo`, which is no target because its program prints the address to open, then `make demo` and
# `make test`.
CARGO ?= cargo

.DEFAULT_GOAL := help
.PHONY: help demo check test package setup bench fuzz lives soak properties fmt lint doc site pages web

# what `make package` builds for; a target whose programs this machine can run
TARGET ?= $(shell rustc -vV | sed -n 's/^host: //p')

# the longest tests wait for drives on a wire, not for the processor
THREADS ?= $(shell echo $$(( $$(nproc) + 2 )))

# a property test tries the same cases in every run, so that it fails for a change, not by chance; `make properties`
# tries others
PROPTEST_RNG_SEED ?= 1
export PROPTEST_RNG_SEED

# a machine that builds once gains nothing by what makes the second build quick or serves a debugger, and has no room for it
ifdef CI
export CARGO_INCREMENTAL := 0
export CARGO_PROFILE_DEV_DEBUG := none
endif

# what has, or passes on, the feature raw-ethernet: must build without it too
ETHERNET = -p profidrive-network -p profidrive-plant -p profidrive -p profidrive-cli

help: ## this list
	@sed -n 's/^\([a-z]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 10

demo: ## find, read and run a virtual drive in memory: no root, no network, no hardware
	@$(CARGO) run -q -p profidrive-cli --bin profidrive -- demo $(ARGS)

check: ## what to run while changing something: format, lints, tables, arrows, unit tests
	$(CARGO) fmt --all --check
	$(CARGO) clippy -q --workspace --all-targets -- -D warnings
	$(CARGO) run -q -p xtask -- gen --check
	$(CARGO) run -q -p xtask -- arrows
	$(CARGO) run -q -p xtask -- web --check
	$(CARGO) test -q --workspace --lib --bins

test: setup ## everything that must pass
	$(CARGO) fmt --all --check
	$(CARGO) clippy -q --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc -q --workspace --no-deps
	target/tools/bin/cargo-deny --locked check bans licenses sources
	$(CARGO) clippy -q --no-default-features $(ETHERNET) -- -D warnings
	$(CARGO) build -q --workspace --lib --bins --examples
	target/debug/xtask gen --check
	target/debug/xtask arrows
	target/debug/xtask web --check
	RUST_TEST_THREADS=$(THREADS) $(CARGO) test --workspace
	tools/web-test
	tools/python-test

package: ## release program, Debian package and checksums, in target/package (TARGET=...)
	$(CARGO) build --release --locked -p profidrive-cli --target $(TARGET)
	tools/package target/$(TARGET)/release/profidrive $(TARGET) target/package

setup: ## install what the tests need (Debian packages, Python packages and cargo-deny under target/)
	@tools/setup

bench: setup ## figures of this machine, each beside its limit or peer
	@tools/bench $(ARGS)

fuzz: ## every fuzz target for SECONDS_EACH seconds, guided by coverage
	@tools/fuzz $(SECONDS_EACH)

lives: ## drives and clients through accidents by seeds, in virtual time (FIRST=, COUNT=)
	$(CARGO) run -q --release -p testbench --example lives -- $(or $(FIRST),0) $(or $(COUNT),10000)

soak: ## 200 drives and their controller on a wire, connected anew each minute (MINUTES=)
	$(CARGO) build -q --release --workspace --bins
	target/release/soak $(or $(MINUTES),60)

properties: ## the property tests with new cases, ROUNDS times; prints the seed of each round
	@tools/properties $(or $(ROUNDS),10)

fmt: ## format
	$(CARGO) fmt --all

lint: ## the lints of `make test`
	$(CARGO) clippy --workspace --all-targets -- -D warnings

doc: ## the documentation, in target/doc
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps

site: ## the site of docs/, in target/site (builds mdBook once, 40 s)
	@tools/site

web: ## the page of the workbench, in crates/workbench/assets (needs Node)
	@tools/web-build

pages: ## the pages of docs/ that come from the program: picture of the demo, reference of the commands
	$(CARGO) build -q -p profidrive-cli
	$(CARGO) run -q -p xtask -- pages target/debug/profidrive
