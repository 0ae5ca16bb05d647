"""What was recognised in a query; filled by the recognisers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal

from kb_serve.recognise.chains.chains import ChainKey
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from kb_serve.recognise.likely.corrections import Correction
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol

# What makes a match of something.
Why = Literal[
    "address",
    "asked of it",
    "attribute of None",
    "behind the successor",
    "class and member",
    "class and words",
    "correction",
    "described",
    "enum item",
    "error message",
    "exact",
    "expression",
    "former name",
    "import",
    "label",
    "made with the successor",
    "may be None",
    "module and member",
    "name",
    "newer node",
    "on the way",
    "owner",
    "quoted name",
    "replacement",
    "same name",
    "similar name",
    "successor",
    "title",
    "within",
    "wrong operator",
]
SIMILAR: Final = "similar name"  # why: one of the names closest to a missing one
WHOLE_LABEL = 0.82  # how sure something is that is called as the whole query


@value_class
class RecognisedName:
    """A symbol or page that the query names. ``sure`` is 1 for an exact spelling and less for a likely reading."""

    id: str
    sure: float
    why: Why


@value_class
class MissingName:
    """A name that does not exist on the class (or in the module) ``owner``; ``owner`` may be empty.

    ``assigned`` tells whether the query assigns to it, ``called`` whether it calls it, ``sure`` whether the owner is
    certain. Where the owner is what a variable's name suggests, ``variable`` is that name; where it hardly does,
    ``told`` is false: what resembles the name may help, but nothing is denied.
    """

    name: str
    owner: str = ""
    assigned: bool = False
    sure: bool = False
    called: bool = False
    variable: str = ""
    told: bool = True


@dataclass(slots=True)
class Recognition:
    """What was recognised: ``matches``, and what was wrong with the names in the query.

    ``arguments``: function or operator → those of its arguments that are named beside it.
    ``readings``: expression → the symbol that it leads to.
    ``guesses``: expression of which that is not certain → the symbols that it may lead to, likeliest first.
    ``doubted`` is what the class lacks that the first expression's variable is named after, where another class has
    it: unlike the ``missing`` names it is right as likely as not, and nothing else is looked for.
    ``notes`` are further sentences for the caller. ``alike`` are the members of the surest one's name that other things
    have for which the query's variable may stand, ``alike_lost`` that variable, and one that a likelier thing had.
    ``is_open`` tells that the query does not say which of several operators it is about, ``says_all`` that what it is
    about is none of Blender's: words of it are found only by chance.
    """

    matches: list[RecognisedName] = field(default_factory=list)
    missing: list[MissingName] = field(default_factory=list)
    corrections: list[Correction] = field(default_factory=list)
    removed: list[RemovedSymbol] = field(default_factory=list)
    arguments: dict[str, list[str]] = field(default_factory=dict[str, "list[str]"])
    readings: dict[ChainKey, str] = field(default_factory=dict[ChainKey, str])
    guesses: dict[ChainKey, list[str]] = field(default_factory=dict[ChainKey, list[str]])
    doubted: MissingName | None = None
    notes: list[str] = field(default_factory=list)
    alike: list[str] = field(default_factory=list)
    alike_lost: tuple[str, RemovedSymbol] | None = None
    is_open: bool = False
    says_all: bool = False

    def add(self, identifier: str, sure: float, why: Why) -> None:
        """Adds a match, or raises the certainty of the one with the same id."""
        for number, match in enumerate(self.matches):
            if match.id == identifier:
                if sure > match.sure:
                    self.matches[number] = RecognisedName(identifier, sure, why)
                return
        self.matches.append(RecognisedName(identifier, sure, why))

    def add_removed(self, removed: RemovedSymbol) -> None:
        """Adds a removed symbol that the query names, once."""
        if all(known.path != removed.path for known in self.removed):
            self.removed.append(removed)

    def add_former_name(self, taken_as: str, sure: float) -> None:
        """Adds the symbol that the query names by a former name which this Blender still takes."""
        self.add(taken_as, sure, "former name")
        self.notes.append(f"The former name still works here; the name is now `{taken_as}`.")

    @property
    def dead_end(self) -> bool:
        """Whether the query names removed symbols, and it is known of each that nothing takes its place."""
        return bool(self.removed) and all(removed.without_successor for removed in self.removed)

    @property
    def best(self) -> RecognisedName | None:
        """The surest match."""
        return max(self.matches, key=lambda match: match.sure, default=None)
