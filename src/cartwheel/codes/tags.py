"""CW301 to CW399: tags, attributes and materials."""
