"""Spawns and deletes models, and adds and removes lights."""

from __future__ import annotations

import dataclasses
import re
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NotYet
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import unquote

from cartwheel.codes.graph import ENTITY_NAME_TAKEN, GRAPH_CLOSED, SPAWN_INVALID
from cartwheel.description import load, load_plain
from cartwheel.description.files.named_files import find_description
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.readable_files import Reach
from cartwheel.description.model import Light, RobotDescription, WorldDescription
from cartwheel.errors import CartwheelError, DescriptionError, WorldError
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.requests import Answer, Offer, pose
from cartwheel.geometry import Pose
from cartwheel.session import Session
from cartwheel.simulation import RunState
from cartwheel.simulation.limits import number
from cartwheel.simulation.models.unique_names import free_name

T = TypeVar("T")
_ASIDE = r"(?:\s|<\?(?:(?!\?>).)*\?>|<!--(?:(?!-->).)*-->)*"
_LIGHT = re.compile(
    rf"({_ASIDE}<sdf\b[^>]*>)({_ASIDE}<light\b.*</light>{_ASIDE})(</sdf>{_ASIDE})\Z", re.DOTALL
)
"""A document with a single light: its head, the light, and its end."""
_LOOK = 0.2
"""Interval of the checks whether an unresponsive simulation has ended, s."""


class Spawning:
    """The services that spawn and delete models.

    Source: gazebo_ros, gazebo_ros_api_plugin. The root element determines the format, in both spawn
    services.
    """

    def __init__(self, session: Session, entities: Entities, package_path: Sequence[Path]) -> None:
        self._session = session
        self._simulation = session.simulation
        self._entities = entities
        self.package_path = tuple(package_path)
        self.reach = Reach(folders=session.allow_path)

    def offers(self) -> list[Offer]:
        """The services."""
        spawn, kind = self.spawn_model, "gazebo_msgs/srv/SpawnModel"
        return [
            Offer("spawn_urdf_model", kind, spawn, threaded=True),
            Offer("spawn_sdf_model", kind, spawn, threaded=True),
            Offer("delete_model", "gazebo_msgs/srv/DeleteModel", self.delete_model),
            Offer("delete_light", "gazebo_msgs/srv/DeleteLight", self.delete_light),
        ]

    def spawn_model(self, request: Any) -> Answer:
        self.spawn_text(
            request.model_xml,
            name=request.model_name,
            where=pose(request.initial_pose, "initial_pose"),
            reference_frame=request.reference_frame,
            namespace=request.robot_namespace,
        )
        return Answer("SpawnModel: Successfully spawned entity")

    def spawn_text(
        self, text: str, *, name: str, where: Pose, reference_frame: str, namespace: str
    ) -> None:
        """Spawns the model or light in a text. Thread-safe.

        The text is parsed on the calling thread; only spawning runs on the owner's thread. See
        `spawn` for the arguments.
        """
        name = name.strip()
        found = self.read(name, text)
        if isinstance(found, Light):
            self.add_light(found, name, where, reference_frame)
        else:
            self.spawn(
                found,
                name=name,
                where=where,
                reference_frame=reference_frame,
                namespace=namespace,
            )

    def spawn(
        self,
        description: RobotDescription,
        *,
        name: str,
        where: Pose,
        reference_frame: str,
        namespace: str,
        rename: bool = False,
    ) -> str:
        """Spawns a model. Thread-safe.

        Args:
            description: The model's description.
            name: Name in this world; empty for the description's name.
            where: Pose in the reference frame.
            reference_frame: The world, a model or a link.
            namespace: Namespace of its topics and services.
            rename: Choose a free name if the name is in use.

        Returns:
            The name.

        Raises:
            CartwheelError: The model cannot be spawned; nothing has changed.
        """
        namespace = namespace.strip()
        prefix = self._session.graph.parameters.search("tf_prefix", namespace)
        frame_prefix = prefix if isinstance(prefix, str) else ""

        def spawn() -> str:
            taken = self._simulation.models
            wanted = name or description.name
            if wanted in taken:
                free = free_name(wanted, taken)
                if not rename:
                    raise WorldError(
                        f'Failure - model name "{wanted}" already exists',
                        code=ENTITY_NAME_TAKEN,
                        hint=f'Delete that model first, or choose another name, such as "{free}".',
                        values={"name": wanted, "free": free},
                    )
                wanted = free
            self._simulation.refresh()
            frame = self._entities.frame(reference_frame).pose
            placed = frame @ where @ description.pose
            for value in placed.position:
                number(value, "the pose in the world")
            return self._session.spawn(
                description,
                name=wanted,
                pose=placed,
                namespace=namespace,
                frame_prefix=frame_prefix,
            )

        return self.on_owner(spawn)

    def add_light(self, light: Light, name: str, where: Pose, reference: str) -> None:
        """Adds a light to the world. Thread-safe. See `spawn` for the arguments."""

        def add() -> None:
            wanted = name or light.name
            world = self._simulation.world
            if any(other.name == wanted for other in world.lights):
                raise WorldError(
                    f'Failure - light "{wanted}" already exists',
                    code=ENTITY_NAME_TAKEN,
                    hint="Delete that light first.",
                    values={"name": wanted},
                )
            self._simulation.refresh()
            placed = self._entities.frame(reference).pose @ where @ light.pose
            added = dataclasses.replace(light, name=wanted, pose=placed)
            self._simulation.change_world(dataclasses.replace(world, lights=(*world.lights, added)))

        self.on_owner(add)

    def read(self, name: str, text: str) -> RobotDescription | Light:
        """The model or light in a text.

        Raises:
            DescriptionError: The text is neither a model nor a light.
        """
        if not text.strip():
            raise DescriptionError("Failure - model_xml is empty", code=SPAWN_INVALID)
        alone = _LIGHT.match(text)
        if alone is not None:
            # SDF allows lights only in worlds and links. The line numbers stay the same.
            text = f'{alone[1]}<world name="of the light">{alone[2]}</world>{alone[3]}'
        found = load_plain(
            text,
            file=f"<model_xml of {name or 'the model'}>",
            package_path=self.package_path,
            reach=self.reach,
        )
        if isinstance(found, WorldDescription) and alone is not None and len(found.lights) == 1:
            return found.lights[0]
        if isinstance(found, WorldDescription):
            if len(found.models) == 1:
                # gazebo_ros's spawn_model converts -database to a world that includes the model.
                return found.models[0]
            raise DescriptionError(
                f'Failure - model_xml describes the world "{found.name}", not a model',
                code=SPAWN_INVALID,
                hint="Start the simulation with that world, and spawn models into it.",
                values={"world": found.name},
            )
        return found

    def load(self, uri: str) -> RobotDescription | WorldDescription:
        """The description in a file requested by a service.

        Raises:
            DescriptionError: The file is not a description, or is outside the allowed folders.
        """
        packages = Packages(None, self.package_path, reach=self.reach)
        named = Path(unquote(uri.removeprefix("file://")))
        # Check before accessing the file: its existence is not revealed without permission.
        if named.is_absolute() or uri.startswith("file:") or ".." in named.parts:
            packages.require(named, "the file")
        path = find_description(uri, self.package_path)
        packages.require(path, "the file")
        return load(path, package_path=self.package_path)

    def on_owner(self, function: Callable[[], T]) -> T:
        """Runs a function on the owner's thread and waits for it while there is an owner."""
        if threading.get_ident() == self._simulation.owner:
            return function()
        future: Future[T] = self._simulation.call(function)
        while True:
            try:
                return future.result(timeout=_LOOK)
            except NotYet:
                if future.done():
                    # The function itself may have raised this error.
                    return future.result()
                ended = self._simulation.run_state is RunState.STOPPED
                if ended and future.cancel():
                    raise CartwheelError("the simulation has ended", code=GRAPH_CLOSED) from None

    def delete_model(self, request: Any) -> Answer:
        self._simulation.delete(request.model_name)
        return Answer("DeleteModel: successfully deleted model")

    def remove_light(self, name: str) -> None:
        """Removes a light from the world.

        Raises:
            UnknownNameError: The light does not exist.
        """
        light = self._entities.light(name)
        world = self._simulation.world
        rest = tuple(other for other in world.lights if other is not light)
        self._simulation.change_world(dataclasses.replace(world, lights=rest))

    def delete_light(self, request: Any) -> Answer:
        self.remove_light(request.light_name)
        return Answer("DeleteLight: successfully deleted light")
