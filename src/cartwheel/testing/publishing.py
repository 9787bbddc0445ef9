"""A condition on how often a topic has messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from cartwheel.api.values import scalar
from cartwheel.testing.conditions import Condition

if TYPE_CHECKING:
    from cartwheel.api import World


class Publishes(Condition):
    """Messages are published on a topic, at a rate if one is given.

    Args:
        topic: The topic.
        rate: Messages per second of simulation time; None if one message is sufficient.
        tolerance: Relative tolerance of the rate.
    """

    def __init__(self, topic: str, rate: float | None = None, *, tolerance: float = 0.1) -> None:
        super().__init__()
        self.topic = topic
        self.rate = None if rate is None else scalar(rate, "rate", above=0.0)
        self.tolerance = scalar(tolerance, "tolerance", least=0.0)
        self.count = self._later = 0
        self._faulty = False
        self.passed = 0.0
        """Time since `begin`, s."""
        self._since = self._last = 0.0
        self.longest_gap = 0.0
        self._end: Callable[[], None] = lambda: None

    def begin(self, world: World) -> None:
        super().begin(world)
        self._since = self._last = world.time
        self.count, self._later, self.longest_gap = 0, 0, 0.0
        world.graph.topic(self.topic)
        self._faulty = world.graph.is_disturbed(self.topic)
        self._end = world.graph.subscribe(self.topic, self._take).close

    def _take(self, _: object) -> None:
        now = self.world.time
        if self.count:
            self.longest_gap = max(self.longest_gap, now - self._last)
        self.count += 1
        self._later += now > self._since
        self._last = now

    def close(self) -> None:
        self._end()
        self._end = lambda: None
        super().close()

    @property
    def measured(self) -> float:
        """Messages per second of simulation time; one at its very beginning does not count."""
        return self._later / self.passed if self.passed > 0 else 0.0

    def holds(self) -> bool:
        self.passed = self.world.time - self._since
        if self.rate is None:
            return self.count > 0
        # The first and last message may be just outside of the time.
        slack = self.rate * self.passed * self.tolerance + 1.0
        return self.count > 0 and abs(self.count - self.rate * self.passed) <= slack

    @property
    def expected(self) -> str:
        rate = "" if self.rate is None else f" at {self.rate:g} Hz ± {100 * self.tolerance:g} %"
        return f"messages on {self.topic}{rate}"

    @property
    def actual(self) -> str:
        if not self.count:
            fault = "; World.faults contains a fault of the topic" if self._faulty else ""
            return f"no message in {self.passed:.3f} s{fault}"
        return (
            f"{self.count} messages in {self.passed:.3f} s, which is {self.measured:.4g} Hz; "
            f"the longest gap was {self.longest_gap:.3g} s"
        )

    @property
    def values(self) -> Mapping[str, float | str | None]:
        return {"count": self.count, "rate": self.measured, "longest_gap": self.longest_gap}
