"""The page about worlds lists all bundled worlds and models."""

import re

from .pages import ROOT


def test_the_page_lists_what_is_bundled() -> None:
    text = (ROOT / "docs/worlds.md").read_text()
    listed = {
        name
        for line in text.splitlines()
        if line.startswith("| `")
        for name in re.findall(r"`([^`]+)`", line.split("|")[1])
    }
    models = {path.name for path in (ROOT / "models").iterdir()}
    worlds = {path.stem for path in (ROOT / "worlds").iterdir() if path.suffix == ".world"}
    assert models and worlds and models | worlds <= listed, (models | worlds) - listed
