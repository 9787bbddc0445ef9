"""Reads launch files in Python by their syntax tree."""
