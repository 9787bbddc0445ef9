"""Sensors of contacts, forces and torques, and forces that are applied to links."""
