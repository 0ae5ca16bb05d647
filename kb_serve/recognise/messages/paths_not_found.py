"""Recognises messages of paths to animate that lead nowhere: ``keyframe_insert() property "rotation" not found``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID
from kb_build.symbols.flag_names import ANIMATABLE
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.changed_by import ANIMATED_BY
from kb_serve.recognise.likely.corrections import nearest

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_MOST_KINDS = 8  # of data-blocks, those that scripts use most


class PathsNotFound:
    """Finds in one base the properties that such a path may mean."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what is called nearly so of the data-blocks that scripts use most and that lack the name itself."""
        for match in forms.first_matches(forms.NO_PATH, query):
            name = match["name"]
            kinds = self._reader.usage.heaviest(self._reader.descendants(ID))[:_MOST_KINDS]
            found = (self._like(kind.path, name) for kind in kinds)
            paths = next(filter(None, found), [])
            for rank, path in enumerate(paths):
                recognition.add(path, 0.95 - 0.01 * rank, "error message")
            if paths:
                listed = ", ".join(f"`{path}`" for path in paths)
                recognition.notes.append(f"What is animated has no `{name}`; closest: {listed}.")
        for match in forms.first_matches(forms.NOT_ANIMATED, query):
            named = [one for one in self._reader.names.by_name(match["name"]) if one.kind == "property"]
            still = [one for one in self._reader.usage.heaviest(named) if not self._is_animated(one.path)]
            for property_ in still[:1]:
                recognition.add(property_.path, 0.97, "error message")
                other = ANIMATED_BY.get(property_.path)
                instead = f" Animate `{other}`." if other else ""
                recognition.notes.append(f"`{property_.path}` cannot be animated.{instead}")

    def _like(self, cls: str, name: str) -> list[str]:
        names = self._reader.member_names(cls)
        found = () if name in names else [one for one, _ in nearest(name, names)]
        members = filter(None, (self._reader.member_of(cls, one) for one in found))
        return [
            member.path for member in self._reader.usage.heaviest(members) if self._is_animated(member.path)
        ]

    def _is_animated(self, path: str) -> bool:
        symbol = self._reader.symbol(path)
        return symbol is not None and symbol.kind == "property" and ANIMATABLE in symbol.flags
