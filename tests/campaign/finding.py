"""Inputs that broke something, saved so that they can be run again."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import traceback
from dataclasses import asdict, dataclass
from pathlib import Path

_FRAME = re.compile(r'File "([^"]+)", line \d+, in (\S+)')
_RAISED = re.compile(r"^([A-Za-z_][\w.]*)(?::|$)", re.MULTILINE)
_NUMBER = re.compile(r"0x[0-9a-f]+|\d+")


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What went wrong, and with which inputs."""

    target: str
    kind: str
    """``exception``, ``traceback``, ``time``, ``memory``, ``death``, or ``start`` without input."""
    where: str
    """One line that findings of the same cause share."""
    text: str
    """The traceback or output."""
    inputs: tuple[bytes, ...]
    """The last one broke it; those before it may have prepared that."""

    @property
    def key(self) -> str:
        """The same for findings of the same cause."""
        shared = f"{self.target} {self.kind} {_NUMBER.sub('N', self.where)}"
        return hashlib.sha256(shared.encode(errors="replace")).hexdigest()[:10]

    def save(self, folder: Path) -> Path:
        """Writes it, unless one of the same cause is there already."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{self.target}-{self.kind}-{self.key}.json"
        if not path.exists():
            entries = asdict(self)
            entries["inputs"] = [base64.b64encode(data).decode() for data in self.inputs]
            path.write_text(json.dumps(entries, indent=1))
        return path

    @classmethod
    def load(cls, path: Path) -> Finding:
        """Reads what `save` wrote."""
        entries = json.loads(path.read_text())
        entries["inputs"] = tuple(base64.b64decode(text) for text in entries["inputs"])
        return cls(**entries)


def of_exception(target: str, error: BaseException, inputs: tuple[bytes, ...]) -> Finding:
    """A finding named by the innermost line of ours that the exception passed."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if "/cartwheel/" in f.filename] or list(frames)
    place = f"{Path(ours[-1].filename).name}:{ours[-1].name}" if ours else "?"
    memory = isinstance(error, MemoryError)
    return Finding(
        target=target,
        kind="memory" if memory else "exception",
        where=place if memory else f"{place} {type(error).__name__}",
        text="".join(traceback.format_exception(error))[-20_000:],
        inputs=inputs,
    )


def of_output(target: str, text: str, inputs: tuple[bytes, ...]) -> Finding:
    """A finding of a printed traceback, named as one of an exception."""
    frames = _FRAME.findall(text)
    ours = [frame for frame in frames if "/cartwheel/" in frame[0]] or frames
    place = f"{Path(ours[-1][0]).name}:{ours[-1][1]}" if ours else "?"
    raised = _RAISED.findall(text)
    return Finding(
        target=target,
        kind="traceback",
        where=f"{place} {raised[-1] if raised else ''}",
        text=text[-20_000:],
        inputs=inputs,
    )
