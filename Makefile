# Everything a contributor does. `make run` and `make test` set up what is missing.
VENV ?= .venv
BIN = $(VENV)/bin
ARGS ?=
FOLDER ?= robots
MINUTES ?= 5
WORKERS ?= 2
export VENV

.PHONY: run test campaign lint format bench corpus docs ros1 dist clean

run: ## the cart in the browser, with a post before its camera
	@tools/setup.sh run
	@$(BIN)/cartwheel run $(ARGS)

test: ## all tests, in WORKERS processes
	@tools/setup.sh test
	@$(BIN)/pytest -q -n $(WORKERS) --dist loadfile $(ARGS)

campaign: ## mutated inputs against all that reads files and sockets, for MINUTES
	@tools/setup.sh test
	@$(BIN)/python -m tests.campaign --minutes $(MINUTES) $(ARGS)

lint: ## style, format and types
	@tools/setup.sh lint
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: ## rewrite the sources in the house's format
	@tools/setup.sh lint
	$(BIN)/ruff check --fix-only -q .
	$(BIN)/ruff format -q .

bench: ## speed against the bare physics loop, as a table and benchmarks/results/*.json
	@tools/setup.sh test
	@$(BIN)/python -m benchmarks $(ARGS)

corpus: ## a table of all robots below FOLDER: do they load, stand, publish, drive and reach?
	@tools/setup.sh run
	@$(BIN)/cartwheel corpus $(FOLDER) $(ARGS)

docs: ## the plugin reference in docs/, and the documentation's site in site/
	@tools/setup.sh docs
	@$(BIN)/python tools/make_plugin_reference.py
	@$(BIN)/python tools/make_site.py $(ARGS)

ros1: ## ROS 1's names for Cartwheel: gazebo_ros, gazebo_msgs, xacro, teleop_twist_keyboard
	@tools/setup.sh ros1
	@tools/build_ros1.sh

dist: ## wheel and sdist, each installed in an empty environment and tried; ARGS=vVERSION checks a tag
	@tools/setup.sh lint
	@tools/check_release.sh $(ARGS)

clean:
	rm -rf $(VENV) ros1/build ros1/devel build dist site .pytest_cache .mypy_cache .ruff_cache .hypothesis
