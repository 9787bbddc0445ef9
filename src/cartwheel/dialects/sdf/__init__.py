"""Elements of SDF that all dialects share: sensor noise and scans."""
