# Needs Python 3 with pip and venv, git and make; everything else is fetched into .tools/ and .venv/.

BLENDER ?= 5.1
PYTHON_VERSION := 3.13
PY := .venv/bin/python
STAMP := .venv/.simworlds-installed
STUBS := .venv/stubs/.written
# The package blender-mcp needs another mcp than ours, so it has an environment of its own.
BLENDER_MCP := .tools/blender-mcp/.installed
BLENDER_MCP_LOCK := tests/agents/blender/drop_in/blender-mcp.lock
UV := $(or $(shell command -v uv 2>/dev/null),.tools/uv/bin/uv)

# uv passes over pyenv's shims, but takes an interpreter that stands in pyenv's folder when it is on PATH.
PYENV_BINS := $(wildcard $(or $(PYENV_ROOT),$(HOME)/.pyenv)/versions/$(PYTHON_VERSION).*/bin)
empty :=
space := $(empty) $(empty)
UV_ENV := VIRTUAL_ENV= PATH="$(PATH):$(subst $(space),:,$(strip $(PYENV_BINS)))"

ifneq ($(wildcard ../shared/corpora),)
export SIMWORLDS_CORPORA ?= $(abspath ../shared/corpora)
endif

# uv trusts a list of its own unless told to trust the system's, where a company's proxy may be known.
ifneq ($(wildcard /etc/ssl/certs/ca-certificates.crt),)
export UV_SYSTEM_CERTS ?= 1
endif

# One more than there are cores, as many tests wait: for a Blender to start or to end, for a limit to be reached. With more
# of them, limits in seconds that tests set are reached by waiting for a core. Each takes up to 2 GB.
TEST_PROCESSES ?= $(shell python3 -c 'import os; cores = len(os.sched_getaffinity(0)); \
  memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") >> 31; print(max(2, min(cores + 1, memory, 8)))')

.DEFAULT_GOAL := help
.PHONY: help setup blender-mcp kb test test-whole test-fast serve bench bench-validate soak lint docs docs-check site rule-pictures audit-pictures \
  window-figures dist \
  dist-validate licences fuzz lock clean

help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## /{printf "  make %-15s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: $(STAMP) ## Make .venv with the pinned dependencies

blender-mcp: $(BLENDER_MCP) ## Install the package blender-mcp, as the client of its test

kb: $(STAMP) ## Build the knowledge base of BLENDER=5.1 [MANUAL= GUIDES= BLENDER_EXE= SUMMARIES= REQUIRE=]
	@.venv/bin/simworlds kb build "$(BLENDER)" \
	  $(if $(MANUAL),--manual "$(MANUAL)") \
	  $(if $(GUIDES),--guides "$(GUIDES)") \
	  $(if $(BLENDER_EXE),--blender-exe "$(BLENDER_EXE)") \
	  $(if $(SUMMARIES),--summaries "$(SUMMARIES)") \
	  $(if $(REQUIRE),--require "$(REQUIRE)") $(KB_ARGS)

test: $(STAMP) ## Run the tests, a file at a time on each core [PYTEST_ARGS=]
	@$(PY) -m pytest --numprocesses=$(TEST_PROCESSES) --dist=loadfile --no-loadscope-reorder --durations=30 $(PYTEST_ARGS)

test-whole: $(STAMP) ## Run them with every cell of the tables that `make test` takes a part of [PYTEST_ARGS=]
	@SIMWORLDS_WHOLE=1 $(MAKE) --no-print-directory test PYTEST_ARGS="$(PYTEST_ARGS)"

test-fast: $(STAMP) ## Run the tests that need no Blender [PYTEST_ARGS=]
	@$(PY) -m pytest --numprocesses=2 --dist=loadfile -m "not blender and not corpora and not slow and not window" $(PYTEST_ARGS)

serve: $(STAMP) ## Serve blender_docs and blender_check over MCP on stdio [SERVE_ARGS=]
	@.venv/bin/simworlds serve $(SERVE_ARGS)

bench: $(STAMP) ## Measure retrieval, latency and builds, beside the peers [BENCH_ARGS=]
	@$(PY) -m measurements $(BENCH_ARGS)

soak: $(STAMP) ## Keep both servers busy for MINUTES each, with rude clients among the polite [MINUTES=30]
	@$(PY) -m measurements --only soak --load-seconds $$((60 * $(or $(MINUTES),30)))

bench-validate: $(STAMP) ## Prove what the benchmark must prove about itself, over all scenes [VALIDATE_ARGS=]
	@.venv/bin/simworlds bench validate --jobs 2 $(VALIDATE_ARGS)

lint: $(STAMP) $(STUBS) ## Check style, format and types
	@.venv/bin/ruff check .
	@.venv/bin/ruff format --check .
	@.venv/bin/pyright
	@.venv/bin/pyright --project pyright-inside.json

docs: $(STAMP) ## Write the generated references
	@$(PY) -m docs.generate

site: $(STAMP) ## Build the documentation site in build/site, links checked, without a network
	@NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --strict --quiet
	@echo "build/site/index.html"

rule-pictures: $(STAMP) ## Draw the pictures on the rules' pages [RULES="V1 V2"]
	@$(PY) tests/agents/protocol/rule_pictures.py $(RULES)

audit-pictures: $(STAMP) ## Draw the pictures of the audit's relations and predicates [PICTURES="Above rigid_type"]
	@$(PY) tests/bench/audit/audit_pictures.py $(PICTURES)

window-figures: $(STAMP) ## Measure SimWorlds in an open Blender, and draw its picture
	@$(PY) tests/agents/blender/attached/window_figures.py docs/open-blender.png

docs-check: $(STAMP) ## Check that the generated references are up to date
	@$(PY) -m docs.generate --check

dist: $(STAMP) ## Build wheel, sdist, SBOM and bundle into dist/, the same bytes each time
	@$(PY) -m release

dist-validate: $(STAMP) ## Ask each artefact's own validator, which npx and uvx fetch
	@PATH="$(CURDIR)/.venv/bin:$$PATH" $(PY) -m release validate

licences: $(STAMP) ## Write and check the table of the dependencies' licences
	@$(PY) -m release licences

fuzz: $(STAMP) ## Give every reader broken input for FUZZ_SECONDS=60; keep what fails in tests/fuzz/corpus
	@$(PY) tests/fuzz/run_fuzz.py --seconds $(or $(FUZZ_SECONDS),60) $(FUZZ_ARGS)

PIN = $(UV_ENV) "$(UV)" pip compile --universal --python-version 3.11 --upgrade --generate-hashes --no-emit-index-url \
  --no-emit-find-links --no-annotate --no-header --quiet

lock: $(UV) ## Pin the newest dependencies in requirements.lock
	@$(PIN) pyproject.toml --all-extras --group dev --output-file requirements.lock
	@echo blender-mcp | $(PIN) - --output-file $(BLENDER_MCP_LOCK)

clean: ## Remove what was made here (knowledge bases live elsewhere and stay)
	rm -rf .venv .tools build dist .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# What runs inside Blender is checked against stubs of the installed bpy.
$(STUBS): $(STAMP) $(wildcard kb_check/stubs/*.py kb_build/flow/*.py kb_build/flow/*/*.py)
	@echo "Writing stubs of the installed bpy ..."
	@mkdir -p .venv/stubs
	@.venv/bin/simworlds kb build --no-pages --offline --out .venv/stubs/base.sqlite >.venv/stubs.log 2>&1 \
	  || { cat .venv/stubs.log; exit 1; }
	@.venv/bin/simworlds stubs --base .venv/stubs/base.sqlite --out .venv/stubs
	@touch $(STUBS)

# The stamp is written last: a set-up that was interrupted is done again.
$(STAMP): requirements.lock pyproject.toml | $(UV)
	@echo "Setting up .venv: CPython $(PYTHON_VERSION) ..."
	@test ! -L .venv || rm .venv  # a link leads to somebody else's environment
	@test -x $(PY) || $(UV_ENV) "$(UV)" venv --quiet --clear --python $(PYTHON_VERSION) .venv
	@echo "Setting up .venv: pinned dependencies, Blender's bpy among them (350 MB of it, minutes on a slow line) ..."
	@$(UV_ENV) "$(UV)" pip sync --quiet --compile-bytecode --python $(PY) --require-hashes requirements.lock
	@echo "Setting up .venv: SimWorlds itself ..."
	@$(UV_ENV) "$(UV)" pip install --quiet --python $(PY) --no-deps --no-build-isolation --editable .
	@$(PY) -m compileall -q simworlds kb_check kb_build kb_serve agents bench measurements release
	@touch $(STAMP)

$(BLENDER_MCP): $(BLENDER_MCP_LOCK) | $(UV)
	@echo "Installing blender-mcp into .tools/blender-mcp/ ..."
	@$(UV_ENV) "$(UV)" venv --quiet --clear --python $(PYTHON_VERSION) .tools/blender-mcp
	@$(UV_ENV) "$(UV)" pip sync --quiet --python .tools/blender-mcp/bin/python --require-hashes $(BLENDER_MCP_LOCK)
	@touch $(BLENDER_MCP)

# The lock pins uv too, since the project depends on it: that very version is fetched, its hashes checked.
.tools/uv/bin/uv:
	@echo "Fetching uv into .tools/ ..."
	@rm -rf .tools/uv && mkdir -p .tools
	@awk '/^[^ ]/{uv = /^uv==/} uv' requirements.lock > .tools/uv-requirements.txt
	@python3 -m venv .tools/uv
	@.tools/uv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	  -r .tools/uv-requirements.txt
