"""A single body with a sensor or plugin, in worlds with geographic coordinates."""

import numpy as np

from cartwheel.description.model import Element
from cartwheel.errors import Origin

HERE = Origin(file="test.world", line=1)

BOX = """<link name="link"><inertial><mass>4</mass><inertia><ixx>0.06</ixx><iyy>0.06</iyy>
  <izz>0.1</izz></inertia></inertial>{sensor}</link>{plugin}"""


def unit(plugin="", sensor=""):
    return f'<model name="unit">{BOX.format(sensor=sensor, plugin=plugin)}</model>'


def vector(message):
    return np.array([message.x, message.y, message.z])


def floating(make, model, pose=None, **more):
    """Without weight, so that it stays or goes on."""
    world = make.world(ground=None, gravity=0.0, **more)
    world.session.spawn(make.sdf(model), pose=pose)
    return world


def spherical(latitude, longitude, elevation=0.0, heading=0.0):
    values = {
        "latitude_deg": latitude,
        "longitude_deg": longitude,
        "elevation": elevation,
        "heading_deg": heading,
    }
    children = tuple(Element(tag=k, text=str(v), origin=HERE) for k, v in values.items())
    return Element(tag="spherical_coordinates", children=children, origin=HERE)
