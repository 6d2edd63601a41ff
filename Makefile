# Two commands: `make charts` and `make test`. Both set up .venv first; only Python and make are needed.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: charts test check bench bias oldest clean

charts: $(VENV)/.run
	$(BIN)/stochlin charts --out figures

test: $(VENV)/.dev
	$(BIN)/python -m pytest

check: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m pytest

bench: $(VENV)/.dev
	$(BIN)/python benchmarks/tables.py
	$(BIN)/python benchmarks/simulation.py

# The map of linearization's bias that comes with the package: an hour or so, to be resumed.
bias: $(VENV)/.dev
	$(BIN)/python benchmarks/bias_map.py stochlin/analyses/bias_map.nc --work build/bias

# The lowest versions that pyproject.toml allows, in an environment of their own.
oldest: $(VENV)/.dev
	$(BIN)/uv venv --clear --python $(PYTHON) .venv/oldest
	$(BIN)/uv pip install --python .venv/oldest/bin/python --resolution lowest-direct -e ".[dev]"
	.venv/oldest/bin/python -m pytest

$(VENV)/.run: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	touch $@

$(VENV)/.dev: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	touch $@ $(VENV)/.run

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
