"""Systems of gz-sim that only exchange messages."""
