"""Which objects are saved, and which are part of a world's structure."""

from __future__ import annotations

import contextlib
import datetime
import decimal
import fractions
import functools
import logging
import pathlib
import random
import threading
import types
import weakref
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from cartwheel.component import Component, Scope, Shared
from cartwheel.dialects.plugin_files import PluginFiles
from cartwheel.dialects.ros_control.files import ControllerFiles
from cartwheel.graph import Action, ActionTopics, Goal, Graph, Mailbox, Publisher, ReconfigureServer
from cartwheel.graph.joint_inputs import JointInput
from cartwheel.graph.topic import Service, Subscription, Topic
from cartwheel.messages import CdrCache, Form
from cartwheel.messages.library.library import TypeLibrary
from cartwheel.saving.encoded import Adapter
from cartwheel.simulation import Part, Simulation
from cartwheel.simulation.clock import Task
from cartwheel.simulation.dynamics.divergence import Guard
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.population import Population
from cartwheel.simulation.models.resident import Resident
from cartwheel.simulation.sensing.embree_rays import SharedRayScenes
from cartwheel.simulation.sensing.visual_model import VisualModel

T = TypeVar("T")

PLAIN: frozenset[type] = frozenset(
    {
        type(None),
        bool,
        int,
        float,
        complex,
        str,
        bytes,
        range,
        slice,
        type(Ellipsis),
        type(NotImplemented),
        fractions.Fraction,
        decimal.Decimal,
        datetime.datetime,
        datetime.date,
        datetime.time,
        datetime.timedelta,
        datetime.timezone,
        pathlib.PurePosixPath,
        pathlib.PureWindowsPath,
        type(pathlib.Path()),
        *(np.dtype(code).type for code in np.typecodes["AllInteger"] + np.typecodes["AllFloat"]),
        np.bool_,
    }
)
"""Immutable classes, whose instances are saved as they are."""

STRUCTURE: tuple[type, ...] = (
    Engine,
    Simulation,
    Population,
    Resident,
    VisualModel,
    SharedRayScenes,
    Part,
    Scope,
    Shared,
    Graph,
    Topic,
    Mailbox,
    TypeLibrary,
    CdrCache,
    Form,
    PluginFiles,
    ControllerFiles,
    contextlib.ExitStack,
    types.ModuleType,
    types.MappingProxyType,
    logging.Logger,
    weakref.ref,
    weakref.WeakKeyDictionary,
    weakref.WeakValueDictionary,
    weakref.WeakSet,
    type(threading.Lock()),
    type(threading.RLock()),
    threading.Condition,
    threading.Event,
    type(functools.cache(len)),
    property,
    np.ufunc,
    np.dtype,
)
"""Classes whose instances belong to a world and have no state of their own, or have a state that is
saved elsewhere."""

STRUCTURE_MODULES = ("cartwheel.description.", "cartwheel.world.")
"""Modules whose classes describe files. Their instances do not change."""

FIXED: tuple[type, ...] = (
    Component,
    Task,
    Publisher,
    Subscription,
    Service,
    Action,
    ActionTopics,
    ReconfigureServer,
    JointInput,
)
"""Classes whose instances are registered with the graph or the schedule: the instance in the same
place is restored, and none can be created."""

IDENTIFIED: tuple[type, ...] = (Goal,)
"""Classes whose instances programs and clients know: a state of another world does not make one of
them another one, and creates new ones."""

CONTAINERS: tuple[type, ...] = (list, dict, set, deque, bytearray)
GENERATORS: tuple[type, ...] = (np.random.Generator, np.random.RandomState, random.Random)


def _publication(publisher: Publisher) -> Any:
    return publisher.sent, publisher.latched


def _publish(publisher: Publisher, saved: Any) -> None:
    publisher.sent = saved[0]
    publisher.latched = saved[1]


def _nothing(_: Any, __: Any) -> None:
    """The parts of the object are restored themselves."""


ADAPTERS: dict[type, Adapter] = {
    Publisher: Adapter(_publication, _publish),
    Subscription: Adapter(lambda subscription: subscription.callback, _nothing),
    Service: Adapter(lambda service: service.handler, _nothing),
    JointInput: Adapter(lambda joint_input: joint_input.put, _nothing),
    Guard: Adapter(Guard.save, Guard.restore),
}


def per_class(function: Callable[[type], T]) -> Callable[[type], T]:
    """Stores the result of a function for each class."""
    results: dict[type, T] = {}

    @functools.wraps(function)
    def stored(cls: type) -> T:
        if cls not in results:
            results[cls] = function(cls)
        return results[cls]

    return stored


@per_class
def adapter(cls: type) -> Adapter | None:
    """The adapter of a class, or None."""
    return next((ADAPTERS[each] for each in cls.__mro__ if each in ADAPTERS), None)


@per_class
def unsaved(cls: type) -> frozenset[str]:
    """Attributes that a class excludes, because they follow from the compiled model."""
    return frozenset[str]().union(*(vars(each).get("_unsaved", ()) for each in cls.__mro__))


@per_class
def slots(cls: type) -> tuple[str, ...]:
    """All slots of a class, by the names of their attributes."""
    found = []
    for each in cls.__mro__:
        own = vars(each).get("__slots__", ())
        for name in (own,) if isinstance(own, str) else own:
            if name in ("__dict__", "__weakref__"):
                continue
            private = name.startswith("__") and not name.endswith("__")
            found.append(f"_{each.__name__.lstrip('_')}{name}" if private else name)
    return tuple(found)


def declares(cls: type) -> bool:
    """Whether a component saves and restores its own attributes."""
    return callable(getattr(cls, "save", None)) and callable(getattr(cls, "restore", None))
