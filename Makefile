# `make` lists the targets. Each does its own set-up: it needs only make and a Python of 3.10 to 3.13.
# Written for GNU make 3.81 (macOS) and a plain POSIX sh.

VENV    = .venv
RUN     = $(VENV)/bin/python
PYTHONS = $(if $(PYTHON),$(PYTHON),python3.13 python3.12 python3.11 python3.10 python3)
# One stamp per requested Python, so that `make test PYTHON=python3.12` rebuilds a .venv made with another one.
STAMP   = $(VENV)/.installed$(if $(PYTHON),-$(notdir $(PYTHON)))
SUITED  = import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))

.PHONY: help cube disc intact test lint versions oldest newest thorough validation verify hardcases study clean

help:
	@echo 'make cube        slit cube in uniaxial compression    -> renders/cube/'
	@echo 'make disc        slit disc in diametral compression   -> renders/disc/'
	@echo 'make intact      cube without a flaw                  -> renders/intact/'
	@echo '                 (each replaces its run of before; into ARGS="--out DIR" only with --overwrite)'
	@echo 'make test        the test suite'
	@echo 'make lint        ruff check, ruff format --check, mypy'
	@echo 'make versions    the tests that touch other packages, with the lowest and the highest versions that are allowed'
	@echo 'make thorough    the rest of the tests that CI runs'
	@echo 'make validation  the longer tier of tests'
	@echo 'make verify      the solver against exact solutions and finite elements; ARGS=--full for all of it'
	@echo 'make hardcases   hard cases and their verdicts; ARGS=--full for all of it'
	@echo 'make study       families of runs against theory; ARGS=NAME, or --list'
	@echo 'make clean       remove .venv, build products and caches; renders/ stays'
	@echo
	@echo 'Options go through ARGS:  make cube ARGS="--quick --set flaw_angle=30"'
	@echo '                          make test ARGS="-k shape -x"'
	@echo 'Another Python (3.10 to 3.13), replacing .venv:  make test PYTHON=python3.12'

cube disc intact: $(STAMP)
	$(RUN) -m rsmpm_ti.scene $@ $(ARGS)

test: $(STAMP)
	$(RUN) -m pytest -n 2 --dist worksteal $(ARGS)

thorough: $(STAMP)
	$(RUN) -m pytest -n 2 --dist worksteal -m thorough $(ARGS)

validation: $(STAMP)
	$(RUN) -m pytest -m validation $(ARGS)

verify: $(STAMP)
	$(RUN) -m rsmpm_ti.verify $(ARGS)

hardcases: $(STAMP)
	$(RUN) -m rsmpm_ti.hardcases $(ARGS)

study: $(STAMP)
	$(RUN) -m rsmpm_ti.study $(ARGS)

lint: $(STAMP)
	$(RUN) -m ruff check .
	$(RUN) -m ruff format --check .
	$(RUN) -m mypy

# Each in an environment of its own, built anew: lower bounds of pyproject.toml as they stand, on the oldest Python that is
# there, and the newest versions within its upper bounds, on the newest Python. pyenv's commands work for those of its
# versions that are switched on: here for all.
OTHERS = tests/test_cli.py tests/test_door.py tests/analysis tests/lab/test_report.py tests/output tests/paint tests/spec tests/run/test_run.py
BOUNDS = sed -n 's/^ *"\([A-Za-z0-9_-]*\)>=\([0-9.]*\),.*/\1==\2/p' pyproject.toml

versions: oldest newest

oldest: TRIED = $(if $(PYTHON),$(PYTHON),python3.10 python3.11 python3.12)
newest: TRIED = $(if $(PYTHON),$(PYTHON),python3.13 python3.12 python3.11 python3.10)

oldest newest:
	@rm -rf build/$@ && mkdir -p build
	@if test $@ = oldest; then $(BOUNDS); fi > build/$@.txt
	@PYENV_VERSION=`pyenv versions --bare 2>/dev/null | tr '\n' :`; export PYENV_VERSION; \
	for python in $(TRIED); do "$$python" -m venv --clear build/$@ >/dev/null 2>&1 && exit; done; \
	echo 'No Python that can make an environment among: $(TRIED)' >&2; exit 1
	build/$@/bin/python -m pip install --quiet --disable-pip-version-check -c build/$@.txt -e '.[test]'
	@build/$@/bin/python --version; build/$@/bin/python -m pip list --format freeze
	build/$@/bin/python -m pytest -n 2 --dist worksteal $(OTHERS) $(ARGS)

# Candidates are executed, not just looked up: a pyenv shim may exist and fail. Debian's python3 comes without
# ensurepip, and its `-m venv` would leave a .venv without pip behind.
$(STAMP): pyproject.toml
	@if test -z "$(PYTHON)" && $(RUN) -c '$(SUITED)' && $(RUN) -m pip --version; then \
	  exit 0; \
	fi >/dev/null 2>&1; \
	bare=; \
	for python in $(PYTHONS); do \
	  "$$python" -c '$(SUITED)' >/dev/null 2>&1 || continue; \
	  "$$python" -c 'import ensurepip, venv' >/dev/null 2>&1 || { bare=$$python; continue; }; \
	  echo "$(VENV): made with $$python, `"$$python" --version`"; \
	  exec "$$python" -m venv --clear $(VENV); \
	done; \
	if test -n "$$bare"; then \
	  echo "$$bare cannot make virtual environments. On Debian and Ubuntu: apt install python3-venv" >&2; \
	else \
	  echo 'No working Python of 3.10 to 3.13 among: $(PYTHONS). Name one: make test PYTHON=/path/to/python3.12' >&2; \
	fi; \
	exit 1
	$(RUN) -m pip install --quiet --disable-pip-version-check -e '.[test]'
	@touch $@

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .ruff_cache .mypy_cache .hypothesis
	find rsmpm_ti scenes tests -name __pycache__ -type d -prune -exec rm -rf {} +
