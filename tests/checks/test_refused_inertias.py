"""Impossible inertias, for which gz-sim does not load a robot and Gazebo Classic does."""

import pytest

from cartwheel.checks import check
from cartwheel.codes.robot import INERTIA_IMPOSSIBLE
from cartwheel.description import load

GZ, CLASSIC = "gz-sim-joint-state-publisher-system", "libgazebo_ros_joint_state_publisher.so"
LINK = (
    '<link name="{}"><inertial>{}<mass value="{}"/><inertia ixx="{}" iyy="{}" izz="{}" ixy="0" '
    'ixz="0" iyz="0"/></inertial></link>'
)
FLAT = ("0.1", "0.1", "0.25")
ALMOST = ("0.1", "0.1", "0.20001")
ROD = ("0", "0.1", "0.1")
POSSIBLE = ("0.1", "0.1", "0.1")
JOINT = '<joint name="j" type="{}"><parent link="base"/><child link="arm"/>{}</joint>'
FIXED = JOINT.format("fixed", "")
TURNING = JOINT.format("continuous", '<axis xyz="0 0 1"/>')
PRESERVED = '<gazebo reference="j"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'


def urdf(base, arm, joint, *plugins, mass=1, arm_place=""):
    tags = "".join(f'<gazebo><plugin name="p" filename="{each}"/></gazebo>' for each in plugins)
    links = LINK.format("base", "", mass, *base) + LINK.format("arm", arm_place, 1, *arm)
    return f'<robot name="r">{links}{joint}{tags}</robot>'


def sdf(arm, *plugins, version="1.7"):
    tags = "".join(f'<plugin name="p" filename="{each}"/>' for each in plugins)
    x, y, z = arm
    inertia = f"<ixx>{x}</ixx><iyy>{y}</iyy><izz>{z}</izz>"
    return (
        f'<sdf version="{version}"><model name="m"><link name="arm"><inertial><mass>1</mass>'
        f"<inertia>{inertia}</inertia></inertial></link>{tags}</model></sdf>"
    )


@pytest.fixture
def severity(tmp_path):
    """The severity of the finding, and whether the loaded description says that gz-sim refuses it;
    None for no finding.
    """

    def run(text):
        path = tmp_path / ("m.sdf" if text.startswith("<sdf") else "r.urdf")
        path.write_text(text)
        found = [each for each in check(path).findings if each.code is INERTIA_IMPOSSIBLE]
        read = [each for each in load(path).diagnostics if each.code is INERTIA_IMPOSSIBLE]
        assert len(found) == len(read) <= 1
        if not found:
            return None
        refused = read[0].values.get("refused", False)
        assert refused == (found[0].severity == "error")
        return found[0].severity

    return run


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (urdf(POSSIBLE, FLAT, TURNING, GZ), "error"),
        (urdf(POSSIBLE, FLAT, TURNING, CLASSIC), "warning"),
        (urdf(POSSIBLE, FLAT, TURNING, GZ, CLASSIC), "warning"),
        (urdf(POSSIBLE, FLAT, TURNING), "warning"),
        # gz-sim tolerates rounding errors only, and accepts moments of 0.
        (urdf(POSSIBLE, ALMOST, TURNING, GZ), "error"),
        (urdf(POSSIBLE, ALMOST, TURNING, CLASSIC), None),
        (urdf(POSSIBLE, ROD, TURNING, GZ), "warning"),
        # The sum of merged links counts.
        (urdf(POSSIBLE, FLAT, FIXED, GZ), "warning"),
        (urdf(("0.001", "0.001", "0.001"), FLAT, FIXED, GZ), "error"),
        (urdf(POSSIBLE, FLAT, FIXED + PRESERVED, GZ), "error"),
    ],
)
def test_in_a_urdf_what_gz_sim_refuses_is_an_error_of_a_robot_for_gz_sim(severity, text, expected):
    assert severity(text) == expected


def test_the_places_of_merged_links_count(severity):
    small, place = ("0.001", "0.001", "0.001"), '<origin xyz="{} 0 {}" rpy="0 {} 0"/>'
    # A distance along x increases the moments about y and z by the same amount, and one along z
    # those about x and y, which are too small.
    for x, z, pitch, expected in (
        (0, 0, 0, "error"),
        (1, 0, 0, "error"),
        (0, 1, 0, "warning"),
        (1, 0, 1.5708, "warning"),
    ):
        there = place.format(x, z, pitch)
        assert severity(urdf(small, FLAT, FIXED, GZ, arm_place=there)) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (sdf(FLAT, GZ), "error"),
        (sdf(FLAT, CLASSIC), "warning"),
        (sdf(FLAT), "warning"),
        (sdf(FLAT, version="1.9"), "error"),  # which Gazebo Classic does not read
        (sdf(FLAT, CLASSIC, version="1.9"), "warning"),
        (sdf(ALMOST, GZ), "error"),
        (sdf(ALMOST, CLASSIC), None),
        (sdf(ROD, GZ), "warning"),
    ],
)
def test_in_sdf_what_gz_sim_refuses_is_an_error_of_a_model_for_gz_sim(severity, text, expected):
    assert severity(text) == expected
