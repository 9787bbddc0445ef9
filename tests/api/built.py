"""What processes of `test_built` run; they import this file."""

import pickle

import numpy as np
from tests.saving.built import run


def drive(built, seed=0, seconds=0.5):
    """A digest of the state and of all messages after a drive."""
    with built.world(seed=seed) as world:
        found = run(world, seconds)
        return found, float(np.abs(world.session.simulation.data.qpos).sum())


def drive_pickled(data):
    return drive(pickle.loads(data))
