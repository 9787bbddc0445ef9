"""Functions and methods in launch files in Python, by what they return."""

from __future__ import annotations

import ast

JOINS = frozenset({"join", "joinpath", "PathJoinSubstitution"})
"""Functions that join the parts of a path."""
SHARES = frozenset(
    {
        "get_package_share_directory",
        "get_package_share_path",
        "FindPackageShare",
        "FindPackage",
        "get_package_prefix",
        "FindPackagePrefix",
    }
)
"""Functions that return the folder of a package."""
PREFIXES = frozenset({"get_package_prefix", "FindPackagePrefix"})
"""Those of them that return the folder in which it is installed."""
SAME = frozenset(
    {
        "str",
        "Path",
        "TextSubstitution",
        "ParameterValue",
        "PythonLaunchDescriptionSource",
        "XMLLaunchDescriptionSource",
        "AnyLaunchDescriptionSource",
        "FrontendLaunchDescriptionSource",
        "abspath",
        "realpath",
        "normpath",
        "expanduser",
        "dict",
        "list",
        "perform_substitution",
    }
)
"""Functions whose value is that of their first argument, or of a keyword in `FIRST`."""
FIRST = ("text", "source_file", "value", "param_file")
"""Keywords of what may also be the first argument."""
OUTPUTS = frozenset({"popen", "check_output", "getoutput"})
"""Functions that execute a command, such as ``xacro FILE``, and return its output."""
PASSED = frozenset(
    {
        "items",
        "perform",
        "toxml",
        "toprettyxml",
        "read",
        "read_text",
        "as_posix",
        "find",
        "strip",
        "resolve",
    }
)
"""Methods whose value is that of the object; ``FindPackageShare(…).find(…)`` is the folder, too."""


def is_module(function: ast.expr, name: str) -> bool:
    """Whether a function is called as one of a module."""
    return (
        isinstance(function, ast.Attribute)
        and isinstance(function.value, ast.Name)
        and function.value.id == name
    )
