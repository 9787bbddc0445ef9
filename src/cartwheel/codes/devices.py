"""CW401 to CW499: sensors, plugins and controllers, as described."""
