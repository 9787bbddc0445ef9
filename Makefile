# The tasks of a contributor. Each target installs what it needs.
VENV ?= .venv
BIN = $(VENV)/bin
ARGS ?=
FOLDER ?= robots
MINUTES ?= 5
WORKERS ?= 2
export VENV
# The tests start many hundreds of processes, and each would compile all sources again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: run test campaign lint format bench corpus catalogue docs ros1 dist clean

run: ## simulate the cart in the browser, with a post in front of its camera
	@tools/setup.sh run
	@$(BIN)/cartwheel run $(ARGS)

test: ## run all tests in WORKERS processes
	@tools/setup.sh test
	@$(BIN)/pytest -q -n $(WORKERS) --dist loadfile --no-loadscope-reorder $(ARGS)

campaign: ## fuzz all readers of files and sockets for MINUTES
	@tools/setup.sh test
	@$(BIN)/python -m tests.campaign --minutes $(MINUTES) $(ARGS)

lint: ## check style, format and types
	@tools/setup.sh lint
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: ## format the sources
	@tools/setup.sh lint
	$(BIN)/ruff check --fix-only -q .
	$(BIN)/ruff format -q .

bench: ## measure the speed relative to MuJoCo alone, and what the check finds; writes benchmarks/results/*.json
	@tools/setup.sh test
	@$(BIN)/python -m benchmarks $(ARGS)

corpus: ## try all robots in FOLDER: load, stand, publish, drive, reach
	@tools/setup.sh run
	@$(BIN)/cartwheel corpus $(FOLDER) $(ARGS)

catalogue: ## generate the tables of plugins and controllers, and the modules of message types
	@tools/setup.sh lint
	@$(BIN)/python tools/make_catalogue.py
	@$(BIN)/python tools/make_message_modules.py

docs: ## generate the plugin reference, and build the site in site/
	@tools/setup.sh docs
	@$(BIN)/python tools/make_plugin_reference.py
	@$(BIN)/python tools/make_controller_tables.py
	@$(BIN)/python tools/make_site.py $(ARGS)

ros1: ## build the ROS 1 workspace: gazebo_ros, gazebo_msgs, xacro, teleop_twist_keyboard
	@tools/setup.sh ros1
	@tools/build_ros1.sh

dist: ## build the wheel and the sdist, and check each; ARGS=vVERSION also checks a tag
	@tools/setup.sh lint
	@tools/check_release.sh $(ARGS)

clean:
	rm -rf $(VENV) ros1/build ros1/devel build dist site .pytest_cache .mypy_cache .ruff_cache .hypothesis
