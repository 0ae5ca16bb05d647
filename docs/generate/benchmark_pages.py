"""The pages of the benchmark's predicates and relations."""

from __future__ import annotations

import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.audit import assembly
from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.predicate import GROUPS
from bench.audit.relations import RELATIONS
from docs.generate.markdown import GENERATED, page, table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.predicates.predicate import Predicate

_PICTURES = Path(__file__).resolve().parents[1] / "audit"
_BOUNDS = {"minimum": "at least", "exclusiveMinimum": "above", "maximum": "at most"}
_ABOUT_PREDICATES = """\
What `simworlds bench audit` can check of an actor, or of a scene. A predicate reads Blender's own data of a .blend,
whoever made it. It passes, fails, or does not apply, and reports the values that it saw. A spec lists it under
`must_have` (it must pass) or `must_not_have` (it must fail). A predicate of an actor is judged for each unit of the
actor (each of the objects, with its parts, that the actor was found as): a `must_have` must pass for as many units as
the spec's count, a `must_not_have` must fail for all of them."""

_ABOUT_RELATIONS = """\
How the actors of a spec stand to each other, as `simworlds bench audit` measures it: distances between evaluated meshes
at the start, the middle and the end of the clip, or at those of these times that the relation names. A relation holds
if each unit of `a` (of more than 24, an even selection) stands in it to all of `b`, each time. It does not hold if an
actor is missing or has no visible geometry. It is not scored if it depends on unbaked physics, which is not played. SPR
is the share of the scored relations that hold. The tolerance is 2 cm unless the spec gives another.

Curves and texts count as meshes, instances as parts of the object that shows them, particles as points, and a liquid as
its surface (without the domain's box). Only a closed piece of mesh is a solid with an inside, whichever way its normals
point; an open sheet has none. Fluids, forces and sources of fluid or particles are not bodies: they may overlap
anything."""


def relations_page() -> str:
    """All relation types, and how assemblies are inferred, as Markdown."""
    parts = [f"# The {len(RELATIONS)} relations", GENERATED, _ABOUT_RELATIONS]
    for name, kind in RELATIONS.items():
        parts += [f"## `{name}`", kind.definition.replace("``", "`"), *_picture(name)]
    assemblies = inspect.cleandoc(assembly.__doc__ or "").partition("\n")[2].strip()
    return page(*parts, "## Assemblies", assemblies)


def _picture(name: str) -> Iterator[str]:
    """The picture of a relation or predicate, if ``make audit-pictures`` draws one."""
    if (_PICTURES / f"{name}.png").is_file():
        yield f"![Left: {name} holds. Right: it does not.]({_PICTURES.name}/{name}.png)"


def predicates_page() -> str:
    """All predicates, by group, as Markdown."""
    parts = [f"# The {len(PREDICATES)} predicates", GENERATED, _ABOUT_PREDICATES]
    for group in GROUPS:
        rows = [row for row in PREDICATES.values() if row.group == group]
        parts.append(f"## {group.capitalize()} ({len(rows)})")
        for row in rows:
            parts += _entry(row)
    return page(*parts)


def _entry(row: Predicate) -> Iterator[str]:
    yield f"### `{row.name}`"
    yield row.definition.replace("``", "`")
    yield from _picture(row.name)
    if row.scope == "scene":
        yield "Judged once, for the whole scene."
    schema = row.params.model_json_schema()
    if schema.get("properties"):
        yield " ".join((row.params.__doc__ or "").split()).replace("``", "`")
        yield table(("parameter", "values", "default"), _parameters(schema))


def _parameters(schema: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    for name, field in schema["properties"].items():
        default = "required" if name in schema.get("required", ()) else f"`{json.dumps(field['default'])}`"
        yield f"`{name}`", _values(field), default


def _values(field: dict[str, Any]) -> str:
    """The values that a parameter can have, in words."""
    if "anyOf" in field:
        return "; ".join(dict.fromkeys(_values(branch) for branch in field["anyOf"]))
    if "enum" in field:
        return " ".join(f"`{value}`" for value in field["enum"])
    if field.get("type") == "array":
        return f"a list of: {_values(field['items'])}"
    bounds = [f"{word} {field[key]}" for key, word in _BOUNDS.items() if key in field]
    kind = str(field["type"])
    return ", ".join([{"null": "none", "string": "text"}.get(kind, kind), *bounds])
