"""The guide to the scene protocol for agents: levels, tags, relations and rules, generated from their definitions."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, get_args

from agents.plan import relations
from agents.plan.scene import MECHANISMS
from agents.protocol import vocabulary
from agents.protocol.report.text_format import format_value
from agents.protocol.rules.catalogue import RULES
from agents.protocol.rules_by_stage import rules_of
from agents.protocol.tolerances import CONTACT, PENETRATION, TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from agents.plan.part import Stage
    from agents.protocol.rule import Rule

# What carries a tag, in words; a collection tag may be limited to one role.
_CARRIERS = {"collection": "L2, L3", "object": "meshes, Empties", "scene": "the scene"}
_KINDS: tuple[tuple[str, dict[Any, str]], ...] = (
    (vocabulary.DEFORMATION_KIND, vocabulary.DEFORMATION_KINDS),
    (vocabulary.MOTION_KIND, vocabulary.MOTION_KINDS),
)
_HEAD = (
    "# The scene protocol\n\n"
    "Units are metres; Z is up; the front of an object, and of the world, is −Y. Rules judge the scene by "
    "measurements of its evaluated geometry."
)
# A file that is edited may have been made without the protocol.
_FOREIGN = (
    "A file without any tag `protocol_role` does not follow it: C and G do not judge it, and nothing in it is tagged "
    "but actors, and contacts of what is new."
)
_UNITS = {tolerance.name: tolerance.metadata["unit"] for tolerance in fields(TOLERANCES)}


def guide(*, edit: bool = False) -> str:
    """The protocol's words, as Markdown: levels, tags and, unless a file is edited, the relations of a scene plan."""
    if edit:
        return "\n\n".join([_HEAD, _FOREIGN, _levels(), _tags(_mechanisms())])
    return "\n\n".join([_HEAD, _levels(), _tags(_required()), _relations()])


def builders_guide(*, edit: bool = False) -> str:
    """The protocol's words as far as whoever builds needs them: tools set the tags, and a plan has its relations."""
    if edit:
        contact = next(tag for tag in vocabulary.PROPERTIES if tag.name == vocabulary.CONTACT_WITH)
        return "\n\n".join(
            [_HEAD, _FOREIGN, _levels(), f"{_mechanisms()}\n\nA custom property:\n{_tag(contact)}"]
        )
    return "\n\n".join([_HEAD, _levels(), _required(), _contacts()])


def rules_guide(
    rules: Iterable[Rule] = RULES, *, with_tolerances: bool = True, is_planned: bool = True
) -> str:
    """Rules, each in a sentence, with its tolerances if wanted. ``is_planned``: there is a scene plan."""
    tightened = ", which a plan may tighten by name" if is_planned else ""
    share, most = format_tolerance("contact_share"), format_tolerance("contact_most")
    return "\n".join(
        [
            "## Rules",
            f"ε is {format_tolerance('contact')} or {share} of the smaller object's diagonal, at most {most}; noise is "
            f"{format_tolerance('penetration')} or {format_tolerance('penetration_share')} of the smallest dimension. "
            f"{f'In brackets: tolerances{tightened}. ' if with_tolerances else ''}Rules are hard unless marked (soft).",
            *_listed(rules, with_tolerances=with_tolerances),
        ]
    )


def format_tolerance(name: str) -> str:
    """The value of a tolerance for readers: lengths below a metre in millimetres, shares in percent."""
    value, unit = getattr(TOLERANCES, name), _UNITS[name]
    if not unit:
        return f"{value * 100:g} %" if 0 < value < 1 else f"{value:g}"
    return format_value(value, unit)


def format_stage_rules(stage: Stage, *, edit: bool = False) -> str:
    """The rules that judge a stage, as ``blender_verify`` takes them: ``C, G, V, R1, R2``; whole families by letter."""
    judging = [rule.id for rule in rules_of(stage, edit=edit)]
    names: list[str] = []
    for family in dict.fromkeys(rule.id[0] for rule in RULES):
        own = [name for name in judging if name[0] == family]
        names += [family] if own and len(own) == sum(rule.id[0] == family for rule in RULES) else own
    return ", ".join(names)


def _levels() -> str:
    lines = [f"- `{role}`: {meaning}" for role, meaning in vocabulary.ROLES.items()]
    lines += ["- Collections without a role are outside the protocol.", "Conventional systems:"]
    return "\n".join(
        ["## Levels", *lines, *(f"- `{name}`: {meaning}" for name, meaning in vocabulary.SYSTEMS.items())]
    )


def _tags(mechanisms: str) -> str:
    lines = list(map(_tag, vocabulary.PROPERTIES))
    lines += [f"- `{name}` is one of: {', '.join(choices)}." for name, choices in _KINDS]
    return "\n".join(["## Tags (custom properties)", *lines, f"- {mechanisms}"])


def _tag(tag: vocabulary.CustomProperty) -> str:
    return f"- `{tag.name}` (on {_carrier(tag)}): {tag.meaning}"


def _required() -> str:
    by_kinds: dict[tuple[str, str], list[str]] = {}
    for role, kinds in MECHANISMS.items():
        by_kinds.setdefault(kinds, []).append(role)
    table = "; ".join(f"{', '.join(roles)}: {' + '.join(kinds)}" for kinds, roles in by_kinds.items())
    return f"A planned role requires `deformation_kind` + `motion_kind`: {table}."


def _mechanisms() -> str:
    moving = dict.fromkeys(kinds for kinds in MECHANISMS.values() if set(kinds) != {"none"})
    return f"An actor has `deformation_kind` + `motion_kind`: {', '.join(' + '.join(kinds) for kinds in moving)}."


def _carrier(tag: vocabulary.CustomProperty) -> str:
    return "L3" if tag.on_role == "object" else _CARRIERS[tag.owner]


def _contacts() -> str:
    contacts = ", ".join(kind.__name__ for kind in relations.CONTACTS)
    return (
        "## Relations of a plan\n"
        f"Each joins objects, or their parts as `Object/Part`. {contacts} declare a contact, as "
        f"`{vocabulary.CONTACT_WITH}` does. For moving objects, a relation must hold at the first or last frame "
        "(`when` end: at the last; always: at both)."
    )


def _relations() -> str:
    return "\n".join([_contacts(), *map(_relation, get_args(get_args(relations.Relation)[0]))])


def _relation(kind: type[relations.RelationPart]) -> str:
    fields_of = kind.model_fields
    names = "/".join(get_args(fields_of["kind"].annotation))
    members = [
        name + ("…" if field.metadata and "tuple" in str(field.annotation) else "")
        if field.is_required()
        else f"{name}?"
        for name, field in fields_of.items()
        if name not in {"kind", "when"}
    ]
    meaning = " ".join((kind.__doc__ or "").split("\n\n")[0].replace("``", "`").split())
    return f"- {names}({', '.join(members)}): {meaning}"


def _listed(rules: Iterable[Rule], *, with_tolerances: bool) -> Iterator[str]:
    known = {*CONTACT, *PENETRATION}  # each tolerance is listed once
    for rule in rules:
        own = [f"{name} {format_tolerance(name)}" for name in rule.tolerances if name not in known]
        known.update(rule.tolerances)
        soft = " (soft)" if rule.severity == "soft" else ""
        yield f"- {rule.id}{soft} {_first_sentence(rule.about)}" + (
            f" [{', '.join(own)}]" if own and with_tolerances else ""
        )


def _first_sentence(text: str) -> str:
    return text.partition(". ")[0].removesuffix(".") + "."
