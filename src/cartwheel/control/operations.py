"""The requests that other processes can send to a running simulation.

All requests run on the connection's thread, which reads files and checks messages. Only changes to
the physics are passed to the simulation's thread.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from cartwheel.codes.command import (
    CONTROL_LIMIT,
    CONTROL_REQUEST_INVALID,
    NO_PAGE,
    SIMULATION_SILENT,
)
from cartwheel.control.faults import packed
from cartwheel.control.parameters import Parameters
from cartwheel.control.place import AXES, placed
from cartwheel.control.protocol import PATIENCE
from cartwheel.control.types import packed_types
from cartwheel.description.model import RobotDescription
from cartwheel.errors import ControlError, UnknownNameError
from cartwheel.graph import TopicInfo, resolve_name
from cartwheel.interfaces import RunningSession
from cartwheel.messages import decode_cdr, from_dict, service_classes, to_dict, type_name
from cartwheel.simulation import RunState

_MOST_WAITING = 1000
"""Maximum number of messages that wait for the simulation."""

T = TypeVar("T")
Answer = dict[str, Any]
Load = Callable[..., RobotDescription]
"""Reads a file, with the keywords `arguments` and `package_path` of `load_robot`."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PageOffer:
    """A simulation's web viewer, for clients that request it. Callable from any thread except its
    own.
    """

    show: Callable[[], str]
    """Returns the viewer's URL, and starts it if necessary."""
    browsers: Callable[[], int]
    """The number of connected browsers."""


class Operations:
    """The requests by name. Each takes parameters and a payload, and returns a response.

    Args:
        session: The session.
        load: Reads the file of a ``spawn`` request.
    """

    def __init__(self, session: RunningSession, load: Load) -> None:
        self._session = session
        self._simulation = session.simulation
        self._graph = session.graph
        self._load = load
        self._page: Future[PageOffer | None] = Future()
        self._counting = threading.Lock()
        self._waiting = 0
        """Messages that the simulation has not delivered yet."""
        self._by_name: dict[str, Callable[[Parameters, bytes], Answer]] = {
            "status": self.status,
            "pause": self.pause,
            "resume": self.resume,
            "step": self.step,
            "reset": self.reset,
            "speed": self.speed,
            "models": self.models,
            "spawn": self.spawn,
            "delete": self.delete,
            "topics": self.topics,
            "topic": self.topic,
            "publish": self.publish,
            "services": self.services,
            "call": self.call,
            "page": self.page,
        }

    def run(self, name: str, parameters: Parameters, payload: bytes) -> Answer:
        """Executes a request.

        Raises:
            CartwheelError: The request failed.
        """
        if name not in self._by_name:
            raise UnknownNameError("request", name, self._by_name, code=CONTROL_REQUEST_INVALID)
        return self._by_name[name](parameters, payload)

    # -- time

    def status(self, _: Parameters, __: bytes) -> Answer:
        simulation = self._simulation

        def read() -> Answer:
            return {
                "time": simulation.time_ns / 1e9,
                "time_ns": simulation.time_ns,
                "step": simulation.step_ns / 1e9,
                "state": simulation.run_state.value,
                "speed": simulation.speed,
                "real_time_factor": simulation.real_time_factor,
                "world": simulation.world.name,
                "models": list(simulation.models),
                "warnings": sum(d.severity != "info" for d in simulation.diagnostics),
            }

        return self._in_time(simulation.read(read))

    def pause(self, _: Parameters, __: bytes) -> Answer:
        return self._then_time(self._simulation.pause)

    def resume(self, _: Parameters, __: bytes) -> Answer:
        return self._then_time(self._simulation.resume)

    def reset(self, _: Parameters, __: bytes) -> Answer:
        return self._then_time(self._simulation.reset)

    def step(self, parameters: Parameters, _: bytes) -> Answer:
        """Responds when the steps are done."""
        simulation = self._simulation
        count = parameters.whole("count", 1, 1, 1_000_000_000)
        self._on_simulation(lambda: simulation.step(count))

        def left() -> bool:
            return bool(simulation.steps_allowed) and simulation.run_state is RunState.PAUSED

        while self._on_simulation(left):
            time.sleep(0.002)
        return self._then_time(lambda: None)

    def speed(self, parameters: Parameters, _: bytes) -> Answer:
        """Accepts a positive number, or null for as fast as possible."""
        speed = None if parameters.value("speed") is None else parameters.number("speed")
        return self._then_time(lambda: self._simulation.set_speed(speed))

    # -- models

    def models(self, _: Parameters, __: bytes) -> Answer:
        simulation = self._simulation

        def read() -> Answer:
            placed = []
            for model in simulation.scene.models:
                pose = simulation.pose(model.name)
                description = model.description
                placed.append(
                    {
                        "name": model.name,
                        "static": description.static,
                        "mass": description.mass,
                        "links": len(description.links),
                        "joints": len(description.joints),
                        "file": str(description.origin),
                        "position": list(pose.position),
                        "rpy": list(pose.rpy),
                    }
                )
            return {"models": placed}

        return self._in_time(simulation.read(read))

    def spawn(self, parameters: Parameters, _: bytes) -> Answer:
        """Reads the file on this thread, so that the simulation can continue."""
        path = Path(parameters.text("file"))
        if not path.is_absolute():
            raise ControlError(
                f'"{path}" must be an absolute path',
                code=CONTROL_REQUEST_INVALID,
                values={"parameter": "file"},
            )
        given = {
            axis: parameters.number(axis) for axis in AXES if parameters.value(axis) is not None
        }
        description = self._load(
            path,
            arguments=parameters.texts("arguments"),
            package_path=[Path(folder) for folder in parameters.list_of_texts("package_path")],
        )
        pose = placed(description.pose, given)
        wanted = parameters.text("model", "") or None

        def spawn() -> Answer:
            before = len(self._session.diagnostics)
            name = self._session.spawn(description, name=wanted, pose=pose)
            reports = [
                packed(each)
                for each in self._session.diagnostics[before:]
                if each.severity != "info"
            ]
            return {"name": name, "mass": description.mass, "diagnostics": reports}

        return self._on_simulation(spawn)

    def delete(self, parameters: Parameters, _: bytes) -> Answer:
        name = parameters.text("model")
        self._on_simulation(lambda: self._simulation.delete(name))
        return {}

    # -- graph

    def topics(self, _: Parameters, __: bytes) -> Answer:
        return {"topics": [_described(topic) for topic in self._graph.topics()]}

    def topic(self, parameters: Parameters, _: bytes) -> Answer:
        return _described(self._graph.topic(resolve_name(parameters.text("topic"))))

    def publish(self, parameters: Parameters, payload: bytes) -> Answer:
        """Accepts a message as a mapping, or as CDR in the payload."""
        name = resolve_name(parameters.text("topic"))
        wanted = type_name(parameters.text("type"))
        self._graph.types.named(wanted)
        known = {topic.name: topic for topic in self._graph.topics()}
        if payload:
            message = decode_cdr(payload, wanted)
        else:
            message = from_dict(wanted, parameters.value("message") or {})
        topic = known.get(name)
        if topic is None:
            # Without subscribers, skip the message, so that topic names do not accumulate in the
            # graph.
            return {"subscribers": 0, "topics": list(known)}
        self._publish(name, wanted, message)
        return {"subscribers": len(topic.subscribers), "topics": []}

    def _publish(self, name: str, type_name: str, message: Any) -> None:
        """Publishes a message, unless too many others wait for the simulation."""
        with self._counting:
            if self._waiting >= _MOST_WAITING:
                raise ControlError(
                    f"{_MOST_WAITING} messages are already waiting for the simulation, so this "
                    "message is rejected",
                    code=CONTROL_LIMIT,
                    hint=self._hint,
                    values={"most": _MOST_WAITING},
                )
            self._waiting += 1
        self._graph.publish(name, type_name, message)
        self._graph.post(self._published)

    def _published(self) -> None:
        with self._counting:
            self._waiting -= 1

    def services(self, _: Parameters, __: bytes) -> Answer:
        return {
            "services": [
                {"name": service.name, "type": service.type, "node": service.node}
                for service in self._graph.services()
            ]
        }

    def call(self, parameters: Parameters, _: bytes) -> Answer:
        service = self._graph.service(resolve_name(parameters.text("service")))
        request_class, _response_class = service_classes(service.type)
        request = from_dict(request_class.__msgtype__, parameters.value("request") or {})
        response = self._in_time(self._graph.call(service.name, request))
        return {
            "response": to_dict(response),
            "type": response.__msgtype__,
            "types": packed_types(response.__msgtype__),
        }

    # -- the viewer

    def page(self, _: Parameters, __: bytes) -> Answer:
        """The viewer's URL and number of browsers; starts the viewer if necessary."""
        offer = self._in_time(self._page, cancel=False)
        if offer is None:
            raise ControlError("this simulation has no web interface", code=NO_PAGE)
        return {"url": offer.show(), "browsers": offer.browsers()}

    def offer_page(self, offer: PageOffer | None) -> None:
        """Sets the viewer; requests wait until this was called."""
        self._page.set_result(offer)

    # -- the simulation's thread

    def _on_simulation(self, function: Callable[[], T]) -> T:
        return self._in_time(self._simulation.call(function))

    def _in_time(self, future: Future[T], *, cancel: bool = True) -> T:
        try:
            return future.result(PATIENCE)
        except TimeoutError as error:
            if cancel:
                future.cancel()
            raise ControlError(
                f"the simulation did not respond within {PATIENCE:.0f} s",
                code=SIMULATION_SILENT,
                hint=self._hint,
            ) from error

    @property
    def _hint(self) -> str:
        if self._simulation.run_state is RunState.WAITING:
            return "The simulation's program must call World.run or World.spin."
        return ""

    def _then_time(self, function: Callable[[], None]) -> Answer:
        def run() -> Answer:
            function()
            simulation = self._simulation
            return {"time": simulation.time_ns / 1e9, "state": simulation.run_state.value}

        return self._on_simulation(run)


def _described(topic: TopicInfo) -> Answer:
    return {
        "name": topic.name,
        "type": topic.type,
        "publishers": list(topic.publishers),
        "subscribers": list(topic.subscribers),
        "readers": list(topic.readers),
        "rate": topic.rate,
        "qos": topic.qos,
    }
