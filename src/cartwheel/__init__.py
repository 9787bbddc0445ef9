"""Cartwheel simulates the robot you described."""
