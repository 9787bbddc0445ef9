"""Evaluates expressions in untrusted descriptions without access to Python.

An expression is parsed by `ast`, and each allowed node becomes a closure. Nothing else is
executed: there is no `eval`. Values are numbers, strings, lists, tuples, sets, dicts and ranges;
only listed functions and methods can be called. The size of each result and the total are limited.

The libraries simpleeval 1.0.8 and asteval 1.0.10 also prevent arbitrary code. However, eight of 13
expressions with huge results killed the process with both of them, for example
``'a'.ljust(10**9)``, ``round(5, -10**8)`` and deeply nested lists. Neither library supports
lambdas, or xacro's symbol tables, which are evaluated lazily.
"""

from cartwheel.description.expressions.budget import Budget, ExpressionError
from cartwheel.description.expressions.evaluator import Evaluator
from cartwheel.description.expressions.functions import BUILTINS, MATH, Function

__all__ = ["BUILTINS", "MATH", "Budget", "Evaluator", "ExpressionError", "Function"]
