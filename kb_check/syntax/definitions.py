"""The definitions of functions in a syntax tree."""

from __future__ import annotations

import ast

FunctionDefinition = ast.FunctionDef | ast.AsyncFunctionDef
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)  # to ask a script for
