# make run: set up and open the explorer on the paper's vehicle.  make test: set up and run all tests, the browser's included.
PYTHON := $(firstword $(shell command -v python3.11) $(shell command -v python3))
BIN := .venv/bin
AS_ROOT := $(if $(filter-out 0,$(shell id -u)),sudo,)

.PHONY: setup run test check bounds bench chromium readme structure paper pictures film studies soak clean

setup: .venv/ready

# Pinned versions first, then Trackride itself; the last line compiles the kernel once, ahead of the first start.
.venv/ready: requirements.txt pyproject.toml
	$(PYTHON) -m venv .venv || { $(AS_ROOT) apt-get update && $(AS_ROOT) apt-get install -y python3-venv && $(PYTHON) -m venv --clear .venv; }
	$(BIN)/python -m pip install --quiet --requirement requirements.txt
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	$(BIN)/python -c "from app.server import prepare; prepare()"
	touch $@

run: setup
	$(BIN)/trackride explore

# One process for the browser's tests, which wait most of the time, one for all others; then both for what is left. What
# both need is compiled before: numba's cache on disk knows nothing of two that fill it at once.
test: setup chromium
	$(BIN)/python -c "from app.server import prepare; prepare()"
	$(BIN)/python -m pytest --numprocesses 2

chromium:
	@command -v chromium chromium-browser google-chrome >/dev/null || { $(AS_ROOT) apt-get update && $(AS_ROOT) apt-get install -y chromium; }

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

# After changing a kernel: the model's tests with every index of compiled code checked, as none is otherwise.
bounds: setup
	NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=build/bounds $(BIN)/python -m pytest tests/model

bench: setup
	$(BIN)/python -m tests.benchmarks

# An hour of everything that may break it; writes tests/soak/REPORT.md.
soak: setup
	$(BIN)/python -m tests.soak

readme: setup
	$(BIN)/python -m tests.readme

structure: setup
	$(BIN)/python -m tests.structure

paper: setup
	$(BIN)/trackride paper --out build/paper

pictures: setup chromium paper
	cp build/paper/claims.png assets/pictures/
	$(BIN)/python -m tests.browser.pictures

film: setup chromium
	$(BIN)/python -m tests.browser.film

studies: setup
	$(BIN)/python -m tests.studies

clean:
	rm -rf .venv build *.egg-info
	find app assets configs model tests -name __pycache__ -prune -exec rm -rf {} +
