"""Joints: trajectories and PID controllers."""
