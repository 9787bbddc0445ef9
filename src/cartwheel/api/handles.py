"""What the handles of a world have in common: their equality, and an error for misspelt names."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from types import MemberDescriptorType
from typing import TYPE_CHECKING, Any

from cartwheel.similar_names import suggestion


class Sealed:
    """An object without attributes beyond those of its class.

    Setting a misspelt property is an error. Without it, the assignment would have no effect.
    """

    __slots__ = ("__weakref__",)

    if not TYPE_CHECKING:  # a type checker would accept any name

        def __setattr__(self, name: str, value: object) -> None:
            try:
                super().__setattr__(name, value)
            except AttributeError:
                if hasattr(type(self), name):
                    raise  # It cannot be set.
                raise unknown_attribute(self, name) from None


class Handle(Sealed, ABC):
    """A handle to a part of a world.

    Handles are equal if they have the same class, world and names.
    """

    __slots__ = ()

    if not TYPE_CHECKING:  # a type checker would accept any name

        def __setattr__(self, name: str, value: object) -> None:
            # Otherwise, the handle would silently become that of something else.
            slot = isinstance(getattr(type(self), name, None), MemberDescriptorType)
            if slot and hasattr(self, name):
                raise AttributeError(
                    f"{type(self).__name__}.{name} cannot be set", name=name, obj=self
                )
            super().__setattr__(name, value)

    @property
    @abstractmethod
    def _identity(self) -> tuple[Any, ...]:
        """The world and the names."""

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Handle) or type(other) is not type(self):
            return NotImplemented
        return self._identity == other._identity

    def __hash__(self) -> int:
        return hash((type(self), *self._identity))


def unknown_attribute(owner: object, name: str, also: Sequence[str] = ()) -> AttributeError:
    """The error for an attribute that is set, but does not exist.

    Args:
        owner: The object.
        name: The attribute.
        also: Attributes that can be set, but are not properties.
    """
    settable = [
        *also,
        *(
            each
            for each in dir(type(owner))
            if not each.startswith("_") and getattr(getattr(type(owner), each), "fset", None)
        ),
    ]
    text = f'{type(owner).__name__} has no attribute "{name}" to set'
    if settable:
        text += f". {suggestion(name, settable)}"
    return AttributeError(text, name=name, obj=owner)
