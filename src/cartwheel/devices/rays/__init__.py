"""Sensors that measure distances along rays: lidars and range finders."""
