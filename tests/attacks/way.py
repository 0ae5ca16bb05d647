"""A way to attack the sandbox or the server behind it: code that runs in Blender, and what is called afterwards."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

Kind = Literal["bubblewrap", "landlock"]
Server = Literal["ground", "replies", "decoder", "channel", "interpreter", "deadline"]
"""What of the server, rather than of the sandbox, an attack is aimed at."""
KINDS: tuple[Kind, ...] = ("bubblewrap", "landlock")


@dataclass(frozen=True, slots=True)
class Tool:
    """A call of a tool. ``{name}`` in strings is replaced by a fact of the target: ``{file}``, ``{folder}`` …"""

    name: str
    arguments: Mapping[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class Way:
    """One attack.

    ``attacks``: the walls that stop it, each by itself; or what of the server it is aimed at: ``ground`` (files that
    it takes from the worker), ``replies``, ``decoder``, ``channel``, ``interpreter`` (Blender's Python), ``deadline``.

    ``steps``: code for blender_execute, or tools to call. Code has the names of inside/helpers.py, ``target`` above
    all. The value of its last expression is what it got, as far as it can tell itself: anything but None, False,
    zero or empty is success. Everything else is told from outside: see outside.py.

    ``lies``: instead of Blender, a program answers the supervisor; tool → the body of a function of ``arguments``,
    ``report`` and ``truth()`` (the honest answer) that gives the reply.

    ``denied``: further types of errors that mean that the attack was denied. An error of any other type means that it
    was not carried out, so that nothing is proven.

    ``must_fail``: the last step may not be answered as if all were well. ``once``: who runs it makes no difference.

    ``seconds``: within which the server must have answered each step. ``spoils``: Blender is started anew afterwards.
    """

    name: str
    attacks: tuple[str, ...]
    steps: tuple[str | Tool, ...]
    lies: Mapping[str, str] = field(default_factory=dict[str, str])
    kinds: tuple[Kind, ...] = KINDS
    denied: tuple[str, ...] = ()
    seconds: float = 40.0
    timeout: float = 20.0
    spoils: bool = False
    must_fail: bool = False
    once: bool = False
    machine: str = ""
    ready: Callable[[], bool] | None = None


def way(name: str, attacks: str, *steps: str | Tool, **more: Any) -> Way:
    """A way; ``attacks`` holds the names of walls, separated by blanks."""
    aims = tuple(attacks.split())
    if "deadline" in aims:
        more["once"] = True
    return Way(name, aims, steps, **more)
