"""CW001 to CW099: the command line."""

from cartwheel.errors import Code

UNKNOWN_CODE = Code("CW001", "unknown-code", "error", "a diagnostic code that does not exist")
