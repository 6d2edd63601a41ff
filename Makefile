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
PARALLEL = -n auto --maxprocesses 4 --dist worksteal
PYTEST = OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest $(PARALLEL)

.PHONY: charts test test-all check lint sets fuzz coverage mutants answers bench drift_map reality docs links oldest newest dist clean

charts: $(VENV)/.run
	$(BIN)/stochlin charts --out figures

test: $(VENV)/.dev
	$(PYTEST) -m "not slow"

# With the long scans and statistics.
test-all: $(VENV)/.dev
	$(PYTEST)

check: lint test
	PYTHONPATH=tests $(BIN)/python -m house.lines

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/codespell
	$(BIN)/mypy

# Mutated case files, records and hazards for an hour or so; `make test-all` has a minute of it.
fuzz: $(VENV)/.dev
	FUZZ_TIMES=60 $(BIN)/python -m pytest tests/fuzz

# The lines of the uncompiled code that `make test` reaches; Python 3.12 and newer count them quickly.
coverage: $(VENV)/newest/.ready
	$(BIN)/uv pip install --quiet --python $(VENV)/newest/bin/python --group coverage
	COVERAGE_CORE=sysmon OPENBLAS_NUM_THREADS=1 $(VENV)/newest/bin/python -m pytest $(PARALLEL) -m "not slow" \
		--cov=stochlin --cov-report=term:skip-covered

# Changes the code at 60 random places, one at a time, and lists what no test notices: half an hour to an hour.
SEED ?= 1
mutants: $(VENV)/.dev
	PYTHONPATH=tests $(BIN)/python -m house.mutants $(SEED)

# Reruns the frozen answers in tests/answers, rewrites those that have moved, with the verification manual,
# and shows what moved.
answers: $(VENV)/.dev
	PYTHONPATH=tests MPLBACKEND=agg $(BIN)/python -m answers.rewrite

bench: $(VENV)/.dev
	$(BIN)/python benchmarks/tables.py build/bench.md
	$(BIN)/python benchmarks/simulation.py
	$(BIN)/python benchmarks/pounding.py
	$(BIN)/python benchmarks/rules.py

# The map that comes with the package, of what simulation adds to the drift closure: two hours or so, to
# be resumed.
drift_map: $(VENV)/.dev
	$(BIN)/python benchmarks/drift_map.py stochlin/analyses/linearization/drift_map.nc --work build/drift

# Whether predicted gaps hold in recorded earthquakes: the numbers and pictures of docs/reality.md, from a
# folder of records that are not part of the repository; half an hour or so on two cores, to be
# resumed.
RECORDS ?= ../shared/records
reality: $(VENV)/.dev
	$(BIN)/python benchmarks/reality.py $(RECORDS) --work build/reality --page docs/reality.md --save docs/gallery/reality.nc

# The documentation site, from scratch: a warning is an error, a link that leads nowhere a warning.
docs: $(VENV)/.docs
	rm -rf build/docs docs/auto_gallery docs/notebooks docs/reference/generated
	$(BIN)/sphinx-build -W --keep-going -b html docs build/docs

# The links to other sites, listed; one that does not answer is no failure.
links: $(VENV)/.docs
	-$(BIN)/sphinx-build -b linkcheck docs build/links

# `make test` in an environment of its own: with the lowest versions that pyproject.toml allows, and with
# the newest libraries on the newest Python that is found, on the path or installed by pyenv.
NEWEST ?= $(shell for python in python3.13 ~/.pyenv/versions/3.13*/bin/python python3.12 \
	~/.pyenv/versions/3.12*/bin/python; do $$python -V >/dev/null 2>&1 && echo $$python && break; done)

oldest: $(VENV)/oldest/.ready
	OPENBLAS_NUM_THREADS=1 $(VENV)/oldest/bin/python -m pytest $(PARALLEL) -m "not slow"

newest: $(if $(NEWEST),$(VENV)/newest/.ready)
	$(if $(NEWEST),OPENBLAS_NUM_THREADS=1 $(VENV)/newest/bin/python -m pytest $(PARALLEL) -m "not slow",\
	@echo "no Python 3.13 or 3.12 is found: nothing is tested with the newest libraries")

# The environments of both.
sets: $(VENV)/oldest/.ready $(if $(NEWEST),$(VENV)/newest/.ready)

$(VENV)/oldest/.ready: OF_SET = $(PYTHON) lowest-direct
$(VENV)/newest/.ready: OF_SET = $(NEWEST) highest
$(VENV)/oldest/.ready $(VENV)/newest/.ready: pyproject.toml | $(VENV)/.dev
	$(BIN)/uv venv --quiet --clear --python $(firstword $(OF_SET)) $(@D)
	$(BIN)/uv pip install --quiet --python $(@D)/bin/python --resolution $(lastword $(OF_SET)) --group dev -e ".[scale,app,tables]"
	$(BIN)/uv pip freeze --quiet --python $(@D)/bin/python | grep -E "^(numpy|scipy|sympy|xarray|matplotlib|numba|click)="
	$(@D)/bin/stochlin warmup
	touch $@

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
	rm -rf $(VENV) build dist docs/auto_gallery docs/notebooks docs/reference/generated *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
