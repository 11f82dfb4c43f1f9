# `make` lists what there is.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

BIN := .venv/bin
PYTHON := $(BIN)/python
export UV_PYTHON_DOWNLOADS := never
export VIRTUAL_ENV := $(CURDIR)/.venv
CARGO := cargo
TRIALS := 1000

.PHONY: help setup demo test test-rust test-python test-portable lint bench bench-peers figures paper golden map stubs pins clean

help: ## List the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

# The environment: uv from PyPI into the project's own .venv, then everything by name and pinned version.
.venv/ready: pyproject.toml constraints.txt
	python3 -m venv .venv || { echo "python3 -m venv failed: install Python 3.11+ with venv (Debian: python3-venv)"; exit 1; }
	$(PYTHON) -m pip install --quiet --disable-pip-version-check --constraint constraints.txt uv
	$(BIN)/uv pip install --quiet --python $(PYTHON) --constraint constraints.txt --group dev --requirements pyproject.toml
	touch $@

setup: .venv/ready ## Build midair into .venv
	$(BIN)/maturin develop --uv --quiet --release

demo: setup ## Solve the paper's fig. 2 by naive and greedy; leaves out/demo/field.png and drive.npz
	mkdir -p out/demo
	$(BIN)/midair compare docs/scenes/smiley.toml --solvers naive,greedy --image out/demo/field.png
	$(BIN)/midair solve docs/scenes/smiley.toml --output out/demo/drive.npz
	@echo "see out/demo/field.png and out/demo/drive.npz"

test: lint test-rust test-python ## Every test of every language

test-rust: ## The core: tests, doctests, each feature set, no_std
	$(CARGO) test --quiet -p midair --features scene-file,parallel
	for features in "" std parallel; do $(CARGO) check --quiet -p midair --no-default-features --features "$$features"; done
	$(CARGO) run --quiet --release --manifest-path core/tests/no_std/Cargo.toml

test-python: setup ## The package: tests, stubs, types
	$(PYTHON) -m pytest --quiet
	$(PYTHON) -m mypy.stubtest midair._midair
	$(PYTHON) -m mypy python/midair

test-portable: ## The core on 64-bit ARM and WebAssembly, emulated (Debian's packages)
	core/tests/portable.sh

lint: .venv/ready ## Formatting, clippy, rustdoc, ruff: warnings are errors
	$(CARGO) fmt --check
	$(CARGO) clippy --quiet --all-targets -p midair --features scene-file,parallel -- -D warnings
	$(CARGO) clippy --quiet --all-targets -p midair-python -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --quiet --no-deps -p midair --features scene-file,parallel
	$(BIN)/ruff check --quiet python bench
	$(BIN)/ruff format --check --quiet python bench

bench: ## Greedy, fast and uniform beside the textbook loop at every level, latency, every method over M and N
	$(CARGO) bench --quiet -p midair --features parallel

RIVALS := autd3/ready textbook.so planar.so $(if $(ACOUSTOOLS),acoustools/ready)

bench-peers: setup ## midair beside its rivals: record and README table (QUICK=1: neither; ACOUSTOOLS=1: AcousTools too)
	-$(MAKE) --keep-going --no-print-directory $(addprefix bench/.envs/,$(RIVALS))
	$(PYTHON) bench/peers.py $(if $(QUICK),--quick)

bench/.envs/%/ready: bench/%.txt .venv/ready
	$(BIN)/uv venv --quiet --clear --python $(PYTHON) $(@D)
	$(BIN)/uv pip install --quiet --python $(@D)/bin/python --constraint constraints.txt --requirements $<
	touch $@

bench/.envs/textbook.so: CXXFLAGS := -O3
bench/.envs/planar.so: CXXFLAGS := -Ofast -march=native
bench/.envs/%.so: bench/workers/%.cpp
	mkdir -p $(@D)
	$(CXX) -std=c++17 $(CXXFLAGS) -fPIC -shared -o $@ $<

figures: setup ## Draw docs/quality-time.png
	OPENBLAS_NUM_THREADS=1 $(PYTHON) bench/figures.py

paper: setup ## Make the paper's figures anew (TRIALS=1000) and docs/paper.md from their tables
	OPENBLAS_NUM_THREADS=1 $(BIN)/midair reproduce all --trials $(TRIALS) --output out/paper
	$(PYTHON) -m midair.reproduce.page out/paper docs

map: ## Write the map in CONTRIBUTING.md anew
	MIDAIR_MAP=write $(CARGO) test --quiet -p midair --features scene-file,parallel --test suite map

stubs: setup ## Write the typed overloads of every solver anew, from the registry
	$(PYTHON) python/stubs.py

golden: ## Write golden/ anew (a breaking change: say so in CHANGELOG.md)
	MIDAIR_GOLDEN=write $(CARGO) test --quiet -p midair --features scene-file,parallel --test suite golden

pins: ## Pin what pyproject.toml asks for, names and versions only
	$(BIN)/uv pip compile --quiet --universal --no-header --no-annotate --group dev --no-emit-index-url --output-file constraints.txt pyproject.toml
	echo "uv==$$($(BIN)/uv --version | cut -d' ' -f2)" >> constraints.txt

clean: ## Remove what was built
	$(CARGO) clean
	rm -rf .venv out bench/.envs core/tests/no_std/target python/midair/*.so
