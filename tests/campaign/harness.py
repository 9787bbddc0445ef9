"""Gives all targets time in turn, counts what they read, and goes on where it was stopped."""

from __future__ import annotations

import json
import shutil
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tests.campaign import registry
from tests.campaign.finding import Finding
from tests.campaign.target import Target
from tests.campaign.watching import Watched, sweep, watch

_LONGEST_SLICE_S = 60.0
_SHORTEST_SLICE_S = 0.3
_STARTING_S = 1.0
"""Wall time until a worker reads its first input, as long as none was measured."""


@dataclass
class Counts:
    """Of one target, over all slices."""

    inputs: int = 0
    accepted: int = 0
    refused: int = 0
    faulty: int = 0
    """Inputs with a finding; many may have one cause."""
    slowest_ms: int = 0
    """CPU time of the slowest input that ended."""
    peak_mb: int = 0
    blocks: int = 0
    """Blocks of Cartwheel's code that were reached."""
    corpus: int = 0
    """Inputs kept because they reached something new."""
    seconds: float = 0.0


@dataclass
class Campaign:
    """Targets, their counts and findings.

    Args:
        folder: Keeps corpora, findings and counts; a campaign on the same folder goes on with them.
        targets: In the order of their turns.
        seed: From which mutations follow.
    """

    folder: Path
    targets: Sequence[Target]
    seed: int = 1
    counts: dict[str, Counts] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.folder = self.folder.resolve()
        self._findings.mkdir(parents=True, exist_ok=True)
        if self._state.exists():
            saved = json.loads(self._state.read_text())
            self.counts = {name: Counts(**each) for name, each in saved["targets"].items()}

    @property
    def _findings(self) -> Path:
        return self.folder / "findings"

    @property
    def _state(self) -> Path:
        return self.folder / "counts.json"

    def findings(self) -> list[Path]:
        """Files of what was found and not yet mended."""
        return sorted(self._findings.glob("*.json"))

    def clear(self) -> None:
        """Forgets all that the folder keeps of these targets."""
        for file in self.findings():
            if any(file.name.startswith(f"{each.name}-") for each in self.targets):
                file.unlink()
        for target in self.targets:
            self.counts.pop(target.name, None)
            shutil.rmtree(self.folder / target.name, ignore_errors=True)

    def forget_mended(self) -> None:
        """Runs all findings again and removes those that are none any more."""
        for file in self.findings():
            if not replay(file):
                file.unlink()

    def run(self, minutes: float) -> None:
        """Gives each target a slice of time in turn until the minutes are over."""
        sweep()
        end = time.monotonic() + minutes * 60
        turn = min(_LONGEST_SLICE_S, minutes * 60 / sum(each.share for each in self.targets))
        starting = [_STARTING_S]
        while True:
            for place, target in enumerate(self.targets):
                rest = self.targets[place:]
                begin = time.monotonic()
                # Workers start in this time too: the rest is for inputs.
                left = end - begin - len(rest) * sum(starting) / len(starting)
                seconds = min(turn, left / sum(each.share for each in rest)) * target.share
                seconds = max(seconds, _SHORTEST_SLICE_S)
                self._slice(target, seconds)
                starting.append(max(0.0, time.monotonic() - begin - seconds))
                self.save()
                print(f"{target.name:24} {self.counts[target.name].inputs:9} inputs", flush=True)
            if time.monotonic() + turn > end:
                return

    def _slice(self, target: Target, seconds: float) -> None:
        counts = self.counts.setdefault(target.name, Counts())
        room = self.folder / target.name
        begin = time.monotonic()
        left = seconds
        while True:
            task = {
                "target": target.name,
                "seed": self.seed,
                "first": counts.inputs,
                "seconds": left,
            }
            watched = watch(target, task, room)
            _add(counts, watched)
            if watched.stopped:
                raise KeyboardInterrupt
            # A worker that died is started anew, for the rest of the slice.
            left = seconds - (time.monotonic() - begin)
            if watched.ended or left < 0:
                break
        if (room / "stats").exists():
            stats = json.loads((room / "stats").read_text())
            counts.peak_mb = max(counts.peak_mb, stats["peak_mb"])
            counts.blocks = stats["blocks"]
        counts.corpus = len(list((room / "corpus").iterdir()))
        counts.seconds += time.monotonic() - begin

    def save(self) -> None:
        """Writes the counts, all or nothing."""
        text = json.dumps(
            {
                "inputs": sum(each.inputs for each in self.counts.values()),
                "findings": [path.name for path in self.findings()],
                "targets": {name: asdict(each) for name, each in self.counts.items()},
            },
            indent=1,
        )
        new = self._state.with_suffix(".new")
        new.write_text(text)
        new.replace(self._state)

    def table(self) -> str:
        """The counts, a line for each target."""
        head = ("target", "inputs", "accepted", "refused", "faulty", "ms max", "MB", "blocks", "s")
        rows = [head]
        for name, each in self.counts.items():
            figures = (each.inputs, each.accepted, each.refused, each.faulty, each.slowest_ms)
            rows.append((name, *map(str, (*figures, each.peak_mb, each.blocks, int(each.seconds)))))
        widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
        return "\n".join(
            f"{row[0]:{widths[0]}}"
            + "".join(f"  {cell:>{width}}" for cell, width in zip(row[1:], widths[1:], strict=True))
            for row in rows
        )


def replay(file: Path) -> str:
    """Lets a finding's target read its inputs again; what is found now, or nothing."""
    finding = Finding.load(file)
    target = registry.load(finding.target)
    with tempfile.TemporaryDirectory(prefix="campaign-") as folder:
        room = Path(folder) / "room"
        room.mkdir()
        inputs = []
        for number, data in enumerate(finding.inputs):
            inputs.append(str(Path(folder) / f"{number}.input"))
            Path(inputs[-1]).write_bytes(data)
        watch(target, {"target": target.name, "seed": 0, "inputs": inputs}, room)
        return "\n".join(Finding.load(f).text for f in (Path(folder) / "findings").glob("*.json"))


def _add(counts: Counts, watched: Watched) -> None:
    counts.inputs += watched.begun
    counts.accepted += watched.accepted
    counts.refused += watched.refused
    counts.faulty += watched.faulty
    counts.slowest_ms = max(counts.slowest_ms, watched.slowest_ms)
