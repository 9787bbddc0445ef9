"""Named materials, and image files."""
