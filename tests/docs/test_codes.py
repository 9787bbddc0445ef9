"""Diagnostic codes that pages name exist, under that name."""

import re
from pathlib import Path

import pytest

from cartwheel.codes import code_named

from .pages import DOCS, ROOT

_CODE = re.compile(r"\b(CW\d{3})(?: ([a-z][a-z0-9]*(?:-[a-z0-9]+)+))?")
WITH_CODES = [
    page
    for page in sorted((ROOT / "README.md", *DOCS.rglob("*.md")))
    if _CODE.search(page.read_text())
]


@pytest.mark.parametrize("page", WITH_CODES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_codes_of_a_page_exist(page: Path) -> None:
    for number, name in _CODE.findall(page.read_text()):
        assert code_named(number).name == (name or code_named(number).name)
