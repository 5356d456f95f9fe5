# One command each, on a bare Debian 12 with git, make and python3-venv:
#
#   make demo        real ground becomes a mesh, pictures and a report, in out/demo
#   make test        lint, format, types and tests, but the slow ones
#   make test-slow   the tests that take several seconds each
#   make docs        the site: guides, gallery and reference, in out/site
#   make clean       forget the environment and everything made
#
# PYTHON=python3.13 chooses another interpreter for .venv. Paths are relative throughout, so the
# checkout may stand in a folder with a space in its name.

PYTHON ?= python3
WORKERS ?= 2

python := .venv/bin/python
mesa := libegl1 libgl1-mesa-dri
draws := from terrain_lod.drawing.graphics import require_graphics as check; check()
as_root := $(if $(filter 0,$(shell id -u)),,sudo -n)

.PHONY: help demo test test-slow docs clean

help:
	@sed -n 's/^#   make/make/p' Makefile

demo: .venv/ready
	.venv/bin/terrain-lod demo --output out/demo

test: .venv/ready-to-test
	$(python) -m ruff check .
	$(python) -m ruff format --check .
	$(python) -m mypy
	$(python) -m pytest --numprocesses $(WORKERS) -m "not slow"

test-slow: .venv/ready-to-test
	$(python) -m pytest --numprocesses $(WORKERS) -m slow

docs: .venv/ready-for-docs
	$(python) -m sphinx -W --keep-going --quiet --jobs $(WORKERS) docs out/site
	@echo "out/site/index.html"

clean:
	rm -rf docs/_examples docs/gallery docs/project docs/reference
	rm -rf .venv build dist out *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis

# the stamps are as old as the last set-up; a change of pyproject.toml asks for the next

.venv/ready: pyproject.toml
	$(call set_up,.)
	@touch $@

.venv/ready-to-test: pyproject.toml
	$(call set_up,.[test])
	@touch .venv/ready $@

.venv/ready-for-docs: pyproject.toml
	$(call set_up,.[docs])
	@touch .venv/ready $@

# the 3-D pictures need software OpenGL: it is installed where that takes no password, else named
define set_up
@echo "setting up .venv: a minute or two the first time"
@$(PYTHON) -m venv .venv
@$(python) -m pip install --quiet --disable-pip-version-check --editable "$(1)"
@$(python) -c "$(draws)" 2>/dev/null || { \
	$(as_root) true 2>/dev/null && \
	echo "installing $(mesa) for the 3-D pictures" && \
	$(as_root) apt-get update -qq && \
	$(as_root) env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y $(mesa) >/dev/null ; } || \
	echo "no 3-D pictures until you run:  sudo apt-get install $(mesa)"
endef
