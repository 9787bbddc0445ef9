"""SDF's ``<link>`` and its contents."""
