"""Categories, tags and filters of entities, for simulation_interfaces."""

from __future__ import annotations

import re
from typing import Any

from cartwheel.description.model import RobotDescription
from cartwheel.errors import Origin
from cartwheel.gazebo.bounds import Rooms
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.results import FAILED, PACKAGE, Handler, Refusal
from cartwheel.messages import zero
from cartwheel.simulation import Simulation

OBJECT, ROBOT, HUMAN, DYNAMIC_OBJECT, STATIC_OBJECT = 0, 1, 2, 4, 5
"""Values in EntityCategory.msg."""
_CATEGORIES = (OBJECT, ROBOT, HUMAN, DYNAMIC_OBJECT, STATIC_OBJECT)
_ALL = 1
"""Value of a tag filter that requires all tags, instead of any."""


class EntityInfos:
    """The default info of each model, and changes by requests.

    A model with plugins, sensors or controllers is a robot; a model that cannot move is a static
    object.

    Args:
        simulation: The simulation.
        entities: Resolves model names.
    """

    def __init__(self, simulation: Simulation, entities: Entities) -> None:
        self._simulation = simulation
        self._entities = entities
        self._rooms = Rooms(entities)
        self._said: dict[str, tuple[Origin, Any]] = {}

    def offers(self) -> list[tuple[str, str, Handler, bool]]:
        """The services: name, type, handler, and whether the handler runs on a separate thread."""
        return [
            ("get_entity_info", "GetEntityInfo", self._get, False),
            ("set_entity_info", "SetEntityInfo", self._set, False),
            ("get_entity_bounds", "GetEntityBounds", self._get_bounds, False),
            ("get_entities", "GetEntities", self._list, False),
        ]

    def forget(self) -> None:
        """Discards all changes."""
        self._said.clear()

    def info(self, name: str) -> Any:
        """``EntityInfo`` of a model.

        Raises:
            UnknownNameError: The model does not exist.
        """
        description = self._entities.model(name)
        origin, said = self._said.get(name, (None, None))
        # The name may meanwhile belong to a different model.
        if said is not None and origin is description.origin:
            return said
        made = zero(f"{PACKAGE}/msg/EntityInfo")
        made.category.category = self._category(name, description)
        made.description = f"{description.name} from {description.origin.file}"
        return made

    def filtered(self, filters: Any) -> list[str]:
        """Names of the models that match ``EntityFilters``.

        Raises:
            Refusal: The filters are invalid.
        """
        try:
            pattern = re.compile(filters.filter)
        except re.error as error:
            raise Refusal(
                FAILED, f'"{filters.filter}" is not a regular expression: {error}'
            ) from None
        wanted = {each.category for each in filters.categories}
        if wanted - set(_CATEGORIES):
            raise Refusal(FAILED, f"category {min(wanted - set(_CATEGORIES))} does not exist")
        self._simulation.refresh()
        within = self._rooms.within(filters.bounds)
        return [
            placed.name
            for placed in self._entities.placed
            if (not filters.filter or pattern.fullmatch(placed.name))
            and (not wanted or self.info(placed.name).category.category in wanted)
            and has_tags(self.info(placed.name).tags, filters.tags)
            and within(placed.name)
        ]

    def _category(self, name: str, description: RobotDescription) -> int:
        moves = self._simulation.moves(name)
        jointed = any(joint.type != "fixed" for joint in description.joints)
        if description.static or not (moves or jointed):
            return STATIC_OBJECT
        acts = description.plugins or description.transmissions or description.ros2_control
        senses = any(link.sensors for link in description.links)
        return ROBOT if acts or senses else OBJECT

    def _get(self, request: Any, response: Any) -> None:
        response.info = self.info(request.entity)

    def _set(self, request: Any, _: Any) -> None:
        description = self._entities.model(request.entity)
        if request.info.category.category not in _CATEGORIES:
            raise Refusal(FAILED, f"category {request.info.category.category} does not exist")
        self._said[request.entity] = description.origin, request.info

    def _get_bounds(self, request: Any, response: Any) -> None:
        self._simulation.refresh()
        response.bounds = self._rooms.message(request.entity)

    def _list(self, request: Any, response: Any) -> None:
        response.entities = self.filtered(request.filters)


def has_tags(tags: list[str], asked: Any) -> bool:
    """Whether tags match a ``TagsFilter``."""
    wanted = set(asked.tags)
    if not wanted:
        return True
    found = wanted & set(tags)
    return found == wanted if asked.filter_mode == _ALL else bool(found)
