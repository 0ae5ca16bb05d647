"""The scene protocol as agents are told it: levels, tags, relations, rules; each fact from where it is kept."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, get_args

from agents.plan import relations
from agents.plan.scene import MECHANISMS
from agents.protocol import vocabulary
from agents.protocol.report.folding import told_value
from agents.protocol.rules.catalogue import RULES
from agents.protocol.rules_by_stage import rules_of
from agents.protocol.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from agents.plan.part import Stage
    from agents.protocol.rule import Rule

# What carries a tag: collections of either or of one role, objects of Blender's, the scene.
_CARRIERS = {"collection": "L2, L3", "object": "meshes, Empties", "scene": "the scene"}
_KINDS: tuple[tuple[str, dict[Any, str]], ...] = (
    (vocabulary.DEFORMATION_KIND, vocabulary.DEFORMATION_KINDS),
    (vocabulary.MOTION_KIND, vocabulary.MOTION_KINDS),
)
_UNITS = {one.name: one.metadata["unit"] for one in fields(TOLERANCES)}
# Rules speak of ε and of noise; what those are is told once.
_EPSILON = ("contact", "contact_share", "contact_most")
_NOISE = ("penetration", "penetration_share")


def guide() -> str:
    """The whole protocol, as Markdown."""
    return "\n\n".join(
        [
            "# The scene protocol",
            "Metres, Z up; the front of a thing, and of the world, is −Y. The scene's facts are measured and judged by "
            "the rules below, on evaluated geometry.",
            _levels(),
            _tags(),
            _relations(),
            _rules(),
        ]
    )


def told_tolerance(name: str) -> str:
    """A tolerance as one says it: lengths below a metre in millimetres, shares in percent."""
    value, unit = getattr(TOLERANCES, name), _UNITS[name]
    if not unit:
        return f"{value * 100:g} %" if 0 < value < 1 else f"{value:g}"
    return told_value(value, unit)


def told_rules(stage: Stage, *, edit: bool = False) -> str:
    """The rules that judge a stage, as ``blender_verify`` takes them: ``C, G, V, R1, R2``, families where all do."""
    judging = [rule.id for rule in rules_of(stage, edit=edit)]
    told: list[str] = []
    for family in dict.fromkeys(rule.id[0] for rule in RULES):
        own = [name for name in judging if name[0] == family]
        told += [family] if own and len(own) == sum(rule.id[0] == family for rule in RULES) else own
    return ", ".join(told)


def _levels() -> str:
    lines = [f"- `{role}`: {meaning}" for role, meaning in vocabulary.ROLES.items()]
    lines += ["- Collections without a role are outside the protocol.", "Systems by convention:"]
    return "\n".join(
        ["## Levels", *lines, *(f"- `{name}`: {meaning}" for name, meaning in vocabulary.SYSTEMS.items())]
    )


def _tags() -> str:
    lines = [f"- `{one.name}` (on {_carrier(one)}): {one.meaning}" for one in vocabulary.PROPERTIES]
    lines += [f"- `{name}` is one of: {', '.join(choices)}." for name, choices in _KINDS]
    by_kinds: dict[tuple[str, str], list[str]] = {}
    for role, kinds in MECHANISMS.items():
        by_kinds.setdefault(kinds, []).append(role)
    told = "; ".join(f"{', '.join(roles)}: {' + '.join(kinds)}" for kinds, roles in by_kinds.items())
    return "\n".join(["## Tags (custom properties)", *lines, f"- A planned role asks for both: {told}."])


def _carrier(one: vocabulary.Property) -> str:
    return "L3" if one.on_role == "object" else _CARRIERS[one.owner]


def _relations() -> str:
    contacts = ", ".join(kind.__name__ for kind in relations.CONTACTS)
    return "\n".join(
        [
            "## Relations of a plan",
            f"Each joins objects, or parts of them as `Object/Part`. {contacts} declare a contact, as "
            f"`{vocabulary.CONTACT_WITH}` does. A relation of what moves must hold at the first or the last frame.",
            *map(_relation, get_args(get_args(relations.Relation)[0])),
        ]
    )


def _relation(kind: type[relations.Part]) -> str:
    known = kind.model_fields
    names = "/".join(get_args(known["kind"].annotation))
    members = [
        name + ("…" if field.metadata and "tuple" in str(field.annotation) else "")
        if field.is_required()
        else f"{name}?"
        for name, field in known.items()
        if name != "kind"
    ]
    meaning = " ".join((kind.__doc__ or "").split("\n\n")[0].replace("``", "`").split())
    return f"- {names}({', '.join(members)}): {meaning}"


def _rules() -> str:
    share, most = told_tolerance("contact_share"), told_tolerance("contact_most")
    return "\n".join(
        [
            "## Rules",
            f"ε is {told_tolerance('contact')} or {share} of the smaller object's diagonal, at most {most}; noise is "
            f"{told_tolerance('penetration')} or {told_tolerance('penetration_share')} of the smallest dimension. In "
            "brackets: tolerances, which a plan may tighten by name. All rules are hard, but for those marked (soft).",
            *_listed(RULES),
        ]
    )


def _listed(rules: Iterable[Rule]) -> Iterator[str]:
    known = {*_EPSILON, *_NOISE}  # each tolerance is told once
    for rule in rules:
        own = [f"{name} {told_tolerance(name)}" for name in rule.tolerances if name not in known]
        known.update(rule.tolerances)
        soft = " (soft)" if rule.severity == "soft" else ""
        yield f"- {rule.id}{soft} {_first_sentence(rule.about)}" + (f" [{', '.join(own)}]" if own else "")


def _first_sentence(text: str) -> str:
    return text.partition(". ")[0].removesuffix(".") + "."
