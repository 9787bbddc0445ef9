"""Checks files and workspaces as the command line does: settings, suppressions, a baseline."""

from cartwheel.checks.run import Result, check

__all__ = ["Result", "check"]
