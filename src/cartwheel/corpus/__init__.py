"""Tests robots from other authors one by one: the results of `cartwheel corpus`."""

from cartwheel.corpus.finding import robots_in
from cartwheel.corpus.trial import try_robot
from cartwheel.corpus.verdict import Drive, Reach, Stand, Verdict

__all__ = ["Drive", "Reach", "Stand", "Verdict", "robots_in", "try_robot"]
