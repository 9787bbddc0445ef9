"""Sensors of mobile bases: hazards, infrared light, optical mice and docks."""
