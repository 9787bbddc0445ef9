"""Rules about files and xacro (CW1xx)."""
