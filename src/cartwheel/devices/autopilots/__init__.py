"""Interfaces of flight controllers that run as separate programs (software in the loop, SITL)."""
