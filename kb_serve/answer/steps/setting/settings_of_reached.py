"""Settings that are there without being made, as those of rendering are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.lines import held
from kb_serve.answer.facts.members_in_brief import are_settings_seen, settings_of
from kb_serve.answer.steps.setting.choices import choice_of
from kb_serve.interface import is_of_interface

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from kb_serve.answer.steps.scene.new_scene import NewScene

_MOST = 2


class ReachedSettings:
    """The settings of one list of steps that are reached without being made.

    ``waiting``: the steps that can be done only once something has been made that no step makes.
    """

    def __init__(self, scene: NewScene) -> None:
        self._scene = scene
        self._reader = scene.reader
        self.waiting: list[str] = []

    def steps(self, classes: Iterable[str], main: Collection[str], *, is_made: bool) -> Iterator[str]:
        """The steps that set the first of some classes which are there and have not been shown.

        ``main``: those that the topic is surely about; ``is_made``: whether it is about something that is made.
        """
        left = _MOST
        for cls in classes:
            expression = self._expression(cls) if left and cls not in self._scene.shown else ""
            settings = settings_of(cls, self._reader) if expression else ""
            # An element of something else is made for what the topic is about, if nothing else is made.
            if not settings or ("[" in expression and (is_made or cls not in main)):
                continue
            told = f"(`{cls.removeprefix(TYPES)}`): {settings}"
            ready = self._scene.pointers.reach(held(expression))
            if ready is None:
                # An element of a collection is there only if somebody has made it.
                if "[" not in expression and (not is_made or are_settings_seen(cls, self._reader)):
                    self.waiting.append(f"set, once it is not None, on `{expression}` {told}")
                    left -= 1
                    self._scene.shown.add(cls)
                continue
            left -= 1
            self._scene.shown.add(cls)
            yield from ready.steps
            if choice := choice_of(expression, self._reader):
                yield f"`{choice.code}` — a new one has `{choice.usual!r}`"
            # The steps' own object need not be the active one.
            is_own = expression.startswith("bpy.context.object") or ready.expression != held(expression)
            yield f"set on `{ready.expression if is_own else expression}` {told}"

    def _expression(self, cls: str) -> str:
        """How the one instance of a class is reached; empty where there is none, or it is the interface's."""
        symbol = self._reader.symbol(cls)
        reached = symbol.reached if symbol else ""
        # Of a collection is set which element is active, and a new one has none.
        is_collection = bool(self._reader.collections_of(cls.removeprefix(TYPES)))
        return "" if is_of_interface(reached) or is_collection else reached
