# `make demo` and `make test` are all one needs; each sets up what it uses, into .venv.

PYTHON ?= python3
OUT := out
DEMO := scenes/workbench/workbench.pov

# rustup puts cargo here; a shell started before the installation does not know it yet.
export PATH := $(PATH):$(HOME)/.cargo/bin
export PIP_DISABLE_PIP_VERSION_CHECK := 1

BIN := .venv/bin
RUST_SOURCES := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock

.PHONY: help demo test test-rust test-python conformance lint setup lab bench peers peers-speed peers-meshes embree clean toolchain
.DELETE_ON_ERROR:

help: ## Print this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 14

demo: .venv/installed ## Set up and render the demo scene to out/workbench.png
	@mkdir -p $(OUT)
	$(BIN)/octray render $(DEMO) -o $(OUT)/workbench.png --size 1280x720 --spp 4

test: test-rust test-python ## Set up and run all tests, Rust and Python

test-rust: toolchain
	cargo test --workspace

test-python: .venv/tools
	$(BIN)/pytest

conformance: toolchain ## Compare every combination of methods with brute force on every scene (an hour)
	OCTRAY_CONFORMANCE=full cargo test --release -p octray --test conformance -- --nocapture

lint: .venv/tools ## Check formatting, lints and types of both languages
	cargo fmt --all --check
	cargo clippy --workspace --all-targets -- -D warnings
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest octray._core

setup: .venv/tools ## Install octray and the tools of its developers into .venv

LAB ?= full

lab: .venv/lab ## Run every method on scenes of all sizes into docs/lab; LAB=quick takes a minute
	@$(BIN)/python benches/lab/run.py --mode $(LAB)

BENCH ?= --all -j 1 -j $(shell getconf _NPROCESSORS_ONLN)

bench: .venv-peers/installed ## Race octray and the other ray tracers that are installed; BENCH= gives options
	@$(PEERS_PYTHON) -m octray bench $(BENCH)

peers: .venv-peers/installed ## Run the same scenes through octray and the peers that are installed
	@$(PEERS_PYTHON) benches/peers/compare.py

peers-speed: .venv-peers/installed ## Count the rays per second of octray and raysect
	@$(PEERS_PYTHON) benches/peers/raysect_rays.py

peers-meshes: .venv-peers/installed ## Time rays from Python onto meshes beside Open3D and trimesh with embreex
	@$(PEERS_PYTHON) benches/peers/cast_rays.py

# `make embree EMBREE='--mesh building --kind primary --size 256'` takes seconds; `--help` says more.
embree: toolchain ## Trace meshes beside Embree, ray for ray, where that is installed
	cargo run --release --manifest-path benches/embree/Cargo.toml --target-dir target/embree -- $(EMBREE)

clean: ## Remove everything that was made here
	rm -rf .venv .venv-peers $(OUT) target python/octray/*.so

toolchain:
	@PYTHON='$(PYTHON)' tools/check-toolchain

# The check comes first, whenever anything has to be made.
.venv/python: tools/check-toolchain
	@PYTHON='$(PYTHON)' tools/check-toolchain
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet 'maturin>=1.9,<2'
	@touch $@

# The compiled crates stay in target/, so a second build makes only what changed.
DEVELOP := VIRTUAL_ENV='$(CURDIR)/.venv' $(BIN)/maturin develop --release

.venv/installed: .venv/python pyproject.toml $(RUST_SOURCES)
	@tools/check-toolchain --rust
	@echo 'Building octray; the first time takes a few minutes.'
	$(DEVELOP) --extras cluster,io
	@touch $@

.venv/tools: .venv/installed pyproject.toml
	$(DEVELOP) --extras cluster,io,dev
	@touch $@

.venv/lab: .venv/installed pyproject.toml
	$(DEVELOP) --extras lab
	@touch $@

# Peers have an environment of their own; one that cannot be installed here is left out and said so.
# POV-Ray and OpenSCAD come from the system's packages.
PEERS ?= raysect trimesh embreex manifold3d open3d mitsuba
PEERS_PYTHON := PYTHONPATH=python .venv-peers/bin/python

.venv-peers/installed: .venv/installed
	$(PYTHON) -m venv .venv-peers
	.venv-peers/bin/pip install --quiet 'click>=8.1' 'numpy>=1.24' pillow
	@for peer in $(PEERS); do \
	  .venv-peers/bin/pip install --quiet $$peer || echo "$$peer cannot be installed here"; \
	done
	@touch $@
