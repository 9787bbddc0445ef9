"""Evaluates the expressions of descriptions, which strangers wrote, without reaching Python.

An expression is parsed by `ast`, and each node that is allowed becomes a closure. Nothing else
runs: there is no `eval`. Values are numbers, texts, lists, tuples, sets, dicts and ranges; only
functions and methods on a list can be called. Each result is bounded, and so is their sum.
"""

from cartwheel.description.expressions.budget import Budget, ExpressionError
from cartwheel.description.expressions.functions import BUILTINS, MATH, Function
from cartwheel.description.expressions.syntax import Evaluator

__all__ = ["BUILTINS", "MATH", "Budget", "Evaluator", "ExpressionError", "Function"]
