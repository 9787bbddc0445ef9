"""Rules for worlds."""
