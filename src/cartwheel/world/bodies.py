"""A model's links and joints as MuJoCo bodies."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from cartwheel.description import meshes
from cartwheel.description.model import (
    Inertial,
    Joint,
    Link,
    Mesh,
    Plane,
    RobotDescription,
    Visual,
)
from cartwheel.errors import WorldError
from cartwheel.geometry import (
    IDENTITY,
    Array,
    Pose,
    matrix_from_quat,
    quat_between,
    quat_from_matrix,
    rotate,
    to_wxyz,
)
from cartwheel.world import contact
from cartwheel.world.entry import CameraMount, ModelEntry, Motor, scoped
from cartwheel.world.shapes import Assets, place, pose_arguments

VISUAL_GROUP = 1
COLLISION_GROUP = 4
_GREY = (0.7, 0.7, 0.7, 1.0)
_CAMERA_AXES = np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]])
"""Columns: MuJoCo's camera axes (right, up, back) in a sensor frame that looks along x."""
_BRAKE_REFERENCE = (0.01, 1.0)
_BRAKE_IMPEDANCE = (0.9999, 0.9999, 0.001, 0.5, 2.0)
_VELOCITY_ERROR = 0.05
"""rad/s or m/s at which a velocity servo gives all of its effort."""


class BodyBuilder:
    """Adds one model to a spec."""

    def __init__(self, spec: mujoco.MjSpec, assets: Assets, step: float) -> None:
        self._spec = spec
        self._assets = assets
        self._step = step
        self.surfaces: list[contact.BuiltSurface] = []
        """Every colliding geom, with what decides how it touches others."""

    def add(self, entry: ModelEntry) -> None:
        """Adds the entry's bodies, joints, geoms, motors and cameras.

        Raises:
            WorldError: The description cannot be built, with the place in its file.
        """
        description = entry.description
        inbound: dict[str, Joint] = {}
        loops: list[Joint] = []
        for joint in description.joints:
            if joint.child in inbound:
                loops.append(joint)
            else:
                inbound[joint.child] = joint
        children: dict[str, list[Joint]] = {}
        for joint in inbound.values():
            children.setdefault(joint.parent, []).append(joint)
        bodies: dict[str, Any] = {}
        links = {link.name: link for link in description.links}
        senses = bool(description.plugins) or any(link.sensors for link in description.links)

        def grow(link: Link, parent: Any, pose: Pose, joint: Joint | None, moves: bool) -> None:
            body = parent.add_body(name=scoped(entry.name, link.name), **pose_arguments(pose))
            bodies[link.name] = body
            roots = moves and joint is None
            if joint is not None and not description.static:
                self._add_joint(entry, body, joint)
                roots = not moves and joint.type != "fixed"
                moves = moves or roots
            if roots and senses:
                # A body asleep has no accelerations and no contacts to be read.
                body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
            self._fill(entry, body, link, joint, moves=moves)
            for next_joint in children.get(link.name, ()):
                child = links[next_joint.child]
                grow(child, body, link.pose.inverse() @ child.pose, next_joint, moves)

        for link in description.links:
            if link.name in inbound and inbound[link.name].parent != "world":
                continue
            anchor = inbound.get(link.name)
            free = anchor is None and not description.static and not link.kinematic
            grow(link, self._spec.worldbody, entry.pose @ link.pose, anchor, free)
            if free:
                bodies[link.name].add_freejoint(name=scoped(entry.name, link.name))
        lost = [link for link in description.links if link.name not in bodies]
        if lost:
            raise WorldError(
                f'link "{lost[0].name}" hangs on a loop of joints and on nothing else',
                origin=lost[0].origin,
            )
        for joint in loops:
            self._close_loop(entry, joint)
        self._exclude(entry, description)
        self._add_mimics(entry)
        for motor in entry.motors.values():
            self._add_motor(entry, motor)
        for camera in entry.cameras:
            self._add_camera(entry, bodies[camera.link], camera)

    def _fill(
        self, entry: ModelEntry, body: Any, link: Link, joint: Joint | None, *, moves: bool
    ) -> None:
        if link.inertial is not None:
            _set_inertial(body, link.inertial)
        if not link.gravity:
            body.gravcomp = 1.0
        for visual in link.visuals:
            self._add_visual(body, visual)
        for collision in link.collisions:
            name = scoped(entry.name, link.name, collision.name)
            shape = contact.tyre(collision, joint)
            if isinstance(shape, Plane) and not entry.description.static:
                raise WorldError(
                    f'collision "{collision.name}": an endless plane must be static',
                    origin=collision.origin,
                    hint="Use a flat box instead, or <static>true</static>.",
                )
            arguments, pose = place(shape, collision.pose, collision.origin, self._assets)
            friction = contact.friction(collision.surface)
            reference = contact.reference(collision.surface, entry.description.mass, self._step)
            geom = body.add_geom(
                name=name,
                group=COLLISION_GROUP,
                density=0,
                condim=3,
                friction=list(friction),
                solref=list(reference),
                solimp=list(contact.IMPEDANCE),
                **arguments,
                **pose_arguments(pose),
            )
            self.surfaces.append(
                contact.BuiltSurface(
                    geom=geom,
                    name=name,
                    model=entry.name,
                    moves=moves,
                    rolls=joint is not None and joint.type == "continuous",
                    friction=friction,
                    reference=reference,
                )
            )

    def _add_visual(self, body: Any, visual: Visual) -> None:
        common: dict[str, Any] = {
            "group": VISUAL_GROUP,
            "contype": 0,
            "conaffinity": 0,
            "density": 0,
        }
        material = visual.material
        opacity = 1.0 - visual.transparency
        shape = visual.shape
        if isinstance(shape, Mesh):
            for index, part in enumerate(meshes.load_mesh(shape)):
                mesh = self._assets.mesh(
                    ("visual", shape, index), part.vertices, part.faces, uv=part.uv
                )
                texture = material.texture or (
                    part.texture if material.diffuse is None or material.yields_to_mesh else None
                )
                rgba = material.colour_of(part.rgba) or _GREY
                look: dict[str, Any] = {"rgba": [*rgba[:3], rgba[3] * opacity]}
                if texture is not None and part.uv is not None:
                    look = {"material": self._assets.texture_material(texture)}
                body.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_MESH,
                    meshname=mesh,
                    **look,
                    **common,
                    **pose_arguments(visual.pose),
                )
            return
        rgba = material.diffuse or _GREY
        look = {"rgba": [*rgba[:3], rgba[3] * opacity]}
        if material.texture is not None:
            look = {"material": self._assets.texture_material(material.texture)}
        arguments, pose = place(shape, visual.pose, visual.origin, self._assets)
        body.add_geom(**arguments, **look, **common, **pose_arguments(pose))

    def _add_joint(self, entry: ModelEntry, body: Any, joint: Joint) -> None:
        name = scoped(entry.name, joint.name)
        kind = mujoco.mjtJoint
        axis = list(rotate(joint.pose.orientation, joint.axis.xyz))
        pos = list(joint.pose.position)
        match joint.type:
            case "fixed":
                return
            case "revolute" | "continuous" | "prismatic":
                hinge = joint.type != "prismatic"
                made = body.add_joint(
                    name=name,
                    type=kind.mjJNT_HINGE if hinge else kind.mjJNT_SLIDE,
                    axis=axis,
                    pos=pos,
                )
                _set_axis(made, joint, first=True)
            case "ball":
                body.add_joint(name=name, type=kind.mjJNT_BALL, pos=pos)
            case "universal":
                made = body.add_joint(name=name, type=kind.mjJNT_HINGE, axis=axis, pos=pos)
                _set_axis(made, joint, first=True)
                second = joint.axis2.xyz if joint.axis2 else (1.0, 0.0, 0.0)
                made = body.add_joint(
                    name=f"{name}::axis2",
                    type=kind.mjJNT_HINGE,
                    axis=list(rotate(joint.pose.orientation, second)),
                    pos=pos,
                )
                _set_axis(made, joint, first=False)
            case "planar":
                across = matrix_from_quat(quat_between((0.0, 0.0, 1.0), axis))
                for index in range(2):
                    self._slide(body, f"{name}::{'xy'[index]}", across[:, index])
                body.add_joint(name=name, type=kind.mjJNT_HINGE, axis=axis, pos=pos)
            case "floating":
                for index in range(3):
                    self._slide(body, f"{name}::{'xyz'[index]}", np.eye(3)[index])
                body.add_joint(name=name, type=kind.mjJNT_BALL)
            case _:
                raise WorldError(
                    f'joint "{joint.name}": a {joint.type} joint is not supported yet',
                    origin=joint.origin,
                )

    @staticmethod
    def _slide(body: Any, name: str, axis: Array) -> None:
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis.tolist())

    def _close_loop(self, entry: ModelEntry, joint: Joint) -> None:
        equality = mujoco.mjtEq
        rigid = joint.type == "fixed"
        self._spec.add_equality(
            name=scoped(entry.name, joint.name),
            type=equality.mjEQ_WELD if rigid else equality.mjEQ_CONNECT,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            name1=scoped(entry.name, joint.child),
            name2=scoped(entry.name, joint.parent),
            data=[*joint.pose.position, *([0.0] * 8)],
        )

    def _exclude(self, entry: ModelEntry, description: RobotDescription) -> None:
        """Links of one model collide only where both ask for it, as in Gazebo."""
        if description.static:
            return
        solid = [link for link in description.links if link.collisions]

        def collides(link: Link) -> bool:
            return description.self_collide if link.self_collide is None else link.self_collide

        for i, first in enumerate(solid):
            for second in solid[i + 1 :]:
                if not (collides(first) and collides(second)):
                    self._spec.add_exclude(
                        bodyname1=scoped(entry.name, first.name),
                        bodyname2=scoped(entry.name, second.name),
                    )

    def _add_mimics(self, entry: ModelEntry) -> None:
        for joint in entry.description.joints:
            if joint.mimic is not None and joint.type != "fixed" and not entry.description.static:
                self._spec.add_equality(
                    name=scoped(entry.name, joint.name, "mimic"),
                    type=mujoco.mjtEq.mjEQ_JOINT,
                    objtype=mujoco.mjtObj.mjOBJ_JOINT,
                    name1=scoped(entry.name, joint.name),
                    name2=scoped(entry.name, joint.mimic.joint),
                    data=[joint.mimic.offset, joint.mimic.multiplier, *([0.0] * 9)],
                )

    def _add_motor(self, entry: ModelEntry, motor: Motor) -> None:
        name = scoped(entry.name, motor.joint)
        arguments: dict[str, Any] = {}
        if motor.max_effort is not None:
            arguments = {"forcelimited": True, "forcerange": [-motor.max_effort, motor.max_effort]}
        actuator = self._spec.add_actuator(
            name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, **arguments
        )
        if motor.mode == "velocity":
            # The gain only sets how small an error draws the full effort: with the implicit
            # integrator a stiff servo is stable at any step.
            gain = (motor.max_effort or 1000.0) / _VELOCITY_ERROR
            actuator.set_to_velocity(kv=gain)
            # As a brake it lets a load slip by nothing that could be seen.
            joint = self._spec.joint(name)
            joint.solref_friction = list(_BRAKE_REFERENCE)
            joint.solimp_friction = list(_BRAKE_IMPEDANCE)
        else:
            actuator.set_to_motor()

    def _add_camera(self, entry: ModelEntry, body: Any, camera: CameraMount) -> None:
        lens = camera.intrinsics
        turned = camera.pose @ Pose((0, 0, 0), quat_from_matrix(_CAMERA_AXES))
        fovy = 2 * np.arctan(np.tan(lens.horizontal_fov / 2) * lens.height / lens.width)
        body.add_camera(
            name=scoped(entry.name, camera.name),
            fovy=float(np.degrees(fovy)),
            **pose_arguments(turned),
        )


def _set_axis(made: Any, joint: Joint, *, first: bool) -> None:
    axis = joint.axis if first or joint.axis2 is None else joint.axis2
    made.damping = [axis.damping, 0, 0]
    made.frictionloss = axis.friction
    if axis.spring_stiffness:
        made.stiffness = [axis.spring_stiffness, 0, 0]
        made.springref = axis.spring_reference
    if joint.type != "continuous" and (axis.lower is not None or axis.upper is not None):
        lower = -1e10 if axis.lower is None else axis.lower
        upper = 1e10 if axis.upper is None else axis.upper
        if lower < upper:
            made.limited = mujoco.mjtLimited.mjLIMITED_TRUE
            made.range = [lower, upper]
    if axis.effort is not None and axis.effort > 0:
        made.actfrclimited = mujoco.mjtLimited.mjLIMITED_TRUE
        made.actfrcrange = [-axis.effort, axis.effort]


def _set_inertial(body: Any, inertial: Inertial) -> None:
    rotation = matrix_from_quat(inertial.pose.orientation)
    tensor = np.array(
        [
            [inertial.ixx, inertial.ixy, inertial.ixz],
            [inertial.ixy, inertial.iyy, inertial.iyz],
            [inertial.ixz, inertial.iyz, inertial.izz],
        ]
    )
    turned = rotation @ tensor @ rotation.T
    body.explicitinertial = True
    body.mass = inertial.mass
    body.ipos = list(inertial.pose.position)
    body.iquat = list(to_wxyz(IDENTITY))
    body.fullinertia = [
        turned[0, 0],
        turned[1, 1],
        turned[2, 2],
        turned[0, 1],
        turned[0, 2],
        turned[1, 2],
    ]
