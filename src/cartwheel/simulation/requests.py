"""A plugin's requests for joints, links, cameras and other parts of its model."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from cartwheel.codes import devices, running, world
from cartwheel.description.model import CameraIntrinsics, RobotDescription
from cartwheel.errors import (
    Diagnostic,
    Origin,
    PluginError,
    StaticModelError,
    UnknownNameError,
)
from cartwheel.geometry import Array, Pose
from cartwheel.simulation.clock import Task, Topic, always
from cartwheel.simulation.dynamics.external_servos import WrenchHandle
from cartwheel.simulation.dynamics.fixed_joints import AttachmentHandle, SurroundingsHandle
from cartwheel.simulation.dynamics.wheel_slip import SlipHandle
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.handles import (
    CameraHandle,
    Handle,
    JointHandle,
    JointsHandle,
    LinkHandle,
)
from cartwheel.simulation.sensing.rays import RayHandle
from cartwheel.world.additions import Addition
from cartwheel.world.build import DEFAULT_STEP
from cartwheel.world.entry import CameraMount, Grip, ModelEntry, scoped
from cartwheel.world.tyres import axle_of


class Requests:
    """Creates handles, which are bound to the compiled model, and adds cameras and others to it.

    Args:
        engine: The engine that simulates the model.
        entry: The model, to which motors, cameras and attachments are added.
    """

    def __init__(self, engine: Engine, entry: ModelEntry) -> None:
        self._engine = engine
        self._entry = entry
        self.handles: list[Handle | RayHandle] = []
        self.tasks: list[Task] = []
        self.diagnostics: list[Diagnostic] = []
        """Diagnostics from before the model was spawned."""
        self.spawned = False

    @property
    def name(self) -> str:
        """The model's name in this world."""
        return self._entry.name

    @property
    def start(self) -> Pose:
        """Spawn pose of the model's frame in the world."""
        return self._entry.pose

    @property
    def description(self) -> RobotDescription:
        return self._entry.description

    def adds(self, addition: Addition) -> bool:
        """Whether physics that the description does not state may be added to the model."""
        return addition not in self._engine.without

    def schedule(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None = None,
        after: Callable[[], None] | None = None,
        active: Callable[[], bool] = always,
        topics: Collection[Topic] | None = None,
        idle: Callable[[], bool] | None = None,
    ) -> Task:
        """Schedules callbacks at a rate in Hz; 0 is every step. See `Task`."""
        task = self._engine.task(
            rate, before=before, after=after, active=active, topics=topics, idle=idle
        )
        self.tasks.append(task)
        return task

    def limit_step(self, seconds: float, why: str, *, origin: Origin | None = None) -> None:
        """Requests a time step of at most `seconds` in a world that states none.

        Args:
            seconds: Longest step, s.
            why: What needs it, as the subject of a message.
            origin: Origin of the request.
        """
        if self._engine.world.physics.max_step_size or seconds >= DEFAULT_STEP:
            return
        self._entry.longest_step = min(self._entry.longest_step, seconds)
        self.report(
            world.STEP_SHORTENED.diagnostic(
                f"{why} needs a time step of {1000 * seconds:g} ms, so it is used instead of the "
                f"default of {1000 * DEFAULT_STEP:g} ms",
                origin=origin,
                values={"model": self.name, "step": seconds},
            )
        )

    def report(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic about this model, at startup or at run time."""
        if self.spawned:
            self._engine.report(diagnostic)
        else:
            self.diagnostics.append(diagnostic)

    def link(self, name: str, *, origin: Origin | None = None) -> LinkHandle:
        """A handle to a link of this model.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
        """
        _require_name(name, "link")
        if self.description.link(name) is None:
            raise UnknownNameError(
                "link",
                name,
                [link.name for link in self.description.links],
                code=running.UNKNOWN_LINK,
                origin=origin,
            )
        handle = LinkHandle(self.name, name)
        self.handles.append(handle)
        return handle

    def joint(self, name: str, *, origin: Origin | None = None) -> JointHandle:
        """A handle to a movable joint of this model, or to the first axis of a universal joint.

        Raises:
            UnknownNameError: The joint does not exist; the error has this `origin`.
            StaticModelError: The model is static.
        """
        _require_name(name, "joint")
        movable = [joint.name for joint in self.description.joints if joint.has_first_axis]
        if self.description.static:
            raise StaticModelError(
                f'model "{self.name}" is static, so its joints do not move',
                code=running.STATIC_MODEL_DRIVEN,
                origin=origin,
                values={"model": self.name, "joint": name},
            )
        if name not in movable:
            kind = next((each.type for each in self.description.joints if each.name == name), "")
            other = f'joint "{name}" has the type {kind}, so it cannot be driven' if kind else ""
            raise UnknownNameError(
                "movable joint",
                name,
                movable,
                code=devices.PLUGIN_JOINT_UNKNOWN,
                origin=origin,
                message=other,
            )
        handle = JointHandle(self.name, name)
        self.handles.append(handle)
        return handle

    def together(self, joints: Sequence[JointHandle]) -> JointsHandle:
        """A handle to several joints of this model that are read together."""
        handle = JointsHandle(joints)
        self.handles.append(handle)
        return handle

    def wrench(self, link: str, *, origin: Origin | None = None) -> WrenchHandle:
        """A wrench on a link.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
        """
        self.link(link, origin=origin)
        handle = WrenchHandle(self.name, link)
        self.handles.append(handle)
        return handle

    def feel(self, link: str) -> None:
        """Keeps bodies in contact with the link awake, because sleeping bodies exert no force."""
        self._entry.felt.append(link)

    def grip(self, link: str, grip: Grip, *, origin: Origin | None = None) -> None:
        """Gives a link a friction in place of that in its description.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
        """
        self.link(link, origin=origin)
        self._entry.grips[link] = grip

    def slip(self, link: str, *, radius: float, origin: Origin | None = None) -> SlipHandle:
        """A wheel's slip on the ground.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
            PluginError: The link is not a wheel, or another plugin already sets its slip.
        """
        self.link(link, origin=origin)
        joint = next((each for each in self.description.joints if each.child == link), None)
        if axle_of(joint) is None:
            raise PluginError(
                f'link "{link}" is not a wheel because no continuous joint turns it',
                code=running.NOT_A_WHEEL,
                origin=origin,
                values={"link": link},
            )
        if link in self._entry.slips:
            raise PluginError(
                f'two plugins set the slip of link "{link}"',
                code=running.JOINT_DRIVEN_TWICE,
                origin=origin,
                values={"link": link},
            )
        self._entry.slips[link] = radius
        handle = SlipHandle(self.name, link, radius)
        self.handles.append(handle)
        return handle

    def attachment(self) -> AttachmentHandle:
        """A fixed joint between links of any models, which can be added and removed at any time."""
        name = scoped(self.name, "attachment", str(len(self._entry.attachments)))
        self._entry.attachments.append(name)
        handle = AttachmentHandle(name)
        self.handles.append(handle)
        if self.spawned:
            for callback in self._engine.on_entries:
                callback()
        return handle

    def surroundings(self) -> SurroundingsHandle:
        """All links in the world, including those of other models."""
        handle = SurroundingsHandle()
        self.handles.append(handle)
        return handle

    def camera(
        self, name: str, link: str, pose: Pose, intrinsics: CameraIntrinsics
    ) -> CameraHandle:
        """A camera on a link, looking along the x axis of `pose`."""
        taken = {mount.name for mount in self._entry.cameras}
        unique = name
        count = 1
        while unique in taken:
            count += 1
            unique = f"{name}_{count}"
        self._entry.cameras.append(
            CameraMount(name=unique, link=link, pose=pose, intrinsics=intrinsics)
        )
        handle = CameraHandle(self.name, unique, intrinsics)
        self.handles.append(handle)
        return handle

    def rays(
        self, link: str, pose: Pose, directions: Array, *, minimum: float, maximum: float,
        visuals: bool = False,
    ) -> RayHandle:  # fmt: skip
        """Rays from a link into the world, which hit visuals or collisions; see `RayHandle`."""
        engine = self._engine
        if (missing := engine.ray_scenes.missing()) is not None:
            self.report(missing)
        handle = RayHandle(
            self.name, link, pose, directions, minimum=minimum, maximum=maximum,
            scenes=engine.ray_scenes, visuals=engine.visuals if visuals else None,
        )  # fmt: skip
        self.handles.append(handle)
        return handle


def _require_name(name: object, what: str) -> None:
    if not isinstance(name, str):
        raise TypeError(f"a {what} is given by its name, such as {what}.name (got {name!r:.60})")
