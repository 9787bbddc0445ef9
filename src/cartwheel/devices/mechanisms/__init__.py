"""Mechanisms: elevators, winches, suspensions and wheels that slip."""
