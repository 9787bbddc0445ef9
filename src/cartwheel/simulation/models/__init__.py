"""The models in a simulation: spawning, deleting, placement, forces."""
