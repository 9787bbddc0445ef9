"""Tests robots from other authors one by one: the results of `cartwheel corpus`."""

from cartwheel.corpus.faults import Fault
from cartwheel.corpus.finding import Kind, Survey, robots_in, survey
from cartwheel.corpus.trial import try_robot
from cartwheel.corpus.verdict import Verdict

__all__ = [
    "Fault",
    "Kind",
    "Survey",
    "Verdict",
    "robots_in",
    "survey",
    "try_robot",
]
