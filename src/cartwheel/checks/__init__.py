"""Checks files and workspaces like the command line: with settings, suppressions and a baseline."""

from cartwheel.checks.project.run import Result, check

__all__ = ["Result", "check"]
