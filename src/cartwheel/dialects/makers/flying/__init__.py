"""Plugins of flying robots: ArduPilot, PX4, RotorS and other quadcopters."""
