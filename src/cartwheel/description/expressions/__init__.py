"""Evaluates expressions in untrusted descriptions without access to Python.

An expression is parsed by `ast`, and each allowed node becomes a closure. Nothing else is executed:
there is no `eval`. Values are numbers, strings, lists, tuples, sets, dicts and ranges; only listed
functions and methods can be called. The size of each result and the total are limited.
"""

from cartwheel.description.expressions.budget import Budget, ExpressionError
from cartwheel.description.expressions.functions import BUILTINS, MATH, Function
from cartwheel.description.expressions.syntax import Evaluator

__all__ = ["BUILTINS", "MATH", "Budget", "Evaluator", "ExpressionError", "Function"]
