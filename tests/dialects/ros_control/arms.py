"""Robots for controllers, made in a line."""

MASS, ARM, INERTIA = 2.0, 0.5, 0.1
"""kg, m, kg m²: of each beam, its centre of mass half a metre from its joint."""
GRAVITY = 9.8


def transmission(joint, interface):
    """For ros_control."""
    return f"""<transmission name="t_{joint}"><type>transmission_interface/SimpleTransmission</type>
      <joint name="{joint}"><hardwareInterface>hardware_interface/{interface}JointInterface
      </hardwareInterface></joint><actuator name="m_{joint}"/></transmission>"""


def beam(name, parent, *, axis="0 1 0", limit="", kind="revolute", origin="0 0 1"):
    """A link that turns, or slides, and its joint ``<name>_joint``."""
    limits = limit or 'lower="-3" upper="3" effort="100" velocity="10"'
    return f"""<link name="{name}"><inertial><origin xyz="{ARM} 0 0"/><mass value="{MASS}"/>
      <inertia ixx="{INERTIA}" iyy="{INERTIA}" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial>
      </link><joint name="{name}_joint" type="{kind}"><parent link="{parent}"/>
      <child link="{name}"/><origin xyz="{origin}"/><axis xyz="{axis}"/><limit {limits}/></joint>"""


def robot(body, plugin):
    """A robot that is bolted to the world."""
    return f"""<robot name="arm"><link name="world"/>{body}<gazebo>{plugin}</gazebo></robot>"""


ROS1 = """<plugin name="control" filename="libgazebo_ros_control.so">
  <robotNamespace>/</robotNamespace></plugin>"""


def ros2_joint(name, *commands, extra=""):
    """For ros2_control."""
    reported = "".join(f'<command_interface name="{each}"/>' for each in commands or ("position",))
    return f"""<joint name="{name}">{reported}<state_interface name="position"/>
      <state_interface name="velocity"/>{extra}</joint>"""


def ros2_system(*joints):
    """The joints of a robot for ros2_control, in a simulation."""
    return f"""<ros2_control name="bench" type="system"><hardware>
      <plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>{"".join(joints)}
      </ros2_control>"""


def ros2_plugin(*files, namespace=""):
    """The plugin, with its parameter files."""
    space = f"<ros><namespace>{namespace}</namespace></ros>" if namespace else ""
    named = "".join(f"<parameters>{file}</parameters>" for file in files)
    return f"""<plugin name="control" filename="gz_ros2_control-system">{space}{named}</plugin>"""


def ros2_parameters(rate=100, /, **controllers):
    """A file of the manager and its controllers, each with its type among its parameters."""
    manager = {"update_rate": rate}
    nodes = {}
    for name, values in controllers.items():
        manager[name] = {"type": values["type"]}
        own = {key: value for key, value in values.items() if key != "type"}
        if own:
            nodes[name] = {"ros__parameters": own}
    return {"controller_manager": {"ros__parameters": manager}, **nodes}
