"""Sensors of position, height and direction: GPS, magnetometer, barometer, ground truth."""
