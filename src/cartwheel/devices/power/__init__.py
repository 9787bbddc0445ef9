"""Sources of electrical power."""
