"""Threads of numpy's linear algebra."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from cartwheel import blas

COUNT = """
from pathlib import Path
from cartwheel import blas
{use}
import numpy
print(len(list(Path("/proc/self/task").iterdir())))
"""


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="numpy starts no threads here")
@pytest.mark.parametrize(
    ("use", "set_by_user", "single"),
    [
        ("blas.use_one_thread()", None, True),
        ("", None, False),
        ("blas.use_one_thread()", "2", False),
    ],
)
def test_numpy_starts_no_threads_unless_the_user_wants_them(
    use: str, set_by_user: str | None, single: bool
) -> None:
    environment = {n: v for n, v in os.environ.items() if "OPENBLAS" not in n}
    if set_by_user is not None:
        environment["OPENBLAS_NUM_THREADS"] = set_by_user
    done = subprocess.run(
        [sys.executable, "-c", COUNT.format(use=use)],
        env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert (int(done.stdout) == 1) is single


def test_programs_of_others_have_the_users_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in os.environ if "OPENBLAS" in name]:
        monkeypatch.delenv(name)
    original = dict(os.environ)
    monkeypatch.setattr(os, "environ", dict(original))
    blas.use_one_thread()
    assert len(os.environ) == len(original) + 2
    assert blas.environment_for_others() == original

    monkeypatch.setattr(os, "environ", {**original, "OPENBLAS_NUM_THREADS": "3"})
    blas.use_one_thread()
    assert blas.environment_for_others() == {**original, "OPENBLAS_NUM_THREADS": "3"}
