"""What the URDF parser of ROS and Gazebo refuses, and Cartwheel loads nevertheless."""

import pytest

from cartwheel.checks import check
from cartwheel.codes import robot, tags
from cartwheel.description import load_text

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)
LIMIT = '<limit lower="-1" upper="1" effort="10" velocity="1"/>'
COLOUR = '<color rgba="1 0 0 1"/>'


def urdf(*parts, kind="revolute", parent="base", version="", limit=LIMIT):
    joint = (
        f'<joint name="j" type="{kind}"><parent link="{parent}"/><child link="arm"/>'
        f'<axis xyz="0 0 1"/>{limit}{"".join(parts)}</joint>'
    )
    links = f'<link name="base">{BODY}</link>\n<link name="arm">{BODY}</link>'
    return f'<robot name="r"{version}>\n{links}\n{joint}\n</robot>'


def limits(**stated):
    values = {"lower": "-1", "upper": "1", "effort": "10", "velocity": "1", **stated}
    text = " ".join(f'{key}="{value}"' for key, value in values.items() if value is not None)
    return f"<limit {text}/>"


def refusals(text):
    return [each for each in load_text(text).diagnostics if each.values.get("refused") is True]


REFUSED = {
    "infinite effort": (urdf(limit=limits(effort="inf")), 'effort="1e9"'),
    "infinite limit": (urdf(limit=limits(lower="-inf")), 'lower="-1e9"'),
    "overflow": (urdf(limit=limits(velocity="1e999")), 'velocity="1e9"'),
    "space after a limit": (urdf(limit=limits(lower="-1 ")), 'lower="-1"'),
    "space after the damping": (urdf('<dynamics damping="0.5 "/>'), 'damping="0.5"'),
    "damping of a fixed joint": (urdf('<dynamics damping="x"/>', kind="fixed"), 'damping="0"'),
    "empty dynamics": (urdf("<dynamics/>"), 'damping="0"'),
    "dynamics of others": (urdf('<dynamics spring="1"/>', kind="fixed"), 'damping="0"'),
    "safety": (urdf('<safety_controller k_position="1"/>'), 'k_velocity="0"'),
    "calibration": (urdf('<calibration rising="up"/>'), 'rising="0"'),
    "type": (urdf(kind="revolute "), 'type="revolute"'),
    "parent": (urdf(parent=" base"), 'link="base"'),
    "version": (urdf(version=' version="1"'), 'version="1.0"'),
    "nameless materials": (
        urdf().replace("</robot>", f"<material>{COLOUR}</material>" * 2 + "</robot>"),
        "",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_the_robot_loads_and_an_error_says_that_ros_and_gazebo_refuse_it(case, tmp_path):
    text, instead = REFUSED[case]
    (found,) = refusals(text)
    assert found.code in (tags.VALUE_INVALID, tags.TAG_MISSING)
    assert found.severity == "error"
    assert found.instead == instead
    path = tmp_path / "r.urdf"
    path.write_text(text)
    report = check(path)
    assert [each.instead for each in report.findings if each.severity == "error"] == [instead]


@pytest.mark.parametrize("kind", ["revolute", "continuous", "fixed"])
@pytest.mark.parametrize("lacks", ["effort", "velocity"])
def test_an_incomplete_limit_is_one_finding(kind, lacks, tmp_path):
    text = urdf(kind=kind, limit=limits(**{lacks: None}))
    (found,) = refusals(text)
    assert found.code is robot.LIMIT_INCOMPLETE
    path = tmp_path / "r.urdf"
    path.write_text(text)
    errors = [each for each in check(path).findings if each.severity == "error"]
    assert [(each.code, each.values["attribute"]) for each in errors] == [
        (robot.LIMIT_INCOMPLETE, lacks)
    ]


@pytest.mark.parametrize(
    "text",
    [
        urdf(),
        urdf(version=' version="1.0"'),
        urdf(version=' version="1.2"'),
        urdf(limit=limits(lower=" -1", upper="+1.", effort=".5", velocity="1e+2")),
        urdf(limit=limits(lower=None, upper=None)),
        urdf('<dynamics friction="0.1"/><calibration/>'),
        urdf('<safety_controller k_velocity="1"/>'),
        urdf(kind="continuous", limit=""),
        urdf().replace('"arm"', '"arm "'),
        urdf().replace("</robot>", f"<material>{COLOUR}</material></robot>"),
    ],
)
def test_what_they_accept_is_not_reported(text):
    assert not refusals(text)
