"""Aircraft without a stabilising controller take off, or the reason is reported."""

import math

import pytest

from cartwheel.codes.devices import HARDWARE_NOT_SIMULATED
from cartwheel.corpus import try_robot
from cartwheel.corpus.flying.hovering import drag_errors
from cartwheel.description import load_text

BODY = (
    '<link name="body"><inertial><mass value="{mass}"/>'
    '<inertia ixx="2e-3" iyy="2e-3" izz="3e-3" ixy="0" ixz="0" iyz="0"/></inertial><collision>'
    '<geometry><box size="0.3 0.3 0.09"/></geometry></collision></link>'
)
ROTOR = (
    '<link name="rotor_{i}"><inertial><mass value="0.005"/>'
    '<inertia ixx="1e-6" iyy="8e-6" izz="9e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="rotor_{i}_joint" type="continuous"><parent link="body"/>'
    '<child link="rotor_{i}"/><origin xyz="{x} {y} 0"/><axis xyz="0 0 1"/></joint>'
    '<gazebo><plugin name="motor_{i}" filename="librotors_gazebo_motor_model.so">'
    "<jointName>rotor_{i}_joint</jointName><linkName>rotor_{i}</linkName>"
    "<turningDirection>{way}</turningDirection><timeConstantUp>0.0125</timeConstantUp>"
    "<timeConstantDown>0.025</timeConstantDown><maxRotVelocity>838</maxRotVelocity>"
    "<motorConstant>8.5e-06</motorConstant><momentConstant>0.016</momentConstant>"
    "<commandSubTopic>command/motor_speed</commandSubTopic><motorNumber>{i}</motorNumber>"
    "<rotorDragCoefficient>8e-05</rotorDragCoefficient>"
    "<rollingMomentCoefficient>1e-06</rollingMomentCoefficient>"
    "<rotorVelocitySlowdownSim>10</rotorVelocitySlowdownSim></plugin></gazebo>"
)
PROPULSION = (
    '<gazebo><plugin name="propulsion" filename="libhector_gazebo_quadrotor_propulsion.so">'
    "{tags}</plugin></gazebo>"
)


def tried(tmp_path, *parts, controllers=()):
    path = tmp_path / "aircraft.urdf"
    path.write_text(f'<robot name="aircraft">{"".join(parts)}</robot>')
    return try_robot(path, standing=1.0, controllers=list(controllers))


def test_a_quadrotor_whose_thrust_is_not_centred_takes_off_before_it_tips_over(tmp_path):
    """Its front rotors lift more than its rear ones, so it would tip over at a slow increase."""
    places = [(0.09, -0.11, "ccw"), (-0.07, 0.11, "ccw"), (0.09, 0.11, "cw"), (-0.07, -0.11, "cw")]
    rotors = [
        ROTOR.format(i=i, x=x, y=y, way=way, name=f"rotor_{i}")
        for i, (x, y, way) in enumerate(places)
    ]
    verdict = tried(tmp_path, BODY.format(mass=0.5), *rotors)
    (flight,) = verdict.flights
    assert flight.motors == 4
    # Four rotors carry 5.1 N at sqrt(5.1 / 4 / 8.5e-6) = 387 rad/s.
    assert flight.command == pytest.approx(1.2 * 387, rel=0.25)
    assert flight.flies
    assert verdict.good, verdict.faults


def turned(rotor, roll, pitch):
    return rotor.replace('<origin xyz="', f'<origin rpy="{roll} {pitch} 0" xyz="', 1)


def test_propellers_that_push_down_do_not_turn(tmp_path):
    """All six at the same speed push in no direction."""
    rotors = [ROTOR.format(i=i, x=x, y=0.0, way="ccw") for i, x in enumerate((0.1, -0.1))]
    rotors += [
        turned(ROTOR.format(i=i, x=0.0, y=0.1, way="ccw"), roll, pitch)
        for i, (roll, pitch) in enumerate(
            ((3.14159, 0), (3.14159, 0), (1.5708, 0), (-1.5708, 0)), start=2
        )
    ]
    verdict = tried(tmp_path, BODY.format(mass=0.5), *rotors)
    (flight,) = verdict.flights
    assert flight.motors == 2
    assert verdict.good, verdict.faults


def test_an_aeroplane_moves_in_the_direction_of_its_thrust(tmp_path):
    rotor = turned(ROTOR.format(i=0, x=0.2, y=0.0, way="cw"), 0, 1.5708)
    smooth = '<gazebo reference="body"><mu1>0.1</mu1><mu2>0.1</mu2></gazebo>'
    verdict = tried(tmp_path, BODY.format(mass=1.0), rotor, smooth)
    (flight,) = verdict.flights
    assert flight.motors == 1
    # The way along x that 8.5e-6 N s²/rad² times the speed's square gives 1 kg against friction.
    force = 8.5e-6 * flight.command**2 - 0.1 * 9.8
    assert flight.rose == pytest.approx(force / 2, rel=0.15)
    assert verdict.good, verdict.faults


def test_a_quadrotor_takes_off_at_a_duty_cycle(tmp_path):
    verdict = tried(tmp_path, BODY.format(mass=1.5), PROPULSION.format(tags=""))
    (flight,) = verdict.flights
    assert flight.topic.endswith("motor_pwm")
    assert flight.motors == 4
    assert 0 < flight.command < 255
    assert verdict.good, verdict.faults


def test_unsupported_hardware_without_joints_is_why_nothing_moves(tmp_path):
    """The hardware would command the propellers, whose plugin has no topics."""
    control = (
        '<gazebo><plugin name="control" filename="libgazebo_ros_control.so">'
        "<robotSimType>own_hardware/QuadrotorHardware</robotSimType></plugin></gazebo>"
    )
    silent = PROPULSION.format(tags="<topicName/><pwmTopicName/>")
    verdict = tried(tmp_path, BODY.format(mass=1.5), silent, control)
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("controller", HARDWARE_NOT_SIMULATED)
    assert fault.source == "unknown"
    assert verdict.should_move
    assert not verdict.moves


@pytest.mark.parametrize("number", ["2147483647", "\u00b2"])
def test_an_index_that_no_message_can_have_takes_no_memory(tmp_path, number):
    rotor = ROTOR.format(i=0, x=0, y=0, way="ccw").replace(
        "<motorNumber>0</motorNumber>", f"<motorNumber>{number}</motorNumber>"
    )
    verdict = tried(tmp_path, BODY.format(mass=0.5), rotor)
    assert not any(flight.flies for flight in verdict.flights)


def multirotor(control, drag):
    """Four rotors of gz-sim at the corners of a square of 0.2 m, about a body of 0.98 kg."""
    rotors = "".join(
        ROTOR.format(i=i, x=x, y=y, way=way)
        for i, (x, y, way) in enumerate(
            ((0.1, -0.1, "ccw"), (-0.1, 0.1, "ccw"), (0.1, 0.1, "cw"), (-0.1, -0.1, "cw"))
        )
    )
    rotors = rotors.replace(
        "librotors_gazebo_motor_model.so", "gz-sim-multicopter-motor-model-system"
    )
    rotors = rotors.replace(">8e-05<", f">{drag}<")
    return f'<robot name="aircraft">{BODY.format(mass=0.98)}{rotors}{control}</robot>'


CONTROL = (
    '<gazebo><plugin name="c" filename="gz-sim-multicopter-control-system">'
    "<comLinkName>body</comLinkName><velocityGain>2 2 2</velocityGain>"
    "<attitudeGain>2 3 0.15</attitudeGain><angularRateGain>0.4 0.5 0.1</angularRateGain>"
    "</plugin></gazebo>"
)


@pytest.mark.parametrize("drag", [0.0, 1e-4, 1e-3])
def test_the_drag_of_propellers_slows_a_multicopter_by_its_gains(drag):
    along, turning = drag_errors(load_text(multirotor(CONTROL, drag), file="aircraft.urdf"))
    # 9.8 N are four times 8.5e-6 N s²/rad² times the square of the speed.
    braking = 4 * drag * math.sqrt(9.8 / 4 / 8.5e-6)
    assert along == pytest.approx(braking / (2 + braking), rel=1e-3)
    assert turning == pytest.approx(braking * 0.02 / (0.1 + braking * 0.02), rel=1e-3)


def test_an_aircraft_without_a_velocity_controller_has_no_such_error():
    assert drag_errors(load_text(multirotor("", 1e-3), file="aircraft.urdf")) == (0.0, 0.0)


def test_a_drone_takes_off_before_it_is_commanded_to_move(tmp_path):
    gains = {
        "rollpitch": (10, 5),
        "yaw": (2, 1),
        "velocityXY": (5, 2.3),
        "velocityZ": (5, 1),
        "positionXY": (1.1, 0),
        "positionZ": (1, 0.2),
    }
    tags = "".join(
        f"<{name}ProportionalGain>{p}</{name}ProportionalGain>"
        f"<{name}DifferentialGain>{d}</{name}DifferentialGain>"
        for name, (p, d) in gains.items()
    )
    drone = (
        '<gazebo><plugin name="drone" filename="libplugin_drone.so"><bodyName>body</bodyName>'
        f"<maxForce>30</maxForce>{tags}</plugin></gazebo>"
    )
    body = BODY.format(mass=1.5).replace("2e-3", "0.02").replace("3e-3", "0.04")
    verdict = tried(tmp_path, body, drone)
    (drive,) = verdict.drives
    assert drive.follows, drive
    assert drive.turns, drive
    assert verdict.moves
