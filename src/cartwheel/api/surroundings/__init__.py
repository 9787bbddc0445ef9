"""What surrounds the models of a world: contacts, distances, lights and gravity."""
