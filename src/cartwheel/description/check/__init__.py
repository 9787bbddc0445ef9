"""Finds what breaks or misleads in a description, with the text to write instead."""

from cartwheel.description.check.checking import RULES, Report, check
from cartwheel.description.check.finding import Finding
from cartwheel.description.check.rule import Rule
from cartwheel.description.check.subject import PluginKnowledge

__all__ = ["RULES", "Finding", "PluginKnowledge", "Report", "Rule", "check"]
