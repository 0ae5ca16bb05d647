"""Adds to what was recognised what is meant by a name that its class lacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import stems_of
from kb_build.symbols.paths import last_name
from kb_serve.rank.meant_members import MeantMembers, meant_members
from kb_serve.recognise.elsewhere.members_within import OF_ELEMENTS
from kb_serve.recognise.likely.corrections import is_misspelling
from kb_serve.recognise.named.data_of_others import data_of_others
from kb_serve.recognise.named.registered_names import add_registering, is_own_name
from kb_serve.recognise.recognition import SIMILAR

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kb_serve.rank.search import Searcher
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.named.data_of_others import DataOfOthers
    from kb_serve.recognise.recognition import MissingName, Recognition

_MEANT = 0.89  # how sure what the search finds of a class is meant by a name that it lacks
_MOST_MEANT, _BEFORE = 0.99, 0.01
_DOUBTED = 0.81  # … where something else has that name


class MeantNames:
    """Finds in one base what is meant by names that classes lack."""

    def __init__(self, reader: BaseReader, searcher: Callable[[], Searcher]) -> None:
        """``searcher`` gives the search, which is loaded when it is first needed."""
        self._reader = reader
        self._searcher = searcher

    def add(self, recognition: Recognition) -> None:
        """Adds what may be meant by the first name that its class lacks."""
        missing = next((one for one in recognition.missing if one.owner), recognition.doubted)
        within = [match for match in recognition.matches if match.why == "within"]
        of_elements = any(note.startswith(OF_ELEMENTS) for note in recognition.notes)
        is_found = recognition.removed or (within and not of_elements)
        if missing is None or is_found or not missing.name.isidentifier():
            return
        if is_own_name(missing.owner, missing.name, self._reader):  # whose words say nothing of Blender's
            add_registering(missing.owner, missing.name, recognition)
        else:
            self._add_meant(missing, recognition, is_of_elements=bool(within))
        recognition.matches.sort(key=lambda match: (-match.sure, match.why != "successor"))

    def _add_meant(self, missing: MissingName, recognition: Recognition, *, is_of_elements: bool) -> None:
        """Adds what Blender has that may be meant."""
        meant = self._meant(missing, recognition)
        if is_of_elements and not self._is_rather_own(missing.name, meant):
            return
        others = data_of_others(missing, self._reader)
        if others and self._is_of_others(others, meant, missing.name):
            _add_instead(others.paths, others.note, recognition)
        else:
            _add_meant(meant, missing, recognition)

    def _meant(self, missing: MissingName, recognition: Recognition) -> MeantMembers:
        """What may be meant by a name: what was recognised with certainty, else what the search finds of its class."""
        alike = tuple(
            match.id
            for match in recognition.matches
            if match.why == SIMILAR
            and (match.sure > _MEANT or is_misspelling(missing.name, last_name(match.id)))
        )
        if alike:
            return MeantMembers(alike, clear=True)
        return meant_members(missing, self._searcher(), self._reader)

    def _is_rather_own(self, name: str, meant: MeantMembers) -> bool:
        """Whether a member of the thing itself is clearly meant, as its name begins with one that its elements have:
        ``frame_current`` of a scene, not the frame of its markers.
        """
        return meant.clear and last_name(meant.paths[0]).startswith(f"{name}_")

    def _is_of_others(self, others: DataOfOthers, meant: MeantMembers, name: str) -> bool:
        """Whether a name means what another type of object has, rather than what its own data has: nothing called so,
        and what is clearly meant by other words is no collection.
        """
        said = stems_of(name)
        if any(not said.isdisjoint(stems_of(last_name(path))) for path in meant.paths):
            return False
        entry = self._reader.entry(others.paths[0])
        return not meant.clear or (entry is not None and entry.type == "collection")


def _add_instead(paths: Sequence[str], note: str, recognition: Recognition) -> None:
    """Adds what something else has, in place of what is spelled a little like the name."""
    recognition.notes.append(note)
    recognition.matches = [match for match in recognition.matches if match.why != SIMILAR]
    for place, path in enumerate(paths):
        recognition.add(path, _MOST_MEANT - _BEFORE * place, "within")


def _add_meant(meant: MeantMembers, missing: MissingName, recognition: Recognition) -> None:
    """Adds members before their class, and before what is spelled a little like the name. Where something else has that
    name, and may be meant as well, behind it.
    """
    # The class itself, and what else has that name.
    beside = [
        match.sure
        for match in recognition.matches
        if match.id == missing.owner or match.why in {"enum item", "name", "within"}
    ]
    sure = max([_MEANT, *(one + (_BEFORE if meant.clear else -_BEFORE) for one in beside)])
    if missing is recognition.doubted:
        sure = _DOUBTED
    for place, path in enumerate(meant.paths):
        recognition.add(path, min(sure, _MOST_MEANT) - _BEFORE * place, SIMILAR)
