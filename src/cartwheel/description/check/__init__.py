"""Finds errors and misleading values in a description and suggests replacement text."""

from cartwheel.description.check.checking import REPORTED, RULES, Report, check
from cartwheel.description.check.rule import Rule
from cartwheel.description.check.subject import PluginKnowledge

__all__ = ["REPORTED", "RULES", "PluginKnowledge", "Report", "Rule", "check"]
