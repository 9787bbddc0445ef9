"""A wind that pushes a link, with gusts."""

from dataclasses import dataclass

from cartwheel.plugin import Plugin, tag


@dataclass(frozen=True, kw_only=True)
class GustyWindParameters:
    link: str = tag("link", default="", doc="Link that the wind pushes. Default: the root link.")
    force: float = tag("force", default=1.0, unit="N", doc="Mean force along x of the world.")


class GustyWind(Plugin[GustyWindParameters]):
    """Pushes a link with a gusty wind."""

    filenames = ("libgusty_wind.so",)

    def configure(self) -> None:
        link = self.link_or_root(self.config.link)
        self.wrench = self.part.wrench(link.name)
        self.part.schedule(10.0, before=self.blow)

    def blow(self) -> None:
        gust = self.part.random("gusts").normal(1.0, 0.3)
        self.wrench.apply((self.config.force * gust, 0.0, 0.0), (0.0, 0.0, 0.0))
