"""Models of the tests of Warp batches: an arm, and a ball that falls."""

ARM = """<robot name="arm">
<link name="world"/>
<link name="base"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0"
ixz="0" iyz="0"/></inertial></link>
<joint name="fixed" type="fixed"><parent link="world"/><child link="base"/>
<origin xyz="0 3 1"/></joint>
<link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="1"/><inertia ixx="0.02" iyy="0.02"
izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="20" velocity="2"/><dynamics damping="0.1"/></joint>
<link name="lower"><inertial><origin xyz="0 0 0.2"/><mass value="0.5"/><inertia ixx="0.01"
iyy="0.01" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
<origin xyz="0 0 0.4"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="10" velocity="2"/>
<dynamics damping="0.1"/></joint>
<gazebo><plugin name="shoulder" filename="gz-sim-joint-position-controller-system">
<joint_name>shoulder</joint_name><topic>/shoulder</topic><use_velocity_commands>true</use_velocity_commands>
<cmd_max>1.0</cmd_max></plugin>
<plugin name="elbow" filename="gz-sim-joint-position-controller-system">
<joint_name>elbow</joint_name><topic>/elbow</topic><p_gain>20</p_gain><d_gain>1</d_gain></plugin>
</gazebo></robot>"""

BALL = """<sdf version="1.7"><model name="ball"><pose>0 -3 10 0 0 0</pose><link name="link">
<velocity/><inertial><mass>0.5</mass><inertia><ixx>0.002</ixx><iyy>0.002</iyy><izz>0.002</izz>
</inertia></inertial><collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>
</collision></link></model></sdf>"""
