"""Contact sensors of gz-sim, and what reads them."""
