"""Sentences about the names in a query: corrected, removed, missing."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS, STRUCT, TYPES, interface_part
from kb_build.symbols.lines import written
from kb_build.symbols.paths import as_code, is_socket, last_name, split_path
from kb_build.symbols.unlisted import OPTIONS, option_of
from kb_serve.recognise.chains.subscripts import MODIFIER_PROPERTIES, CustomProperties
from kb_serve.recognise.elsewhere.meant_elsewhere import meant_elsewhere
from kb_serve.recognise.likely.corrections import names_meant, nearest
from kb_serve.recognise.named.enum_values import EnumValues
from kb_serve.recognise.recognition import SIMILAR

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.elsewhere.meant_elsewhere import MeantElsewhere
    from kb_serve.recognise.recognition import MissingName, Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol

_CLOSE = 0.6  # similar names with at least this share of the best one's score are named
_MOST_NAMED = 3
_MOST_ALIKE = 4
_TELLS_WHAT = "Write "  # how what names something that is no Blender's begins
_NOTHING = "Nothing takes its place."
# The owners that get more while Blender runs → what gives it to them.
_ASIDE = {"bpy.ops": "add-ons", "bpy.types": "add-ons and custom properties"}
_UNLISTED = (
    "_",
    "addon_utils",
    "aud",
    "bl_keymap_utils",
    "bpy_extras",
    "nodeitems_utils",
    "rna_keymap_ui",
    "rna_prop_ui",
)  # modules of which the history has nothing, or nothing of most versions


def _list(paths: Iterable[str]) -> str:
    return ", ".join(f"`{as_code(path)}`" for path in list(paths)[:_MOST_NAMED])


def _if(variable: str) -> str:
    """Begins a sentence on a class that a variable's name suggests; "" for no variable."""
    return f"If `{variable}` is one of these: " if variable else ""


class Notes:
    """Words what was recognised, for one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._enum_values = EnumValues(reader)

    @cached_property
    def _version(self) -> str:
        return self._reader.meta.get("minor", "this version")

    def on(self, recognition: Recognition) -> list[str]:
        """Every sentence once: corrections, removed names, missing ones, and what the recognisers noted."""
        notes = [
            f"`{correction.written}` does not exist; read as `{correction.meant}`."
            for correction in recognition.corrections
            if correction.similarity < 1
        ]
        notes += map(self.removed, recognition.removed)
        notes += self._missing(recognition)
        return list(dict.fromkeys((*notes, *recognition.notes)))

    def alike(self, recognition: Recognition) -> str:
        """What else of the same name a query may mean whose variable may stand for several things; "" if nothing."""
        if recognition.removed or recognition.missing:
            return ""
        return " ".join(filter(None, (self._lost(recognition.alike_lost), self._today(recognition.alike))))

    def _lost(self, lost: tuple[str, RemovedSymbol] | None) -> str:
        """What a variable of no telling name may stand for besides, which this version lost."""
        if lost is None:
            return ""
        variable, symbol = lost
        name, instead = symbol.path.removeprefix(TYPES), " ".join(self._instead(symbol))
        return f"If `{variable}` is what had `{name}`, that was {self._span(symbol)}. {instead}"

    @staticmethod
    def _today(paths: Sequence[str]) -> str:
        if not paths:
            return ""
        named, more = paths[:_MOST_ALIKE], len(paths) - _MOST_ALIKE
        names = ", ".join(f"`{path.removeprefix(TYPES)}`" for path in named)
        return f"The variable may also stand for what has {names}{f' or {more} more' if more > 0 else ''}."

    def removed(self, symbol: RemovedSymbol) -> str:
        """When a symbol was removed, and what takes its place: by a source, or only perhaps."""
        if option := self._option_of(symbol):
            told = f"`{as_code(symbol.path)}` is not in this build of Blender {self._version}"
            return f"{told}: it is in those that are made with it, where `{option}` is True."
        return " ".join(
            (
                f"`{as_code(symbol.path)}` does not exist in Blender {self._version}: {self._span(symbol)}.",
                *self._instead(symbol),
            )
        )

    def _option_of(self, symbol: RemovedSymbol) -> str:
        """The option of the build that an operator needs of which it is not known since when Blender has it."""
        _, lacked = ("", "") if symbol.gone else self._reader.history.arrival(symbol.path)
        return option_of(symbol.path, self._build_options) if lacked else ""

    @cached_property
    def _build_options(self) -> frozenset[str]:
        paths = self._reader.rows("SELECT path FROM symbols WHERE owner = ?", OPTIONS.rstrip("."))
        return frozenset(path.removeprefix(OPTIONS) for (path,) in paths)

    def _span(self, symbol: RemovedSymbol) -> str:
        if not symbol.gone:
            _, lacked = self._reader.history.arrival(symbol.path)
            too = f" ({lacked} lacks it)" if lacked not in {"", self._version} else ""
            return f"new in {symbol.first}{' or a little before' if lacked else ''}{too}"
        versions = self._reader.history.history_versions
        if symbol.is_dated(versions):
            last = f" (last in {symbol.last})" if symbol.was_last(versions) else ""
            return f"removed in {symbol.gone}{last}"
        return f"gone by {symbol.gone} (last seen in {symbol.last})"

    def _instead(self, symbol: RemovedSymbol) -> Iterator[str]:
        if symbol.targets:
            yield f"Use {_list(symbol.targets)}."
            if condition := self.setting_of(symbol.targets[0]):
                yield condition
        elif symbol.successors and not symbol.successors[0].how.startswith(_TELLS_WHAT):
            yield _NOTHING
        elif symbol.similar:
            close = _CLOSE * symbol.similar[0][1]
            yield f"Similar names: {_list(path for path, score in symbol.similar if score >= close)}."
        elif meant := None if symbol.gone else self._before(symbol.path):
            yield meant.how
        how = next((successor.how for successor in symbol.successors if successor.how), "")
        if how and how != _NOTHING:
            yield how

    def _before(self, path: str) -> MeantElsewhere | None:
        """What Blenders have that lack what is newer."""
        owner, _, name = path.rpartition(".")
        return meant_elsewhere(owner, name, self._reader)

    def setting_of(self, path: str) -> str:
        """A sentence on the setting without which an item of an enumeration is not taken; "" for other paths."""
        owner, mark, item = split_path(path)
        where = self._enum_values.where(owner, item) if mark == ":" else None
        return self._enum_values.condition(owner, item) if where and where.wants_a_setting else ""

    def _missing(self, recognition: Recognition) -> Iterator[str]:
        removed_names = {removed.path.rpartition(".")[2] for removed in recognition.removed}
        similar = [match.id for match in recognition.matches if match.why == SIMILAR]
        closest = f" Closest: {_list(map(self._written, similar))}." if similar else ""
        for missing in recognition.missing:
            if (recognition.removed and not missing.sure) or not missing.told:
                continue
            if self._may_have_more(missing.owner):
                continue
            if not missing.owner and (similar or not recognition.matches):
                found = closest or " What follows was found by its words."
                yield f"Nothing is called `{missing.name}` in Blender {self._version}.{found}"
            elif (
                missing.owner == MODIFIER_PROPERTIES
            ):  # of which each instance has the inputs of its own group
                yield CustomProperties(self._reader).on_inputs()
            elif missing.owner and missing.name.startswith("["):
                yield f"`{missing.owner}` takes no custom properties: `{missing.name}` fails.{closest}"
            elif missing.owner and missing.name not in removed_names:
                alike = dict.fromkeys(
                    (*self._named_beside(missing, recognition), *map(self._written, similar))
                )
                closest_to_it = f" Closest: {_list(alike)}." if alike else ""
                yield f"{_if(missing.variable)}{self._lacks(missing)}{closest_to_it}"
        if (doubted := recognition.doubted) and not recognition.removed:
            names = nearest(doubted.name, names_meant(doubted.owner, self._reader, called=doubted.called))
            meant = similar or [f"{doubted.owner}.{name}" for name, _ in names]
            closest = f" Closest: {_list(meant)}." if meant else ""
            yield f"{_if(doubted.variable)}{self._lacks(doubted)}{closest}"

    def _named_beside(self, missing: MissingName, recognition: Recognition) -> list[str]:
        """What is most like a name that a class surely lacks, where the query names that as well."""
        names = names_meant(missing.owner, self._reader, called=missing.called) if missing.sure else []
        named = {match.id for match in recognition.matches if match.why == "expression"}
        alike = (f"{missing.owner}.{name}" for name, _ in nearest(missing.name, names))
        return [path for path in alike if path in named]

    def _may_have_more(self, owner: str) -> bool:
        """Whether something may have more than is known: a class of the interface, which Python has made, or a member
        of the context of which no class is known.
        """
        entry = self._reader.entry(owner)
        is_untyped = entry is not None and entry.kind == "context" and not entry.target
        return is_untyped or bool(interface_part(last_name(owner)))

    def _written(self, path: str) -> str:
        """A path as a script can write it: no socket by an identifier that never gives it."""
        symbol = self._reader.symbol(path) if is_socket(path) else None
        return written(symbol) if symbol else path

    def _lacks(self, missing: MissingName) -> str:
        """A sentence on what a class does not have, and whether it ever had it."""
        owner, name = missing.owner, missing.name
        if owner.startswith(OPERATORS) and self._reader.entry(owner) is None:
            owner, _, name = owner.rpartition(".")  # no such module
        never = self.never(owner, name) if missing.sure else ""
        return f"`{owner}` has no `{name}`{never}."

    def never(self, owner: str, name: str) -> str:
        """Since when a class is known not to have had a name, as the end of a sentence; "" where that is not known.

        What a class inherited in other versions is not: one without a base may have lost it.
        """
        versions = self._reader.history.history_versions
        # Of the interface's classes the history has those alone that scripts use.
        if not versions or owner.startswith(_UNLISTED) or interface_part(name):
            return ""
        entry = self._reader.entry(owner)
        if entry is not None and entry.base in {"", STRUCT}:
            owners = {found.owner for found in self._reader.names.by_name(name)}
            owners |= {path.rpartition(".")[0] for path in self._reader.history.removed_named(name)}
            owners -= {owner, STRUCT}
            if any(self._reader.subclasses(other) for other in owners):
                return ""
        aside = next((f" ({told} aside)" for start, told in _ASIDE.items() if owner.startswith(start)), "")
        return f", and never had it from {self._reader.history.since(owner) or versions[0]} to {versions[-1]}{aside}"
