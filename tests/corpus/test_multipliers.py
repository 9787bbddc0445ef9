"""Multipliers of sizes that a controller of ROS 1 measures in the description itself."""

import pytest
from tests.corpus.carts import RADIUS, TRACK, cart, written
from tests.corpus.test_other_ros import CONTROL

from cartwheel.codes.robot import WHEEL_DIAMETER_MISMATCH, WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot

DRIVE = """base:
  type: diff_drive_controller/DiffDriveController
  left_wheel: left_joint
  right_wheel: right_joint
"""


@pytest.mark.parametrize(
    ("factors", "faults"),
    [
        ({"wheel_radius": 1.0, "wheel_separation": 1.0}, []),
        (
            {"wheel_radius": 1.5},
            [("drive", WHEEL_DIAMETER_MISMATCH), ("turn", WHEEL_DIAMETER_MISMATCH)],
        ),
        (
            {"left_wheel_radius": 0.8, "right_wheel_radius": 0.8},
            [("drive", WHEEL_DIAMETER_MISMATCH), ("turn", WHEEL_DIAMETER_MISMATCH)],
        ),
        ({"wheel_separation": 1.5}, [("turn", WHEEL_SEPARATION_MISMATCH)]),
        (
            {"wheel_radius": 0.8, "wheel_separation": 1.5},
            [("drive", WHEEL_DIAMETER_MISMATCH), ("turn", WHEEL_SEPARATION_MISMATCH)],
        ),
    ],
)
def test_a_multiplier_of_a_size_that_is_not_stated_is_the_reason(tmp_path, factors, faults):
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    (tmp_path / "config").mkdir()
    lines = "".join(f"  {name}_multiplier: {factor}\n" for name, factor in factors.items())
    (tmp_path / "config/base.yaml").write_text(DRIVE + lines)
    verdict = try_robot(written(tmp_path, cart(), CONTROL), standing=0.5)
    assert [(each.test, each.code) for each in verdict.faults] == faults
    assert verdict.outcome == ("file" if faults else "good")
    for each in verdict.faults:
        size = RADIUS if each.code is WHEEL_DIAMETER_MISMATCH else TRACK
        assert each.reason.values["measured"] == pytest.approx(size)
        assert each.reason.origin.file.endswith("base.yaml")
