"""Whatever a request holds, it is answered, and what is refused changes nothing."""

import math
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cartwheel.description.model import Light
from cartwheel.errors import Origin
from cartwheel.geometry import Pose
from cartwheel.messages import from_dict
from cartwheel.messages.fields import fields

from .conftest import CHAIN, SDF, SERVICES, URDF, Gazebo

NAMES = st.one_of(
    st.sampled_from(
        [
            "",
            "world",
            "map",
            "chain",
            "chain::arm",
            "arm",
            "elbow",
            "chain::elbow",
            "glue",
            "box",
            "box::link",
            "link",
            "sun",
            "ground_plane",
            "ground_plane::link",
            "::",
            "chain::",
            "::arm",
        ]
    ),
    st.text(max_size=12),
)
XML = st.one_of(
    st.sampled_from([URDF, SDF, "", "<robot/>", "<sdf/>", "<robot name='x'><link/></robot>"]),
    st.text(max_size=40),
    st.tuples(st.integers(0, len(URDF)), st.text(max_size=3)).map(
        lambda cut: URDF[: cut[0]] + cut[1] + URDF[cut[0] :]
    ),
)
FLOATS = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 1e-300, 1e300, -1e16, math.nan, math.inf, -math.inf, 0.001]),
    st.floats(),
)


def values(field):
    if field.kind == "message":
        one = message(field.type)
    elif field.kind == "string":
        one = XML if field.name == "model_xml" else NAMES
    elif field.kind == "bool":
        one = st.booleans()
    elif field.kind == "float":
        one = FLOATS.map(float) if field.type == "float64" else st.floats(width=32)
    else:
        limits = np.iinfo(field.type)
        one = st.integers(int(limits.min), int(limits.max))
    return st.lists(one, max_size=3) if field.array else one


def message(type_name):
    return st.fixed_dictionaries({field.name: values(field) for field in fields(type_name)})


@pytest.fixture(scope="module")
def api(make_once):
    made = Gazebo(
        make_once.world(
            make_once.sdf(CHAIN),
            make_once.box("box", (0.5,) * 3, pose=Pose((0, 0, 0.25))),
            lights=(Light(name="sun", origin=Origin(file="test.sdf")),),
        )
    )
    simulation = made.simulation
    lit, models = simulation.world, simulation.models

    def restore():
        if simulation.world != lit:
            simulation.change_world(lit)
        for model in simulation.models:
            if model not in models:
                simulation.delete(model)
        for description in lit.models:
            if description.name not in simulation.models:
                simulation.spawn(description)

    made.restore = restore
    return made


LINK = {"mass": 2.0, "ixx": 0.1, "iyy": 0.1, "izz": 0.1, "gravity_mode": True}
VALID = {
    "apply_body_wrench": {"body_name": "box::link", "wrench": {"force": {"x": 1.0}}},
    "apply_joint_effort": {"joint_name": "elbow", "effort": 1.0},
    "clear_body_wrenches": {"body_name": "box::link"},
    "clear_joint_forces": {"joint_name": "elbow"},
    "delete_light": {"light_name": "sun"},
    "delete_model": {"model_name": "none"},
    "get_joint_properties": {"joint_name": "elbow"},
    "get_light_properties": {"light_name": "sun"},
    "get_link_properties": {"link_name": "arm"},
    "get_link_state": {"link_name": "arm", "reference_frame": "box"},
    "get_model_properties": {"model_name": "chain"},
    "get_model_state": {"model_name": "chain", "relative_entity_name": "box::link"},
    "get_physics_properties": {},
    "get_world_properties": {},
    "set_joint_properties": {"joint_name": "elbow", "ode_joint_config": {"damping": [0.1]}},
    "set_light_properties": {"light_name": "sun", "direction": {"z": -1.0}},
    "set_link_properties": {"link_name": "box::link", **LINK},
    "set_link_state": {"link_state": {"link_name": "tip", "pose": {"position": {"z": 5.0}}}},
    "set_model_configuration": {
        "model_name": "chain",
        "joint_names": ["elbow"],
        "joint_positions": [0.5],
    },
    "set_model_state": {"model_state": {"model_name": "chain", "reference_frame": "box"}},
    "set_physics_properties": {"time_step": 0.004, "gravity": {"z": -9.8}},
    "spawn_sdf_model": {"model_name": "one", "model_xml": SDF, "reference_frame": "box"},
    "spawn_urdf_model": {"model_name": "two", "model_xml": URDF},
}

WITHOUT_SUCCESS = ("delete_model", "clear_body_wrenches", "clear_joint_forces")


def nearly(type_name, valid):
    """A request that can be met, with a few fields of anything."""

    def one(field):
        if field.name in valid and isinstance(valid[field.name], dict):
            return nearly(field.type, valid[field.name])
        if field.kind == "message" and not field.array:
            return nearly(field.type, {})
        kept = st.just(valid[field.name]) if field.name in valid else st.just(None)
        return st.one_of(*[kept] * 9, values(field))

    parts = st.fixed_dictionaries({field.name: one(field) for field in fields(type_name)})
    return parts.map(lambda found: {k: v for k, v in found.items() if v is not None})


def test_what_is_nearly_broken_here_works_unbroken(api):
    for name, request in VALID.items():
        if name not in (*WITHOUT_SUCCESS, "delete_light"):
            api.done(name, **request)
    api.restore()


@pytest.mark.parametrize("name", SERVICES)
@pytest.mark.parametrize("broken", ["anything", "nearly"])
def test_anything_is_answered(api, name, broken):
    kind = f"gazebo_msgs/srv/{SERVICES[name]}_Request"
    requests = message(kind) if broken == "anything" else nearly(kind, VALID[name])
    api.met = 0

    @settings(max_examples=40, suppress_health_check=list(HealthCheck))
    @given(requests)
    def ask(fields):
        simulation = api.simulation
        answer = api(name, from_dict(kind, fields))
        if hasattr(answer, "success"):
            api.met += answer.success
            assert isinstance(answer.success, bool)
            assert answer.success or answer.status_message
            # Names of requests are quoted, also one that is "Error: ".
            assert not re.search(r"[A-Z]\w+Error: ", answer.status_message), "Python's own error"
        assert np.isfinite(simulation.data.qpos).all()
        assert np.isfinite(simulation.data.qvel).all()
        assert np.isfinite(simulation.model.body_mass).all()
        assert 0 < simulation.step_ns <= 100_000_000
        assert simulation.speed is None or simulation.speed > 0
        api.restore()

    ask()
    if broken == "nearly" and name not in WITHOUT_SUCCESS:
        assert api.met, "none was met: it tests one check alone"
