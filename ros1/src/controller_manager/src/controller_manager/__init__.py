"""Programs for the controller manager of a robot."""
