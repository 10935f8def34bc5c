# Two commands do everything: `make demo` and `make test`, which leaves the slow tests to `make test-all`. Each makes its
# own environment in .venv, so an externally managed system Python (PEP 668) is left alone.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# small matrices: threads of the linear algebra only get into each other's way
export OPENBLAS_NUM_THREADS ?= 1
# where this is set, every process of a run would read all its sources and rewrite all asserts anew
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test static test-all check docs bench bench-doctor bench-sessions data clean

demo: $(VENV)/.runtime
	$(BIN)/ident demo -o out

# types and examples, while loops are compiled that the tests need; then the tests. Each of the two that compile begins
# with the loop that the other asks for last, and so finds it compiled
test: $(VENV)/.test
	$(MAKE) --no-print-directory -j3 static compiled-contract compiled-unit
	$(BIN)/pytest -n 2 --dist worksteal -m "not slow and not compiles" tests

static: $(VENV)/.test
	$(BIN)/ruff check . && $(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/pytest src

compiled-%: $(VENV)/.test
	$(BIN)/pytest -m "compiles and not slow" $$(grep -rl --include="*.py" mark.compiles tests/$* | sort)

test-all: test
	$(BIN)/pytest -n 3 --dist worksteal -m slow tests

check: $(VENV)/.test
	$(BIN)/ruff check --fix . && $(BIN)/ruff format . && $(BIN)/mypy && $(BIN)/lint-imports

docs: $(VENV)/.docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo "open site/index.html"

bench: $(VENV)/.test
	for f in $(filter-out %/bench_doctor.py,$(wildcard benchmarks/bench_*.py)); do $(BIN)/python $$f; done

# N: sessions of each kind; FAMILIES: some of them; START: others than the frozen ones; ENGINE: another one
bench-doctor: $(VENV)/.test
	$(BIN)/python benchmarks/bench_doctor.py $(if $(N),-n $(N)) $(if $(FAMILIES),--families $(FAMILIES)) \
	  $(if $(START),--start $(START)) $(if $(ENGINE),--engine $(ENGINE))

# made-up and drawn sessions with what the first doctor must say of each
bench-sessions: $(VENV)/.test
	$(BIN)/pytest -n 2 --dist worksteal benchmarks/sessions

data: $(VENV)/.runtime
	$(BIN)/python data/make_raw.py

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Python 3.11 or newer is needed; $(PYTHON) is older. Name another one: make demo PYTHON=python3.12"; exit 2; }
	$(PYTHON) -m venv $(VENV) || \
	  { rm -rf $(VENV); echo "No virtual environment could be made. On Debian or Ubuntu: apt install python3-venv"; exit 2; }

$(VENV)/.runtime: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	@touch $@

$(VENV)/.test: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[test]'
	@touch $@ $(VENV)/.runtime

$(VENV)/.docs: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[docs]'
	@touch $@ $(VENV)/.runtime

clean:
	rm -rf $(VENV) out build site
