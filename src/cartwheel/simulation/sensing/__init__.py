"""What sensors measure in a compiled model: images, ray distances, contacts."""
