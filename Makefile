# refdof: every task sets up .venv by itself; it needs git, make and Python 3.11 or newer.
PYTHON ?= python3
SECONDS ?= 600
BIN := .venv/bin
# A worker per core, two threads each: several tests compare one thread with two. Files stay whole, so that a file's
# shared references are rendered once, and come in the order of tests/conftest.py.
PYTEST := NUMBA_NUM_THREADS=2 $(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder

INSTALL := $(BIN)/pip install --quiet --disable-pip-version-check --no-compile --constraint constraints.txt --editable
# pip compiles one file after the other, the tests of packages too, which takes longer than all else that it does.
BYTECODE := $(BIN)/python -m compileall -qq -j 0 -x '/tests?/' .venv/lib || true

.DEFAULT_GOAL := help

help:  ## list the tasks
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

compare: .venv/run  ## compare every method with the reference on a built-in scene, into out/
	$(BIN)/refdof compare --out out

test: .venv/test  ## every test, compiled
	$(PYTEST)

fast: .venv/test  ## tests that are quick without compiling, on tiny pictures
	NUMBA_DISABLE_JIT=1 $(PYTEST) -m "fast and not long"

mutants: .venv/test  ## plant faults and see which tests find them, about an hour; then docs/mutants.md
	$(BIN)/python -m tests.mutants.run --jobs 2

fuzz: .venv/fuzz  ## spoil what files and options hold, for SECONDS (600); findings are kept in build/fuzz/
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m tests.fuzz.run --seconds $(SECONDS)

# Checks need no fast code, which takes longer to compile.
bounds: .venv/test  ## of the same tests those of kernels, compiled with bounds checks
	NUMBA_BOUNDSCHECK=1 NUMBA_OPT=1 $(PYTEST) -m "fast" $(shell cat .ci/kernel_rooms)

lint: .venv/test  ## style, types and import layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

wheel: .venv/test  ## build the wheel and the source archive and try both outside the repository
	.ci/wheel
	.ci/source_archive

readme: .venv/run  ## make the README's picture and table anew
	$(BIN)/refdof compare fence --size 320x240 --out out/readme
	cp out/readme/overview.png docs/overview.png
	$(BIN)/python .ci/readme_table.py out/readme/table.md

bench: .venv/peers  ## every benchmark beside its peers, one table and JSON files, into out/bench/
	$(BIN)/python benchmarks/bench.py

docs: .venv/docs  ## the documentation, into build/docs/index.html
	$(BIN)/sphinx-build --fail-on-warning --keep-going --quiet --builder html docs build/docs
	$(BIN)/python docs/check_offline.py build/docs

new-method:  ## write the skeleton of a method: make new-method NAME=my_method
	@$(PYTHON) scaffold/new.py method '$(NAME)'

new-scene:  ## write the skeleton of a scene: make new-scene NAME=my_scene
	@$(PYTHON) scaffold/new.py scene '$(NAME)'

clean:  ## remove the virtual environment and what was built
	rm -rf .venv build *.egg-info out docs/api docs/examples docs/methods

.venv/bin/python:
	$(PYTHON) -m venv .venv

.venv/run: .venv/bin/python pyproject.toml constraints.txt
	$(INSTALL) .
	$(BYTECODE)
	touch $@

.venv/test: .venv/run
	$(INSTALL) '.[test,lint]'
	$(BYTECODE)
	touch $@

.venv/peers: .venv/test
	$(INSTALL) '.[peers]'
	$(BYTECODE)
	touch $@

.venv/fuzz: .venv/test
	$(INSTALL) '.[fuzz]'
	touch $@

.venv/optiland: .venv/test
	$(INSTALL) '.[optiland]'
	touch $@

.venv/docs: .venv/run
	$(INSTALL) '.[docs]'
	$(BYTECODE)
	touch $@

everything: .venv/bin/python  ## install what every task needs, in one go, 3 GB
	$(INSTALL) '.[test,lint,peers,fuzz,optiland,docs]'
	$(BYTECODE)
	touch .venv/run && touch .venv/test && touch .venv/peers .venv/fuzz .venv/optiland .venv/docs

optiland: .venv/optiland  ## install optiland (1.3 GB) and make the stored rays of real lenses anew
	REFDOF_REQUIRE_OPTILAND=1 $(BIN)/python -m pytest tests/optics/systems/test_optiland.py

peers: .venv/peers  ## install the renderers that some tests and benchmarks compare with

.PHONY: help compare test fast bounds mutants fuzz lint bench docs wheel readme new-method new-scene clean peers optiland everything
