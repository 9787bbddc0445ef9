"""A post with a range finder, for the tests of its plugins."""

from cartwheel.geometry import Pose

RANGE = "libgazebo_ros_range.so"


def finder(
    tags="<topicName>front</topicName>",
    *,
    filename=RANGE,
    rate=20,
    least=0.05,
    most=4.0,
    noise="",
):
    """Five by five rays, a quarter rad to each side."""
    angles = "<samples>5</samples><min_angle>-0.25</min_angle><max_angle>0.25</max_angle>"
    return f"""<model name="post"><static>true</static><pose>0 0 2 0 0 0</pose>
      <link name="nose"><sensor name="sonar" type="ray"><update_rate>{rate}</update_rate>
        <ray><scan><horizontal>{angles}</horizontal><vertical>{angles}</vertical></scan>
          <range><min>{least}</min><max>{most}</max></range>{noise}</ray>
        <plugin name="range" filename="{filename}">{tags}</plugin></sensor></link></model>"""


def wall(make, distance):
    return make.box("wall", (1, 10, 10), static=True, pose=Pose((distance + 0.5, 0, 0)))


def messages(world, topic="/front", seconds=0.2):
    inbox = world.mailbox(topic, size=10_000)
    world.run(seconds)
    inbox.close()
    return inbox.drain()
