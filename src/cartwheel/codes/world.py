"""CW601 to CW699: world and physics."""
