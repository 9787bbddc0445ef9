"""Finds the files that a description names, and limits which of them may be read."""
