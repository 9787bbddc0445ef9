"""Grips: links that are attached to other links at run time."""
