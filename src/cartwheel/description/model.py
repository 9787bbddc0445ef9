"""The contents of robot and world descriptions, as frozen dataclasses independent of MuJoCo.

SI units. Frames follow SDF: a link's pose is relative to its model; the pose of a visual,
collision, inertial or sensor is relative to its link, and a joint's to its child link
(`Joint.pose`). Every element contains its location in the user's file.

The file is long because it is one table of types, which readers look up together.
"""

# ruff: noqa: RUF009  (the defaults that are called for, such as Pose(), are frozen themselves)

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from cartwheel.errors import Diagnostic, Origin
from cartwheel.geometry import Pose, Vec3

Simulator = Literal["", "classic", "gz"]
"""Gazebo Classic or gz-sim; empty if it may be for either of them."""
Rgba = tuple[float, float, float, float]
"""Red, green, blue, alpha, each 0 to 1."""

JointType = Literal[
    "fixed",
    "revolute",
    "continuous",
    "prismatic",
    "ball",
    "universal",
    "screw",
    "floating",
    "planar",
]


WITHOUT_POSITION: frozenset[JointType] = frozenset(("fixed", "ball", "floating", "planar"))
"""Types of joints that do not have one position, which other joints could mimic."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Element:
    """A parameter tree of a plugin or sensor, as written, which the plugin or sensor reads."""

    tag: str
    text: str = ""
    attributes: tuple[tuple[str, str], ...] = ()
    children: tuple[Element, ...] = ()
    origin: Origin

    def find(self, path: str) -> Element | None:
        """The first descendant at a path such as ``image/width``."""
        tag, _, rest = path.partition("/")
        for child in self.children:
            if child.tag == tag:
                return child.find(rest) if rest else child
        return None

    def find_all(self, tag: str) -> Iterator[Element]:
        """The direct children with this tag."""
        return (child for child in self.children if child.tag == tag)

    def walk(self) -> Iterator[Element]:
        """This element and all its descendants, in file order."""
        yield self
        for child in self.children:
            yield from child.walk()

    def attribute(self, name: str) -> str | None:
        """The value of an attribute."""
        return dict(self.attributes).get(name)


@dataclass(frozen=True, kw_only=True, slots=True)
class Box:
    size: Vec3
    """Full edge lengths."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Cylinder:
    radius: float
    length: float
    """Along z, centred."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sphere:
    radius: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Capsule:
    radius: float
    length: float
    """Length of the cylindrical part along z, centred."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Cone:
    radius: float
    length: float
    """Along z, centred, tip up."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ellipsoid:
    radii: Vec3


@dataclass(frozen=True, kw_only=True, slots=True)
class Plane:
    normal: Vec3 = (0.0, 0.0, 1.0)
    size: tuple[float, float] = (100.0, 100.0)
    """Drawn size; collisions have no limit."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Mesh:
    uri: str
    """As written."""
    path: Path
    """The resolved file, which exists."""
    scale: Vec3 = (1.0, 1.0, 1.0)
    submesh: str | None = None
    center_submesh: bool = False
    convex_decomposition: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class Heightmap:
    path: Path
    size: Vec3
    """m; the third component is the height of the brightest pixel above black."""
    position: Vec3 = (0.0, 0.0, 0.0)
    texture: Path | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Polyline:
    points: tuple[tuple[float, float], ...]
    height: float
    """Along z, from 0."""
    holes: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Additional outlines: points inside an odd number of outlines are filled."""


Shape = Box | Cylinder | Sphere | Capsule | Cone | Ellipsoid | Plane | Mesh | Heightmap | Polyline


@dataclass(frozen=True, kw_only=True, slots=True)
class Material:
    """A surface's appearance; `colour_of` selects between its colour and a mesh's colours."""

    name: str = ""
    """URDF material or Gazebo script name, as written."""
    diffuse: Rgba | None = None
    """None to keep the mesh's colours."""
    yields_to_mesh: bool = False
    """Whether a mesh's colours take precedence over `diffuse`: rviz's rule for URDF colours."""
    specular: float = 0.1
    emissive: Rgba = (0.0, 0.0, 0.0, 1.0)
    texture: Path | bytes | None = None
    """A file or its contents. Multiplied by `diffuse`, if that is set."""
    texture_scale: tuple[float, float] = (1.0, 1.0)
    """The part of a surface covered by one copy of the texture, across and along, about its centre.
    """

    def colour_of(self, own: Rgba | None) -> Rgba | None:
        """The colour of a part with the colour `own`, such as a mesh's; None if neither is set."""
        if own is not None and (self.diffuse is None or self.yields_to_mesh):
            return own
        return self.diffuse


NO_BOUNCE = 1e5
"""m/s; SDF's default of a bounce threshold, which no impact reaches."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Surface:
    """Contact parameters as in Gazebo's ODE; None if not stated."""

    mu1: float | None = None
    mu2: float | None = None
    fdir1: Vec3 | None = None
    """The direction in which mu1 applies, with mu2 across it; None for the world's axes."""
    fdir1_frame: str | None = None
    """The link that defines the axes of `fdir1`; None for the collision's own axes."""
    slip1: float | None = None
    slip2: float | None = None
    torsional: float | None = None
    """Torsional friction coefficient; 1 if only `patch_radius` is stated."""
    patch_radius: float | None = None
    """Radius of the contact area, m."""
    surface_radius: float | None = None
    """Radius of the surface's curvature, m, if the contact area depends on the depth instead."""
    kp: float | None = None
    """N/m."""
    kd: float | None = None
    """N s/m."""
    min_depth: float | None = None
    """m."""
    max_vel: float | None = None
    """m/s."""
    max_contacts: int | None = None
    restitution: float | None = None
    bounce_threshold: float | None = None
    """m/s; slower impacts do not bounce. None is `NO_BOUNCE`."""
    collide_bitmask: int | None = None
    """32 bits: the categories that it collides with."""
    category_bitmask: int | None = None
    """32 bits: the same as `collide_bitmask` if not stated."""
    collide_without_contact: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class Visual:
    name: str
    pose: Pose = Pose()
    shape: Shape
    material: Material = Material()
    transparency: float = 0.0
    cast_shadows: bool = True
    laser_retro: float | None = None
    origin: Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class Collision:
    name: str
    """Unique in its link. In a URDF, Gazebo's spelling: ``<link>_collision``, then ``_1``, …"""
    aliases: tuple[str, ...] = ()
    """Other spellings that sensors may use, including those of merged links."""
    pose: Pose = Pose()
    shape: Shape
    surface: Surface = Surface()
    laser_retro: float | None = None
    origin: Origin


MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
"""The fields of an `Inertial` that are its inertia matrix."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Inertial:
    mass: float
    """kg, positive."""
    pose: Pose = Pose()
    """Pose of the centre of mass and the inertia's axes in the link."""
    ixx: float
    iyy: float
    izz: float
    ixy: float = 0.0
    ixz: float = 0.0
    iyz: float = 0.0
    """kg m²."""
    added_mass: tuple[float, ...] = ()
    """Mass of the water that moves with the link: the upper triangle of a symmetric 6 × 6 matrix,
    row by row, in kg, kg m and kg m². Its rows and columns are x, y, z and the rotations about
    them, in the axes of the link and about its origin. Empty: none."""
    origin: Origin

    @property
    def diagonal(self) -> Vec3:
        """ixx, iyy, izz."""
        return self.ixx, self.iyy, self.izz

    @property
    def products(self) -> Vec3:
        """ixy, ixz, iyz."""
        return self.ixy, self.ixz, self.iyz

    def scaled(self, mass: float) -> dict[str, Any]:
        """The moments, by their names, of a body with the same shape and another mass."""
        factor = mass / self.mass
        return {key: getattr(self, key) * factor for key in MOMENTS}


@dataclass(frozen=True, kw_only=True, slots=True)
class Pinhole:
    """Focal lengths and principal point of a pinhole camera, pixels, with SDF's defaults."""

    fx: float = 277.0
    fy: float = 277.0
    cx: float = 160.0
    cy: float = 120.0
    """From the upper left corner of the image."""
    tx: float = 0.0
    ty: float = 0.0
    """Last column of ``camera_info``'s P."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraIntrinsics:
    """The parameters of one lens in SDF's ``<camera>``."""

    name: str = ""
    pose: Pose = Pose()
    horizontal_fov: float = 1.047
    """rad."""
    width: int = 320
    height: int = 240
    format: str = "R8G8B8"
    near: float = 0.1
    far: float = 100.0
    """m."""
    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    distortion_center: tuple[float, float] = (0.5, 0.5)
    noise_mean: float = 0.0
    noise_stddev: float = 0.0
    pinhole: Pinhole | None = None
    """``<lens><intrinsics>``, which gz-sim uses instead of the field of view."""
    projection: Pinhole | None = None
    """``<lens><projection>``, with which gz-sim renders the image."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PluginTag:
    """A ``<plugin>`` as written."""

    name: str
    filename: str
    element: Element
    origin: Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class Sensor:
    name: str
    type: str
    """SDF's type: camera, depth, imu, contact, ray, gpu_lidar, …"""
    link: str
    """The link name in the URDF, even if Gazebo would merge the link."""
    joint: str | None = None
    """The joint that it measures; `link` is then that joint's child."""
    pose: Pose = Pose()
    update_rate: float = 0.0
    """Hz; 0 for every step."""
    always_on: bool = False
    visualize: bool = False
    topic: str | None = None
    cameras: tuple[CameraIntrinsics, ...] = ()
    collisions: tuple[str, ...] = ()
    """The collision names of a contact sensor, as written."""
    plugins: tuple[PluginTag, ...] = ()
    element: Element
    """The complete element, for parameters of rarer sensor types."""
    origin: Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class Light:
    name: str
    type: Literal["directional", "point", "spot"] = "directional"
    pose: Pose = Pose()
    diffuse: Rgba = (0.8, 0.8, 0.8, 1.0)
    specular: Rgba = (0.2, 0.2, 0.2, 1.0)
    direction: Vec3 = (-0.5, 0.1, -0.9)
    range: float = 10.0
    attenuation: Vec3 = (1.0, 0.0, 0.0)
    """Constant, linear, quadratic."""
    spot_angle: float = 1.0
    """Outer angle, rad."""
    spot_inner: float = 0.0
    """Angle of full brightness, rad."""
    spot_falloff: float = 0.0
    """Exponent of the decrease in brightness from the inner to the outer angle; 0 for none."""
    intensity: float = 1.0
    """Factor on `diffuse`."""
    on: bool = True
    cast_shadows: bool = True
    origin: Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class Link:
    name: str
    pose: Pose = Pose()
    """Pose in the model at zero joint positions."""
    inertial: Inertial | None = None
    visuals: tuple[Visual, ...] = ()
    collisions: tuple[Collision, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    lights: tuple[Light, ...] = ()
    gravity: bool = True
    self_collide: bool | None = None
    kinematic: bool = False
    wind: bool = False
    """Whether wind acts on it, if a plugin of the world simulates wind."""
    linear_damping: float = 0.0
    angular_damping: float = 0.0
    """Fraction of the velocity removed per Gazebo time step, as in SDF's ``<velocity_decay>``."""
    origin: Origin

    @property
    def mass_centre(self) -> Vec3:
        """Centre of mass in the link's frame, m; the origin of the frame without a mass."""
        return (0.0, 0.0, 0.0) if self.inertial is None else self.inertial.pose.position


@dataclass(frozen=True, kw_only=True, slots=True)
class Axis:
    xyz: Vec3 = (0.0, 0.0, 1.0)
    """Unit vector in the joint frame."""
    lower: float | None = None
    upper: float | None = None
    """rad or m; None is unlimited."""
    effort: float | None = None
    """N m or N; None is unlimited."""
    velocity: float | None = None
    """rad/s or m/s; None is unlimited."""
    damping: float = 0.0
    """N m s/rad or N s/m."""
    friction: float = 0.0
    """N m or N."""
    spring_stiffness: float = 0.0
    spring_reference: float = 0.0

    @property
    def locks(self) -> bool:
        """Whether its limits leave no range of motion."""
        return self.lower is not None and self.lower == self.upper


@dataclass(frozen=True, kw_only=True, slots=True)
class Mimic:
    joint: str
    multiplier: float = 1.0
    offset: float = 0.0
    mutual: bool = False
    """Whether both joints hold each other, as with a gear: also at the limits of the follower."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SoftLimits:
    """A ``<safety_controller>``: limits that ros_control enforces."""

    lower: float = 0.0
    upper: float = 0.0
    """rad or m."""
    k_position: float = 0.0
    """1/s: maximum speed toward a limit per distance from the limit."""
    k_velocity: float = 0.0
    """N m s/rad or N s/m: maximum effort per velocity beyond the limit."""


_MANY = 120 * math.pi
"""rad; a wheel whose joint has such limits on both sides rolls freely for sixty turns. Limits of up
to 360 are probably degrees."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Joint:
    name: str
    type: JointType
    parent: str
    """A link or ``world``."""
    child: str
    pose: Pose = Pose()
    """The joint frame in the child link; identity for a URDF."""
    axis: Axis = Axis()
    axis2: Axis | None = None
    mimic: Mimic | None = None
    soft: SoftLimits | None = None
    thread_pitch: float | None = None
    """Metres along the axis per turn of a screw, positive for a right-handed one."""
    stop_cfm: float | None = None
    stop_erp: float | None = None
    provide_feedback: bool = False
    preserve_fixed: bool = False
    implicit_spring_damper: bool = False
    origin: Origin

    @property
    def drivable(self) -> bool:
        """Whether it has one degree of freedom that can be driven and measured; false for balls and
        screws.
        """
        return self.type in ("revolute", "continuous", "prismatic")

    @property
    def has_first_axis(self) -> bool:
        """Whether plugins can drive and measure its axis, or the first axis of a universal joint,
        as in Gazebo.
        """
        return self.drivable or self.type == "universal"

    @property
    def turns(self) -> bool:
        """Whether it turns like a wheel: without limits, or with limits many turns away."""
        if self.type == "continuous":
            return True
        lower, upper = self.axis.lower, self.axis.upper
        return self.type == "revolute" and (
            (lower is None and upper is None)
            or (lower is not None and upper is not None and lower <= -_MANY <= _MANY <= upper)
        )

    @property
    def resists(self) -> bool:
        """Whether its first axis has limits, damping, friction or a spring."""
        axis = self.axis
        limited = axis.lower is not None or axis.upper is not None
        return limited or any((axis.damping, axis.friction, axis.spring_stiffness))


@dataclass(frozen=True, kw_only=True, slots=True)
class RobotDescription:
    """A model: a robot or an object in the world."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...] = ()
    plugins: tuple[PluginTag, ...] = ()
    static: bool = False
    self_collide: bool = False
    pose: Pose = Pose()
    """Pose in the world, as stated in its file."""
    joint_positions: tuple[tuple[str, float], ...] = ()
    """Initial positions in rad or m; other joints start at 0."""
    canonical_link: str
    """The link whose frame is the model's frame in Gazebo: the root link of a URDF."""
    transmissions: tuple[Element, ...] = ()
    ros2_control: tuple[Element, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
    text: str = ""
    """The expanded XML, as in the ROS parameter robot_description."""
    arguments: Mapping[str, str] = field(default_factory=dict, compare=False)
    """The xacro's arguments by name, including defaults."""
    simulator: Simulator = ""
    """The Gazebo in which the launch files of the author start it; empty if it is unknown."""
    unlaunched: frozenset[str] = frozenset()
    """File names of its plugins that it has not with the arguments of these launch files."""
    origin: Origin

    def link(self, name: str) -> Link | None:
        """The link with this name."""
        return next((link for link in self.links if link.name == name), None)

    def joint(self, name: str) -> Joint | None:
        """The joint with this name."""
        return next((joint for joint in self.joints if joint.name == name), None)

    @property
    def all_plugins(self) -> tuple[PluginTag, ...]:
        """The plugins of the model, then those in its sensors."""
        sensors = (sensor for link in self.links for sensor in link.sensors)
        return (*self.plugins, *(tag for sensor in sensors for tag in sensor.plugins))

    @property
    def canonical_pose(self) -> Pose:
        """Pose of the canonical link in the model's frame; identity for a URDF."""
        link = self.link(self.canonical_link)
        return link.pose if link is not None else Pose()

    @property
    def mass(self) -> float:
        """Total mass of all links, kg."""
        return sum(link.inertial.mass for link in self.links if link.inertial)

    @property
    def is_free(self) -> bool:
        """Whether the model can move as a whole: it has mass, and is not static or fixed to the
        world.
        """
        fixed = any(joint.child == self.canonical_link for joint in self.joints)
        known = self.link(self.canonical_link) is not None
        return known and not (self.static or fixed) and self.mass > 0

    @property
    def parts(self) -> str:
        """The number of links and joints, in words."""
        counts = (len(self.links), "link"), (len(self.joints), "joint")
        return ", ".join(f"{n} {noun}{'' if n == 1 else 's'}" for n, noun in counts)


@dataclass(frozen=True, kw_only=True, slots=True)
class Physics:
    max_step_size: float | None = None
    """s; None if the world does not state it."""
    real_time_factor: float | None = None
    real_time_update_rate: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class WorldDescription:
    name: str
    models: tuple[RobotDescription, ...] = ()
    lights: tuple[Light, ...] = ()
    joints: tuple[Joint, ...] = ()
    """Joints between links of different models, as ``model::link``."""
    places: tuple[tuple[str, Pose], ...] = ()
    """The world's own ``<frame>`` elements by name that are not attached to a model."""
    gravity: Vec3 = (0.0, 0.0, -9.8)
    wind: Vec3 = (0.0, 0.0, 0.0)
    """Velocity of the wind, m/s, for plugins that simulate it."""
    magnetic_field: Vec3 = (6e-06, 2.3e-05, -4.2e-05)
    """T, east-north-up, Gazebo's default."""
    ambient: Rgba = (0.4, 0.4, 0.4, 1.0)
    background: Rgba = (0.7, 0.7, 0.7, 1.0)
    shadows: bool = True
    physics: Physics = Physics()
    plugins: tuple[PluginTag, ...] = ()
    spherical_coordinates: Element | None = None
    diagnostics: tuple[Diagnostic, ...] = ()
    origin: Origin = field(default_factory=lambda: Origin(file="<empty>"))
