# The commands that people and CI run. `make` alone lists them.
.PHONY: help setup demo library install uninstall wheel test test-python test-shared lint doc bench bench-error counters test-debian13 test-wheel

# Rust's own installer puts cargo there; a fresh shell may not have it in PATH yet.
export PATH := $(PATH):$(HOME)/.cargo/bin

# What is left out by default and can be built here: one build for all tests.
comma := ,
has_mpi := $(shell command -v mpicc)
features := parquet$(if $(has_mpi),$(comma)mpi)

help:
	@echo 'make demo           set up, build, light the furnished room, leave a picture, a page and a report in out/'
	@echo 'make library        set up, build the C library, the program, its man pages and completions'
	@echo 'make install        install all of these: PREFIX=/usr/local, DESTDIR for packages; make uninstall takes them away'
	@echo 'make wheel          set up, build the Python package: a wheel in target/python/wheels'
	@echo 'make test           set up, run all tests; those of several processes where MPI is (scripts/setup.sh mpi installs it)'
	@echo 'make test-python    set up, build the wheel, install it in an environment of its own, run its tests alone'
	@echo 'make test-shared    set up, run the long tests on scenes by others in ../shared'
	@echo 'make lint           formatting and clippy, warnings are errors'
	@echo 'make doc            the documentation of the library, warnings are errors'
	@echo 'make bench          run the benchmarks (minutes)'
	@echo 'make bench-error    error against time, whether claims are true, and scenes made to be hard (some hours)'
	@echo 'make counters       write anew what solves cost in rays, links and elements, after a change that is meant to move it'
	@echo 'make test-wheel     install the wheel in Debian 12 and 13 roots without Embree and light the room (needs root and debootstrap)'
	@echo 'make test-debian13  run the tests in a Debian 13 root, which has Embree 4 (needs root and debootstrap)'

setup:
	@scripts/setup.sh

demo: setup
	@mkdir -p out
	cargo build --release --locked --bin patchlight
	cargo run --quiet --release --locked --bin patchlight -- solve scenes/room.obj \
	    --error 0.03 --mesh out/room.ply --image out/room.png --image out/room.exr --html out/room.html --report out/report.json
	@echo
	@echo 'picture   out/room.png (to look at), out/room.exr (linear radiance)'
	@echo 'mesh      out/room.ply (radiosity on the surfaces, which the picture shows)'
	@echo 'page      out/room.html (to walk around in, in any browser)'
	@echo 'report    out/report.json'

library: setup
	cargo build --release --locked
	cargo run --quiet --release --locked --example manual -- target/release/manual

# Builds only what is missing, so that root needs no Rust.
target/release/manual target/release/libpatchlight_capi.so:
	$(MAKE) library

install: target/release/libpatchlight_capi.so target/release/manual
	@PREFIX='$(PREFIX)' LIBDIR='$(LIBDIR)' DESTDIR='$(DESTDIR)' scripts/install.sh install target/release

uninstall:
	@PREFIX='$(PREFIX)' LIBDIR='$(LIBDIR)' DESTDIR='$(DESTDIR)' scripts/install.sh uninstall target/release

wheel: setup
	scripts/wheel.sh build

test: setup
	cargo test --locked --features $(features)
	scripts/wheel.sh test
	@$(if $(has_mpi),,echo 'SKIPPED: no tests of several processes: no MPI with headers is here; scripts/setup.sh mpi installs it')

# Long ones on scenes by others, which lie beside the repository.
test-shared: setup
	cargo test --locked --features $(features) --test held_back --test peers --test shared_scenes -- --ignored

test-python: setup
	scripts/wheel.sh test

lint: setup
	cargo fmt --all --check
	cargo clippy --locked --all-targets --features $(features) -- -D warnings
	PYO3_BUILD_EXTENSION_MODULE=1 PYO3_NO_PYTHON=1 cargo clippy --locked -p patchlight-python -- -D warnings

doc: setup
	RUSTDOCFLAGS='-D warnings' cargo doc --locked --no-deps --features $(features)

bench: setup
	cargo bench --locked

bench-error: setup
	cargo bench --locked --bench error_vs_time
	cargo bench --locked --bench hard_scenes

counters: setup
	PATCHLIGHT_WRITE_COUNTERS=1 cargo test --locked --features parquet --test counters
	git --no-pager diff --stat -- tests/counters.json

test-debian13:
	scripts/test-debian13.sh

test-wheel:
	scripts/test-wheel.sh
