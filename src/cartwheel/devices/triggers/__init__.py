"""Messages that other messages trigger."""
