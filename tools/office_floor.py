"""An office floor of 54 m by 36 m: walls, door openings, doors, furniture."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from world_text import Solid, link, model

HEIGHT, THICK = 2.5, 0.15
"""Height and thickness of the walls, m."""
DOOR, GATE = 1.5, 2.2
"""Width of an opening of a room and of a hall, m."""
LINTEL = 2.1
"""Height of the lintels above the ground, m."""
HALF_X, HALF_Y = 27.0, 18.0
BLOCKS = ((-27.0, -10.5), (-8.0, 8.0), (10.5, 27.0))
"""Range of each block along x, with cross corridors between them, m."""
HALL, NEAR, FAR = 1.5, 6.5, 8.5
"""|y| of the main corridor's wall, the offices' back wall and the large rooms' wall, m."""
OFFICES = 4
"""Number of offices in a row of each block."""
WHITE, DARK, WOOD = (0.82, 0.81, 0.77), (0.35, 0.37, 0.40), (0.62, 0.45, 0.28)
Gap = tuple[float, float]
"""Centre and width of an opening."""


def office_floor() -> list[list[str]]:
    """The models of the floor."""
    walls = link("walls", list(_walls()))
    furniture = link("furniture", list(_furniture()))
    return [
        model("walls", walls, static=True),
        model("furniture", furniture, static=True),
        *_doors(),
    ]


def _walls() -> Iterator[Solid]:
    for side, y in (("north", HALF_Y), ("south", -HALF_Y)):
        yield from _along_x(f"{side}_front", y, -HALF_X, HALF_X, ())
    yield from _along_y("west_front", -HALF_X, -HALF_Y, HALF_Y, ((0.0, GATE),))
    yield from _along_y("east_front", HALF_X, -HALF_Y, HALF_Y, ())
    for block, (left, right) in enumerate(BLOCKS):
        width = (right - left) / OFFICES
        middles = [left + width * (i + 0.5) for i in range(OFFICES)]
        rooms = [(middle, DOOR) for middle in middles]
        large = [((3 * left + right) / 4, GATE), ((left + 3 * right) / 4, GATE)]
        for side, sign in (("n", 1), ("s", -1)):
            name = f"{side}{block}"
            yield from _along_x(f"{name}_hall", sign * HALL, left, right, rooms)
            # Every second office has a back door.
            yield from _along_x(f"{name}_near", sign * NEAR, left, right, rooms[::2])
            yield from _along_x(f"{name}_far", sign * FAR, left, right, large)
            for i in range(1, OFFICES):
                yield from _along_y(
                    f"{name}_room{i}", left + width * i, sign * HALL, sign * NEAR, ()
                )
            middle = (left + right) / 2
            yield from _along_y(f"{name}_large", middle, sign * FAR, sign * HALF_Y, ())
            for end, x in (("w", left), ("e", right)):
                if abs(x) < HALF_X:
                    yield from _along_y(f"{name}_{end}_near", x, sign * HALL, sign * NEAR, ())
                    yield from _along_y(f"{name}_{end}_far", x, sign * FAR, sign * HALF_Y, ())


def _along_x(name: str, y: float, start: float, end: float, gaps: Sequence[Gap]) -> Iterator[Solid]:
    for part, (low, high, bottom) in enumerate(_parts(start, end, gaps)):
        tall = HEIGHT - bottom
        yield Solid(
            name=f"{name}_{part}",
            kind="box",
            size=(high - low, THICK, tall),
            pose=((low + high) / 2, y, bottom + tall / 2, 0, 0, 0),
            colour=WHITE,
        )


def _along_y(name: str, x: float, start: float, end: float, gaps: Sequence[Gap]) -> Iterator[Solid]:
    start, end = min(start, end), max(start, end)
    for part, (low, high, bottom) in enumerate(_parts(start, end, gaps)):
        tall = HEIGHT - bottom
        # Walls along x are continuous; those across end at their faces.
        yield Solid(
            name=f"{name}_{part}",
            kind="box",
            size=(THICK, high - low - THICK, tall),
            pose=(x, (low + high) / 2, bottom + tall / 2, 0, 0, 0),
            colour=WHITE,
        )


def _parts(start: float, end: float, gaps: Sequence[Gap]) -> Iterator[tuple[float, float, float]]:
    """Start, end and bottom of each piece of a wall: lintels over the gaps."""
    at = start
    for middle, width in sorted(gaps):
        yield at, middle - width / 2, 0.0
        yield middle - width / 2, middle + width / 2, LINTEL
        at = middle + width / 2
    yield at, end, 0.0


def _furniture() -> Iterator[Solid]:
    for block, (left, right) in enumerate(BLOCKS):
        width = (right - left) / OFFICES
        for side, sign in (("n", 1), ("s", -1)):
            for i in range(OFFICES):
                # A desk in a corner, away from the doors in the middle.
                x = left + width * i + 0.75
                yield from _table(f"{side}{block}_desk{i}", x, sign * 5.5, 0.8, 1.4)
            for i, part in enumerate((0.25, 0.75)):
                x = left + (right - left) * part
                yield from _table(f"{side}{block}_table{i}", x, sign * 13.5, 3.6, 1.4)
                yield Solid(
                    name=f"{side}{block}_column{i}",
                    kind="cylinder",
                    size=(0.25, HEIGHT),
                    pose=(x + 2.8, sign * 15.5, HEIGHT / 2, 0, 0, 0),
                    colour=WHITE,
                )


def _table(name: str, x: float, y: float, length: float, depth: float) -> Iterator[Solid]:
    """A desk: a top on two boards."""
    top = (length, depth, 0.04)
    yield Solid(name=name, kind="box", size=top, pose=(x, y, 0.73, 0, 0, 0), colour=WOOD)
    for leg, side in (("a", -1), ("b", 1)):
        yield Solid(
            name=f"{name}_{leg}",
            kind="box",
            size=(0.04, depth - 0.1, 0.71),
            pose=(x + side * (length / 2 - 0.06), y, 0.355, 0, 0, 0),
            colour=DARK,
        )


def _doors() -> Iterator[list[str]]:
    """Doors of the offices in the middle block. They are ajar and open when pushed."""
    left, right = BLOCKS[1]
    width = (right - left) / OFFICES
    for i in range(OFFICES):
        middle = left + width * (i + 0.5)
        leaf = Solid(
            name="leaf",
            kind="box",
            size=(DOOR - 0.06, 0.04, LINTEL - 0.06),
            pose=((DOOR - 0.06) / 2, 0, LINTEL / 2, 0, 0, 0),
            colour=WOOD,
        )
        hinge = [
            '<joint name="hinge" type="revolute">',
            "  <parent>world</parent><child>leaf</child>",
            "  <axis><xyz>0 0 1</xyz><limit><lower>-0.3</lower><upper>1.2</upper></limit>",
            "    <dynamics><damping>2</damping><friction>0.5</friction></dynamics></axis>",
            "</joint>",
        ]
        yield model(
            f"door_{i}",
            link("leaf", [leaf], mass=18),
            hinge,
            pose=(middle - DOOR / 2 + 0.03, HALL, 0, 0, 0, 0.35),
        )
