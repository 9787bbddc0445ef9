"""Rules about sensors, plugins and controllers (CW4xx)."""
