.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help studio test lint bench binder docs browser clean

HOST ?= 127.0.0.1
PORT ?= 8888
TORCH ?= torch==2.13.0
# The first Python on the path that is new enough.
PYTHON ?= $(shell for python in python3 python3.13 python3.12 python3.11 python; do \
	$$python -c "import sys; sys.exit(sys.version_info < (3, 11))" 2>/dev/null && echo $$python && break; done)

CPU_INDEX := https://download.pytorch.org/whl/cpu
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "make %-8s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

studio: $(VENV)/studio.stamp ## open JupyterLab on the studio notebook; HOST=127.0.0.1 PORT=8888
	@$(BIN)/python -m sketchwidget studio --host "$(HOST)" --port "$(PORT)"

test: lint browser ## lint, then run the whole suite; ARGS='tests/sketch -x' goes to pytest
	$(BIN)/python -m pytest $(ARGS)

lint: $(VENV)/test.stamp ## check style, types and formatting
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .
	$(BIN)/python -m pyright --pythonpath $(BIN)/python

bench: browser ## measure the figures of benchmarks/RESULTS.md on this machine; nothing else should run beside it
	$(BIN)/python -m benchmarks

binder: ## build Binder's environment in a fresh folder and try it; the folder goes again
	"$(PYTHON)" binder/check.py

docs: $(VENV)/docs.stamp ## build the documentation into build/site, and check its links
	$(BIN)/python docs/build_site.py

browser: $(VENV)/test.stamp
	@sh scripts/browser.sh $(BIN)/python

clean: ## remove what builds and tests leave; the environment stays
	rm -rf build dist .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find sketchwidget tests benchmarks notebooks \( -name __pycache__ -o -name .ipynb_checkpoints \) -prune -exec rm -rf {} +

$(VENV)/pyvenv.cfg:
	@"$(PYTHON)" -c "import sys; sys.exit(sys.version_info < (3, 11))" 2>/dev/null || { \
		echo "sketchwidget needs Python 3.11 or newer; name one with: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	"$(PYTHON)" -m venv $(VENV)

# The CPU build comes first: elsewhere than in PyTorch's own index, torch for Linux is a CUDA build of several gigabytes.
# Its dependencies come with ours in the next step, from the usual index.
$(VENV)/torch.stamp: $(VENV)/pyvenv.cfg
	$(PIP) install --no-deps --retries 1 --timeout 20 --index-url $(CPU_INDEX) "$(TORCH)" || { \
		echo "PyTorch's CPU index did not serve $(TORCH): taking it from the usual index."; \
		$(PIP) install "$(TORCH)"; }
	@touch $@

$(VENV)/studio.stamp: $(VENV)/torch.stamp pyproject.toml
	$(PIP) install --editable ".[notebooks]"
	@touch $@

$(VENV)/test.stamp: $(VENV)/torch.stamp pyproject.toml
	$(PIP) install --editable ".[notebooks,database,test]"
	@touch $@ $(VENV)/studio.stamp

$(VENV)/docs.stamp: $(VENV)/torch.stamp pyproject.toml
	$(PIP) install --editable ".[notebooks,database,docs]"
	@touch $@ $(VENV)/studio.stamp
