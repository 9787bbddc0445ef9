"""SDF's ``<world>`` and its contents."""
