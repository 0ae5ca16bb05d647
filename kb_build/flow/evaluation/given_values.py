"""Compares the texts that scripts give to enumerations, or compare with them, with the values that these have."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import DERIVED_BY_SCRIPTS
from kb_build.flow.evaluation.members import Members
from kb_build.flow.state.core import ANY
from kb_build.flow.state.doubts import without
from kb_build.flow.values.types import (
    FROM_VERSION,
    NONE,
    PASSED,
    FromProperty,
    Instance,
    Plain,
    Sequence,
    Type,
    literal_text,
    members,
)
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.paths import argument_of, plain_path
from kb_build.symbols.unlisted import FEWEST_VALUES, MORE_VALUES, NAMED_IN_FILES, STAND_INS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_build.flow.values.types import ResolutionKind

CARRYING = (ast.Name, ast.Subscript, ast.Attribute)  # what may hold a text that is written elsewhere


class GivenValues(Members):
    """Records what the texts in expressions that were evaluated stand for as values of enumerations."""

    def check_value(self, kind: Type, node: ast.expr, use: ResolutionKind = "value") -> None:
        """Records literals that are assigned to a value of an enumeration, or ``compared`` with it."""
        source = self.source_of(kind)
        if not source:
            return
        # Those that were not reached are of a branch for other versions.
        for constant in filter(self.here.types.__contains__, self._given(node, source)):
            self.resolve_value(constant, constant.value, source, use=use)
        if use == "value" and isinstance(node, CARRYING):
            self.check_carried(node, source)

    def _given(self, node: ast.expr, sources: tuple[str, ...]) -> Iterator[ast.Constant]:
        """The text literals that an expression gives to enumerations, but for those that it gives to another Blender's:
        ``"A" if "A" in listed else "B"``, where this one's have ``A``.
        """
        if not isinstance(node, ast.IfExp):
            yield from constants(node)
            return
        for holds, part in ((True, node.body), (False, node.orelse)):
            if not self.is_listed_here(without(node.test, holds=holds).unlisted, sources):
                yield from self._given(part, sources)

    def is_listed_here(self, texts: frozenset[str], paths: Iterable[str]) -> bool:
        """Whether this Blender's enumerations have one of some texts."""
        return bool(texts) and any(not texts.isdisjoint(self.api.values_of(path)) for path in paths)

    def check_carried(self, node: ast.expr, sources: tuple[str, ...]) -> None:
        """Records a text that a name, an item or an attribute holds, where the enumeration it is given to lacks it."""
        text = self.carried_text(node)
        if text is not None:
            self.resolve_value(node, text, sources, only_lacking=True)

    def carried_text(self, node: ast.expr) -> str | None:
        """The text that a name, an item or an attribute surely holds, though it is written elsewhere."""
        kind = self.here.types.get(node)
        if not isinstance(kind, Plain) or not (kind.source is None or kind.source is FROM_VERSION):
            return None
        text = literal_text(kind)
        return text if text is not None and self.comes_surely(text) else None

    def check_possible(self, owner: Type, name: str, paths: list[str], node: ast.expr) -> None:
        """Records literals given to a property that only classes below the owner's have, enumerations all of them."""
        if any(registered in {name, ANY} for _, registered in self.registered):
            return
        if any(
            not isinstance(kind, Instance) or self.is_open(kind.cls) or kind.cls in DERIVED_BY_SCRIPTS
            for kind in members(owner)
            if kind is not NONE
        ):
            return
        symbols = [self.api.symbols.symbol(path) for path in paths]
        if all(
            symbol and symbol.type == "enum" and len(symbol.enum_items) >= FEWEST_VALUES for symbol in symbols
        ):
            for constant in filter(self.here.types.__contains__, constants(node)):
                self.resolve_value(constant, constant.value, tuple(paths))

    @staticmethod
    def source_of(kind: Type) -> tuple[str, ...]:
        """The enumerations that a value was read from."""
        found: list[str] = []
        for member in members(kind):
            plain = member.element if isinstance(member, Sequence) else member
            source = plain.source if isinstance(plain, Plain) else None
            if isinstance(source, FromProperty):
                found.append(source.path)
            elif source is not PASSED and plain is not NONE:
                return ()
        return tuple(found)

    def resolve_value(
        self,
        node: ast.expr,
        value: object,
        sources: tuple[str, ...],
        *,
        use: ResolutionKind = "value",
        only_lacking: bool = False,
    ) -> None:
        """Records a text as one of the values of properties, or of parameters, ``function(parameter)``."""
        if not isinstance(value, str):
            return
        having: list[str] = []
        lacking: list[str] = []
        unsure = False
        for source in sources:
            symbol, argument = self.api.symbols.symbol(plain_path(source)), argument_of(source)
            if symbol is None:
                continue
            items = symbol.enum_items
            computed = symbol.enum_computed or source in NAMED_IN_FILES
            if argument:
                found = symbol.parameter(argument)
                items, computed = (found.enum_items, found.is_open) if found else ((), False)
            is_listed = any(item.identifier == value for item in items) or value in MORE_VALUES.get(
                source, ()
            )
            are_classes = bool(items) and all(self.api.is_class(T + item.identifier) for item in items)
            # Of classes, those of add-ons are taken as well.
            is_listed = is_listed or (are_classes and not self.api.is_class(T + value))
            # A function's only value is meant, unless it stands in for others.
            is_judged = len(items) >= FEWEST_VALUES or (
                bool(argument)
                and symbol.kind == "function"
                and not STAND_INS.issuperset(item.identifier for item in items)
            )
            if is_listed or not is_judged:
                having.append(source)
            elif are_classes or not computed:
                lacking.append(source)
            else:
                unsure = True
        if only_lacking:
            self.here.resolutions.pop(node, None)
        if (having and not only_lacking) or (lacking and not having and not unsure):
            is_for_another = self.is_listed_here(self.here.scope.state.doubted.unlisted, lacking)
            self.resolve(node, use, value, having, lacking, guarded=is_for_another)


def constants(node: ast.expr) -> list[ast.Constant]:
    """The text literals in a literal or a display of literals."""
    if isinstance(node, ast.Constant):
        return [node]
    if isinstance(node, (ast.Set, ast.Tuple, ast.List)):
        return [item for item in node.elts if isinstance(item, ast.Constant)]
    if isinstance(node, ast.IfExp):
        return [*constants(node.body), *constants(node.orelse)]
    return []
