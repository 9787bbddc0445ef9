"""Finds what breaks or misleads in a description, with the text to write instead."""

from cartwheel.description.check.checking import REPORTED, RULES, Report, check
from cartwheel.description.check.rule import Rule
from cartwheel.description.check.subject import PluginKnowledge

__all__ = ["REPORTED", "RULES", "PluginKnowledge", "Report", "Rule", "check"]
