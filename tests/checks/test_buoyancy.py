"""Vehicles in water that are too heavy."""

import pytest

from cartwheel.checks.checking import check
from cartwheel.codes.robot import SINKS_IN_WATER
from cartwheel.corpus import try_robot

HULL = """<link name="hull"><inertial><mass>{mass}</mass>
  <inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
  <collision name="c"><geometry><box><size>0.25 0.2 0.1</size></box></geometry></collision>
  </link>"""
PROPELLER = """<link name="{side}"><pose>-0.2 {y} 0 0 0 0</pose>{inertial}</link>
  <joint name="{side}_joint" type="revolute"><parent>hull</parent><child>{side}</child>
  <axis><xyz>1 0 0</xyz></axis></joint>
  <plugin name="{side}" filename="gz-sim-thruster-system"><joint_name>{side}_joint</joint_name>
  <thrust_coefficient>0.004</thrust_coefficient><propeller_diameter>0.1</propeller_diameter>{more}
  </plugin>"""
LIGHT = "<inertial><mass>0.05</mass></inertial>"


def vehicle(folder, mass, *, inertial=LIGHT, more="", plugin=""):
    """A hull that displaces 5 kg of water, with two thrusters."""
    sides = "".join(
        PROPELLER.format(side=side, y=y, inertial=inertial, more=more)
        for side, y in (("left", 0.1), ("right", -0.1))
    )
    file = folder / "model.sdf"
    text = f'<model name="rov">{HULL.format(mass=mass)}{sides}{plugin}</model>'
    file.write_text(f'<sdf version="1.9">{text}</sdf>')
    return file


@pytest.mark.parametrize(
    ("mass", "options", "expected"),
    [
        (4.8, {}, None),
        # It sinks slowly.
        (5.3, {}, None),
        (7.9, {}, ()),
        (4.8, {"inertial": ""}, ("left", "right")),
        # A propeller in air, and a plugin that may lift the vehicle.
        (7.9, {"more": "<fluid_density>1.2</fluid_density>"}, None),
        (7.9, {"plugin": '<plugin name="own" filename="libBallast.so"/>'}, None),
        (7.9, {"plugin": "<static>1</static>"}, None),
    ],
)
def test_the_weight_of_a_vehicle_in_water(tmp_path, mass, options, expected):
    file = vehicle(tmp_path, mass, **options)
    found = [each for each in check(file).findings if each.code is SINKS_IN_WATER]
    assert [each.values["links"] for each in found] == ([] if expected is None else [expected])


@pytest.mark.parametrize(
    ("mass", "state", "reasons"),
    [(4.8, "floats", []), (5.3, "floats", []), (7.9, "sinks", [SINKS_IN_WATER])],
)
def test_a_vehicle_that_sinks_is_a_fault_of_its_file(tmp_path, mass, state, reasons):
    verdict = try_robot(vehicle(tmp_path, mass), standing=3.0)
    assert verdict.stand is not None and verdict.stand.state == state
    assert [each.reason.code for each in verdict.faults if each.reason] == reasons
