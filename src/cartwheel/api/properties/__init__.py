"""The properties of links and lights: masses, surfaces and colours."""
