"""CW501 to CW599: sensors, plugins and controllers, as they run."""
