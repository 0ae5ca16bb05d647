"""Values that a later version lost are taken before it, also where the reference does not list them."""

from __future__ import annotations

from kb_build.symbols.records import EnumItem, Parameter, Symbol
from kb_build.symbols.taken import Taken
from kb_build.versions.successors import load_successors
from kb_build.versions.unlisted_values import with_values_until

_LISTED = (EnumItem("FLAT_COLOR"), EnumItem("UNIFORM_COLOR"))
_SHADERS = Symbol(
    "gpu.shader.from_builtin",
    "function",
    "gpu.shader",
    parameters=(Parameter("shader_name", enum_items=_LISTED), Parameter("config")),
)


def test_values_of_before_are_taken_until_they_go() -> None:
    (symbol,) = with_values_until([_SHADERS], load_successors(), "3.4")
    shaders, config = symbol.parameters
    assert {"FLAT_COLOR", "2D_UNIFORM_COLOR", "3D_FLAT_COLOR"} <= {
        item.identifier for item in shaders.enum_items
    }
    assert {item.where for item in shaders.enum_items} == {None, Taken("before", version="4.0")}
    # Others may be left out of the reference as well.
    assert shaders.is_open
    assert config.enum_items == ()


def test_they_are_not_taken_from_then_on() -> None:
    assert with_values_until([_SHADERS], load_successors(), "4.0") == [_SHADERS]


def test_what_lists_nothing_is_left_alone() -> None:
    bare = Symbol("gpu.shader.from_builtin", "function", "gpu.shader", parameters=(Parameter("shader_name"),))
    assert with_values_until([bare], load_successors(), "3.4") == [bare]
