"""CW001 to CW099: the command line."""

from cartwheel.errors import Code

UNKNOWN_CODE = Code("CW001", "unknown-code", "error", "a diagnostic code that does not exist")
SETTINGS_INVALID = Code(
    "CW050", "settings-invalid", "error", "a settings file with an unknown or wrong entry"
)
BASELINE_INVALID = Code("CW051", "baseline-invalid", "error", "a baseline file that cannot be read")
SUPPRESSION_UNUSED = Code(
    "CW052", "suppression-unused", "info", "a comment that suppresses nothing"
)
