"""The graph on the wires of others."""
