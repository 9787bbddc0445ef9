"""One simulation and one page for all tests of this folder, since each page takes seconds to open.

Each test begins with the same state, see `tests.viewer.conftest.page`. What else it chooses at the
page, such as a tab, it puts back.
"""

import pytest
from tests.viewer.conftest import Arena, opened_page


@pytest.fixture(scope="package")
def arena():
    made = Arena()
    yield made
    made.close()


@pytest.fixture(scope="package")
def shared_page(browser, arena):
    with opened_page(browser, arena) as page:
        yield page
