"""What explains that a robot falls, or does not move as commanded."""
