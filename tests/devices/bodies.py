"""A box, and an arm whose wrist carries a hand."""

import numpy as np

BOX = """<link name="link"><inertial><mass>4</mass><inertia><ixx>0.06</ixx><iyy>0.06</iyy>
  <izz>0.1</izz></inertia></inertial><collision name="c"><geometry><box><size>0.4 0.4 0.1</size>
  </box></geometry></collision></link>"""

ARM = """<model name="arm"><pose>0 0 1 0 0 0</pose>
  <link name="post"><inertial><mass>1</mass></inertial></link>
  <link name="beam"><inertial><pose>0.5 0 0 0 0 0</pose><mass>3</mass>
    <inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
  <link name="hand"><pose>1 0 0 0 0 0</pose><inertial><mass>2</mass>
    <inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
  <joint name="bolt" type="fixed"><parent>world</parent><child>post</child></joint>
  <joint name="turn" type="revolute"><parent>post</parent><child>beam</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="wrist" type="{wrist}"><parent>beam</parent><child>hand</child>{axis}{sensor}</joint>
  {plugin}</model>"""
AXIS = "<axis><xyz>0 0 1</xyz></axis>"


def arm(plugin="", wrist="fixed", sensor=""):
    axis = "" if wrist == "fixed" else AXIS
    return ARM.format(plugin=plugin, wrist=wrist, axis=axis, sensor=sensor)


def vector(message):
    return np.array([message.x, message.y, message.z])


def turn(message):
    return (message.x, message.y, message.z, message.w)
