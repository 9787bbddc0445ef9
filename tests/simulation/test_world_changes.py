"""A world changed in place is the one that compiling gives."""

import dataclasses

import mujoco
import numpy as np
import pytest

from cartwheel.description.model import Light
from cartwheel.errors import Origin
from cartwheel.geometry import Pose, quat_from_rpy

ORIGIN = Origin(file="test.sdf")
SUN = Light(name="sun", origin=ORIGIN)
LAMP = Light(name="lamp", type="spot", pose=Pose((0, 0, 3)), origin=ORIGIN)
CHANGED = dataclasses.replace(
    LAMP,
    pose=Pose((1, 2, 3), quat_from_rpy(0.1, 0.2, 0.3)),
    direction=(0.3, 0.0, -2.0),
    diffuse=(0.1, 0.2, 0.3, 1.0),
    attenuation=(0.5, 0.25, 0.125),
)


@pytest.fixture
def simulation(make):
    box = make.box("box", (0.5,) * 3, pose=Pose((0, 0, 0.25)))
    return make.world(box, lights=(SUN, LAMP)).session.simulation


def arrays(model):
    """Everything that a model consists of, by name."""
    found = {"gravity": model.opt.gravity.copy()}
    for name in dir(model):
        value = getattr(model, name) if not name.startswith("_") else None
        if isinstance(value, np.ndarray):
            found[name] = value.copy()
    return found


def test_in_place_as_compiled(simulation):
    world = dataclasses.replace(simulation.world, lights=(SUN, CHANGED), gravity=(1.0, 2.0, 3.0))
    model, version = simulation.model, simulation.scene.version
    simulation.change_world(world)
    assert simulation.model is model
    assert simulation.scene.version == version + 1
    assert simulation.scene.world is world
    changed = arrays(model)
    simulation._population.compile()
    assert simulation.model is not model
    compiled = arrays(simulation.model)
    assert changed.keys() == compiled.keys()
    assert len(changed) > 100
    # These are read for lights that follow a body alone.
    tracking = {"light_pos0", "light_poscom0", "light_dir0"}
    for name in compiled.keys() - tracking:
        value = compiled[name]
        assert np.array_equal(changed[name], value), name


@pytest.mark.parametrize(
    "change",
    [
        {"lights": (SUN,)},
        {"lights": (SUN, dataclasses.replace(LAMP, type="point"))},
        {"lights": (SUN, dataclasses.replace(LAMP, spot_angle=0.5))},
        {"ambient": (0.1, 0.1, 0.1, 1.0)},
    ],
)
def test_what_is_built_in_is_compiled_anew(simulation, change):
    model = simulation.model
    simulation.change_world(dataclasses.replace(simulation.world, **change))
    assert simulation.model is not model


def test_gravity_wakes_what_sleeps_and_it_may_sleep_again(simulation):
    simulation.advance(5_000_000_000)
    assert (simulation.data.tree_asleep >= 0).all()
    simulation.change_world(dataclasses.replace(simulation.world, gravity=(0.0, 0.0, -5.0)))
    assert (simulation.data.tree_asleep < 0).all()
    simulation.advance(10_000_000_000)
    assert (simulation.data.tree_asleep >= 0).all()
    assert isinstance(simulation.model, mujoco.MjModel)
