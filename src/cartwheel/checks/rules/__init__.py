"""Rules, each of which finds one kind of fault."""
