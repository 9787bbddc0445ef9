"""Models for the tests of ground truth and properties."""

PENDULUM = """<model name="pendulum"><pose>0 0 2 0 0 0</pose>
<link name="base"><inertial><mass>1</mass></inertial></link>
<joint name="anchor" type="fixed"><parent>world</parent><child>base</child></joint>
<link name="arm"><inertial><mass>2</mass><pose>0 0 -0.5 0 0 0</pose>
<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
<joint name="hinge" type="revolute"><parent>base</parent><child>arm</child>
<axis><xyz>0 1 0</xyz><limit><lower>-3</lower><upper>3</upper></limit></axis></joint>
<link name="finger"><pose>0 0 -1 0 0 0</pose><inertial><mass>0.1</mass>
<inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial></link>
<joint name="slider" type="prismatic"><parent>arm</parent><child>finger</child>
<axis><xyz>0 0 1</xyz><limit><lower>-0.1</lower><upper>0.1</upper></limit></axis></joint>
</model>"""

SERVO = """<model name="lift"><link name="base"/>
<joint name="anchor" type="fixed"><parent>world</parent><child>base</child></joint>
<link name="car"><inertial><mass>3</mass></inertial></link>
<joint name="rail" type="prismatic"><parent>base</parent><child>car</child>
<axis><xyz>0 0 1</xyz></axis></joint>
<plugin filename="gz-sim-joint-position-controller-system"
 name="gz::sim::systems::JointPositionController"><joint_name>rail</joint_name>
<topic>/lift/rail/cmd_pos</topic><p_gain>1000</p_gain><i_gain>0</i_gain><d_gain>200</d_gain></plugin></model>"""

LASER = """<model name="laser"><static>1</static><pose>0 0 0.15 0 0 0</pose><link name="link">
<sensor name="laser" type="ray"><update_rate>20</update_rate><ray><scan><horizontal>
<samples>3</samples><min_angle>-0.01</min_angle><max_angle>0.01</max_angle></horizontal></scan>
<range><min>0.1</min><max>20</max></range></ray>
<plugin name="p" filename="libgazebo_ros_laser.so"><topicName>/scan</topicName>
<frameName>link</frameName></plugin></sensor></link></model>"""
