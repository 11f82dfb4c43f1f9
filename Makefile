# `make` lists the targets.
SHELL := bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

# On Windows: the bash of Git, and .venv/Scripts instead of .venv/bin.
WINDOWS := $(filter Windows_NT,$(OS))
BIN := .venv/$(if $(WINDOWS),Scripts,bin)
PYTHON := $(BIN)/python
HOST_PYTHON := $(if $(WINDOWS),python,python3)
export UV_PYTHON_DOWNLOADS := never
# The tests start hundreds of processes: what one compiles, the others read.
unexport PYTHONDONTWRITEBYTECODE
export VIRTUAL_ENV := $(CURDIR)/.venv
CARGO := cargo
CORE := -p midair --no-default-features --features scene-file
# Beside the Python extension, the core's dependencies have the extension's features: both share one compiled core.
SHARED := -p midair -p midair-python -p midair-fuzz --no-default-features --features midair/scene-file
SHOWN := naive,greedy,uniform
BUILT := $(or $(CARGO_TARGET_DIR),target)/release
PREFIX := /usr/local
CODE := python capi bench book firmware fuzz gateware examples matlab
RUST := Cargo.toml Cargo.lock core/Cargo.toml python/Cargo.toml python/build.rs $(wildcard python/stubs/*.py) $(shell find core/src python/src -name '*.rs')

# A step prints its name, with the expected time on two cores without earlier builds; then its name with the time that it
# took, or if it fails.
step = @echo; echo "== $(1)"; begin=$$SECONDS; $(2) \
	|| { status=$$?; echo "== failed: $(1)" >&2; exit $$status; }; echo "-- $(1): it took $$((SECONDS - begin)) s"

.PHONY: help outlook compiled check setup demo capi install studio test test-rust test-python test-capi test-firmware embedded test-portable test-windows test-boards test-serve test-long gateware test-studio npm test-npm unity test-unity matlab test-matlab lint fuzz sanitize bench-peers measured pictures look docs site generated api schema golden map header pins wheels release clean

help: ## List the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

# The environment: installs uv from PyPI into the project's own .venv, then all packages in their pinned versions.
.venv/ready: pyproject.toml constraints.txt
	@echo; echo "== environment in .venv: Python's tools and libraries from PyPI (1 min)"
	$(HOST_PYTHON) -m venv .venv || { echo "$(HOST_PYTHON) -m venv failed: install Python 3.11+ with venv (Debian: python3-venv)"; exit 1; }
	$(PYTHON) -m pip install --quiet --disable-pip-version-check --constraint constraints.txt uv
	$(BIN)/uv pip install --python $(PYTHON) --constraint constraints.txt --group dev --requirements pyproject.toml
	touch $@

setup: .venv/ready ## Build midair into .venv
	$(call step,package: the extension is built into .venv (2 min),$(BIN)/maturin develop --uv --release)
	@touch .venv/extension

# The extension for `make check`: compiled with the tests' profile, only if a Rust file is newer than the installed one.
.venv/extension: .venv/ready $(RUST) python/midair/_toolbox.py
	$(call step,package: the extension as the tests are compiled (2 min; 20 s after a change),$(BIN)/maturin develop --uv --quiet)
	@touch $@

check: .venv/ready ## The loop while you work: formatting, lints, guards, quick tests (1 min; MODULE=device: fewer of the core's)
	$(call step,formatting (1 s),$(CARGO) fmt --check && $(BIN)/ruff check --quiet $(CODE) && $(BIN)/ruff format --check --quiet $(CODE))
	$(call step,core: clippy on the library (10 s),$(CARGO) clippy --quiet $(CORE) -- -D warnings)
	$(call step,core: quick unit tests (15 s),$(CARGO) test --quiet $(CORE) --lib -- $(addsuffix ::,$(MODULE)))
	$(call step,core: guards and quick tests (15 s),$(CARGO) test --quiet $(SHARED) --test suite -- $(if $(MODULE),layers map unsafe_code $(MODULE)))
	@$(MAKE) --no-print-directory .venv/extension
	$(call step,package: quick tests (30 s),$(PYTHON) -m pytest --quiet -m "not slow")
	@echo; echo "== all passed. Before you propose the change: make test"

demo: setup ## Solve the paper's fig. 2 by naive, greedy and uniform; leaves a picture and a drive in out/demo
	@mkdir -p out/demo
	$(call step,one scene by three solvers (5 s),\
		$(BIN)/midair compare docs/scenes/smiley.toml --solvers $(SHOWN) --image out/demo/field.png)
	$(call step,its drive as a file (2 s),$(BIN)/midair solve docs/scenes/smiley.toml --output out/demo/drive.npz)
	@echo; echo "The picture is $(CURDIR)/out/demo/field.png, the drive $(CURDIR)/out/demo/drive.npz."

capi: ## Build the C library: libmidair.so and libmidair.a in target/release
	$(call step,C library: built (2 min),$(CARGO) build --release -p midair-capi)

install: $(BUILT)/libmidair.so ## Install the C library: headers, libraries, midair.pc (PREFIX=/usr/local)
	capi/install.sh $(BUILT) $(PREFIX)

studio: studio/node_modules ## Build the studio's page, also for midair studio and notebooks (Node 20+, Debian's Rust packages)
	$(call step,studio: the core for browsers (4 min),studio/door/build.sh)
	$(call step,studio: the page for browsers and notebooks (30 s),cd studio && node build.mjs)

studio/node_modules: studio/package.json
	$(call step,studio: tools from npm (30 s),cd studio && npm install --no-package-lock --no-audit --no-fund)
	touch $@

$(BUILT)/libmidair.so:
	$(MAKE) --no-print-directory capi

test: outlook .venv/ready ## The core's tests and the package's (the C library's: test-capi)
	@$(MAKE) --no-print-directory --jobs 2 lint compiled
	@$(MAKE) --no-print-directory test-rust test-python
	@echo; echo "== all passed. Left out: make test-capi (the C library, 6 min), test-studio, test-npm, test-unity, test-matlab, test-firmware, test-boards, test-serve, test-long (Ctrl-C, flights, the wheel, docs/extending.md, the oldest Rust), test-portable, test-windows, fuzz, sanitize"

outlook:
	@echo "make test: lint, the core's tests, the package's tests; 18 minutes on two cores, a third of it when built before."

# Runs beside the lint: neither fills two cores. So the lint has a target folder of its own.
compiled:
	$(call step,core: tests are compiled (5 min),$(CARGO) test $(SHARED) --no-run)

test-rust: compiled ## The core: tests, doctests, each feature set, no_std
	$(call step,core: tests run (2 min),$(CARGO) test --quiet $(SHARED) -- --include-ignored --skip at_length)
	$(call step,core: a program without std and feature std (20 s),\
		{ $(CARGO) run --quiet --manifest-path core/tests/no_std/Cargo.toml & \
		$(CARGO) check -p midair --no-default-features --features std && wait $$!; })

test-python: .venv/extension ## The package: tests, stubs, types
	$(call step,package: tests (8 min),$(PYTHON) -m pytest --numprocesses auto --dist worksteal)
	$(call step,package: types and stubs against the extension (30 s),\
		{ $(PYTHON) -m mypy.stubtest midair._midair & $(PYTHON) -m mypy python/midair && wait $$!; })

test-capi: setup capi ## The C library: header, same bits as the package, refusals, memory, examples in C and C++
	$(call step,C library: header and unit tests (2 min),$(CARGO) test --quiet -p midair-capi)
	$(call step,C library: tests (40 s),$(PYTHON) -m pytest capi/tests)

test-firmware: ## Four methods on an emulated microcontroller, to the bit (Debian's packages, 5 min)
	python3 firmware/test.py

embedded: ## Write the table of docs/embedded.md anew (Debian's packages, 5 min)
	python3 firmware/measure.py

test-portable: ## The core on 64-bit ARM and WebAssembly, emulated (Debian's packages)
	core/tests/portable.sh

test-windows: .venv/ready ## Under Wine: wheel, board at a COM port, C library, core, quick tests (PARTS=package: all of the package's)
	$(PYTHON) python/tests/windows.py $(PARTS)

test-boards: setup ## Boards: programs that play end in every way, 20 times each, and 10,000 frames a link (8 min)
	$(CARGO) build --quiet --release --manifest-path gateware/autd3/Cargo.toml
	MIDAIR_SLOW=1 $(PYTHON) -m pytest $(wildcard python/tests/test_boards*.py)

test-serve: setup ## Points of other programs: 1,000,000 histories of signs of life, 1,000 real ones, 10,000 connections (8 min)
	MIDAIR_SLOW=1 $(PYTHON) -m pytest $(wildcard python/tests/test_serve*.py)

test-long: .venv/extension ## What takes too long for make test, and Ctrl-C at 20 moments of every long call (50 min, quiet computer)
	$(call step,core: the steps of docs/extending.md on a copy (1 min),core/tests/extending.sh)
	$(call step,all crates: the oldest Rust (1 min),core/tests/minimum.sh)
	$(call step,core: tests of minutes (3 min),$(CARGO) test --quiet $(SHARED) -- --ignored at_length)
	$(call step,package: tests of minutes (20 min),MIDAIR_SLOW=1 $(PYTHON) -m pytest --numprocesses auto --dist worksteal -m long)
	$(call step,package: Ctrl-C (25 min),MIDAIR_SLOW=1 $(PYTHON) -m pytest python/tests/test_ctrl_c.py)

gateware: .venv/extension ## Boards' makers' own gateware with our bytes, recorded (MAKERS=folder of their repositories, Debian's ghdl, simavr)
	$(PYTHON) gateware/autd3_run.py
	$(PYTHON) gateware/run.py $(MAKERS)

test-studio: setup studio studio/.venv/ready ## The studio: types, tests, the package's side, and a browser (Node 20+, Debian's chromium; 10 min)
	$(call step,studio: clippy on the door (30 s),cd studio/door && $(CARGO) fmt --check && $(CARGO) clippy --quiet -- -D warnings)
	$(call step,studio: types (10 s),cd studio && npx tsc --noEmit)
	$(call step,studio: tests (1 min),cd studio && npx vitest run)
	$(call step,studio: served and in notebooks (20 s),$(PYTHON) -m pytest python/tests/test_studio.py python/tests/test_view.py)
	$(call step,studio: in a browser and in JupyterLab (4 min),cd studio && npx vitest run --config vite.browser.ts)

npm: studio ## The package for Node and browsers, npm/dist (Node 20+)
	npm/build.sh

test-npm: npm ## The package for Node: packed, installed into an empty folder, its example, its bits (10 s once built)
	cd npm && node --test test/

unity: capi ## Copy the C library that was built into unity/, the package for Unity
	@for pair in libmidair.so:Linux/x86_64 midair.dll:Windows/x86_64 libmidair.dylib:macOS; do \
		[ ! -e $(BUILT)/$${pair%:*} ] || cp -v $(BUILT)/$${pair%:*} unity/Runtime/Plugins/$${pair#*:}; done

test-unity: setup capi ## The scripts for Unity without Unity (Debian's mono-mcs and mono-runtime; 30 s once built)
	@command -v mcs > /dev/null && command -v mono > /dev/null || { echo "test-unity needs mcs and mono: install Mono (Debian: mono-mcs, mono-runtime)"; exit 1; }
	$(call step,Unity: scripts compiled and run by Mono (30 s),$(PYTHON) -m pytest capi/tests/test_unity.py)

matlab: capi ## The package for MATLAB and Octave: compile matlab/midair_mex.c for Octave (Debian's octave, octave-dev)
	@command -v octave-cli > /dev/null && command -v mkoctfile > /dev/null || { echo "matlab needs octave-cli and mkoctfile: install Octave (Debian: octave, octave-dev)"; exit 1; }
	$(call step,MATLAB: midair_mex.c compiled for Octave (5 s),cd matlab && octave-cli --norc --quiet --eval "midair_build('$(abspath $(BUILT))/libmidair.a')")

test-matlab: .venv/extension matlab ## MATLAB's functions in Octave: the bits of Python, 1,000 bad calls, memory, pages (2 min once built)
	$(call step,MATLAB: tests in Octave (2 min),$(PYTHON) -m pytest matlab/tests)

lint: .venv/ready ## Formatting, clippy, rustdoc, ruff, spelling: warnings are errors
	$(call step,lint: Rust is formatted (2 s),$(CARGO) fmt --check)
	$(call step,lint: clippy on the core and the extension and the C library (1 min),$(CARGO) clippy --target-dir target/lint --workspace --all-targets --features midair/scene-file -- -D warnings)
	$(call step,lint: the core's documentation (5 s),RUSTDOCFLAGS="-D warnings" $(CARGO) doc --target-dir target/lint --no-deps $(CORE))
	$(call step,lint: Python (2 s),$(BIN)/ruff check $(CODE) && $(BIN)/ruff check --preview --select PLW1514 $(CODE))
	$(call step,lint: Python is formatted (2 s),$(BIN)/ruff format --check $(CODE))
	$(call step,lint: words are spelt right (2 s),$(BIN)/codespell *.md docs book core python capi bench examples firmware matlab studio/src)
	$(call step,lint: words that docs/style.md replaces (1 s),book/words.sh)

fuzz: fuzz/.tools/bin/cargo-fuzz fuzz/.venv/ready ## Guided fuzzing, recorded (TIME=60 seconds or RUNS a target, TARGETS="scene solve")
	nice -n 19 $(PYTHON) fuzz/run.py --time $(TIME) --runs $(RUNS) $(TARGETS)

TIME := 60
RUNS := 100000000

sanitize: fuzz/.tools/bin/cargo-fuzz .venv/ready ## Address, leak and thread sanitizers and Miri, recorded (CHECKS="address replay thread miri")
	$(PYTHON) fuzz/sanitize.py $(CHECKS)

fuzz/.tools/bin/cargo-fuzz:
	rustup +nightly component list --installed | grep -q '^rust-src' || { echo "fuzz and sanitize need a nightly compiler: rustup toolchain install nightly --component rust-src,miri"; exit 1; }
	$(CARGO) install --quiet --locked --root fuzz/.tools cargo-fuzz@0.13.2

fuzz/.venv/ready: fuzz/requirements.txt .venv/ready
	$(BIN)/uv venv --quiet --clear --python $(PYTHON) $(@D)
	$(BIN)/uv pip install --quiet --python $(@D)/bin/python --constraint constraints.txt --requirements $< --requirements pyproject.toml
	touch $@

RIVALS := autd3/ready autd3-rs textbook.so planar.so $(if $(ACOUSTOOLS),acoustools/ready)

measured: .venv/extension ## Model and calibration beside published measurements (DATA=clone of insitu_optimization)
	$(PYTHON) bench/measured.py $(DATA)

bench-peers: setup ## midair beside its rivals: record and README table (QUICK=1: neither; ACOUSTOOLS=1: AcousTools too)
	-$(MAKE) --keep-going --no-print-directory $(addprefix bench/.envs/,$(RIVALS))
	$(PYTHON) bench/peers.py $(if $(QUICK),--quick)
	$(if $(QUICK),,$(PYTHON) book/pictures peers)

bench/.envs/%/ready: bench/%.txt .venv/ready
	$(BIN)/uv venv --quiet --clear --python $(PYTHON) $(@D)
	$(BIN)/uv pip install --quiet --python $(@D)/bin/python --constraint constraints.txt --requirements $<
	touch $@

bench/.envs/autd3-rs: bench/autd3/src/main.rs bench/autd3/Cargo.toml bench/autd3/Cargo.lock
	RUSTFLAGS='-C target-cpu=native' $(CARGO) build --quiet --locked --release --manifest-path bench/autd3/Cargo.toml --target-dir $(@D)/cargo
	cp $(@D)/cargo/release/autd3-worker $@

bench/.envs/textbook.so: CXXFLAGS := -O3
bench/.envs/planar.so: CXXFLAGS := -Ofast -march=native
bench/.envs/%.so: bench/workers/%.cpp
	mkdir -p $(@D)
	$(CXX) -std=c++17 $(CXXFLAGS) -fPIC -shared -o $@ $<

pictures: $(if $(NAMES),setup) ## Pictures and tables of pages: lists them; NAMES="motion touch" makes some, from 10 s to 2 h each
	OPENBLAS_NUM_THREADS=1 MPLBACKEND=agg $(PYTHON) book/pictures $(NAMES)

look: docs studio ## Look at the book in a browser: axe, requests, widths, live cells (Node 20+, Debian's chromium; 3 min)
	$(call step,book: in a browser (3 min),node studio/look.mjs out/site out/look)

docs: setup site ## Build the book, the documentation as a site: out/site/index.html

site: book/.venv/ready
	cd python && $(abspath $(PYTHON)) -B stubs midair
	$(call step,book: built where nothing warns (10 s),NO_MKDOCS_2_WARNING=1 book/.venv/bin/mkdocs build --quiet --strict --config-file book/mkdocs.yml)
	$(call step,book: every link followed (6 s),$(PYTHON) book/links.py out/site)
	@touch out/site/.nojekyll # GitHub Pages would leave out folders that begin with _
	@echo; echo "Open $(CURDIR)/out/site/index.html. Its search needs a server: python3 -m http.server --directory out/site"

# The book's generator and the notebooks for tests of the studio each have an environment with their own libraries. midair
# and the libraries that it needs are found in .venv, which comes later in the search path.
book/.venv/ready studio/.venv/ready: %/.venv/ready: %/requirements.txt .venv/ready
	$(BIN)/uv venv --quiet --clear --python $(PYTHON) $(@D)
	$(BIN)/uv pip install --quiet --python $(@D)/bin/python --requirements $<
	echo "import site; site.addsitedir('$$(echo $(CURDIR)/.venv/lib/python*/site-packages)')" \
		> "$$(echo $(@D)/lib/python*/site-packages)/midair.pth"
	touch $@

generated: schema api map header ## Write all generated files anew, except those that need a word: golden and pins

schema: .venv/extension # docs/*.schema.json, docs/columns.md, fuzz/*.dict
	$(PYTHON) book/schema.py

api: .venv/extension # docs/api.md, docs/tutorials/first-focus.ipynb
	$(PYTHON) book/reference.py

map: # docs/map.md
	MIDAIR_MAP=write $(CARGO) test --quiet $(SHARED) --test suite map

header: # capi/include/midair.h
	MIDAIR_HEADER=write $(CARGO) test --quiet -p midair-capi --test header

golden: ## Write golden/ anew (a breaking change: say so in CHANGELOG.md)
	MIDAIR_GOLDEN=write $(CARGO) test --quiet $(SHARED) --test suite -- golden motion_files

pins: ## Pin what pyproject.toml asks for, names and versions only
	$(BIN)/uv pip compile --quiet --universal --no-header --no-annotate --group dev --no-emit-index-url --output-file constraints.txt pyproject.toml
	$(BIN)/uv pip compile --quiet --universal --no-header --no-annotate --group docs --no-emit-index-url --output-file book/requirements.txt
	$(BIN)/uv pip compile --quiet --universal --no-header --no-annotate --group lab --constraint constraints.txt --no-emit-index-url --output-file studio/requirements.txt
	echo "uv==$$($(BIN)/uv --version | cut -d' ' -f2)" >> constraints.txt

wheels: setup studio ## Wheels for Linux, x86-64 and 64-bit ARM, with the studio, into dist (15 min)
	python/wheels.sh

release: book/.venv/ready studio/node_modules ## Rehearse a release: all parts into out/release, each tried in an empty folder (17 min)
	$(PYTHON) python/release.py

clean: ## Remove what was built
	$(CARGO) clean
	rm -rf .venv out bench/.envs core/tests/no_std/target python/midair/*.so python/midair/_*.pyi studio/.venv studio/node_modules studio/built python/midair/_studio/built
