"""Speed against the bare physics loop: ``python -m benchmarks``."""
