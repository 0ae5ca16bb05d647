"""Recognises what is meant by names and words that stand side by side: a member and its class or module, what words ask
of an expression, imports.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import STOP_WORDS, stem, words
from kb_build.symbols.api_names import STRUCT, TYPES
from kb_serve.recognise.by_words.members_by_words import members_by_words

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.old_code import OldCode

_OF = frozenset({"a", "an", "from", "in", "of", "on", "the", "to"})


def said_in_words(chains: Iterable[Chain]) -> set[str]:
    """The stems of what a query says beside its code."""
    return {stem(word) for chain in chains if not chain.is_code for word in words(chain.root)}


class NamesBeside:
    """Recognises such names against one base."""

    def __init__(self, reader: BaseReader, old: OldCode) -> None:
        self._reader = reader
        self._old = old

    def recognise(self, chains: list[Chain], recognition: Recognition) -> None:
        """Adds them, where the expressions among ``chains`` were read before."""
        self._asked_of(chains, recognition)
        self._imported(chains, recognition)
        self._module_with_member(chains, recognition)
        self._class_with_member(chains, recognition)

    def _asked_of(self, chains: list[Chain], recognition: Recognition) -> None:
        """Adds what words ask of an expression: ``f-curves of obj.action``, ``add a driver to obj.location``."""
        if not any(chain.steps for chain in chains):
            return
        said = said_in_words(chains)
        for place, chain in enumerate(chains):
            certain = recognition.readings.get(chain.key, "")
            path = certain or next(iter(recognition.guesses.get(chain.key, ())), "")
            entry = self._reader.entry(path) if path and chain.steps else None
            if entry is None or entry.kind not in {"property", "context"}:
                continue
            for name in self._functions_of_all:
                if said.issuperset(map(stem, words(name))):
                    recognition.add(f"{STRUCT}.{name}", 0.975, "asked of it")
            if certain and entry.type == "pointer" and entry.target:
                self._member_before(chains[:place], TYPES + entry.target, recognition)

    def _member_before(self, before: list[Chain], cls: str, recognition: Recognition) -> None:
        """Adds the member of a class that the words before an expression name, ``f-curves of``."""
        roots = [chain.root for chain in before if not chain.steps]
        while roots and roots[-1] in _OF:
            roots.pop()
        for name in ("".join(roots[-2:]), *roots[-1:]):
            if name in STOP_WORDS:
                continue
            if member := self._reader.member_of(cls, name):
                recognition.add(member.path, 0.98, "asked of it")
            elif gone := self._old.member(cls, name):
                recognition.add_removed(gone)

    @cached_property
    def _functions_of_all(self) -> list[str]:
        """The functions of everything in Blender whose names have several words: ``keyframe_insert``."""
        return [name for name in self._reader.members(STRUCT) if "_" in name.strip("_")]

    def _imported(self, chains: list[Chain], recognition: Recognition) -> None:
        """Adds what an import is of, ``from bpy.app import handlers``, before its module; nothing for a script, which
        is about what follows.
        """
        roots = [chain.root for chain in chains]
        if any(chain.steps or chain.assigned for chain in chains[2:]):
            return
        if roots[:1] == ["import"]:
            paths = [chain.dotted for chain in chains[1:2]]
        elif roots[:1] == ["from"] and roots[2:3] == ["import"]:
            paths = [f"{chains[1].dotted}.{root}" for root in roots[3:]]
        else:
            return
        for rank, path in enumerate(path for path in paths if self._reader.entry(path)):
            recognition.add(path, 0.985 - 0.005 * rank, "import")

    def _module_with_member(self, chains: list[Chain], recognition: Recognition) -> None:
        """Adds a module's member that stands beside the module, ``from bpy_extras.object_utils import
        world_to_camera_view``: it comes before the module.
        """
        for chain in chains:
            module = self._reader.entry(chain.dotted) if chain.steps else None
            if module and module.kind == "module":
                for name in (other.root for other in chains if other.is_code):
                    if self._reader.entry(f"{module.path}.{name}"):
                        recognition.add(f"{module.path}.{name}", 0.98, "module and member")

    def _class_with_member(self, chains: list[Chain], recognition: Recognition) -> None:
        """Adds a class's member that stands beside the class, ``SoftBodySettings goal_spring``.

        It comes before the class, unless it may be a word of the question.
        """
        bare = [chain.root for chain in chains if not chain.steps]
        names = list(dict.fromkeys(bare))
        # All classes have a capital or a ``_`` in their names.
        paths = [TYPES + root for root in names if "_" in root or not root.islower()]
        self._reader.entry.load(paths)
        named = map(self._reader.entry, paths)
        classes = [entry for entry in named if entry and entry.kind == "class"]
        if not classes:
            return
        # ``mass of ClothSettings``
        assigned = {chain.root for chain in chains if chain.assigned and not chain.steps}
        before = {
            (first, last) for first, of, last in zip(bare, bare[1:], bare[2:], strict=False) if of in _OF
        }
        for cls in classes:
            for root in names:
                if root == cls.name:
                    continue
                member = self._reader.member_of(cls.path, root)
                is_said = "_" in root or root in assigned or (root, cls.name) in before
                if member and (is_said or root not in STOP_WORDS):
                    recognition.add(member.path, 0.98 if is_said else 0.96, "class and member")
                elif not member and is_said and (gone := self._old.member(cls.path, root)):
                    recognition.add_removed(gone)
            if len(bare) == len(chains):
                beside = [root for root in bare if root != cls.name]
                meant = members_by_words(cls.path, beside, self._reader)
                said = [word for text in beside for word in words(text) if word not in STOP_WORDS]
                # Of several, the class shows them all, unless one is meant.
                for rank, path in enumerate(meant):
                    is_one = len(meant) == 1 or words(path.rpartition(".")[2]) == said
                    recognition.add(path, (0.975 if is_one else 0.955) - 0.005 * rank, "class and words")
