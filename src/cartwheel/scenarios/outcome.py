"""The result of a case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, Self

Status = Literal["passed", "failed", "error"]
Kind = Literal["expectation", "step", "lockstep", "error"]


@dataclass(frozen=True, kw_only=True)
class Finding:
    """A condition that was not met, or an error."""

    kind: Kind
    expected: str
    actual: str
    file: str
    line: int
    time: float | None
    """Simulation time from the start of the case, s."""
    code: str = ""
    hint: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """Where, when and why, in a few lines."""
        when = "" if self.time is None else f" at {self.time:.3f} s"
        lines = [f"{self.file}:{self.line}: {self.kind}{when}"]
        if self.kind == "error":
            lines[0] += f": {self.actual}{f' [{self.code}]' if self.code else ''}"
        else:
            lines += [f"  expected: {self.expected}", f"  actual:   {self.actual}"]
        return "\n".join([*lines, f"  {self.hint}"] if self.hint else lines)


@dataclass(kw_only=True)
class Outcome:
    """The result of a case; it can be written as JSON."""

    id: str
    scenario: str
    file: str
    digest: str
    parameters: Mapping[str, Any]
    seed: int
    status: Status = "passed"
    time: float = 0.0
    """Simulation time, s."""
    wall: float = 0.0
    """Wall time, s."""
    cpu: float = 0.0
    """CPU time of the case's process, s."""
    late: int = 0
    """Number of periods in lockstep without a message in time."""
    findings: list[Finding] = field(default_factory=list)
    diagnostics: list[str] = field(default_factory=list)
    output: str = ""
    """The last output of the launched program."""
    trajectories: dict[str, list[Sequence[float]]] = field(default_factory=dict)
    """Time in s, x and y in m, and yaw in rad of each model."""
    obstacles: list[Sequence[float]] = field(default_factory=list)
    """Lowest x and y, and highest x and y, of fixed shapes, m."""
    targets: list[Sequence[float]] = field(default_factory=list)
    """x, y and radius in m of the positions to reach."""
    picture: str = ""
    """File with a picture of the world at the end, relative to the results."""
    recording: str = ""
    """File with the recorded messages, relative to the results."""

    def as_mapping(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return asdict(self)

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Self:
        """The outcome of `as_mapping`.

        Raises:
            TypeError: The data is not that of an outcome.
        """
        findings = [Finding(**each) for each in data["findings"]]
        return cls(**{**data, "findings": findings})
