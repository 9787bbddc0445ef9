"""Decodes the objects of a state into those of a simulation."""

from __future__ import annotations

import functools
import pickle
import types
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cartwheel.component import Component
from cartwheel.saving.changes import (
    mismatch,
    refill,
    refill_dict,
    refill_set,
    set_attributes,
    set_random,
    set_slots,
)
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
from cartwheel.saving.kinds import FIXED, IDENTIFIED, PLAIN, adapter, slots, unsaved

_BOUND, _MISSING, _UNSET = Sentinel.BOUND, Sentinel.MISSING, Sentinel.UNSET
_ALWAYS_NEW = (Kind.VALUE, Kind.ARRAY, Kind.MESSAGE, Kind.PICKLED)
"""Kinds of objects that others may use, so that they are not changed."""


class Reader:
    """Decodes nodes; `apply` then changes the objects.

    An object of the same world is restored itself. In another world, and for what has been created
    again since, the object in the same place is restored, or a new one is created.

    Args:
        nodes: The nodes of a state.
        message_class: Returns the class of a message type.
        originals: The objects from which the state was saved; None for another world.
    """

    def __init__(
        self,
        nodes: Sequence[Node],
        message_class: Callable[[str], Any],
        originals: Originals | None,
    ) -> None:
        self._nodes = nodes
        self._message_class = message_class
        self._originals = originals
        self._objects: list[Any] = [_MISSING] * len(nodes)
        self._own = [False] * len(nodes)
        """For each node, whether its object is the one that was saved."""
        self._claimed: set[int] = set()
        self._pending: deque[int] = deque()
        self._sets: deque[int] = deque()
        self._changes: list[Callable[[], None]] = []
        self._last: list[Callable[[], None]] = []

    def root(self, encoded: Any, live: Any, *, own: bool) -> Any:
        """Decodes a value, without the contents of the objects to which it refers.

        Args:
            encoded: The value.
            live: The value in the same place of the world.
            own: Whether the world's value is the one that was saved.

        Raises:
            SimulationError: The world differs from the one that was saved.
        """
        return self._value(encoded, live, own=own)

    def finish(self) -> None:
        """Decodes the contents of all objects.

        Raises:
            SimulationError: The world differs from the one that was saved.
        """
        while self._pending or self._sets:
            self._fill((self._pending or self._sets).popleft())

    def apply(self) -> None:
        """Changes all objects to the saved state. May be repeated."""
        for change in self._changes:
            change()
        for change in self._last:
            change()

    # -- values

    def _value(self, encoded: Any, live: Any, *, own: bool) -> Any:
        """Decodes a value; returns `_BOUND` if the value in the same place is kept."""
        cls = type(encoded)
        if cls in PLAIN or cls is tuple or cls is frozenset:
            return encoded
        if cls is Ref:
            found = self._objects[encoded.index]
            return self._node(encoded.index, live, own) if found is _MISSING else found
        if cls is Left:
            if own:
                assert self._originals is not None
                return self._originals.left[encoded.index]
            return _BOUND
        if cls is Constant:
            return self._constant(encoded, live)
        if cls is Items:
            return self._items(encoded, live, own)
        if cls is Method:
            owner = self._value(encoded.owner, getattr(live, "__self__", _MISSING), own=own)
            if owner is _BOUND:
                return _BOUND
            made = getattr(owner, encoded.name)
            return live if type(live) is type(made) and live == made else made
        if cls is Partial:
            return self._partial(encoded, live, own)
        if cls is View:
            return self._view(encoded, live, own)
        assert isinstance(encoded, Sentinel)
        return encoded

    def _constant(self, encoded: Constant, live: Any) -> Any:
        try:
            return encoded.find()
        except LookupError:
            # The module of a plugin's file may have another name in another process.
            name = encoded.name.rpartition(".")[2]
            for candidate in (live, getattr(type(live), name, None)):
                if getattr(candidate, "__qualname__", getattr(candidate, "name", "")) in (
                    encoded.name,
                    name,
                ):
                    return candidate
            raise mismatch(f"{encoded.module}.{encoded.name} does not exist") from None

    def _items(self, encoded: Items, live: Any, own: bool) -> Any:
        items = self._sequence(encoded.items, live if isinstance(live, tuple) else (), own)
        if (
            isinstance(live, tuple)
            and len(items) == len(live)
            and all(a is b for a, b in zip(items, live, strict=True))
        ):
            return live
        if encoded.cls is None:
            return tuple(items)
        cls = self._constant(encoded.cls, type(live))
        return cls._make(items) if hasattr(cls, "_make") else cls(items)

    def _partial(self, encoded: Partial, live: Any, own: bool) -> Any:
        same = isinstance(live, functools.partial)
        function = self._value(encoded.function, live.func if same else _MISSING, own=own)
        arguments = self._value(encoded.arguments, live.args if same else _MISSING, own=own)
        known = live.keywords if same else {}
        keywords = {
            key: self._kept(
                self._value(each, known.get(key, _MISSING), own=own), known.get(key, _MISSING)
            )
            for key, each in encoded.keywords.items()
        }
        if function is _BOUND:
            return _BOUND
        if same and live.func == function and live.args is arguments and live.keywords == keywords:
            return live
        return functools.partial(function, *arguments, **keywords)

    def _view(self, encoded: View, live: Any, own: bool) -> Any:
        array = self._value(encoded.array, getattr(live, "base", _MISSING), own=own)
        if encoded.equals(live, array):
            return live
        return np.ndarray(
            encoded.shape,
            encoded.dtype,
            buffer=array,
            offset=encoded.offset,
            strides=encoded.strides,
        )

    @staticmethod
    def _kept(value: Any, live: Any) -> Any:
        """An item of a tuple, or the one in the same place if it is kept."""
        if value is not _BOUND:
            return value
        if live is _MISSING:
            raise mismatch("a part of the saved world does not exist")
        return live

    # -- objects

    def _node(self, index: int, live: Any, own: bool) -> Any:
        """Finds or creates the object of a node, which is not changed yet."""
        node = self._nodes[index]
        original = self._originals.objects[index] if own and self._originals else _MISSING
        same = live is not _MISSING and _named(type(live), node.cls)
        if node.kind is Kind.FUNCTION:
            same = (
                isinstance(live, types.FunctionType)
                and (live.__module__, live.__qualname__) == (node.cls.module, node.cls.name)
                and len(live.__closure__ or ()) == len(node.content)
            )
        if same and isinstance(live, FIXED) and id(live) not in self._claimed:
            found = live
        elif original is not _MISSING:
            found = original
        elif node.kind in _ALWAYS_NEW:
            found = self._made(node, live if same else _MISSING)
        elif same and id(live) not in self._claimed and not isinstance(live, IDENTIFIED):
            found = live
        else:
            found = self._created(node)
        self._objects[index] = found
        self._own[index] = found is original
        self._claimed.add(id(found))
        if node.kind is not Kind.VALUE or self._own[index]:
            (self._sets if node.kind is Kind.SET else self._pending).append(index)
        return found

    def _made(self, node: Node, live: Any) -> Any:
        """Creates an object that is complete at once, or returns the live one if it is equal."""
        if node.kind is Kind.PICKLED:
            return pickle.loads(node.content)  # noqa: S301 - its source is that of the state
        if node.kind is Kind.ARRAY:
            if live is not _MISSING and _equal(live, node.content):
                return live
            return node.content.copy()
        if node.kind is Kind.MESSAGE:
            assert node.attributes is not None
            return self._message_class(node.cls.name)(**dict.fromkeys(node.attributes))
        assert node.attributes is not None
        cls = self._constant(node.cls, type(live))
        values = {
            name: self._value(each, getattr(live, name, _MISSING), own=False)
            for name, each in node.attributes.items()
        }
        values = {
            name: self._kept(each, getattr(live, name, _MISSING)) for name, each in values.items()
        }
        if live is not _MISSING and all(
            _alike(each, getattr(live, name, _MISSING)) for name, each in values.items()
        ):
            return live
        made = cls.__new__(cls)
        for name, each in values.items():
            object.__setattr__(made, name, each)
        return made

    def _created(self, node: Node) -> Any:
        """Creates an object, of which nothing is in the same place of the world."""
        if node.kind in (Kind.FUNCTION, Kind.ADAPTED, Kind.DECLARED):
            raise mismatch(f"{node.cls.name} does not exist")
        cls = self._constant(node.cls, _MISSING)
        if issubclass(cls, FIXED):
            raise mismatch(f"{node.cls.name} does not exist")
        if node.kind is Kind.DEQUE:
            return cls([], node.content[0])
        if node.kind is Kind.RANDOM:
            if issubclass(cls, np.random.Generator):
                return cls(getattr(np.random, node.content["bit_generator"])())
            return cls()
        return cls.__new__(cls)

    # -- contents

    def _fill(self, index: int) -> None:
        node, target, own = self._nodes[index], self._objects[index], self._own[index]
        match node.kind:
            case Kind.LIST:
                self._fill_list(node.content, target, own)
            case Kind.DEQUE:
                items = self._sequence(node.content[1], list(target), own)
                self._changes.append(functools.partial(refill, target, items))
            case Kind.SET:
                items = [self._value(each, _MISSING, own=own) for each in node.content]
                self._changes.append(functools.partial(refill_set, target, items))
            case Kind.DICT:
                self._fill_dict(node.content, target, own)
            case Kind.BYTES:
                content = node.content
                self._changes.append(functools.partial(target.__setitem__, slice(None), content))
            case Kind.ARRAY:
                if own and target.flags.writeable:
                    self._changes.append(functools.partial(np.copyto, target, node.content))
            case Kind.RANDOM:
                self._changes.append(functools.partial(set_random, target, node.content))
            case Kind.FUNCTION:
                self._fill_cells(node.content, target, own)
            case Kind.ADAPTED:
                self._fill_adapted(node.content, target, own)
            case Kind.DECLARED:
                saved = self._value(node.content, _MISSING, own=False)
                self._last.append(functools.partial(target.restore, saved))
            case _:
                pass
        if node.attributes is not None:
            if node.kind is Kind.VALUE:
                for name, each in node.attributes.items():
                    self._value(each, getattr(target, name, _MISSING), own=own)
            else:
                self._fill_attributes(node, target, own)

    def _fill_list(self, content: Sequence[Any], target: list[Any], own: bool) -> None:
        items = self._sequence(content, target, own)
        self._changes.append(functools.partial(target.__setitem__, slice(None), items))

    def _sequence(self, content: Sequence[Any], live: Sequence[Any], own: bool) -> list[Any]:
        count = len(live)
        items = []
        for place, each in enumerate(content):
            if type(each) in PLAIN:
                items.append(each)
            else:
                old = live[place] if place < count else _MISSING
                items.append(self._kept(self._value(each, old, own=own), old))
        return items

    def _fill_dict(self, content: Any, target: dict[Any, Any], own: bool) -> None:
        items = {}
        for given, each in content:
            key = given if type(given) in PLAIN else self._value(given, _MISSING, own=own)
            if type(each) in PLAIN:
                items[key] = each
            else:
                old = target.get(key, _MISSING)
                items[key] = self._kept(self._value(each, old, own=own), old)
        self._changes.append(functools.partial(refill_dict, target, items))

    def _fill_cells(self, content: Sequence[Any], target: types.FunctionType, own: bool) -> None:
        for cell, each in zip(target.__closure__ or (), content, strict=True):
            try:
                live = cell.cell_contents
            except ValueError:
                live = _MISSING
            value = self._value(each, live, own=own)
            if value is not _BOUND and value is not _UNSET and value is not live:
                self._changes.append(functools.partial(setattr, cell, "cell_contents", value))

    def _fill_adapted(self, content: Any, target: Any, own: bool) -> None:
        found = adapter(type(target))
        assert found is not None
        value = self._value(content, found.get(target), own=own)
        if value is not _BOUND:
            self._changes.append(functools.partial(found.put, target, value))

    def _fill_attributes(self, node: Node, target: Any, own: bool) -> None:
        assert node.attributes is not None
        names = slots(type(target))
        live = getattr(target, "__dict__", {})
        values: dict[str, Any] = {}
        slotted: dict[str, Any] = {}
        kept = set(unsaved(type(target)))
        if node.kind is Kind.DECLARED:
            kept.update(live.keys() - node.attributes.keys())
        for name, each in node.attributes.items():
            if type(each) in PLAIN:
                value = each
            else:
                old = live.get(name, _MISSING)
                if old is _MISSING and name in names:
                    old = getattr(target, name, _MISSING)
                value = self._value(each, old, own=own)
                if value is _BOUND:
                    if old is _MISSING and type(each) is Left:
                        raise mismatch(f"{node.cls.name}.{name} cannot be created")
                    kept.add(name)
                    continue
            (slotted if name in names else values)[name] = value
        if names:
            removed = [name for name in names if name not in slotted and name not in kept]
            self._changes.append(functools.partial(set_slots, target, slotted, removed))
        if values or live:
            self._changes.append(functools.partial(set_attributes, target, values, kept))


def _named(cls: type, constant: Constant) -> bool:
    return cls.__qualname__ == constant.name and (
        cls.__module__ == constant.module or issubclass(cls, Component)
    )


def _alike(value: Any, live: Any) -> bool:
    return value is live or (type(value) in PLAIN and type(value) is type(live) and value == live)


def _equal(live: Any, content: Any) -> bool:
    same = live.shape == content.shape and live.dtype == content.dtype
    return bool(same and live.tobytes() == content.tobytes())
