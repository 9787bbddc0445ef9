"""Codes that a strict world does not treat as errors."""

import pytest

import cartwheel as cw
from cartwheel.errors import CartwheelError, UnknownNameError

LIGHT = """<robot name="bot"><link name="base"><inertial><mass value="1"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  <collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <gazebo><plugin name="odd" filename="libno_such_plugin.so"/></gazebo></robot>"""


def test_a_strict_world_ignores_codes():
    with pytest.raises(CartwheelError) as caught:
        cw.World(strict=True).spawn(LIGHT, z=0.5)
    code = caught.value.code
    for word in (code.number, code.name, [code.number[:3], "CW1"]):
        world = cw.World(strict=True, ignore=word)
        world.spawn(LIGHT, z=0.5)
        world.run(0.1)
        assert code not in [each.code for each in world.diagnostics]
        built = cw.build("empty", {"robot": LIGHT, "z": 0.5}, strict=True, ignore=word)
        assert code not in [each.code for each in built.diagnostics]
    with pytest.raises(CartwheelError) as again:
        cw.World(strict=True, ignore="CW1").spawn(LIGHT, z=0.5)
    assert again.value.code is code
    lax = cw.World()
    lax.spawn(LIGHT, z=0.5)
    assert code in [each.code for each in lax.diagnostics]


@pytest.mark.parametrize("word", ["CW2044", "wheel-seperation"])
def test_an_unknown_code_is_refused(word):
    with pytest.raises(UnknownNameError):
        cw.World(ignore=word)
