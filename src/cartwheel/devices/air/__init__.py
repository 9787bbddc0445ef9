"""Multicopters: propellers and their states."""
