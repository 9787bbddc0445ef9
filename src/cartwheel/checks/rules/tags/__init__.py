"""Rules about tags (CW3xx)."""
