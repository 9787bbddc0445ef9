"""Links that a program attaches to each other."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.simulation.dynamics.fixed_joints import AttachmentHandle
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.part import Part
from cartwheel.world.entry import scoped

Place = tuple[str, str]
"""Names of a model and a link."""


class Attachments:
    """Attaches pairs of links in their current relative pose, any number at the same time.

    Each pair needs a weld in the compiled model. A weld that is free is used again; otherwise, the
    models are compiled with one more. Use it only on the simulation's thread.

    Args:
        engine: The engine with the links.
        part: The world's own part, which has the welds.
    """

    def __init__(self, engine: Engine, part: Part) -> None:
        self._engine = engine
        self._part = part
        self._welds: list[AttachmentHandle] = []

    def movable(self, place: Place) -> bool:
        """Whether a link can move."""
        return bool(self._engine.model.body_treeid[self._engine.body_id(*place)] >= 0)

    def attach(self, one: Place, two: Place) -> None:
        """Attaches two links, one of which is movable; attached links at their present poses."""
        weld = self._weld(one, two) or next((each for each in self._welds if not each.held), None)
        if weld is None:
            weld = self._part.attachment()
            self._welds.append(weld)
        # A link that cannot move holds the other one.
        weld.hold(*((one, two) if self.movable(two) else (two, one)))
        self._engine.commanded += 1

    def detach(self, one: Place, two: Place) -> None:
        """Detaches two links. Does nothing if they are not attached."""
        weld = self._weld(one, two)
        if weld is not None:
            weld.release()
            self._engine.commanded += 1

    def attached(self, place: Place) -> Iterator[str]:
        """Scoped names of the links that are attached to a link, in the order of the welds."""
        name = scoped(*place)
        for weld in self._welds:
            pair = [] if weld.held is None else [weld.held.holder, weld.held.link]
            if name in pair:
                pair.remove(name)
                yield pair[0]

    def release(self) -> None:
        """Detaches all links."""
        for weld in self._welds:
            weld.release()

    def _weld(self, one: Place, two: Place) -> AttachmentHandle | None:
        pair = {scoped(*one), scoped(*two)}
        held = (each for each in self._welds if each.held is not None)
        return next((each for each in held if _pair(each) == pair), None)


def _pair(weld: AttachmentHandle) -> set[str]:
    return set() if weld.held is None else {weld.held.holder, weld.held.link}
