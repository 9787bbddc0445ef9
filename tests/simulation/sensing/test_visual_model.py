"""Visuals are compiled when they are first used, and show the simulated bodies."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from tests.devices.cameras.sensors import pixels_of, sensor, take

from cartwheel.description.model import Light
from cartwheel.errors import Origin
from cartwheel.geometry import Pose
from cartwheel.simulation.models import compilations
from cartwheel.world import build

PLACE = Origin(file="test.sdf", line=1)
ARM = """<model name="arm"><pose>2 0 0.5 0 0 0.3</pose>
  <link name="base"><collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
    </collision><visual name="v"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></visual>
  </link>
  <link name="tip"><pose>0 0 0.2 0 0 0</pose>
    <inertial><pose>0.1 0 0 0 0 0</pose></inertial>
    <visual name="v"><pose>0.2 0.1 0 0.1 0 0</pose><geometry><cylinder><radius>0.05</radius>
    <length>0.4</length></cylinder></geometry></visual></link>
  <joint name="j" type="revolute"><parent>base</parent><child>tip</child>
    <axis><xyz>0 1 0</xyz></axis></joint></model>"""
PLATE = """<model name="plate"><static>1</static><pose>0 0 0.2 0 0 0</pose><link name="l">
  <visual name="v"><geometry><mesh><uri>file://{}/plate.obj</uri></mesh></geometry></visual>
  </link></model>"""

BOX = """<model name="box"><static>1</static><pose>3 0 1 0 0 0</pose><link name="l">
  <visual name="v"><geometry><box><size>1 1 1</size></box></geometry>
  <material><diffuse>0.9 0.1 0.1 1</diffuse></material></visual></link></model>"""


@pytest.fixture
def compiled(monkeypatch):
    """The number of compilations of visuals so far, in a list."""
    calls = [0]
    original = compilations.build_visuals

    def counted(*arguments, **options):
        calls[0] += 1
        return original(*arguments, **options)

    monkeypatch.setattr(compilations, "build_visuals", counted)
    return calls


def test_nothing_is_compiled_that_nobody_sees(make, compiled):
    world = make.world(make.sdf(ARM), make.sdf(sensor()))
    world.run(0.1)
    assert compiled == [0]
    assert set(world.session.simulation.model.geom_group) == {4}
    take(world, "/cam/image_raw")
    assert compiled == [1]
    take(world, "/cam/image_raw")
    assert compiled == [1]
    world.spawn(make.sdf(ARM.replace('"arm"', '"second"')))
    take(world, "/cam/image_raw")
    assert compiled == [2]


def test_visuals_are_where_a_model_with_all_shapes_has_them(make):
    """To the last bit, wherever the joints are."""
    world = make.world(make.sdf(ARM))
    simulation = world.session.simulation
    whole = build(simulation.world, simulation.engine.entries).model
    data = mujoco.MjData(whole)
    seen = np.flatnonzero(whole.geom_group == 1)
    for seconds in (0.0, 0.1, 0.4):
        world.run(seconds)
        data.qpos[:] = simulation.data.qpos
        mujoco.mj_kinematics(whole, data)
        model, shown = simulation.engine.visuals.current()
        assert np.array_equal(shown.geom_xpos, data.geom_xpos[seen])
        assert np.array_equal(shown.geom_xmat, data.geom_xmat[seen])
        assert np.array_equal(model.geom_rgba, whole.geom_rgba[seen])
    assert simulation.data.qpos[-1] != 0


def test_shapes_that_only_show_change_no_bit_of_the_motion(make):
    """The state with and without visuals in the simulated model."""
    world = make.world(make.sdf(ARM))
    simulation = world.session.simulation
    whole = build(simulation.world, simulation.engine.entries).model
    whole.opt.disableflags = simulation.model.opt.disableflags
    data = mujoco.MjData(whole)
    mujoco.mj_forward(whole, data)
    steps = round(0.5 / whole.opt.timestep)
    mujoco.mj_step(whole, data, steps)
    world.run(0.5)
    assert simulation.current_step == steps
    assert np.array_equal(data.qpos, simulation.data.qpos)
    assert np.array_equal(data.qvel, simulation.data.qvel)


def test_a_camera_shows_a_fixed_model_where_it_was_moved(make):
    world = make.world(make.sdf(BOX), make.sdf(sensor(width=32, height=24)))
    before = pixels_of(take(world, "/cam/image_raw"))
    with world._used(change=True) as simulation:
        simulation.set_pose("box", Pose((3.0, 0.4, 1.0)))
    after = pixels_of(take(world, "/cam/image_raw"))
    assert not np.array_equal(before, after)


def test_a_change_of_the_sun_is_seen(make):
    """Lights change in the compiled model, and with them the next image."""
    eye = make.sdf(sensor(width=32, height=24))
    sun = Light(name="sun", type="directional", direction=(0.5, 0.1, -1.0), origin=PLACE)
    world = make.world(make.sdf(BOX), eye, lights=(sun,))
    before = pixels_of(take(world, "/cam/image_raw"))
    with world._used() as simulation:
        dark = replace(sun, diffuse=(0.1, 0.1, 0.1, 1.0))
        simulation.change_world(replace(simulation.world, lights=(dark,)))
    after = pixels_of(take(world, "/cam/image_raw"))
    assert after.mean() < before.mean()


def test_a_visual_too_small_for_the_engine_is_reported_and_left_out(make, tmp_path):
    (tmp_path / "plate.obj").write_text("v 0 0 0\nv 1e-9 0 0\nv 0 1e-9 0\nf 1 2 3\n")
    world = make.world(make.sdf(PLATE.format(tmp_path)), make.sdf(sensor()), ground=None)
    (found,) = [each for each in world.diagnostics if each.severity == "warning"]
    assert found.code.name == "value-ignored"
    assert found.values["visual"] == "v"
    pixels_of(take(world, "/cam/image_raw"))
    assert world.session.simulation.engine.visuals.current()[0].ngeom == 0
