# `make charts`, `make test` and `make docs` set up .venv first; only Python and make are needed.
# Modules are compiled when they are first imported, which most of the installed ones never are, and kept:
# otherwise every command would compile numba and scipy again, seven seconds each time.
unexport PYTHONDONTWRITEBYTECODE
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALL = $(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check
# A process for every core, at most four; one that has no more tests takes from the others. Threads of
# linear algebra in each would wait for one another.
PYTEST = OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --maxprocesses 4 --dist worksteal
# The tests of `make test`; `make test VENV=.venv/newest PYTHON=python3.13` runs them in another environment.
MARKS ?= not slow

# What the site builds, and makes beside its pages.
SITE = $(BIN)/sphinx-build -W --keep-going -q -b html
MADE = docs/auto_gallery docs/notebooks docs/reference/generated

.PHONY: charts test test-all check docs pages answers mutants dist clean

charts: $(VENV)/.run
	$(BIN)/stochlin charts --out figures

test: $(VENV)/.dev
	$(PYTEST) -m "$(MARKS)"

# With the long scans and statistics.
test-all: $(VENV)/.dev
	$(PYTEST)

# What does not run the code: linter, spelling and types; then lines, modules and public names.
check: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/codespell
	$(BIN)/mypy
	PYTHONPATH=tests $(BIN)/python -m house.lines

# The pictures of the pages that have moved, and the documentation site, from scratch: a warning is an error.
docs: $(VENV)/.docs
	rm -rf build/docs $(MADE)
	PYTHONPATH=tests $(BIN)/python -m house.pictures
	$(SITE) docs build/docs

# The site without its gallery, whose scripts `make test-all` runs: a minute.
pages: $(VENV)/.docs
	rm -rf build/pages $(MADE)
	$(SITE) -D plot_gallery=0 docs build/pages

# Reruns the frozen answers in tests/answers, rewrites those that have moved, with the verification manual and
# what other pages take from the code, and shows what moved.
answers: $(VENV)/.dev
	PYTHONPATH=tests MPLBACKEND=agg $(BIN)/python -m answers.rewrite

# Changes the code at 60 random places, one at a time, and lists what no test notices: half an hour to an hour.
SEED ?= 1
mutants: $(VENV)/.dev
	PYTHONPATH=tests $(BIN)/python -m house.mutants $(SEED)

# The wheel and the source archive in dist/, their contents compared with the repository; then the wheel
# answers the example, in an environment of its own.
dist: $(VENV)/.dev
	$(INSTALL) --group dist -e .
	rm -rf dist build/wheel
	$(BIN)/python -m build --outdir dist
	$(BIN)/twine check --strict dist/*
	$(BIN)/python -m pytest tests/house/test_distribution.py
	$(PYTHON) -m venv build/wheel
	build/wheel/bin/python -m pip install --quiet --disable-pip-version-check dist/*.whl
	cd build/wheel && bin/stochlin gap --example > case.toml && bin/stochlin gap case.toml --report gap.html

$(VENV)/.run: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL) -e .
	touch $@

$(VENV)/.dev: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL) "pip>=25.1"  # which knows the groups of pyproject.toml
	$(INSTALL) --group dev -e ".[scale,app,tables]"
	$(BIN)/stochlin warmup
	touch $@ $(VENV)/.run

$(VENV)/.docs: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL) "pip>=25.1"  # which knows the groups of pyproject.toml
	$(INSTALL) --group docs -e .
	touch $@ $(VENV)/.run

clean:
	rm -rf $(VENV) build dist $(MADE) *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
