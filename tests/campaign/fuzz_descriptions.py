"""Descriptions: loaded, and small ones built and run for a moment.

Seeds are what is shipped, and what lies below the folder in CAMPAIGN_CORPUS.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable
from pathlib import Path

from tests.campaign import mutating
from tests.campaign.target import Target

from cartwheel.errors import CartwheelError

_ROOT = Path(__file__).parents[2]
_SEEDS = Path(__file__).parent / "seeds/fuzz_description"
"""A package with a seed for each part of xacro, and the files that they include."""
_TUTORIAL = _ROOT / "docs/tutorial/steps/07-drive"
_LARGEST = 40_000
"""Bytes of a seed."""
_MOST_LINKS = 15
"""Of what is built, one input in `_EVERY`."""
_EVERY = 4


def _files(*suffixes: str) -> list[bytes]:
    folders = [_ROOT / name for name in ("robots", "worlds", "models")]
    if "CAMPAIGN_CORPUS" in os.environ:
        folders.append(Path(os.environ["CAMPAIGN_CORPUS"]))
    found = []
    for folder in folders:
        found += [path for path in sorted(folder.rglob("*")) if path.suffix in suffixes]
    return [path.read_bytes() for path in found if path.stat().st_size <= _LARGEST]


def _expanded() -> list[bytes]:
    """The shipped robots as plain URDF."""
    from cartwheel.description.convert import to_urdf

    found = _files(".urdf")
    for path in sorted((_ROOT / "robots").rglob("*.xacro")):
        try:
            found.append(to_urdf(path).encode())
        except CartwheelError:  # a part of another
            continue
    return found


def _xacros() -> list[bytes]:
    """Those that are whole by themselves; what they include is found."""
    from cartwheel.description import load_text

    files = [*_SEEDS.glob("*.xacro"), _TUTORIAL / "cart_description/urdf/cart.xacro"]
    found = []
    for data in (*(path.read_bytes() for path in sorted(files)), *_files(".xacro")):
        try:
            load_text(data, file=str(_SEEDS / "fuzz.xacro"), package_path=_packages())
        except CartwheelError:  # a part of another
            continue
        found.append(data)
    return found


def _packages() -> list[Path]:
    return [_ROOT / "robots", _ROOT / "models", _TUTORIAL]


def _reader(file: str) -> Callable[[bytes], None]:
    def run_one(data: bytes) -> None:
        from cartwheel.description import load_text
        from cartwheel.description.model import WorldDescription

        found = load_text(data, file=file, package_path=_packages())
        if zlib.crc32(data) % _EVERY:
            return
        import cartwheel as cw

        if isinstance(found, WorldDescription):
            if sum(len(model.links) for model in found.models) <= 2 * _MOST_LINKS:
                with cw.World(found, lenient=True) as world:
                    world.run(0.1)
        elif len(found.links) <= _MOST_LINKS:
            with cw.World(lenient=True) as world:
                world.spawn(found)
                world.run(0.1)

    return run_one


def _target(name: str, seeds: Callable[[], list[bytes]], share: float) -> Target:
    return Target(
        name=name,
        seeds=seeds,
        run_one=_reader(str(_SEEDS / f"fuzz.{name}")),
        allowed=(CartwheelError,),
        mutate=mutating.xml,
        seconds=15.0,
        memory_mb=2048,
        share=share,
    )


TARGETS = (
    _target("urdf", _expanded, 2.0),
    _target("sdf", lambda: _files(".sdf"), 1.0),
    _target("world", lambda: _files(".world"), 1.0),
    _target("xacro", _xacros, 2.0),
)
