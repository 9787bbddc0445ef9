"""Adds what plugins requested of a model: motors, drives, cameras and mimicked joints."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from cartwheel.description.model import Joint
from cartwheel.geometry import Pose, quat_from_matrix
from cartwheel.world import joints
from cartwheel.world.entry import (
    DRIVE_AXES,
    ROTOR,
    BodyDrive,
    CameraMount,
    ModelEntry,
    Motor,
    scoped,
)
from cartwheel.world.mimics import add_mimics
from cartwheel.world.shapes import pose_arguments

_CAMERA_AXES = np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]])
"""Columns: MuJoCo's camera axes (right, up, back) in a sensor frame that looks along x."""
ROTOR_INERTIA = 1e6
"""kg m²; large enough that no load slows a rotor."""
_STRONGEST = 1e6
"""N m or N; limit of a motor without a stated limit."""
_SLIP = 0.002
"""m/s; maximum slip between a rim and its rotor under the weight of the whole model."""
_GRAVITY = 9.8
"""m/s²."""
_WORLD_SITE = "world::site"


def add_requested(spec: mujoco.MjSpec, entry: ModelEntry, bodies: dict[str, Any]) -> None:
    """Adds a model's motors, drives and cameras, and couples the joints that mimic others.

    Args:
        spec: Contains the model's bodies.
        entry: The model with its requests.
        bodies: The model's bodies by link name.
    """
    add_mimics(spec, entry)
    for motor in entry.motors.values():
        _add_motor(spec, entry, motor)
    for drive in entry.drives:
        _add_drive(spec, entry, bodies[drive.link], drive)
    for camera in entry.cameras:
        _add_camera(entry, bodies[camera.link], camera)


def _add_motor(spec: mujoco.MjSpec, entry: ModelEntry, motor: Motor) -> None:
    name = scoped(entry.name, motor.joint)
    if motor.mode != "velocity":
        arguments: dict[str, Any] = {}
        if motor.max_effort is not None:
            arguments = {"forcelimited": True, "forcerange": [-motor.max_effort, motor.max_effort]}
        actuator = spec.add_actuator(
            name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, **arguments
        )
        actuator.set_to_motor()
        # The damping is set at run time.
        actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    _add_rotor(spec, entry, motor)


def rotor_strength(motor: Motor, joint: Joint | None) -> float:
    """Maximum effort with which a motor holds a velocity or position, N m or N.

    Args:
        motor: The motor.
        joint: Its joint.
    """
    limits = [] if motor.max_effort is None else [motor.max_effort]
    stated = None if joint is None or motor.beyond else joint.axis.effort
    if stated is not None and stated > 0:
        limits.append(stated)
    return min(limits, default=_STRONGEST)


def _add_rotor(spec: mujoco.MjSpec, entry: ModelEntry, motor: Motor) -> None:
    """Adds a rotor that turns at a motor's velocity and drags the joint by dry friction."""
    name = scoped(entry.name, motor.joint, ROTOR)
    body = spec.worldbody.add_body(name=name)
    body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
    body.explicitinertial = True
    body.mass = 1.0
    body.inertia = [ROTOR_INERTIA] * 3
    body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    coupling = spec.add_tendon(
        name=name,
        frictionloss=rotor_strength(motor, entry.description.joint(motor.joint)),
        solref_friction=list(joints.STIFF_REFERENCE),
        solimp_friction=list(joints.STIFF_IMPEDANCE),
    )
    coupling.wrap_joint(scoped(entry.name, motor.joint), 1.0)
    coupling.wrap_joint(name, -1.0)


def stiffen_rotors(model: mujoco.MjModel) -> None:
    """Limits the slip of motors whose joints move links with very small inertias.

    The engine softens a constraint in proportion to its inverse inertia. A wheel with a stated
    inertia of 1e-4 kg m² under a robot of 300 kg would turn 30 % more slowly than its rotor. The
    inverse inertia of such a constraint is therefore replaced by a smaller one. The masses and the
    constraints of all other motors do not change.

    Args:
        model: A compiled model, or one whose constants have just been computed.
    """
    impedance = joints.STIFF_IMPEDANCE[0]
    softness = (1.0 - impedance) / impedance
    rate = 2.0 / (impedance * max(joints.STIFF_REFERENCE[0], 2.0 * model.opt.timestep))
    # Links that are fixed to each other have one number.
    rigid = model.body_weldid
    shapes = rigid[model.geom_bodyid]
    for tendon in range(model.ntendon):
        first = model.tendon_adr[tendon]
        joint, rotor = (int(each) for each in model.wrap_objid[first : first + 2])
        if model.dof_M0[model.jnt_dofadr[rotor]] < ROTOR_INERTIA / 2:
            continue
        body = model.jnt_bodyid[joint]
        weight = model.body_subtreemass[model.body_rootid[body]] * _GRAVITY
        lever = 1.0
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
            lever = model.geom_rbound[shapes == rigid[body]].max(initial=0.0)
        load = min(model.tendon_frictionloss[tendon], weight * lever)
        if load > 0:
            most = _SLIP / lever * rate / (softness * load)
            model.tendon_invweight0[tendon] = min(model.tendon_invweight0[tendon], most)


def _add_drive(spec: mujoco.MjSpec, entry: ModelEntry, body: Any, drive: BodyDrive) -> None:
    name = scoped(entry.name, drive.link, drive.name)
    body.add_site(name=name, pos=list(drive.centre))
    if not any(site.name == _WORLD_SITE for site in spec.worldbody.sites):
        spec.worldbody.add_site(name=_WORLD_SITE)
    for index, axis in enumerate(DRIVE_AXES):
        gear = [0.0] * 6
        gear[index] = 1.0
        # Relative to the world's site, the actuators measure and act in world axes.
        spec.add_actuator(
            name=scoped(name, axis),
            target=name,
            refsite=_WORLD_SITE,
            trntype=mujoco.mjtTrn.mjTRN_SITE,
            gear=gear,
        ).set_to_velocity(kv=0.0)


def _add_camera(entry: ModelEntry, body: Any, camera: CameraMount) -> None:
    lens = camera.intrinsics
    turned = camera.pose @ Pose((0, 0, 0), quat_from_matrix(_CAMERA_AXES))
    fovy = 2 * np.arctan(np.tan(lens.horizontal_fov / 2) * lens.height / lens.width)
    body.add_camera(
        name=scoped(entry.name, camera.name),
        fovy=float(np.degrees(fovy)),
        **pose_arguments(turned),
    )
