"""Scenarios: tests of robots in files, for `cartwheel test`."""

from cartwheel.scenarios.cases import Case, Scenario, cases_of, digests, load_scenario
from cartwheel.scenarios.finding import find_scenarios
from cartwheel.scenarios.junit import as_junit
from cartwheel.scenarios.outcome import Outcome
from cartwheel.scenarios.page import as_page
from cartwheel.scenarios.results import Results
from cartwheel.scenarios.runner import Options, Runner
from cartwheel.scenarios.schema import schema_text
from cartwheel.scenarios.workers import Workers

__all__ = [
    "Case",
    "Options",
    "Outcome",
    "Results",
    "Runner",
    "Scenario",
    "Workers",
    "as_junit",
    "as_page",
    "cases_of",
    "digests",
    "find_scenarios",
    "load_scenario",
    "schema_text",
]
