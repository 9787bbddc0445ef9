"""Which blocks of Cartwheel's code an input reaches, cheaply enough to ask for each input.

An import hook writes ``hits[n] = 1`` to the begin of each function, branch, loop and handler.
Reading a URDF takes 5 % longer with it, and six times as long with a trace function.
"""

from __future__ import annotations

import ast
import builtins
import hashlib
import importlib.abc
import importlib.machinery
import importlib.util
import marshal
import os
import sys
import zlib
from collections.abc import Sequence
from pathlib import Path
from types import CodeType, ModuleType

import numpy as np

_NAME = "__campaign_hits__"
_MOST = 1 << 17
_THIS = sys.version.encode() + Path(__file__).read_bytes()
"""What the compiled modules depend on, apart from their sources."""


class Coverage:
    """Blocks reached so far, of the modules of a package that are imported from now on.

    Args:
        package: Its name.
        file: Keeps what was reached from one process to the next.
        compiled: A folder for the compiled modules, which all processes of a campaign share.
    """

    def __init__(self, package: str, file: Path, compiled: Path) -> None:
        self._file = file
        self._hits = bytearray(_MOST)
        self._now = np.frombuffer(self._hits, dtype=np.uint8)
        self._seen = np.zeros(_MOST, dtype=np.uint8)
        if file.exists():
            self._seen = np.frombuffer(file.read_bytes(), dtype=np.uint8).copy()
        setattr(builtins, _NAME, self._hits)
        compiled.mkdir(exist_ok=True)
        sys.meta_path.insert(0, _Finder(package, compiled))

    def is_new(self) -> bool:
        """Whether a block was reached for the first time since the last call."""
        new = bool((self._now > self._seen).any())
        if new:
            np.maximum(self._seen, self._now, out=self._seen)
        self._now[:] = 0
        return new

    def save(self) -> None:
        """Writes the file."""
        self._file.write_bytes(self._seen.tobytes())

    @property
    def blocks(self) -> int:
        """How many blocks were reached."""
        return int(self._seen.sum())


class _Finder(importlib.abc.MetaPathFinder):
    def __init__(self, package: str, compiled: Path) -> None:
        self._package = package
        self._compiled = compiled

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if name != self._package and not name.startswith(f"{self._package}."):
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        if spec is not None and isinstance(spec.loader, importlib.machinery.SourceFileLoader):
            spec.loader = _Loader(spec.loader.name, spec.loader.path, self._compiled)
        return spec


class _Loader(importlib.machinery.SourceFileLoader):
    def __init__(self, fullname: str, path: str, compiled: Path) -> None:
        super().__init__(fullname, path)
        self._compiled = compiled

    def get_code(self, fullname: str) -> CodeType:
        """Compiled apart from Python's cache, where no code with counters may be left behind."""
        data = self.get_data(self.path)
        kept = (
            self._compiled
            / hashlib.sha256(b"\0".join((_THIS, self.path.encode(), data))).hexdigest()
        )
        if kept.exists():
            code = marshal.loads(kept.read_bytes())
            assert isinstance(code, CodeType)
            return code
        made = self.source_to_code(data, self.path)
        # Another process may be writing the same, or be killed meanwhile.
        new = kept.with_suffix(f".{os.getpid()}")
        new.write_bytes(marshal.dumps(made))
        new.replace(kept)
        return made

    def source_to_code(self, data: bytes, path: str) -> CodeType:  # type: ignore[override]
        tree = ast.parse(data, path)
        for node in ast.walk(tree):
            if isinstance(node, ast.Module | ast.ClassDef):
                continue
            if not hasattr(node, "lineno"):
                continue
            for field in ("body", "orelse", "finalbody"):
                body = getattr(node, field, None)
                if isinstance(body, list) and body:
                    at = int(_is_docstring(body[0]))
                    body.insert(at, _mark(f"{path}:{node.lineno}:{field}", body[0]))
        return compile(tree, path, "exec", dont_inherit=True)


def _is_docstring(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _mark(place: str, near: ast.stmt) -> ast.stmt:
    """The number is the place's hash, so that it stays the same whatever is imported first."""
    made = ast.Assign(
        [
            ast.Subscript(
                ast.Name(_NAME, ast.Load()),
                ast.Constant(zlib.crc32(place.encode()) % _MOST),
                ast.Store(),
            )
        ],
        ast.Constant(1),
    )
    for node in ast.walk(made):
        ast.copy_location(node, near)
    return made
