"""Imports point one way: each room knows only the rooms below it."""

import ast
import functools
import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "cartwheel"

# Each room, and the rooms it may import; the leaves are open to all.
LEAVES = {
    "blas",
    "budget",
    "errors",
    "similar_names",
    "reporting",
    "codes",
    "geometry",
    "calls",
    "forks",
    "options",
    "watchers",
    "yaml_text",
    "jobs",
}
MAY_IMPORT = {
    "blas": set(),
    "budget": set(),
    "jobs": set(),
    "errors": set(),
    "similar_names": set(),
    "reporting": set(),
    "codes": set(),
    "geometry": set(),
    "calls": set(),
    "yaml_text": set(),
    "forks": set(),
    "options": set(),
    "watchers": set(),
    "arrays": set(),
    "gate": set(),
    "messages": set(),
    "msgs": {"messages"},
    "graph": {"messages"},
    "description": set(),
    "world": {"description"},
    "simulation": {"description", "world"},
    "component": {"simulation", "messages", "graph"},
    "devices": {"component", "description", "world", "simulation", "messages", "graph"},
    "dialects": {"component", "description", "devices", "world", "simulation", "messages", "graph"},
    "plugin": {"component", "description", "dialects", "graph"},
    "interfaces": {"description", "simulation", "graph"},
    "session": {"component", "description", "simulation", "messages", "graph", "dialects"},
    "saving": {
        "component",
        "description",
        "world",
        "simulation",
        "messages",
        "graph",
        "dialects",
        "session",
    },
    "api": {
        "saving",
        "arrays",
        "gazebo",
        "description",
        "simulation",
        "messages",
        "graph",
        "interfaces",
        "session",
        "dialects",
        "bridges",
        "assembly",
    },
    "control": {"description", "simulation", "messages", "graph", "interfaces"},
    "viewer": {
        "arrays",
        "description",
        "simulation",
        "messages",
        "graph",
        "interfaces",
        "gate",
    },
    "gazebo": {"description", "world", "simulation", "messages", "graph", "dialects", "session"},
    "bridges": {"messages", "graph", "gate"},
    "assembly": {
        "description",
        "simulation",
        "messages",
        "graph",
        "interfaces",
        "dialects",
        "session",
        "gazebo",
        "bridges",
        "gate",
        "control",
        "viewer",
    },
    "playback": {"description", "simulation", "messages", "graph", "bridges"},
    "checks": {"description", "dialects"},
    "corpus": {
        "checks",
        "description",
        "simulation",
        "messages",
        "graph",
        "devices",
        "dialects",
        "api",
    },
    "testing": {
        "api",
        "arrays",
        "description",
        "messages",
        "graph",
        "gazebo",
        "bridges",
    },
    "scenarios": {"api", "arrays", "testing", "description", "messages", "graph"},
    "batch": {"api", "assembly", "simulation", "messages", "arrays"},
    "gym": {"api", "batch"},
    "sweeps": {"api"},
    "dataset": {"api", "arrays", "description"},
    "cli": {
        "description",
        "world",
        "simulation",
        "messages",
        "graph",
        "interfaces",
        "session",
        "control",
        "viewer",
        "gazebo",
        "bridges",
        "gate",
        "playback",
        "assembly",
        "api",
        "dialects",
        "corpus",
        "checks",
        "scenarios",
    },
    "__main__": {"cli"},
}


@functools.cache
def parsed(path: Path) -> ast.Module:
    """The syntax tree of a file, for all rules."""
    return ast.parse(path.read_text())


def shown(path: Path) -> str:
    return str(path.relative_to(SOURCE.parent))


def room_of(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


@functools.cache
def imports(path: Path) -> list[tuple[ast.Import | ast.ImportFrom, bool]]:
    """The imports of a file, wherever in the file, and whether each is made when it runs."""
    found: list[tuple[ast.Import | ast.ImportFrom, bool]] = []
    pending: list[tuple[ast.AST, bool]] = [(parsed(path), True)]
    while pending:
        node, runs = pending.pop()
        if isinstance(node, ast.Import | ast.ImportFrom):
            found.append((node, runs))
            continue
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            runs = False
        # Imports are statements, which only these fields of a node contain.
        for name in ("body", "orelse", "finalbody", "handlers", "cases"):
            below = getattr(node, name, ())
            if isinstance(below, list):  # not of an expression
                pending += [(each, runs) for each in below]
    return found


def test_imports_are_found_wherever_they_are(tmp_path: Path) -> None:
    file = tmp_path / "file.py"
    file.write_text("""
import a
from typing import TYPE_CHECKING
if TYPE_CHECKING:
    import b
class C:
    def f(self):
        async def g():
            for x in y:
                with z: import d
            else: import e
            while z: import f
        try: import h
        except E: import i
        else: import j
        finally: import k
        match x:
            case 1: from l import m
        if x: pass
        elif y: import n
x = 1 if y else (lambda: 2)
""")
    names = {each.name: runs for node, runs in imports(file) for each in node.names}
    assert names == {"TYPE_CHECKING": True, **dict.fromkeys("adefhijkmn", True), "b": False}


def imported_rooms(path: Path) -> set[tuple[str, int]]:
    """Every room of ours that a file imports, wherever in the file, with its line."""
    found = set()
    for node, _ in imports(path):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: a relative import hides its room"
            module = node.module or ""
            names = (
                [f"cartwheel.{alias.name}" for alias in node.names]
                if module == "cartwheel"
                else [module]
            )
        for name in names:
            parts = name.split(".")
            if parts[0] == "cartwheel" and len(parts) > 1:
                found.add((parts[1], node.lineno))
    return found


FILES = sorted(
    path for path in SOURCE.rglob("*.py") if path.parent != SOURCE or path.stem != "__init__"
)


def test_each_room_has_a_place_in_the_order() -> None:
    assert {room_of(path) for path in FILES} <= set(MAY_IMPORT)


def test_a_file_imports_only_rooms_below_its_own() -> None:
    wrong = [
        f"{shown(path)}:{line}: {room_of(path)} may not import {name}"
        for path in FILES
        for name, line in sorted(imported_rooms(path))
        if name not in MAY_IMPORT[room_of(path)] | LEAVES | {room_of(path)}
    ]
    assert not wrong, "\n".join(wrong)


def test_the_order_has_no_cycle() -> None:
    done: set[str] = set()
    while len(done) < len(MAY_IMPORT):
        ready = {room for room, below in MAY_IMPORT.items() if room not in done and below <= done}
        assert ready, f"a cycle among {set(MAY_IMPORT) - done}"
        done |= ready


FOLDERS = sorted({path.parent for path in FILES if path.parent != SOURCE})
NESTED_FORMATS = {("urdf", "sdf")}
"""An SDF file may include a URDF file, whose ``<gazebo>`` tags may contain SDF."""
MOST_FILES = 26
GENERATED = SOURCE / "msgs"
"""A module and a stub for each ROS package."""
MOST_LINES = 400


@functools.cache
def imported_modules(path: Path) -> frozenset[str]:
    """The modules that a file imports when it runs."""
    return frozenset(_imported_modules(path))


def _imported_modules(path: Path) -> Iterator[str]:
    for node, runs in imports(path):
        if isinstance(node, ast.ImportFrom) and runs:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_the_files_and_folders_of_a_folder_import_each_other_one_way() -> None:
    cycles = {shown(folder): cycle for folder in FOLDERS if (cycle := cycle_in(folder))}
    assert not cycles


def cycle_in(folder: Path) -> list[str]:
    """Files and folders of a folder that import each other in a circle; empty without one."""
    below: dict[str, set[str]] = {}
    prefix = folder.relative_to(SOURCE.parent).parts
    for path in folder.rglob("*.py"):
        name = path.relative_to(folder).parts[0].removesuffix(".py")
        if name == "__init__":
            continue
        for module in imported_modules(path):
            parts = module.split(".")
            if tuple(parts[: len(prefix)]) == prefix and len(parts) > len(prefix):
                below.setdefault(name, set()).add(parts[len(prefix)])
    order = {
        name: {each for each in names if each != name and (name, each) not in NESTED_FORMATS}
        for name, names in below.items()
    }
    try:
        TopologicalSorter(order).prepare()
    except CycleError as error:
        cycle: list[str] = error.args[1]
        return cycle
    return []


def test_a_folder_is_small_enough_to_look_through() -> None:
    sizes = {
        shown(folder): len([path for path in folder.iterdir() if path.name != "__pycache__"])
        for folder in FOLDERS
        if folder != GENERATED
    }
    assert not {folder: size for folder, size in sizes.items() if size > MOST_FILES}


def test_a_long_file_says_why_it_is_long() -> None:
    lengths = {path: len(path.read_text().splitlines()) for path in FILES}
    long = [
        f"{shown(path)}: {length}"
        for path, length in lengths.items()
        if length > MOST_LINES
        and "The file is long because" not in (ast.get_docstring(parsed(path)) or "")
    ]
    assert not long


def test_wires_and_browser_are_imported_only_in_their_rooms() -> None:
    homes = {
        "viser": "viewer",
        "h11": "gate",
        "rospy": "bridges",
        "cyclonedds": "bridges",
        "foxglove": "bridges",
        "mujoco": None,
    }
    for path in FILES:
        for node, _ in imports(path):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                names = [node.module or ""]
            for name in names:
                top = name.split(".")[0]
                if top == "mujoco":
                    assert room_of(path) in {"world", "simulation", "cli"}, f"{path} imports mujoco"
                elif top in homes:
                    assert room_of(path) == homes[top], f"{path} imports {top}"


def test_rtps_lite_imports_nothing_of_cartwheel() -> None:
    files = sorted((SOURCE.parent / "rtps_lite").glob("*.py"))
    assert len(files) > 5
    for path in files:
        assert not imported_rooms(path), path
        assert "cartwheel" not in path.read_text().lower(), path


def test_the_internals_of_viser_are_used_in_one_file() -> None:
    private = re.compile(r"viser import _|\._websock|\._impl\b|\._gui_input|\._release_cross")
    users = [path.name for path in FILES if private.search(path.read_text())]
    assert users == ["viser_internals.py"]


def test_what_rooms_share_has_a_type() -> None:
    """A cast, or a variable of type ``Any``, would hide a method that only some of them have."""
    hidden = [
        f"{shown(path)}:{node.lineno}: {ast.unparse(node)}"
        for path in FILES
        for node in ast.walk(parsed(path))
        if hides_type(node)
    ]
    assert not hidden


def hides_type(node: ast.AST) -> bool:
    """Whether a simulation, a session or a graph gets another type than its own."""
    if isinstance(node, ast.Call) and ast.unparse(node.func) in ("cast", "typing.cast"):
        value: ast.expr | None = node.args[1]
    elif isinstance(node, ast.AnnAssign) and ast.unparse(node.annotation) == "Any":
        value = node.value
    else:
        return False
    name = getattr(value, "attr", getattr(value, "id", ""))
    return name.strip("_") in ("graph", "player", "session", "simulation")


def test_a_hidden_type_is_found() -> None:
    for text in ("player: Any = self.simulation", "x = cast('Player', session._simulation)"):
        assert any(map(hides_type, ast.walk(ast.parse(text))))
    assert not any(map(hides_type, ast.walk(ast.parse("graph: Graph = session.graph"))))
