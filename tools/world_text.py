"""SDF text of the shipped worlds: models of boxes, cylinders and spheres, with their inertia."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

Numbers = Sequence[float]


def words(values: Iterable[float]) -> str:
    """Numbers as SDF text, rounded to 0.1 mm."""
    return " ".join(f"{round(value, 4) + 0.0:g}" for value in values)


@dataclass(frozen=True, kw_only=True)
class Solid:
    """A box, cylinder or sphere with its pose in a link."""

    name: str
    kind: str
    """box, cylinder or sphere."""
    size: Numbers
    """Edge lengths; radius and length; or radius; m."""
    pose: Numbers = (0, 0, 0, 0, 0, 0)
    colour: Numbers = (0.7, 0.7, 0.7)
    mu: float | None = None
    contact: Numbers | None = None
    """kp in N/m and kd in N s/m."""
    collides: bool = True

    @property
    def geometry(self) -> str:
        if self.kind == "box":
            inner = f"<size>{words(self.size)}</size>"
        else:
            inner = f"<radius>{self.size[0]:g}</radius>"
        if self.kind == "cylinder":
            inner += f"<length>{self.size[1]:g}</length>"
        return f"<geometry><{self.kind}>{inner}</{self.kind}></geometry>"

    def moments(self, mass: float) -> tuple[float, float, float]:
        """Principal moments of inertia, kg m²."""
        if self.kind == "box":
            x, y, z = (side * side for side in self.size)
            return mass * (y + z) / 12, mass * (x + z) / 12, mass * (x + y) / 12
        r = self.size[0]
        if self.kind == "sphere":
            return (0.4 * mass * r * r,) * 3
        across = mass * (3 * r * r + self.size[1] ** 2) / 12
        return across, across, mass * r * r / 2

    def lines(self) -> list[str]:
        """The collision and the visual."""
        pose = f"<pose>{words(self.pose)}</pose>" if any(self.pose) else ""
        colour = f"{words(self.colour)} 1"
        material = f"<material><ambient>{colour}</ambient><diffuse>{colour}</diffuse></material>"
        surface = ""
        if self.mu is not None:
            surface = f"<friction><ode><mu>{self.mu:g}</mu><mu2>{self.mu:g}</mu2></ode></friction>"
        if self.contact is not None:
            kp, kd = self.contact
            surface += f"<contact><ode><kp>{kp:g}</kp><kd>{kd:g}</kd></ode></contact>"
        surface = f"<surface>{surface}</surface>" if surface else ""
        found = [f'<visual name="{self.name}">', f"  {pose}{self.geometry}", f"  {material}"]
        found.append("</visual>")
        if self.collides:
            found += [f'<collision name="{self.name}">', f"  {pose}{self.geometry}{surface}"]
            found.append("</collision>")
        return found


def link(name: str, solids: Sequence[Solid], *, pose: Numbers = (), mass: float = 0.0) -> list[str]:
    """A link. Its mass and inertia are those of its first solid, with uniform density."""
    found = [f'<link name="{name}">']
    if pose:
        found.append(f"  <pose>{words(pose)}</pose>")
    if mass:
        first = solids[0]
        moments = zip(("ixx", "iyy", "izz"), first.moments(mass), strict=True)
        inertia = "".join(f"<{tag}>{value:.6g}</{tag}>" for tag, value in moments)
        place = f"<pose>{words(first.pose)}</pose>" if any(first.pose) else ""
        found.append(f"  <inertial>{place}<mass>{mass:g}</mass><inertia>{inertia}</inertia>")
        found.append("  </inertial>")
    for solid in solids:
        found += indented(solid.lines())
    return [*found, "</link>"]


def model(name: str, *parts: Sequence[str], pose: Numbers = (), static: bool = False) -> list[str]:
    """A model with links, joints and other elements."""
    found = [f'<model name="{name}">']
    if static:
        found.append("  <static>true</static>")
    if pose:
        found.append(f"  <pose>{words(pose)}</pose>")
    for part in parts:
        found += indented(part)
    return [*found, "</model>"]


def thing(solid: Solid, *, pose: Numbers, mass: float = 0.0) -> list[str]:
    """A model with one solid; static without a mass."""
    return model(solid.name, link("link", [solid], mass=mass), pose=pose, static=not mass)


def include(uri: str, *, name: str = "", pose: Numbers = ()) -> list[str]:
    """An include of a shipped model."""
    found = ["<include>"]
    if name:
        found.append(f"  <name>{name}</name>")
    found.append(f"  <uri>model://{uri}</uri>")
    if pose:
        found.append(f"  <pose>{words(pose)}</pose>")
    return [*found, "</include>"]


def world(comment: str, *parts: Sequence[str], eye: Numbers) -> str:
    """The text of a world file: sun, ground and the parts."""
    head = ["<gravity>0 0 -9.8</gravity>", *include("sun"), *include("ground_plane")]
    tail = [
        "<scene><ambient>0.4 0.4 0.4 1</ambient><background>0.7 0.7 0.7 1</background></scene>",
        f'<gui><camera name="user_camera"><pose>{words(eye)}</pose></camera></gui>',
    ]
    lines = [*head, *(line for part in parts for line in part), *tail]
    body = "\n".join(f"    {line}" for line in lines)
    return (
        f'<?xml version="1.0"?>\n<!-- {comment}\n     Made by tools/make_worlds.py. -->\n'
        f'<sdf version="1.6">\n  <world name="default">\n{body}\n  </world>\n</sdf>\n'
    )


def indented(lines: Sequence[str]) -> list[str]:
    """The lines, indented by one level."""
    return [f"  {line}" for line in lines]
