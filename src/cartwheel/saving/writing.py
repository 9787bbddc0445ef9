"""Encodes the objects of a simulation."""

from __future__ import annotations

import copy
import dataclasses
import enum
import functools
import pickle
import random
import types
import warnings
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from cartwheel.component import Component, is_connection
from cartwheel.saving.encoded import (
    Constant,
    Items,
    Kind,
    Left,
    Method,
    Node,
    Originals,
    Partial,
    Ref,
    Sentinel,
    View,
)
from cartwheel.saving.kinds import (
    CONTAINERS,
    FIXED,
    GENERATORS,
    PLAIN,
    STRUCTURE,
    STRUCTURE_MODULES,
    adapter,
    declares,
    per_class,
    slots,
    unsaved,
)

_HEAP_TYPE = 1 << 9
"""Flag of classes that are not built in."""
_OF_PYTHON = ("__dict__", "__weakref__", "__slots__")
"""Of these, each class has one that is defined in Python and derives only from `object`."""


class Writer:
    """Encodes objects with everything that they refer to, up to the structure of the world.

    Each object with an identity becomes a `Node`, once. Nodes are in the order in which they were
    found, which only depends on the objects: `Reader` finds their counterparts in the same order.
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.left_out: list[str] = []
        """Places of values that cannot be saved, with their classes."""
        self._objects: list[Any] = []
        self._left: list[Any] = []
        self._indices: dict[int, Ref] = {}
        self._found: list[tuple[int, str]] = []
        """For each node, the node in which it was found, and its place there."""
        self._pending: deque[int] = deque()
        self._sets: deque[int] = deque()
        """Nodes of sets. They are encoded last, because their items have no fixed order."""
        self._here: tuple[int, str] = (-1, "")

    @property
    def originals(self) -> Originals:
        """The encoded objects."""
        return Originals(self._objects, self._left)

    def root(self, value: Any, name: str) -> Any:
        """Encodes a value, without the contents of the objects to which it refers."""
        self._here = (-1, name)
        return self.value(value)

    def finish(self) -> None:
        """Encodes the contents of all objects."""
        while self._pending or self._sets:
            index = (self._pending or self._sets).popleft()
            self._fill(index)

    def value(self, value: Any) -> Any:
        """Encodes a value."""
        cls = type(value)
        if cls in PLAIN:
            return value
        known = self._indices.get(id(value))
        if known is not None:
            return known
        return _encoder(cls)(self, value)

    # -- values without identity

    def _tuple(self, value: tuple[Any, ...]) -> Any:
        items = [self.value(each) for each in value]
        if type(value) is tuple and all(a is b for a, b in zip(items, value, strict=True)):
            return value
        return Items(items, None if type(value) is tuple else _constant(type(value)))

    def _frozenset(self, value: frozenset[Any]) -> Any:
        if all(type(each) in PLAIN for each in value):
            return value
        return Items([self.value(each) for each in value], _constant(frozenset))

    def _enum(self, value: enum.Enum) -> Any:
        cls = type(value)
        return Constant(cls.__module__, f"{cls.__qualname__}.{value.name}")

    def _class(self, value: type) -> Any:
        return _constant(value)

    def _method(self, value: types.MethodType) -> Any:
        return Method(self.value(value.__self__), value.__func__.__name__)

    def _built_in(self, value: types.BuiltinMethodType) -> Any:
        owner = value.__self__
        if owner is None or isinstance(owner, types.ModuleType | type):
            return self._structure(value)
        return Method(self.value(owner), value.__name__)

    def _partial(self, value: functools.partial[Any]) -> Any:
        return Partial(
            self.value(value.func),
            self._tuple(value.args),
            {key: self.value(each) for key, each in value.keywords.items()},
        )

    def _structure(self, value: Any) -> Left:
        self._left.append(value)
        return Left(len(self._left) - 1)

    def _bound(self, _: Any) -> Sentinel:
        return Sentinel.BOUND

    # -- objects with identity

    def _new(self, value: Any, node: Node) -> Ref:
        index = len(self.nodes)
        self.nodes.append(node)
        self._objects.append(value)
        self._found.append(self._here)
        reference = self._indices[id(value)] = Ref(index)
        return reference

    def _later(self, kind: Kind, value: Any) -> Ref:
        cls = type(value)
        named = Constant("", cls.__msgtype__) if kind is Kind.MESSAGE else _constant(cls)
        reference = self._new(value, Node(kind, named))
        (self._sets if kind is Kind.SET else self._pending).append(reference.index)
        return reference

    def _frozen(self, value: Any) -> Any:
        # Its items are encoded at once, because it is complete as soon as it is created.
        node = Node(Kind.VALUE, _constant(type(value)))
        reference = self._new(value, node)
        here = self._here
        node.attributes = self._attributes(value, reference.index)
        self._here = here
        return reference

    def _function(self, value: types.FunctionType) -> Any:
        if "<" not in value.__qualname__:
            constant = Constant(value.__module__, value.__qualname__)
            try:
                if constant.find() is value:
                    return constant
            except LookupError:
                pass
        reference = self._new(
            value, Node(Kind.FUNCTION, Constant(value.__module__, value.__qualname__))
        )
        self._pending.append(reference.index)
        return reference

    def _array(self, value: np.ndarray[Any, Any]) -> Any:
        owner: Any = value
        while isinstance(owner.base, np.ndarray):
            owner = owner.base
        if type(owner.base).__name__ == "PyCapsule":
            return Sentinel.BOUND
        if owner is not value and owner.base is None and owner.flags.c_contiguous:
            return View(
                self.value(owner),
                value.dtype,
                value.shape,
                value.strides,
                value.__array_interface__["data"][0] - owner.__array_interface__["data"][0],
            )
        if value.dtype.hasobject:
            return self._pickled(value)
        return self._new(value, Node(Kind.ARRAY, _constant(type(value)), value.copy()))

    def _random(self, value: Any) -> Ref:
        if isinstance(value, np.random.Generator):
            content: Any = copy.deepcopy(value.bit_generator.state)
        elif isinstance(value, random.Random):
            content = value.getstate()
        else:
            content = value.get_state(legacy=False)
        return self._new(value, Node(Kind.RANDOM, _constant(type(value)), content))

    def _pickled(self, value: Any) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                content = pickle.dumps(value)
        except Exception:  # noqa: BLE001 - any class may refuse in its own way
            self._leave_out(value)
            return self._structure(value)
        return self._new(value, Node(Kind.PICKLED, _constant(type(value)), content))

    # -- contents

    def _fill(self, index: int) -> None:
        node, value = self.nodes[index], self._objects[index]
        match node.kind:
            case Kind.LIST | Kind.SET:
                node.content = self._sequence(value, index)
            case Kind.DEQUE:
                node.content = (value.maxlen, self._sequence(value, index))
            case Kind.DICT:
                node.content = self._mapping(value, index)
            case Kind.BYTES:
                node.content = bytes(value)
            case Kind.FUNCTION:
                self._here = (index, "")
                node.content = [self._cell(cell) for cell in value.__closure__ or ()]
                return
            case Kind.ADAPTED:
                found = adapter(type(value))
                assert found is not None
                self._here = (index, "")
                node.content = self.value(found.get(value))
                return
            case Kind.DECLARED:
                self._here = (index, "")
                node.content = self.value(value.save())
                node.attributes = {
                    name: self.value(vars(value)[name]) for name in ("_devices", "publishers")
                }
                return
            case _:
                pass
        attributes = self._attributes(value, index)
        if attributes or node.kind in (Kind.OBJECT, Kind.MESSAGE):
            node.attributes = attributes

    def _sequence(self, value: Any, index: int) -> list[Any]:
        items = list(value)
        for place, each in enumerate(items):
            if type(each) not in PLAIN:
                self._here = (index, f"[{place}]")
                items[place] = self.value(each)
        return items

    def _mapping(self, value: dict[Any, Any], index: int) -> list[tuple[Any, Any]]:
        items = []
        for key, each in value.items():
            if type(each) not in PLAIN or type(key) not in PLAIN:
                self._here = (index, f"[{key!r}]" if type(key) is str else "[…]")
                items.append((self.value(key), self.value(each)))
            else:
                items.append((key, each))
        return items

    def _attributes(self, value: Any, index: int) -> dict[str, Any]:
        cls = type(value)
        found = {}
        excluded = unsaved(cls)
        for name in slots(cls):
            each = getattr(value, name, Sentinel.MISSING)
            if name in excluded or each is Sentinel.MISSING:
                continue
            self._here = (index, f".{name}")
            found[name] = self.value(each)
        for name, each in getattr(value, "__dict__", {}).items():
            if type(each) in PLAIN:
                if name not in excluded:
                    found[name] = each
            elif name not in excluded:
                self._here = (index, f".{name}")
                found[name] = self.value(each)
            elif is_connection(each):
                self._here = (index, f".{name}")
                self._leave_out(each)
        return found

    def _cell(self, cell: types.CellType) -> Any:
        try:
            content = cell.cell_contents
        except ValueError:
            return Sentinel.UNSET
        return self.value(content)

    def _leave_out(self, value: Any) -> None:
        self.left_out.append(f"{self._place()} ({type(value).__qualname__})")

    def _place(self) -> str:
        """Where the current value was found: ``rosbots: libgazebo_ros_imu.so._socket``."""
        index, place = self._here
        while index >= 0:
            value = self._objects[index]
            if isinstance(value, Component):
                return f"{value.title}: {place.lstrip('.')}"
            index, before = self._found[index]
            place = before + place
        return place


@per_class
def _constant(cls: type) -> Constant:
    return Constant(cls.__module__, cls.__qualname__)


_Encoder = Callable[[Writer, Any], Any]


def _as(kind: Kind) -> _Encoder:
    return lambda writer, value: writer._later(kind, value)


_EXACT: dict[type, _Encoder] = {
    tuple: Writer._tuple,
    frozenset: Writer._frozenset,
    list: _as(Kind.LIST),
    dict: _as(Kind.DICT),
    set: _as(Kind.SET),
    deque: _as(Kind.DEQUE),
    bytearray: _as(Kind.BYTES),
    np.ndarray: Writer._array,
    types.MethodType: Writer._method,
    types.FunctionType: Writer._function,
    types.BuiltinMethodType: Writer._built_in,
    types.MethodWrapperType: Writer._structure,
    functools.partial: Writer._partial,
    memoryview: Writer._bound,
}


@per_class
def _encoder(cls: type) -> _Encoder:
    """How instances of a class are encoded."""
    if cls in _EXACT:
        return _EXACT[cls]
    if issubclass(cls, type):
        return Writer._class
    if issubclass(cls, enum.Enum):
        return Writer._enum
    if cls.__module__.startswith("mujoco"):
        return Writer._bound
    if issubclass(cls, STRUCTURE) or cls.__module__.startswith(STRUCTURE_MODULES):
        return Writer._structure
    if adapter(cls) is not None:
        return _as(Kind.ADAPTED)
    if issubclass(cls, Component) and declares(cls):
        return _as(Kind.DECLARED)
    for base, kind in zip(
        CONTAINERS, (Kind.LIST, Kind.DICT, Kind.SET, Kind.DEQUE, Kind.BYTES), strict=True
    ):
        if issubclass(cls, base):
            return _as(kind)
    if issubclass(cls, GENERATORS):
        return Writer._random
    if issubclass(cls, tuple):
        return Writer._tuple
    if isinstance(getattr(cls, "__msgtype__", None), str):
        return _as(Kind.MESSAGE)
    if _from_python(cls):
        frozen = dataclasses.is_dataclass(cls) and cls.__dataclass_params__.frozen  # type: ignore[attr-defined]
        if frozen and not issubclass(cls, FIXED):
            return Writer._frozen
        return _as(Kind.OBJECT)
    return Writer._pickled


def _from_python(cls: type) -> bool:
    """Whether a class is defined in Python, so that its attributes are its whole state."""
    roots = [each for each in cls.__mro__ if each.__bases__ == (object,)]
    return all(not vars(each).keys().isdisjoint(_OF_PYTHON) for each in roots) and all(
        each is object or each.__flags__ & _HEAP_TYPE for each in cls.__mro__
    )
