# Everything runs in .venv, which `.ci/set-up` makes from requirements.lock and leaves alone when nothing changed.
# Another Python: make demo PYTHON=python3.12.  More for pytest: make test PYTEST_ARGS="-k offset"
# A part of the bars, as Markdown: make bars BARS_ARGS="--only attacks --markdown bars.md"

# Where this is set, each of the hundreds of processes that the tests start would compile all modules anew.
unexport PYTHONDONTWRITEBYTECODE

PYTHON ?=
PYTEST_ARGS ?=
BARS_ARGS ?=
FUZZ_ARGS ?=
MUTANTS_ARGS ?=

.DEFAULT_GOAL := help
.PHONY: help demo test test-all coverage check lint format docs gallery bars mutants fuzz bench lock clean set-up

help:  ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-8s %s\n", $$1, $$2 }' Makefile

demo: set-up  ## the main job on embedded data: course built, sample hand-ins graded, a record identified
	@.venv/bin/labsid demo

test: set-up  ## the tests, on all cores
	@.venv/bin/python -m pytest -n auto -m "not exhaustive" $(PYTEST_ARGS)

test-all: set-up  ## the tests, and for every case what `test` proves for one of each kind (half an hour)
	@.venv/bin/python -m pytest -n auto $(PYTEST_ARGS)

coverage: set-up  ## branches that the tests take, by room; what is below 90 % with its reason (longer than `make test`)
	@rm -rf build/coverage && mkdir -p build/coverage
	@.venv/bin/python -m coverage run -m pytest -n auto -m "not exhaustive" $(PYTEST_ARGS)
	@.venv/bin/python -m coverage combine --quiet
	@.venv/bin/python -m coverage json --quiet --ignore-errors -o build/coverage/report.json
	@.venv/bin/python -P tests/coverage_by_room.py build/coverage/report.json

check: set-up lint  ## for work in progress, within a minute: style, types, and the tests that start and search nothing
	@.venv/bin/python -m pytest -n auto -m "not slow" $(PYTEST_ARGS)

lint: set-up  ## style, format and types
	@.venv/bin/ruff check --no-cache . # a cached answer can be stale: whose package an import is, depends on other files
	@.venv/bin/ruff format --check .
	@.venv/bin/mypy

format: set-up  ## rewrite the code in the project's format
	@.venv/bin/ruff check --fix .
	@.venv/bin/ruff format .

docs: set-up  ## the site, in build/docs: sources, pages, doctests and links checked (a minute; no network)
	@.venv/bin/python -P notebooks/site/pages.py build/site
	@for builder in html doctest linkcheck; do \
	    .venv/bin/sphinx-build -b $$builder -c notebooks/site -n -W --keep-going -q -d build/docs/.doctrees \
	        build/site build/docs/$$builder || exit 1; \
	done
	@echo 'the site: build/docs/html/index.html'

gallery: set-up  ## the figures of the site: a simulated rig with each effect, diagnosed (minutes; kept in build/gallery)
	@.venv/bin/python -P notebooks/site/gallery.py

bars: set-up  ## every bar, measured here: marks, slips, attacks, speed beside nbgrader, kills, Dask, simulators (an hour)
	@.venv/bin/python -P tests/bars_grading.py $(BARS_ARGS)

mutants: set-up  ## every single change of a model solution, and whether the checks notice it (minutes)
	@.venv/bin/python -P tests/mutants.py $(MUTANTS_ARGS)

fuzz: set-up  ## hostile values, and mutated hand-ins, downloads, zip files, records and models (minutes)
	@.venv/bin/python -P tests/fuzz.py $(FUZZ_ARGS)

bench: set-up  ## labsid beside its peers, in one run; fetches the peers into build/bench
	@sh .ci/bench
	@.venv/bin/python -P tests/bench_grading.py

set-up:  ## only make .venv
	@PYTHON="$(PYTHON)" sh .ci/set-up

lock:  ## resolve requirements.lock anew, with uv, to the newest versions that pyproject.toml allows
	@PYTHON="$(PYTHON)" sh .ci/lock

clean:  ## remove .venv, builds and caches
	rm -rf .venv build dist *.egg-info .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find autograder labsid tests -name __pycache__ -type d -prune -exec rm -rf {} +
