"""What is doubted at one place of a script: that it is for this Blender, or for every text that comes there."""

from __future__ import annotations

import ast
from dataclasses import dataclass

from kb_build.flow.values.types import FROM_VERSION, FromNames, FromVersion, Telling


@dataclass(frozen=True, slots=True)
class Doubts:
    """``everything``: what stands here may all be for another Blender.

    ``chosen``: it may not be come to with every text that comes from elsewhere. ``members`` are names that Blender was
    asked for, doubted whatever has them. ``chains`` are names and chains (``context.object``), by their text, of which
    the script has found that they lack a member, as those of another Blender do: what it reads from them is not for
    this one. ``unlisted`` are texts of which the script has found that something does not list them: what it gives to
    an enumeration that lists them here is for another Blender.
    """

    everything: bool = False
    chosen: bool = False
    members: frozenset[str] = frozenset()
    chains: frozenset[str] = frozenset()
    unlisted: frozenset[str] = frozenset()

    def __or__(self, other: Doubts) -> Doubts:
        """What the one or the other doubts."""
        if self is NO_DOUBTS or other is NO_DOUBTS:
            return other if self is NO_DOUBTS else self
        return Doubts(
            self.everything or other.everything,
            self.chosen or other.chosen,
            self.members | other.members,
            self.chains | other.chains,
            self.unlisted | other.unlisted,
        )

    def __and__(self, other: Doubts) -> Doubts:
        """What both doubt."""
        if self is NO_DOUBTS or other is NO_DOUBTS:
            return NO_DOUBTS
        return Doubts(
            self.everything and other.everything,
            self.chosen and other.chosen,
            self.members & other.members,
            self.chains & other.chains,
            self.unlisted & other.unlisted,
        )

    def has_member(self, name: str) -> bool:
        """Whether a member of this name is doubted, whatever has it."""
        return self.everything or name in self.members

    @property
    def anywhere(self) -> Doubts:
        """What is doubted whatever the names of this place hold, and whatever texts come to it."""
        return Doubts(self.everything, members=self.members)


def without(test: ast.expr, *, holds: bool) -> Doubts:
    """What is doubted where a condition, ``"A" in names``, tells that something does not list a text."""
    match test:
        case ast.Compare(left=ast.Constant(value=str(text)), ops=[ast.In() | ast.NotIn() as operator]):
            is_listed = isinstance(operator, ast.In) is holds
            return NO_DOUBTS if is_listed else Doubts(unlisted=frozenset({text}))
        case _:
            return NO_DOUBTS


NO_DOUBTS = Doubts()
EVERYTHING = Doubts(everything=True)
CHOSEN = Doubts(chosen=True)


def as_doubts(source: Telling) -> Doubts:
    """What a condition makes doubted that asks a value which tells of this Blender."""
    return EVERYTHING if isinstance(source, FromVersion) else Doubts(members=source.names)


def as_source(doubts: Doubts) -> Telling | None:
    """How a value tells of this Blender that was chosen by a condition which makes this doubted."""
    if doubts.everything:
        return FROM_VERSION
    return FromNames(doubts.members) if doubts.members else None
