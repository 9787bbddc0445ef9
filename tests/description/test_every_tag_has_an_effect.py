"""Every element has an effect or is reported: without it, the result differs."""

from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from cartwheel.description.elements.xml import Node, parse
from cartwheel.description.files.packages import Packages
from cartwheel.description.sdf import read_sdf
from cartwheel.description.urdf import read_urdf
from cartwheel.errors import DescriptionError

MESH = """solid s
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 1 0 0
endloop
endfacet
facet normal 1 1 1
outer loop
vertex 1 0 0
vertex 0 1 0
vertex 0 0 1
endloop
endfacet
endsolid s
"""

WORLD = """
<audio><device>default</device></audio>
<wind><linear_velocity>1 0 0</linear_velocity></wind>
<gravity>0 0 -1</gravity>
<magnetic_field>1 2 3</magnetic_field>
<atmosphere type="adiabatic"><temperature>300</temperature></atmosphere>
<physics type="ode"><max_step_size>0.004</max_step_size></physics>
<physics type="ode" default="true">
  <max_step_size>0.003</max_step_size>
  <real_time_factor>2</real_time_factor>
  <real_time_update_rate>500</real_time_update_rate>
  <max_contacts>3</max_contacts>
  <dart><collision_detector>bullet</collision_detector></dart>
  <simbody><accuracy>1</accuracy></simbody>
  <bullet><solver><iters>3</iters></solver></bullet>
  <ode><solver><iters>3</iters></solver></ode>
</physics>
<scene>
  <ambient>0.1 0.2 0.3 1</ambient>
  <background>0.1 0.2 0.3 1</background>
  <sky><time>3</time></sky>
  <shadows>false</shadows>
  <fog><type>linear</type></fog>
  <grid>false</grid>
  <origin_visual>false</origin_visual>
  <shadow_caster_material_name>x</shadow_caster_material_name>
</scene>
<light name="l" type="spot">
  <cast_shadows>true</cast_shadows>
  <intensity>0.5</intensity>
  <visualize>true</visualize>
  <diffuse>0.1 0.2 0.3 1</diffuse>
  <specular>0.3 0.2 0.1 1</specular>
  <attenuation><range>3</range><linear>0.1</linear><constant>0.2</constant>
    <quadratic>0.3</quadratic></attenuation>
  <direction>0 1 -1</direction>
  <spot><inner_angle>0.1</inner_angle><outer_angle>0.2</outer_angle><falloff>2</falloff></spot>
  <pose>0 0 3 0 0 0</pose>
</light>
<light name="dark" type="point"><light_on>false</light_on></light>
<model name="m" canonical_link="b"><pose>0 0 1 0 0 0</pose><link name="a"/>
  <link name="b"><pose>0 1 0 0 0 0</pose></link></model>
<frame name="f" attached_to="m"><pose>1 0 0 0 0 0</pose></frame>
<model name="n"><pose relative_to="f" degrees="true">0 0 1 0 0 90</pose><link name="a"/></model>
<model name="q"><pose rotation_format="quat_xyzw">0 0 1 1 0 0 0</pose><link name="a"/></model>
<actor name="x"><skin><filename>a.dae</filename></skin></actor>
<road name="r"><width>3</width></road>
<population name="x"><model_count>3</model_count></population>
<particle_emitter name="e" type="point"/>
<spherical_coordinates><latitude_deg>1</latitude_deg></spherical_coordinates>
<plugin name="p" filename="libx.so"><a>b</a></plugin>
<joint name="held" type="revolute"><parent>world</parent><child>n</child>
  <axis><xyz>0 1 0</xyz></axis></joint>
<joint name="both" type="fixed"><parent>m</parent><child>q</child></joint>
<joint name="loose" type="prismatic"><parent>m</parent><child>q</child><axis/></joint>
"""

STATE = """
<model name="gone"><link name="a"/></model>
<model name="lone"><link name="a"/></model>
<model name="arm"><link name="a"/><link name="b"><pose>0 0 1 0 0 0</pose></link>
  <joint name="j" type="revolute"><parent>a</parent><child>b</child><axis/></joint>
  <model name="in"><link name="i"/></model></model>
<light name="sun" type="point"/>
<state world_name="w">
  <sim_time>3 2</sim_time><wall_time>3 3</wall_time><real_time>3 2</real_time>
  <iterations>3</iterations>
  <insertions><model name="new"><link name="a"/></model></insertions>
  <deletions><name>gone</name></deletions>
  <model name="lone"><pose>3 2 1 0 0 0</pose><scale>2 1 1</scale>
    <link name="a"><pose>3 2 2 0 0 0</pose><velocity>1 0 0 0 0 0</velocity>
      <acceleration>1 0 0 0 0 0</acceleration><wrench>1 0 0 0 0 0</wrench></link>
    <link name="strange"/></model>
  <model name="arm"><joint name="j"><angle axis="0">0.3</angle></joint>
    <joint name="strange"/>
    <model name="in"><link name="i"><pose>0 0 9 0 0 0</pose></link></model></model>
  <light name="sun"><pose>0 0 9 0 0 0</pose></light>
  <model name="strange"/>
</state>
"""

MODEL = """
<model name="m" placement_frame="fr">
<static>true</static>
<self_collide>true</self_collide>
<allow_auto_disable>false</allow_auto_disable>
<enable_wind>true</enable_wind>
<frame name="fr" attached_to="a"><pose>0 1 0 1 0 0</pose></frame>
<pose>0 0 1 0 0 0</pose>
<gripper name="g"><palm_link>b</palm_link></gripper>
<plugin name="x" filename="y"><a>1</a></plugin>
<link name="a">
  <gravity>false</gravity>
  <self_collide>false</self_collide>
  <kinematic>true</kinematic>
  <must_be_base_link>true</must_be_base_link>
  <velocity_decay><linear>0.1</linear><angular>0.2</angular></velocity_decay>
  <pose>0 0 0.5 0 0 0</pose>
  <inertial><mass>2</mass><pose>0 0 0.1 0 0 0</pose><density>3</density>
    <inertia><ixx>2</ixx><ixy>0.1</ixy><ixz>0.1</ixz><iyy>2</iyy><iyz>0.1</iyz><izz>2</izz></inertia>
    <fluid_added_mass><xx>1</xx></fluid_added_mass></inertial>
  <collision name="c">
    <density>2</density>
    <auto_inertia_params><x>1</x></auto_inertia_params>
    <laser_retro>3</laser_retro>
    <max_contacts>3</max_contacts>
    <pose>0 0 0.2 0 0 0</pose>
    <geometry><box><size>1 2 3</size></box></geometry>
    <surface>
      <bounce><restitution_coefficient>0.5</restitution_coefficient><threshold>2</threshold></bounce>
      <friction>
        <torsional><coefficient>0.5</coefficient><use_patch_radius>false</use_patch_radius>
          <surface_radius>0.2</surface_radius><ode><slip>0.1</slip></ode></torsional>
        <ode><mu>0.3</mu><mu2>0.4</mu2><fdir1>1 1 0</fdir1><slip1>0.1</slip1>
          <slip2>0.2</slip2></ode>
        <bullet><friction>0.4</friction></bullet>
      </friction>
      <contact>
        <collide_without_contact>true</collide_without_contact>
        <collide_without_contact_bitmask>3</collide_without_contact_bitmask>
        <collide_bitmask>2</collide_bitmask>
        <category_bitmask>4</category_bitmask>
        <poissons_ratio>0.1</poissons_ratio>
        <elastic_modulus>3</elastic_modulus>
        <ode><soft_cfm>0.1</soft_cfm><soft_erp>0.3</soft_erp><kp>1000</kp><kd>10</kd>
          <max_vel>0.2</max_vel><min_depth>0.003</min_depth></ode>
        <bullet><kp>3</kp></bullet>
      </contact>
      <soft_contact><dart><stiffness>3</stiffness></dart></soft_contact>
    </surface>
  </collision>
  <visual name="v">
    <cast_shadows>false</cast_shadows>
    <laser_retro>2</laser_retro>
    <transparency>0.3</transparency>
    <visibility_flags>3</visibility_flags>
    <meta><layer>2</layer></meta>
    <pose>0 0 1 0 0 0</pose>
    <plugin name="x" filename="y"/>
    <geometry><sphere><radius>3</radius></sphere></geometry>
    <material>
      <script><name>Gazebo/Red</name></script>
      <shader type="pixel"/>
      <render_order>3</render_order>
      <lighting>false</lighting>
      <ambient>1 0 0 1</ambient>
      <diffuse>0 1 0 1</diffuse>
      <specular>0 0 1 1</specular>
      <shininess>3</shininess>
      <emissive>1 0 1 1</emissive>
      <double_sided>true</double_sided>
      <pbr><metal><albedo_map>map.png</albedo_map><roughness>0.2</roughness></metal></pbr>
    </material>
  </visual>
  <visual name="v1"><geometry><cylinder><radius>3</radius><length>2</length></cylinder></geometry>
  </visual>
  <visual name="v2"><geometry><capsule><radius>3</radius><length>2</length></capsule></geometry>
  </visual>
  <visual name="v3"><geometry><cone><radius>3</radius><length>2</length></cone></geometry></visual>
  <visual name="v4"><geometry><ellipsoid><radii>3 1 2</radii></ellipsoid></geometry></visual>
  <visual name="v5"><geometry><plane><normal>0 1 0</normal><size>2 3</size></plane></geometry>
  </visual>
  <visual name="v6"><geometry><polyline><point>0 0</point><point>1 0</point><point>1 1</point>
    <point>0 2</point><height>2</height></polyline></geometry></visual>
  <visual name="v7"><geometry><image><uri>a.png</uri></image></geometry></visual>
  <visual name="v9"><geometry><mesh optimization="convex_decomposition">
    <convex_decomposition><max_convex_hulls>3</max_convex_hulls></convex_decomposition>
    <uri>cube.stl</uri><scale>1 2 3</scale></mesh></geometry></visual>
  <visual name="v10"><geometry><heightmap><uri>map.png</uri><size>3 4 5</size><pos>1 2 3</pos>
    <texture><size>3</size><diffuse>map.png</diffuse><normal>map.png</normal></texture>
    <blend><min_height>1</min_height></blend><use_terrain_paging>true</use_terrain_paging>
    <sampling>4</sampling></heightmap></geometry></visual>
  <projector name="pr"><texture>x</texture></projector>
  <audio_source><uri>a</uri></audio_source>
  <battery name="b"><voltage>3</voltage></battery>
  <particle_emitter name="e" type="point"><emitting>1</emitting></particle_emitter>
  <light name="ll" type="point"><pose relative_to="b">0 0 1 0 0 0</pose></light>
  <sensor name="s" type="imu"><pose relative_to="b">0 0 1 0 0 0</pose><update_rate>3</update_rate>
    <always_on>true</always_on><visualize>true</visualize><topic>x</topic></sensor>
</link>
<link name="b"><pose>0 0 2 0 0 0</pose></link>
<link name="d"/><link name="e"/><link name="g"/><link name="h"/><link name="k"/>
<link name="c">
  <inertial auto="true"><density>3</density><mass>4</mass><inertia><ixx>3</ixx></inertia>
    <pose>1 0 0 0 0 0</pose><auto_inertia_params><x>1</x></auto_inertia_params></inertial>
  <collision name="c"><density>2</density><geometry><box><size>1 1 1</size></box></geometry>
  </collision>
  <collision name="d"><pose>1 0 0 0 0 0</pose><geometry><box><size>1 1 1</size></box></geometry>
  </collision>
</link>
<joint name="j" type="revolute"><parent>a</parent><child>b</child>
  <pose relative_to="a">0 0 0.1 0 0 0</pose>
  <axis>
    <initial_position>0.2</initial_position>
    <xyz expressed_in="fr">0 1 0</xyz>
    <dynamics><damping>0.1</damping><friction>0.2</friction>
      <spring_reference>0.3</spring_reference><spring_stiffness>0.4</spring_stiffness></dynamics>
    <limit><lower>-1</lower><upper>2</upper><effort>3</effort><velocity>4</velocity>
      <stiffness>5</stiffness><dissipation>6</dissipation></limit>
    <mimic joint="j2" axis="axis"><multiplier>2</multiplier><offset>0.1</offset>
      <reference>0.2</reference></mimic>
  </axis>
  <axis2><xyz>1 0 0</xyz></axis2>
  <thread_pitch>3</thread_pitch>
  <gearbox_ratio>3</gearbox_ratio>
  <physics>
    <simbody><must_be_loop_joint>true</must_be_loop_joint></simbody>
    <provide_feedback>true</provide_feedback>
    <ode><cfm_damping>true</cfm_damping><fudge_factor>0.3</fudge_factor><cfm>0.1</cfm>
      <erp>0.2</erp><bounce>0.3</bounce><max_force>3</max_force><velocity>2</velocity>
      <limit><cfm>0.1</cfm><erp>0.3</erp></limit><suspension><erp>0.2</erp></suspension></ode>
  </physics>
  <sensor name="f" type="force_torque"><force_torque><frame>child</frame></force_torque></sensor>
</joint>
<joint name="j2" type="prismatic"><parent>a</parent><child>c</child>
  <axis><xyz>0 1 0</xyz></axis>
  <physics><ode><provide_feedback>true</provide_feedback>
    <implicit_spring_damper>true</implicit_spring_damper></ode></physics></joint>
<joint name="j3" type="screw"><parent>a</parent><child>d</child><axis><xyz>0 1 0</xyz></axis>
  <screw_thread_pitch>0.2</screw_thread_pitch></joint>
<joint name="j4" type="screw"><parent>a</parent><child>e</child><axis><xyz>0 1 0</xyz></axis>
  <thread_pitch>0.2</thread_pitch></joint>
<joint name="j5" type="universal"><parent>a</parent><child>g</child><axis><xyz>0 1 0</xyz></axis>
  <axis2><xyz>1 0 0</xyz><limit><lower>-2</lower><upper>2</upper></limit>
    <mimic joint="j2"/></axis2></joint>
<joint name="j6" type="ball"><parent>a</parent><child>h</child>
  <axis><dynamics><damping>3</damping></dynamics></axis></joint>
<joint name="j7" type="gearbox"><parent>k</parent><child>b</child><gearbox_ratio>3</gearbox_ratio>
  <gearbox_reference_body>a</gearbox_reference_body><axis><xyz>0 0 -1</xyz></axis></joint>
<joint name="j9" type="revolute"><parent>a</parent><child>k</child><axis/></joint>
<model name="in"><self_collide>true</self_collide><link name="o"/>
  <link name="i"/>
  <frame name="k" attached_to="i"/><pose relative_to="b">1 0 0 0 0 0</pose></model>
<joint name="j8" type="fixed"><parent>a</parent><child>in::k</child></joint>
</model>
"""

ROBOT = """
<material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
<link name="shown"><visual><geometry><sphere radius="1"/></geometry><material name="grey"/></visual>
</link>
<joint name="s" type="fixed"><parent link="base"/><child link="shown"/></joint>
<link name="base">
  <inertial><origin xyz="0 0 0.1" rpy="0.1 0 0"/><mass value="2"/>
    <inertia ixx="1" iyy="1.1" izz="1.2" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial>
  <visual name="vis"><origin xyz="0 0 1" rpy="1 0 0"/><geometry><box size="1 2 3"/></geometry>
    <material name="grey"/></visual>
  <visual><geometry><cylinder radius="2" length="3"/></geometry><material name="red">
    <color rgba="1 0 0 1"/></material></visual>
  <collision name="col"><origin xyz="0 0 1" rpy="1 0 0"/><geometry><sphere radius="1"/></geometry>
  </collision>
  <collision><geometry><capsule radius="2" length="3"/></geometry></collision>
</link>
<link name="arm"><visual><geometry><sphere radius="1"/></geometry></visual>
  <inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="cam"/><link name="end"/>
<joint name="j" type="revolute"><origin xyz="0 0 1" rpy="0 1 0"/><parent link="base"/>
  <child link="arm"/><axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="5" velocity="2"/>
  <dynamics damping="0.1" friction="0.2"/><mimic joint="k" multiplier="2" offset="0.1"/>
  <safety_controller soft_lower_limit="-0.5" soft_upper_limit="0.5" k_position="10"
    k_velocity="5"/>
  <calibration rising="0.1"/></joint>
<joint name="k" type="continuous"><parent link="arm"/><child link="tip"/><axis xyz="0 1 0"/>
  <limit upper="1" effort="3" velocity="1"/></joint>
<joint name="f" type="fixed"><parent link="tip"/><child link="cam"/><limit effort="2"/>
  <dynamics damping="1"/></joint>
<joint name="g" type="fixed"><parent link="tip"/><child link="end"/></joint>
<transmission name="t"><type>x</type><joint name="j"/></transmission>
<gazebo>
  <static>true</static><self_collide>true</self_collide>
  <gripper name="g"/><allow_auto_disable>true</allow_auto_disable><pose>0 0 1 0 0 0</pose>
  <plugin name="p" filename="x.so"><a/></plugin>
  <sensor name="s0" type="imu"/><light name="l0" type="point"/><mu1>3</mu1><strange>1</strange>
</gazebo>
<gazebo reference="base">
  <mu1>0.3</mu1><mu2>0.4</mu2><fdir1>1 0 0</fdir1><kp>1000</kp>
  <kd>10</kd><maxVel>0.2</maxVel><minDepth>0.003</minDepth><laserRetro>3</laserRetro>
  <selfCollide>false</selfCollide><turnGravityOff>true</turnGravityOff>
  <dampingFactor>0.1</dampingFactor><canonicalBody>true</canonicalBody>
  <visual><cast_shadows>false</cast_shadows><transparency>0.3</transparency></visual>
  <collision><max_contacts>6</max_contacts><surface><bounce><restitution_coefficient>0.3
    </restitution_coefficient></bounce><contact><ode><soft_cfm>3</soft_cfm></ode></contact>
    </surface><pose>1 0 0 0 0 0</pose></collision>
  <sensor name="s" type="imu"><pose>0 0 1 0 0 0</pose><update_rate>3</update_rate></sensor>
  <light name="l" type="point"><pose>0 0 1 0 0 0</pose></light>
  <projector name="pr"><fov>1</fov></projector>
  <plugin name="x" filename="y"/><stopCfm>3</stopCfm><kinematic>true</kinematic>
  <enable_wind>true</enable_wind><must_be_base_link>true</must_be_base_link>
  <inertial><mass>4</mass></inertial><battery name="b"/>
</gazebo>
<gazebo reference="arm"><material>Gazebo/Blue</material><maxContacts>5</maxContacts>
  <gravity>false</gravity>
  <self_collide>true</self_collide><velocity_decay><linear>0.2</linear></velocity_decay></gazebo>
<gazebo reference="j">
  <stopCfm>0.1</stopCfm><stopErp>0.2</stopErp><springReference>0.3</springReference>
  <springStiffness>0.4</springStiffness><fudgeFactor>0.5</fudgeFactor>
  <provideFeedback>true</provideFeedback><implicitSpringDamper>true</implicitSpringDamper>
  <preserveFixedJoint>true</preserveFixedJoint><sensor name="ft" type="force_torque"/>
  <mu1>2</mu1><physics><ode><limit><cfm>3</cfm></limit></ode></physics><damping>3</damping>
</gazebo>
<gazebo reference="k"><cfmDamping>true</cfmDamping></gazebo>
<gazebo reference="f"><disableFixedJointLumping>true</disableFixedJointLumping></gazebo>
<gazebo reference="g"><preserveFixedJoint>true</preserveFixedJoint></gazebo>
<gazebo reference="nowhere"><mu1>3</mu1></gazebo>
"""

WITHOUT_WORD = {
    # Stands for itself, or is said by something else as well.
    ("physics", "@type"), ("state", "@world_name"), ("angle", "@axis"),
}  # fmt: skip


def described(text: str, file: Path, place: tuple[int, ...] = (), attribute: str | None = None):
    """The result of a document, and its diagnostics; without the element at `place`."""
    root = parse(text, str(file))
    if place:
        owner = at(root, place[:-1])
        child = owner.children[place[-1]]
        if attribute is None:
            owner.drop(child)
        else:
            mutable = dict(child.attributes)
            del mutable[attribute]
            owner.children[place[-1]] = Node(
                child.tag, mutable, child.origin, child.children, child.text
            )
    packages = Packages(file, environment={})
    found = read_urdf(root, packages) if root.tag == "robot" else read_sdf(root, packages)
    return replace(found, diagnostics=()), found.diagnostics


def at(node: Node, place: tuple[int, ...]) -> Node:
    for index in place:
        node = node.children[index]
    return node


DOCUMENTS = {
    "world": f'<sdf version="1.11"><world name="w">{WORLD}</world></sdf>',
    "state": f'<sdf version="1.11"><world name="w">{STATE}</world></sdf>',
    "model": f'<sdf version="1.11">{MODEL}</sdf>',
    "robot": f'<robot name="r">{ROBOT}</robot>',
}


@pytest.mark.parametrize("text", DOCUMENTS.values(), ids=DOCUMENTS)
def test_every_element_acts_or_is_reported(tmp_path, text):
    (tmp_path / "cube.stl").write_text(MESH)
    Image.linear_gradient("L").resize((5, 5)).save(tmp_path / "map.png")
    file = tmp_path / "w.sdf"
    whole = described(text, file)
    silent = []
    top = () if text.startswith("<robot") else (0,)
    left: list[tuple[int, ...]] = [
        (*top, index) for index in range(len(at(parse(text, ""), top).children))
    ]
    assert len(left) > 3
    while left:
        place = left.pop()
        node = at(parse(text, str(file)), place)
        owner = at(parse(text, str(file)), place[:-1])
        acts = []
        for attribute in (None, *node.attributes):
            label = (owner.tag, node.tag) if attribute is None else (node.tag, f"@{attribute}")
            try:
                found = described(text, file, place, attribute)
            except DescriptionError:
                acts.append(attribute)
                continue
            if found[0] != whole[0]:
                acts.append(attribute)
            elif found[1] == whole[1] and label not in WITHOUT_WORD:
                silent.append(f"line {node.origin.line}: {label}")
            if attribute is None and None not in acts:
                break  # reported as a whole
        if None in acts and node.tag != "plugin":
            left += [(*place, index) for index in range(len(node.children))]
    assert sorted(silent) == []
