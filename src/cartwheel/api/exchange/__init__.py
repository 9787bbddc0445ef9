"""Services of a program, and the messages of a model."""
