"""Forces on the links of a world in gz-sim."""
