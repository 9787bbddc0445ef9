"""Reads launch files in Python (ROS 2) by their syntax tree. They are never executed.

The file is long because its functions evaluate statements and expressions, which call each other.
"""

from __future__ import annotations

import ast
import functools
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any, Literal

from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.package_folders import is_file
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.launches.effort import LONGEST, UNKNOWN
from cartwheel.description.launches.environment import is_environ, is_variable, ros_variable
from cartwheel.description.launches.python.actions import (
    Later,
    called_functions,
    certain_functions,
    name_of,
    start_all,
    unused_actions,
    used,
)
from cartwheel.description.launches.python.classes import CLASSES, Classes
from cartwheel.description.launches.python.conditions import (
    CONDITIONS,
    compared,
    connected,
    holds,
)
from cartwheel.description.launches.python.functions import (
    FIRST,
    JOINS,
    OUTPUTS,
    PASSED,
    PREFIXES,
    SAME,
    SHARES,
    is_module,
)
from cartwheel.description.launches.python.imports import with_imports
from cartwheel.description.launches.python.modules import LOADER, Module, formatted
from cartwheel.description.launches.python.texts import CHANGES, ChangedFile
from cartwheel.description.launches.python_values import (
    NOTHING,
    Changed,
    Configuration,
    Description,
    Unknown,
    combined,
    concatenated,
    differ,
    is_known,
    items,
    joined,
    loaded,
    path_of,
    text,
)
from cartwheel.description.launches.python_variables import Place, Uncertain, Variables
from cartwheel.description.launches.use import Facts
from cartwheel.description.launches.variants import SUFFIXES
from cartwheel.errors import Origin

_STARTED = frozenset({"IncludeLaunchDescription", "Node", "RosGzBridge"})
"""Actions that start nodes or read files."""
_ON_OTHER_EVENTS = frozenset({"OnProcessIO", "OnShutdown", "OnStateTransition"})
"""Event handlers whose actions may never be executed."""
_End = Literal["", "continue", "break", "return"]
_ENDS: Sequence[_End] = ("", "continue", "break", "return")
"""How a block ends; empty if the statements after it may be executed."""
_DEEPEST_CALL = 8
"""Maximum nesting of calls of functions that the file defines."""
_MOST_TURNS = 500
"""Maximum number of times that the bodies of all loops of a file are evaluated."""


def read_python(path: Path, arguments: Mapping[str, str], facts: Facts, depth: int) -> None:
    """Adds the contents of a launch file to `facts`."""
    try:
        content = read_regular_text(path).removeprefix("\ufeff")
        facts.effort.spend(len(content))
        tree = with_imports(ast.parse(content), path, facts)
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    # Declared defaults may follow their use, so the file is read twice.
    unused = Facts(
        find=facts.find,
        read=_ignore,
        home=facts.home,
        effort=facts.effort,
        reversed=facts.reversed,
        strict=facts.strict,
    )
    first = Classes(path, {}, arguments, unused, depth)
    _Reader(first).file(tree)
    _Reader(Classes(path, first.defaults, arguments, facts, depth)).file(tree)


def _ignore(_path: Path, _arguments: Mapping[str, str], _facts: Facts, _depth: int) -> None:
    """Included files are irrelevant for the declared defaults."""


def _reads(places: Sequence[Any], words: Mapping[str, Any]) -> bool:
    """Whether a call of ``open`` with these arguments opens a file to read it."""
    mode = places[1] if len(places) > 1 else words.get("mode", "r")
    return isinstance(mode, str) and not set(mode) & set("wax+")


class _Reader:
    def __init__(self, classes: Classes) -> None:
        self._classes = classes
        self._path = classes.path
        self._facts = classes.facts
        self._turns = _MOST_TURNS
        self._names = Variables({"__file__": str(self._path)})
        self._functions: dict[str, ast.FunctionDef] = {}
        """The functions of the file that the file itself calls."""
        self._calls = 0
        """The number of these functions that are being evaluated."""
        self._returned: list[tuple[int, Any]] = []
        """The lines of the ``return`` statements of the last of them, and their values."""
        self._started: list[Later] = []
        """The actions that are assigned to variables."""
        self._unused: frozenset[ast.stmt] = frozenset()
        """The statements whose actions nothing uses."""
        self._certain: frozenset[str] = frozenset()
        """The names of the functions that are certainly called."""

    def file(self, tree: ast.Module) -> None:
        """Evaluates a launch file. Actions whose use is unknown are started last."""
        self._functions = called_functions(tree)
        self._unused = unused_actions(tree, self._facts.effort)
        self._certain = certain_functions(tree)
        space = self._facts.namespace
        try:
            self.block(tree.body)
        except RecursionError:  # the rest of the file is unknown
            self._facts.namespace = space
        for each in self._started:
            if not each.skipped:
                with self._facts.within(each.space), self._facts.doubting():
                    each.start()

    def block(self, statements: Iterable[ast.stmt]) -> _End:
        """Evaluates statements in their order; of branches, all that may be executed.

        The body of a loop is evaluated for each value, or once if the values are unknown.

        Returns:
            The statement that certainly ends it.
        """
        for each in statements:
            self._facts.effort.spend()
            if each in self._unused:
                continue
            if isinstance(each, ast.FunctionDef) and each.name in self._functions:
                continue
            if isinstance(each, ast.Assign):
                value = self._assigned(each.value)
                for target in each.targets:
                    self._assign(target, value)
            elif isinstance(each, ast.AnnAssign) and each.value is not None:
                self._assign(each.target, self._assigned(each.value))
            elif isinstance(each, ast.AugAssign):
                held, value = self.value(each.target), self._assigned(each.value)
                self._assign(each.target, combined(each.op, held, value))
            elif isinstance(each, ast.Expr):
                self.value(each.value)
            elif isinstance(each, ast.Return):
                value = None if each.value is None else self.value(each.value)
                self._returned.append((each.lineno, value))
                return "return"
            elif isinstance(each, ast.Break | ast.Continue):
                return "break" if isinstance(each, ast.Break) else "continue"
            elif isinstance(each, ast.For):
                if end := self._loop(each):
                    return end
            elif isinstance(each, ast.If):
                if end := self._branches(each):
                    return end
            elif isinstance(each, ast.With):
                for item in each.items:
                    if item.optional_vars is not None:
                        self._assign(item.optional_vars, self.value(item.context_expr))
                if end := self.block(each.body):
                    return end
            elif isinstance(each, ast.Try):
                # What it raises may be caught.
                with self._facts.doubting():
                    end = self.block(each.body) or self.block(each.orelse)
                if end := self.block(each.finalbody) or end:
                    return end
            else:
                certain = isinstance(each, ast.FunctionDef) and each.name in self._certain
                with self._facts.doubting(not certain):
                    for name in ("body", "orelse"):
                        self.block(getattr(each, name, ()) or ())
        return ""

    def _branches(self, node: ast.If) -> _End:
        """Evaluates the branches that may be executed, each with the variables before them."""
        holds = self._holds(node.test)
        if holds is not None:
            self._facts.leaves_out = True
            return self.block(node.body if holds else node.orelse)
        before = self._names
        first, last = before.within({}), before.within({})
        with self._facts.doubting():
            self._names = first
            body = self.block(node.body)
            self._names = last
            other = self.block(node.orelse)
        self._names = before
        if body or other:
            # What follows may not be executed.
            self._facts.doubts += 1
        if "return" in (body, other):
            before.add(first if other == "return" else last)
        else:
            before.add_one_of(first, last, node.lineno, self._facts.effort)
        # Of different ends, the one after which more may be executed.
        return min(body, other, key=_ENDS.index)

    def _loop(self, loop: ast.For) -> _End:
        """Evaluates a loop. One over unknown values may be executed any number of times."""
        for item in self._items(loop.iter):
            self._assign(loop.target, item)
            with self._facts.doubting(item is NOTHING):
                end = self.block(loop.body)
            if item is not NOTHING and end in ("return", "break"):
                return end if end == "return" else ""
        return self.block(loop.orelse)

    def _assigned(self, node: ast.expr) -> Any:
        """The value of an expression that is assigned: an action starts where it is used."""
        if isinstance(node, ast.Call) and name_of(node.func) in _STARTED:
            return self._call(node, later=True)
        if isinstance(node, ast.List | ast.Tuple):
            return self._elements(node.elts, self._assigned)
        if isinstance(node, ast.Name) and node.id in self._names:
            return self._read(node.id)
        return self.value(node)

    def _read(self, name: str) -> Any:
        """The value of a variable or function; that a variable may have several is noted."""
        choice = self._names.choice(name)
        if choice is not None:
            place = (self._path, choice.other, name)
            noted = Uncertain(what="variable", used=choice.used)
            self._facts.uncertain.setdefault(place, noted)
            if self._facts.strict:
                return NOTHING
        return self._names.get(name, self._functions.get(name, NOTHING))

    @staticmethod
    def _elements(nodes: list[ast.expr], value: Callable[[ast.expr], Any]) -> list[Any]:
        """The values of a list's elements, of which some may be the elements of other lists."""
        found: list[Any] = []
        for each in nodes:
            item = value(each.value if isinstance(each, ast.Starred) else each)
            if isinstance(each, ast.Starred) and isinstance(item, list):
                found += item[:LONGEST]
            else:
                found.append(item)
        return found[:LONGEST]

    def _assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self._names.assign(target.id, value, target.lineno)
        elif isinstance(target, ast.Tuple | ast.List):
            known = isinstance(value, list) and len(value) == len(target.elts)
            for index, each in enumerate(target.elts):
                self._assign(each, value[index] if known else NOTHING)
        elif (
            isinstance(target, ast.Subscript)
            and isinstance(holder := self.value(target.value), dict)
            and isinstance(key := self.value(target.slice), str)
        ):
            holder[key] = value

    def _items(self, node: ast.expr) -> Iterator[Any]:
        """The values of a loop's variable; a single unknown one if nothing is known about them."""
        kind, values = "", [node]
        own = isinstance(node, ast.Call) and name_of(node.func) in self._functions
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not own:
            kind = node.func.id
            values = [*node.args, *(each.value for each in node.keywords if each.arg == "start")]
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            kind, values = node.func.attr, [node.func.value]
        first, *more = items(kind, [self.value(each) for each in values]) or [NOTHING]
        yield first
        for item in more:
            if self._turns <= 0:
                return
            self._turns -= 1
            yield item

    def _collected(self, node: ast.ListComp | ast.GeneratorExp | ast.SetComp) -> list[Any]:
        """The values of a comprehension."""
        found: list[Any] = []
        self._collect(node.generators, node.elt, found)
        return found

    def _mapped(self, node: ast.DictComp) -> dict[str, Any]:
        """The known keys of a dictionary comprehension, with their values."""
        found: list[Any] = []
        pair = ast.Tuple(elts=[node.key, node.value], ctx=ast.Load())
        self._collect(node.generators, pair, found)
        return {text(key): value for key, value in found if is_known(text(key))}

    def _collect(self, loops: list[ast.comprehension], item: ast.expr, found: list[Any]) -> None:
        """Adds the values of an expression for all values of the loops' variables."""
        if not loops:
            found.append(self.value(item))
            return
        first, *others = loops
        for value in self._items(first.iter):
            self._assign(first.target, value)
            held = [self._holds(test) for test in first.ifs]
            if False not in held:
                with self._facts.doubting(None in held or value is NOTHING):
                    self._collect(others, item, found)

    def value(self, node: ast.expr) -> Any:
        """The value of an expression; `NOTHING` if it is unknown."""
        self._facts.effort.spend()
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name):
            return used(self._read(node.id))
        if isinstance(node, ast.JoinedStr):
            return concatenated(self.value(each) for each in node.values)
        if isinstance(node, ast.FormattedValue):
            return self.value(node.value)
        if isinstance(node, ast.List | ast.Tuple | ast.Set):
            return self._elements(node.elts, self.value)
        if isinstance(node, ast.Dict):
            return self._dictionary(zip(node.keys, node.values, strict=True))
        if isinstance(node, ast.BinOp):
            return combined(node.op, self.value(node.left), self.value(node.right))
        if isinstance(node, ast.UnaryOp | ast.BoolOp | ast.Compare):
            return self._logical(node)
        if isinstance(node, ast.IfExp):
            return self._conditional(node)
        if isinstance(node, ast.Attribute):
            value = self.value(node.value)
            if node.attr == "parent" and isinstance(value, str):
                return str(PurePosixPath(value).parent)
            if node.attr == "robot_description" and isinstance(value, Configuration):
                return {node.attr: self._described(value, {})}
            return NOTHING
        if isinstance(node, ast.Subscript):
            held, key = self.value(node.value), self.value(node.slice)
            if is_environ(node.value):
                return ros_variable(key, self._path, node.lineno, self._facts) or NOTHING
            if isinstance(held, list) and isinstance(key, int) and 0 <= key < len(held):
                return used(held[key])
            known = isinstance(held, dict) and isinstance(key, str | int)
            return held.get(key, NOTHING) if known else NOTHING
        if isinstance(node, ast.ListComp | ast.GeneratorExp | ast.SetComp):
            return self._collected(node)
        if isinstance(node, ast.DictComp):
            return self._mapped(node)
        if isinstance(node, ast.Call):
            return self._call(node)
        return NOTHING

    def _dictionary(self, pairs: Iterable[tuple[ast.expr | None, ast.expr]]) -> dict[str, Any]:
        """The values by their keys. Those of another dictionary, as in ``{**other}``, have none; if
        it is unknown, there is a value without a known key.
        """
        found: dict[str, Any] = {}
        for key, node in pairs:
            value = self.value(node)
            if key is not None:
                found[text(self.value(key))] = value
            elif isinstance(value, dict):
                self._facts.effort.spend(len(value))
                found |= {text(name): each for name, each in value.items()}
            else:
                found[UNKNOWN] = NOTHING
        return found

    def _conditional(self, node: ast.IfExp) -> Any:
        """The value of ``a if condition else b``: a if the condition is unknown, which is noted."""
        holds = self._holds(node.test)
        self._facts.leaves_out |= holds is not None
        if holds is None:
            place = Place(self._path, node.lineno, node.col_offset)
            holds = place not in self._facts.reversed
            self._facts.conditionals.setdefault(place, node.body.lineno)
            if self._facts.strict:
                return NOTHING
        return self.value(node.body if holds else node.orelse)

    def _logical(self, node: ast.UnaryOp | ast.BoolOp | ast.Compare) -> Any:
        """The value of ``not``, ``and``, ``or`` or a comparison; that of ``a or b`` is a or b."""
        if isinstance(node, ast.BoolOp):
            *others, last = node.values
            for each in others:
                holds = self._holds(each)
                if holds is None:
                    return NOTHING
                if holds is isinstance(node.op, ast.Or):
                    return self.value(each)
            return self.value(last)
        holds = None
        if isinstance(node, ast.Compare):
            holds = self._holds(node) if len(node.ops) == 1 else None
        elif isinstance(node.op, ast.Not):
            holds = self._holds(node)
        return NOTHING if holds is None else holds

    def _holds(self, test: ast.expr) -> bool | None:
        """Whether a condition holds; None if it is unknown."""
        if isinstance(test, ast.Compare) and len(test.ops) == 1:
            return compared(test.ops[0], self.value(test.left), self.value(test.comparators[0]))
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            inner = self._holds(test.operand)
            return None if inner is None else not inner
        if isinstance(test, ast.BoolOp):
            return connected(test.op, [self._holds(each) for each in test.values])
        value = self.value(test)
        if value is None or isinstance(value, bool | int | float):
            return bool(value)
        return value != "" if is_known(value) else None

    def _call(self, node: ast.Call, *, later: bool = False) -> Any:
        """The value of a call; the action that it makes is started, or `later` is returned."""
        named = isinstance(node.func, ast.Name | ast.Attribute)
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        holder: Any = NOTHING
        if isinstance(node.func, ast.Attribute):
            name = node.func.attr
            holder = self.value(node.func.value)
        conditions = [self.value(each.value) for each in node.keywords if each.arg == "condition"]
        skipped = any(each is False for each in conditions)
        if skipped and name not in CHANGES:
            self._facts.leaves_out = True
            self._skip(node)
            return NOTHING  # the action is not executed, nor are those in it
        doubt = any(each is not True and each is not None for each in conditions)
        with self._facts.doubting(doubt or name in _ON_OTHER_EVENTS):
            found = self._held_call(node, name if named else "", holder, later=later)
        return found.source if skipped and isinstance(found, Changed) else found

    def _held_call(self, node: ast.Call, name: str, holder: Any, *, later: bool) -> Any:
        """The value of a call whose condition holds; its name is empty if it has none.

        `holder` is the object whose method is called.
        """
        space = self._facts.namespace
        is_kept = name in ("append", "extend") and isinstance(holder, list)
        function = self._function(name, holder)
        if function is not None:
            places = self._elements(node.args, self.value)
        else:
            places = [
                (self._assigned if is_kept else self.value)(
                    each.value if isinstance(each, ast.Starred) else each
                )
                for each in node.args
            ]
        words = self._dictionary(
            (None if each.arg is None else ast.Constant(each.arg), each.value)
            for each in node.keywords
            if each.arg not in ("condition", "target_action")
        )
        if not name:
            return NOTHING
        if function is not None and (isinstance(node.func, ast.Name) or isinstance(holder, Module)):
            return self._called(function, places, words)
        if name not in SAME | CHANGES and not is_kept:
            for value in (*places, *words.values()):
                start_all(value)
        if name == "GroupAction":
            self._facts.namespace = space
            return NOTHING
        if name in CONDITIONS:
            return holds(name, [*places, *words.values()])
        first = places[0] if places else next((words[w] for w in FIRST if w in words), NOTHING)
        if is_variable(node, name):
            stated = words.get("name", first)
            return ros_variable(stated, self._path, node.lineno, self._facts) or NOTHING
        if name in JOINS:
            parts = [*([] if isinstance(holder, Unknown) else [holder]), *places]
            return path_of(parts)
        if is_kept:
            more = [first] if name == "append" else first
            if isinstance(more, list) and len(holder) + len(more) <= LONGEST:
                holder += more
            return NOTHING
        if name in SHARES:
            folder = self._facts.package(text(words.get("package", first)))
            # The files of a package are not in the folder in which it is installed.
            return NOTHING if self._facts.strict and name in PREFIXES else folder
        if name in CHANGES:
            make = functools.partial(self._changed, name, first, places, words, node.lineno)
            return Changed(make, first)
        if name in SAME:
            return words if name == "dict" and words else first
        if name == "dirname":
            return str(PurePosixPath(text(first)).parent)
        if name == "open" or name in PASSED:
            if name == "open" and isinstance(node.func, ast.Name) and _reads(places, words):
                origin = Origin(file=shown_path(self._path), line=node.lineno)
                self._facts.need("file", text(first), origin)
            return first if name == "open" else holder
        if name == "format" and isinstance(holder, str):
            return formatted(holder, places, words)
        if name == LOADER:
            return Module(Path(text(first)), self._facts.effort)
        if name == "getattr" and isinstance(first, Module) and len(places) > 1:
            return first.functions.get(text(places[1]), NOTHING)
        if name == "replace" and isinstance(holder, str) and is_known(*places[:1]):
            return self._replaced(holder, places, node.lineno)
        if name in ("process_file", "process", "process_doc"):
            # For process_doc, the document is the text of the file that xacro.parse has read.
            if name == "process_file":
                origin = Origin(file=shown_path(self._path), line=node.lineno)
                self._facts.need("file", text(first), origin)
            return self._processed(text(first), words.get("mappings", {}))
        if name == "load_xacro":  # of launch_param_builder
            mappings = words.get("mappings", places[1] if len(places) > 1 else {})
            return self._processed(text(words.get("file_path", first)), mappings)
        if name in ("safe_load", "full_load", "load") and is_module(node.func, "yaml"):
            # A file that was opened is its path.
            return loaded(text(first), self._facts.effort)
        if name == "MoveItConfigsBuilder":
            robot = text(words.get("robot_name", first))
            package = text(words.get("package_name", f"{robot}_moveit_config"))
            return Configuration(robot, self._facts.package(package))
        if isinstance(holder, Configuration):
            if name == "robot_description":
                self._described(holder, {"file_path": first, **words} if places else words)
            return holder
        if name in ("lower", "upper") and is_known(holder):
            return holder.lower() if name == "lower" else holder.upper()
        if name in ("dump", "safe_dump") and is_module(node.func, "yaml"):
            self._facts.incomplete = True
            return NOTHING
        if name in OUTPUTS:
            said = first if isinstance(first, list) else [first]
            origin = Origin(file=str(self._path), line=node.lineno)
            return Description(self._facts.describe(" ".join(map(joined, said)), origin))
        if name == "parse":
            return first if is_module(node.func, "xacro") else NOTHING
        if name == "OpaqueFunction":
            self._call_opaque(words.get("function", first), words)
            return NOTHING
        meaning = CLASSES.get(name)
        if meaning is None:
            return NOTHING
        if later:
            made = functools.partial(meaning, self._classes, first, places, words)
            made = functools.partial(self._begin, made, node.lineno, self._facts.doubts > 0)
            self._started.append(Later(made, self._facts.namespace))
            return self._started[-1]
        self._classes.line = node.lineno
        return meaning(self._classes, first, places, words)

    def _begin(self, make: Callable[[], Any], line: int, doubt: bool) -> Any:
        """Starts an action that is assigned in a line, perhaps only under a condition."""
        self._classes.line = line
        with self._facts.doubting(doubt):
            return make()

    def _function(self, name: str, holder: Any) -> ast.FunctionDef | None:
        """The function that is called: one of the file, or one of an imported file."""
        if isinstance(holder, Module):
            return holder.functions.get(name)
        if name in self._functions:
            return self._functions[name]
        held = self._names.get(name) if holder is NOTHING else None
        return held if isinstance(held, ast.FunctionDef) else None

    def _changed(
        self, name: str, source: Any, places: list[Any], words: dict[str, Any], line: int
    ) -> str:
        """The path of a file whose text nav2_common or launch_ros changes."""
        stated = joined(source)
        file = ChangedFile(stated, self._facts.effort)
        if name == "ParameterFile":
            if words.get("allow_substs") is True:
                file.substitute(lambda one: self._classes.configuration(one, [], {}))
            return file.path
        key = "replacements" if name == "ReplaceString" else "param_rewrites"
        values = words.get(key, places[1] if len(places) > 1 else {})
        known = isinstance(values, dict)
        pairs = {str(old): new for old, new in values.items()} if isinstance(values, dict) else {}
        if name == "ReplaceString":
            file.replace(pairs)
        else:
            root = joined(words.get("root_key", places[2] if len(places) > 2 else ""))
            known = known and UNKNOWN not in root and "key_rewrites" not in words
            convert = words.get("convert_types", False) is True
            file.rewrite(pairs, "" if UNKNOWN in root else root.strip("/"), convert=convert)
        if (file.kept or not known) and UNKNOWN not in file.path:
            self._facts.kept[file.path] = (self._path, line)
        return file.path

    def _replaced(self, held: str, places: list[Any], line: int) -> str:
        """A text in which a launch file replaces parts. In that of a file, nothing is replaced.

        Args:
            held: The text, or the path of the file.
            places: The part, and what replaces it.
            line: Line of the launch file.
        """
        old = places[0]
        if old in held:
            new = text(places[1]) if len(places) > 1 else UNKNOWN
            first, *others = held.split(old) if old else [held]
            return concatenated([first, *itertools.chain(*((new, each) for each in others))])
        file = Path(held)
        if file.suffix in SUFFIXES and is_file(file):
            try:
                content = read_regular_text(file)
            except OSError:
                return held
            self._facts.effort.spend(len(content))
            if old in content:
                place = (self._path, line, file.name)
                self._facts.uncertain.setdefault(place, Uncertain(what="text", used=line))
        return held

    def _skip(self, node: ast.Call) -> None:
        """Notes that an action that is not executed does not start those that it contains."""
        for each in ast.walk(node):
            self._facts.effort.spend()
            found = self._names.get(each.id) if isinstance(each, ast.Name) else None
            if isinstance(found, Later):
                found.skipped = True

    def _called(self, function: ast.FunctionDef, places: list[Any], words: dict[str, Any]) -> Any:
        """The value that a function of the file returns for these arguments.

        If a ``return`` is in a branch whose condition is unknown, the value is that of the last
        ``return`` that may be executed, and this is noted if the values differ.
        """
        if self._calls >= _DEEPEST_CALL:
            return NOTHING
        outside = self._names
        stated = function.args
        plain = [each.arg for each in (*stated.posonlyargs, *stated.args)]
        given = dict.fromkeys((*plain, *(each.arg for each in stated.kwonlyargs)), NOTHING)
        for names, values in (
            (plain[len(plain) - len(stated.defaults) :], stated.defaults),
            ([each.arg for each in stated.kwonlyargs], stated.kw_defaults),
        ):
            for name, value in zip(names, values, strict=True):
                given[name] = NOTHING if value is None else self.value(value)
        given |= dict(zip(plain, places, strict=False))
        given |= {name: value for name, value in words.items() if name in given}
        self._names = outside.within(given)
        self._calls += 1
        before, self._returned = self._returned, []
        self.block(function.body)
        found, self._returned = self._returned, before
        self._calls -= 1
        self._names = outside
        if not found:
            return NOTHING
        (first, _), (last, value) = found[0], found[-1]
        if differ((each for _, each in found), self._facts.effort):
            place = (self._path, first, function.name)
            self._facts.uncertain.setdefault(place, Uncertain(what="return", used=last))
        return NOTHING if value is None else value

    def _call_opaque(self, function: Any, words: dict[str, Any]) -> None:
        """Calls a function of the file with the arguments that an `OpaqueFunction` states."""
        if not isinstance(function, ast.FunctionDef):
            return
        given, more = words.get("args", []), words.get("kwargs", {})
        self._called(
            function,
            [NOTHING, *(given if isinstance(given, list) else [])],
            more if isinstance(more, dict) else {},
        )

    def _described(self, robot: Configuration, words: dict[str, Any]) -> Description:
        """The description of a configuration of MoveIt, with arguments that state its file. The
        first ones count; by default, it is that of MoveIt's assistant.
        """
        if robot.description is None:
            default = f"config/{robot.name}.urdf.xacro"
            file = path_of((robot.folder, text(words.get("file_path", default))))
            robot.description = self._processed(file, words.get("mappings", {}))
        return robot.description

    def _processed(self, file: str, mappings: Any) -> Description:
        arguments = (
            {key: text(value) for key, value in mappings.items()}
            if isinstance(mappings, dict)
            else {}
        )
        return Description(self._facts.add(Path(file), arguments))
