"""The reliability campaign: mutated inputs against everything that reads what strangers wrote."""
