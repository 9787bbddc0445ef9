"""CW201 to CW299: links, joints, masses and wheels."""

from cartwheel.errors import Code

WHEEL_SEPARATION_MISMATCH = Code(
    "CW204",
    "wheel-separation-mismatch",
    "warning",
    "a drive's wheel separation differs from the distance between its wheels",
)
