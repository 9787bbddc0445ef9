"""The sensors of the TurtleBot 4's base: each by the geometry it is put into."""

import math

import pytest

from cartwheel.geometry import Pose, quat_from_rpy

BODY, HEIGHT = 0.17, 0.08
RATE = 62.0
OMNI, FRONT = 0, 1


def plugin(name, tags="", out="reported"):
    return f"""<plugin name="one" filename="libgazebo_ros_create_{name}.so">
      <ros><remapping>~/out:={out}</remapping></ros>{tags}</plugin>"""


def ray(name, tags="", *, most=0.15, frame=""):
    """One ray, straight ahead of a link that stands still."""
    return f"""<model name="post"><static>1</static>{frame}<link name="nose">
      <sensor name="eye" type="ray"><update_rate>{RATE}</update_rate>
      <ray><scan><horizontal><samples>1</samples></horizontal></scan>
      <range><min>0.001</min><max>{most}</max></range></ray>{plugin(name, tags)}</sensor>
      </link></model>"""


def slider(make, extra="", sensor="", mouse=""):
    """A can with a commanded velocity, on a floor without friction."""
    inertia = 3.0 * BODY**2 / 4
    return make.sdf(f"""<model name="robot"><link name="base">
      <inertial><pose>0 0 0.04 0 0 0</pose><mass>3</mass><inertia><ixx>{inertia}</ixx>
      <iyy>{inertia}</iyy><izz>{2 * inertia}</izz></inertia></inertial>
      <collision name="shell"><pose>0 0 {0.03 + HEIGHT / 2} 0 0 0</pose><geometry><cylinder>
      <radius>{BODY}</radius><length>{HEIGHT}</length></cylinder></geometry></collision>
      <collision name="foot"><pose>0 0 0.02 0 0 0</pose><geometry><cylinder>
      <radius>{BODY - 0.05}</radius><length>0.04</length></cylinder></geometry>
      <surface><friction><ode><mu>0</mu><mu2>0</mu2></ode></friction></surface></collision>
      {sensor}</link>{mouse}
      <plugin name="move" filename="libgazebo_ros_planar_move.so"/>{extra}</model>""")


@pytest.mark.parametrize(
    ("degrees", "zone"),
    [
        (-72, "bump_right"),
        (-36, "bump_front_right"),
        (0, "bump_front_center"),
        (36, "bump_front_left"),
        (72, "bump_left"),
    ],
)
def test_the_zone_of_the_bumper_that_meets_something_is_published(make, degrees, zone):
    angle = math.radians(degrees)
    x, y = 0.3 * math.cos(angle), 0.3 * math.sin(angle)
    post = make.sdf(f"""<model name="thing"><static>1</static><pose>{x} {y} 0.1 0 0 0</pose>
      <link name="link"><collision name="c"><geometry><cylinder><radius>0.02</radius>
      <length>0.2</length></cylinder></geometry></collision></link></model>""")
    bumper = f"""<sensor name="bumper" type="contact"><update_rate>{RATE}</update_rate>
      <contact><collision>shell</collision></contact>{plugin("bumper")}</sensor>"""
    world = make.world(post, slider(make, sensor=bumper), ground=0.0)
    box = world.mailbox("/reported")
    world.run(0.5)
    assert not box.drain()
    world.publish("/cmd_vel", linear_x=0.2 * math.cos(angle), linear_y=0.2 * math.sin(angle))
    world.run(1.5)
    reported = box.drain()
    assert {message.header.frame_id for message in reported} == {zone}
    assert {message.type for message in reported} == {reported[0].BUMP}


def test_what_is_behind_presses_no_zone(make):
    wall = make.box("wall", (0.1, 1, 0.5), static=True, pose=Pose((-0.3, 0, 0.25)))
    bumper = f"""<sensor name="bumper" type="contact"><contact><collision>shell</collision>
      </contact>{plugin("bumper")}</sensor>"""
    world = make.world(wall, slider(make, sensor=bumper), ground=0.0)
    box = world.mailbox("/reported")
    world.publish("/cmd_vel", linear_x=-0.2)
    world.run(1.5)
    assert not box.drain()


@pytest.mark.parametrize(("height", "cliff"), [(0.05, False), (0.1, True), (1.0, True)])
def test_a_floor_that_is_far_down_is_a_cliff(make, height, cliff):
    tags = "<detection_threshold>0.08</detection_threshold><frame_id>cliff_front</frame_id>"
    down = f"<pose>0 0 {height} 0 {math.pi / 2} 0</pose>"
    world = make.world(make.sdf(ray("cliff_sensor", tags, frame=down)), ground=1.0)
    box = world.mailbox("/reported", size=1000)
    world.run(1.0)
    reported = box.drain()
    assert bool(reported) == cliff
    assert all(
        (each.type, each.header.frame_id) == (each.CLIFF, "cliff_front") for each in reported
    )


@pytest.mark.parametrize("distance", [0.02, 0.1, None])
def test_infrared_light_fades_with_the_distance(make, distance):
    """3500 where it touches, 3500 / e² at every e-th part of the range more."""
    reach = 0.2
    things = [make.sdf(ray("ir_intensity_sensor", most=reach))]
    if distance is not None:
        wall = make.box("wall", (1, 1, 1), static=True, pose=Pose((distance + 0.5, 0, 0)))
        things.append(wall)
    world = make.world(*things)
    box = world.mailbox("/reported")
    world.run(0.1)
    message = box.drain()[-1]
    away = reach if distance is None else distance
    assert message.value == pytest.approx(3500 * math.exp(-2 * math.e * away / reach), abs=1)
    assert message.header.frame_id == "nose"


def test_its_acceleration_is_without_gravity(make):
    """Of what falls it is gravity's own, in the axes of the unit."""
    imu = f'<sensor name="imu" type="imu"><update_rate>{RATE}</update_rate>{plugin("imu")}</sensor>'
    still = make.sdf(f"""<model name="still"><static>1</static><pose>0 0 1 0.3 0.2 0.1</pose>
      <link name="imu_link">{imu}</link></model>""")
    world = make.world(still)
    box = world.mailbox("/reported")
    world.run(0.1)
    rest = box.drain()[-1].linear_acceleration
    assert (rest.x, rest.y, rest.z) == pytest.approx((0, 0, 0), abs=1e-9)
    falling = make.sdf(f"""<model name="falling"><pose>0 0 9 {math.pi / 2} 0 0</pose>
      <link name="imu_link"><inertial><mass>1</mass></inertial>{imu}</link></model>""")
    world = make.world(falling)
    box = world.mailbox("/reported")
    world.run(0.2)
    fall = box.drain()[-1].linear_acceleration
    # Lying on its side: what is down is -y there.
    assert (fall.x, fall.y, fall.z) == pytest.approx((0, -9.8, 0), abs=1e-6)


def test_the_mouse_adds_up_the_way_along_its_own_axes(make):
    link = f"""<link name="mouse"><pose>0.1 0.05 0.01 0 0 {-math.pi / 4}</pose><inertial>
      <mass>0.01</mass><inertia><ixx>1e-6</ixx><iyy>1e-6</iyy><izz>1e-6</izz></inertia></inertial>
      </link><joint name="held" type="fixed"><parent>base</parent><child>mouse</child></joint>"""
    tags = "<link_name>mouse</link_name><update_rate>50</update_rate>"
    robot = slider(make, plugin("optical_mouse", tags), mouse=link)
    world = make.world(robot, ground=0.0)
    box = world.mailbox("/reported", size=1000)
    world.run(0.5)
    first, start = box.drain()[-1], world.model("robot").pose
    world.publish("/cmd_vel", linear_x=0.2)
    world.run(2.0)
    last, end = box.drain()[-1], world.model("robot").pose
    half = (end.x - start.x) * math.sqrt(0.5)
    gone = (last.integrated_x - first.integrated_x, last.integrated_y - first.integrated_y)
    # The published value is up to one period of 20 ms old.
    assert gone == pytest.approx((half, half), abs=0.2 * 0.02)
    assert (last.frame_id, last.last_squal, last.header.frame_id) == (0, 90, "mouse")


def test_a_wheel_is_dropped_from_the_upper_bound_until_below_the_lower(make):
    """A spring of k bears m and a push F up at (m g - F) / k, which is part of the threshold."""
    stiffness, mass, threshold = 400.0, 1.0, 0.025
    tags = f"""<joint_name>drop</joint_name><frame_id>wheel_drop_left</frame_id>
      <detection_threshold>{threshold}</detection_threshold>"""
    wheel = make.sdf(f"""<model name="leg"><link name="hub"/><link name="wheel">
      <inertial><mass>{mass}</mass></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>hub</child></joint>
      <joint name="drop" type="prismatic"><parent>hub</parent><child>wheel</child>
      <axis><xyz>0 0 -1</xyz><limit><lower>0</lower><upper>0.03</upper></limit><dynamics>
      <damping>40</damping><spring_stiffness>{stiffness}</spring_stiffness>
      <spring_reference>0</spring_reference></dynamics></axis></joint>
      {plugin("wheel_drop", tags)}<plugin name="push" filename="libgazebo_ros_force.so">
      <bodyName>wheel</bodyName><topicName>push</topicName></plugin></model>""")
    world = make.world(wheel)
    box = world.mailbox("/reported", size=1000)

    def reported_at(part):
        """What is published once the wheel hangs out by so much of the threshold."""
        world.publish("/push", force_z=mass * 9.8 - part * threshold * stiffness)
        world.run(2.0)
        box.drain()
        world.run(0.2)
        return box.drain()

    reported = reported_at(0.98)
    assert {(each.type, each.header.frame_id) for each in reported} == {
        (reported[0].WHEEL_DROP, "wheel_drop_left")
    }
    assert reported_at(0.8)
    assert not reported_at(0.72)
    assert not reported_at(0.8)


DOCK = """<model name="dock"><static>1</static><link name="halo"/></model>"""
SENSES = """<robot_model_name>robot</robot_model_name><receiver_link_name>eye</receiver_link_name>
  <dock_model_name>dock</dock_model_name><emitter_link_name>halo</emitter_link_name>"""


def watcher(make, x, y, yaw):
    """A robot at a place, with the receivers of a Create 3; the dock looks along x from 0."""
    fields = f"""<sensor_0_fov>{math.radians(220)}</sensor_0_fov>
      <sensor_0_range>0.01</sensor_0_range><sensor_1_fov>{math.pi / 2}</sensor_1_fov>
      <sensor_1_range>0.5</sensor_1_range><update_rate>62</update_rate>"""
    pose = Pose((x, y, 0), quat_from_rpy(0, 0, yaw))
    robot = make.sdf(f"""<model name="robot"><static>1</static><link name="eye"/>
      {plugin("ir_opcode", SENSES + fields, "ir_opcode")}
      {plugin("docking_status", SENSES + "<update_rate>1</update_rate>", "dock_status")}</model>""")
    world = make.world(make.sdf(DOCK))
    world.session.spawn(robot, pose=pose)
    return world


@pytest.mark.parametrize(
    ("degrees", "distance", "facing", "codes"),
    [
        # On the axis both buoys overlap. The halo reaches 0.61 m; the front one sees 0.5 m more.
        (0, 0.5, 0, {(OMNI, 161), (FRONT, 161), (OMNI, 172), (FRONT, 172)}),
        (0, 0.9, 0, {(FRONT, 161), (OMNI, 172), (FRONT, 172)}),
        (0, 1.3, 0, {(FRONT, 172)}),
        (0, 1.6, 0, set()),
        # Red to the one side from -5° to 25°, green to the other.
        (15, 0.9, 0, {(FRONT, 161), (OMNI, 168), (FRONT, 168)}),
        (-15, 0.9, 0, {(FRONT, 161), (OMNI, 164), (FRONT, 164)}),
        (40, 0.9, 0, {(FRONT, 161)}),
        # Turned away by 60° the front one sees nothing, by 120° neither does.
        (0, 0.9, 60, {(OMNI, 172)}),
        (0, 0.5, 120, set()),
    ],
)
def test_the_codes_are_those_of_the_lights_that_reach_a_receiver(
    make, degrees, distance, facing, codes
):
    angle = math.radians(degrees)
    place = (distance * math.cos(angle), distance * math.sin(angle))
    world = watcher(make, *place, angle + math.pi + math.radians(facing))
    box = world.mailbox("/ir_opcode", size=1000)
    world.run(0.1)
    reported = box.drain()
    assert {(each.sensor, each.opcode) for each in reported} == codes
    assert all(each.header.frame_id == "eye" for each in reported)


@pytest.mark.parametrize(
    ("x", "y", "visible", "docked"),
    [(0.05, 0.0, True, True), (0.05, 0.03, True, False), (0.3, 0.0, True, False),
     (3.0, 0.0, False, False)],
)  # fmt: skip
def test_it_is_docked_where_it_is_near_and_in_line(make, x, y, visible, docked):
    world = watcher(make, x, y, math.pi)
    box = world.mailbox("/dock_status", size=1000)
    world.run(1.2)
    last = box.drain()[-1]
    assert (last.dock_visible, last.is_docked) == (visible, docked)


def test_without_a_dock_nothing_is_reported(make):
    world = watcher(make, 0.3, 0.0, math.pi)
    world.model("dock").delete()
    boxes = [world.mailbox(topic, size=1000) for topic in ("/ir_opcode", "/dock_status")]
    world.run(1.2)
    assert not any(box.drain() for box in boxes)
