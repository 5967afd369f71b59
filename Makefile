# Every target sets itself up: a machine with Python 3.11 or newer, pip and make is enough.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
JOBS ?= 2
# Small matrices: threads only cost. A comment behind the value would leave its blanks in the value.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: install test lint docs demo audit fuzz lock bench bench-discovery bench-real bench-cdia bench-samples
.PHONY: bench-logs bench-scale bench-sensitivity bench-soak bench-reliability clean help

help:  ## show this list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/'

install: $(VENV)/.installed  ## the package with every extra and the command cdia, in .venv

# worksteal: most files stay with one worker, which sets up and compiles for them once.
test: $(VENV)/.installed-dev  ## all tests
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal

lint: $(VENV)/.installed-dev  ## format, lint and types
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

docs: $(VENV)/.installed-docs  ## the documentation site, in out/docs; runs the examples in the pages
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going -b html docs out/docs
	$(BIN)/python -m pytest docs/checks

audit:  ## look for known vulnerabilities in requirements.lock, where the database of advisories answers
	.ci/audit

fuzz: $(VENV)/.installed-dev  ## fuzz all readers, led by coverage, with the inputs of CI; FUZZ_SECONDS=600 tries new ones for so long
	VENV=$(VENV) .ci/fuzz

demo: $(VENV)/.installed  ## find a missing effect in a log that ships, in under a minute
	$(BIN)/cdia demo

bench: $(VENV)/.installed-dev  ## measure what the README states of measured logs
	$(BIN)/python -m benchmarks
	$(BIN)/python -m benchmarks.measured_logs

bench-discovery: $(VENV)/.installed-dev  ## measure the discovery of hidden effects; an hour, an interrupted run goes on
	-$(BIN)/python -m pip install --quiet --editable ".[bench]"
	$(BIN)/python -m benchmarks.hidden_effects --jobs $(JOBS)

bench-real: $(VENV)/.installed-dev  ## measure known effects in measured logs; hours, an interrupted run goes on
	$(BIN)/python -m benchmarks.real_residuals --jobs $(JOBS)
	$(BIN)/python -m benchmarks.known_weights
	$(BIN)/python -m benchmarks.two_changes --jobs $(JOBS)

bench-cdia: $(VENV)/.installed-dev  ## measure the monitor in closed loop; an hour, an interrupted run goes on
	$(BIN)/python -m benchmarks.online --jobs $(JOBS)

bench-logs: $(VENV)/.installed-dev  ## let the monitor watch measured logs; ten minutes, an interrupted run goes on
	$(BIN)/python -m benchmarks.monitored_logs --jobs $(JOBS)

bench-samples: $(VENV)/.installed-dev  ## give the monitor samples that cannot be; hours, an interrupted run goes on
	$(BIN)/python -m benchmarks.fault_injection --jobs $(JOBS)

bench-soak: $(VENV)/.installed-dev  ## let a monitor run for ten million ticks; ten minutes
	$(BIN)/python -m benchmarks.soak

bench-reliability: $(VENV)/.installed-dev  ## try by kinds what must not break, and count what held; three minutes
	$(BIN)/python -m benchmarks.reliability

bench-sensitivity: $(VENV)/.installed-dev  ## halve and double each number that decides; an hour, an interrupted run goes on
	$(BIN)/python -m benchmarks.sensitivity --jobs $(JOBS)

bench-scale: $(VENV)/.installed-dev  ## measure what many logs and runs need; an hour, best on an idle machine
	$(BIN)/python -m benchmarks.scale --speed-up 1000

lock: | $(BIN)/python  ## choose the versions of make install again, within the ranges of pyproject.toml
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv pip compile pyproject.toml --quiet --extra all --universal --python-version 3.11 --upgrade \
		--generate-hashes --no-emit-index-url --no-annotate --custom-compile-command "make lock" -o requirements.lock

clean:  ## remove the environment and what tools leave behind
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis dist build out

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "cdia-pin needs Python 3.11 or newer; this is %d.%d: make PYTHON=/path/to/python3.11" % sys.version_info[:2])'
	$(PYTHON) -m venv $(VENV)

# The stamps keep the set-up from being done again; a changed pyproject.toml renews it.
# What runs here was tested in exactly these versions, and a file that was exchanged on its way is refused.
$(VENV)/.installed: pyproject.toml requirements.lock | $(BIN)/python
	$(BIN)/python -m pip install --quiet --require-hashes --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	@touch $@

$(VENV)/.installed-docs: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable ".[docs]"
	@touch $@ $(VENV)/.installed

$(VENV)/.installed-dev: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable ".[dev]"
	@tests/browser/install
	@touch $@ $(VENV)/.installed
