"""Drives: from velocity commands to joint commands, and odometry."""
