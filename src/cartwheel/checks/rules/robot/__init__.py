"""Rules about links, joints, masses and wheels (CW2xx)."""
