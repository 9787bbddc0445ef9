"""Rules about links, joints and masses (CW2xx)."""
