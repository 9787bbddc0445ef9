"""Wheels without motors that brake a base with their damping and friction."""

import pytest
from tests.checks.test_steering_and_casters import BODY, REAR, WHEEL, found

from cartwheel.codes.robot import WHEELS_BRAKED
from cartwheel.corpus.trial import try_robot

GRAVITY, RADIUS, MASS = 9.8, 0.1, 7.0
"""m/s², m, kg: half of the weight is on the rear wheels."""
DRIVE = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  {joints}<wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
  <wheelTorque>20</wheelTorque></plugin></gazebo>"""
PAIR = "<leftJoint>{0}left_joint</leftJoint><rightJoint>{0}right_joint</rightJoint>"


def car(dynamics, mu="", drive=None):
    front = "".join(
        WHEEL.format(name=f"front_{side}", parent="base", place=f"0.2 {y} 0")
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    front = front.replace('<axis xyz="0 1 0"/>', f'<axis xyz="0 1 0"/><dynamics {dynamics}/>')
    rough = "".join(f'<gazebo reference="{side}">{mu}</gazebo>' for side in ("left", "right"))
    drive = drive or DRIVE.format(joints=PAIR.format(""))
    return BODY.format(more="") + REAR + front + rough + drive


def slips_at(mu, damping, friction=0.0):
    """Where the force on two braked wheels is that on the two driven ones."""
    push = mu * MASS * GRAVITY / 2
    return (push - 2 * friction / RADIUS) * RADIUS**2 / (2 * damping)


@pytest.mark.parametrize(
    ("dynamics", "mu", "speed"),
    [
        ('damping="0.5"', "", slips_at(1.0, 0.5)),
        ('damping="0.5"', "<mu1>0.5</mu1><mu2>0.5</mu2>", slips_at(0.5, 0.5)),
        ('damping="0.5"', "<mu1>0.9</mu1><mu2>0.2</mu2>", slips_at(0.2, 0.5)),
        (
            'damping="0.5"',
            "<mu1>0.2</mu1><mu2>0.9</mu2><fdir1>0 0 1</fdir1>",
            slips_at(0.9, 0.5),
        ),
        (
            'damping="0.5"',
            "<mu1>0.9</mu1><mu2>0.2</mu2><fdir1>1 0 0</fdir1>",
            slips_at(0.9, 0.5),
        ),
        ('damping="0.5" friction="0.5"', "", slips_at(1.0, 0.5, 0.5)),
        ('damping="0" friction="2"', "", 0.0),
        ('damping="0" friction="1"', "", None),
        ('damping="0.1"', "", None),
    ],
)
def test_brakes_that_exceed_the_grip_at_a_low_speed_are_reported(tmp_path, dynamics, mu, speed):
    findings = found(tmp_path, car(dynamics, mu), WHEELS_BRAKED)
    assert [each.values["speed"] for each in findings] == (
        [] if speed is None else [pytest.approx(speed)]
    )


@pytest.mark.wording
def test_friction_that_exceeds_the_grip_brakes_at_any_speed(tmp_path):
    (finding,) = found(tmp_path, car('damping="0" friction="2"'), WHEELS_BRAKED)
    assert finding.message.endswith("slip at any speed")


@pytest.mark.wording
@pytest.mark.parametrize(("count", "shown"), [(1, 'joint "front_left_joint", '), (6, "and 2 more")])
def test_only_some_of_many_braked_joints_are_listed(tmp_path, count, shown):
    sides = [("left", 0.15), ("right", -0.15)] * 3
    wheels = "".join(
        WHEEL.format(
            name=f"front_{side}{n // 2 or ''}", parent="base", place=f"{0.2 + n / 9} {y} 0"
        )
        for n, (side, y) in enumerate(sides[:count])
    ).replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><dynamics damping="5"/>')
    drive = DRIVE.format(joints=PAIR.format(""))
    (finding,) = found(tmp_path, BODY.format(more="") + REAR + wheels + drive, WHEELS_BRAKED)
    assert shown in finding.message
    assert finding.message.count("front_") == min(count, 4)


def test_each_of_several_drives_has_its_own_traction(tmp_path):
    """Drives push together, so only wheels that brake more than all of them are reported."""
    middle = "".join(
        WHEEL.format(name=f"middle_{side}", parent="base", place=f"0 {y} 0")
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    rough = "<mu1>0.5</mu1><mu2>0.5</mu2>"
    drives = DRIVE.format(joints=PAIR.format("")) + DRIVE.format(joints=PAIR.format("middle_"))
    for damping, several in ((0.3, False), (1.0, True)):
        robot = car(f'damping="{damping}"', rough, drive=middle + drives)
        findings = found(tmp_path, robot, WHEELS_BRAKED)
        assert len(findings) == 2 * several
    rear, front = (each.values["traction"] for each in findings)
    # On three axles at equal distances, each carries a third of the weight.
    third = (MASS + 1) / 3 * GRAVITY
    assert (rear, front) == pytest.approx((0.5 * third, third), rel=1e-5)
    speeds = [each.values["speed"] for each in findings]
    assert speeds == pytest.approx([each * RADIUS**2 / 2 for each in (rear, front)])


def test_wheels_with_motors_brake_nothing(tmp_path):
    four = DRIVE.format(joints=PAIR.format("") + PAIR.format("front_")).replace(
        "<wheelTorque>", "<num_wheel_pairs>2</num_wheel_pairs><wheelTorque>"
    )
    assert found(tmp_path, car('damping="0.5"', drive=four), WHEELS_BRAKED) == []


def test_a_base_drives_as_fast_as_the_finding_states(tmp_path):
    mu = "<mu1>0.3</mu1><mu2>0.3</mu2>"
    (finding,) = found(tmp_path, car('damping="0.5"', mu), WHEELS_BRAKED)
    verdict = try_robot(tmp_path / "robot.urdf", standing=2.0)
    (drive,) = verdict.drives
    assert drive.measured == pytest.approx(finding.values["speed"], rel=0.02)
    fault = next(each for each in verdict.faults if each.test == "drive")
    assert (fault.code, fault.source) == (WHEELS_BRAKED, "file")
