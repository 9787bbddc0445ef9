"""CW701 to CW799: topics, services and messages."""
