"""The rules' pages: docs/rules.md, and docs/rules/ID.md for each, beside its picture ID.png."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

from agents.protocol.guide import format_tolerance
from agents.protocol.rules.catalogue import RULES
from agents.protocol.tolerances import TOLERANCES
from docs.generate.markdown import GENERATED, cell, page, table

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agents.protocol.rule import Rule

FOLDER = "rules"
FAMILIES: dict[str, tuple[str, str]] = {
    "C": ("Layout", "How collections are nested and tagged, whatever is in them."),
    "G": ("Parents", "Roots, and the chains of parents that lead to them."),
    "V": ("Contact and penetration", "Whether surfaces meet where they are declared to, and only there."),
    "W": ("Warnings", "What makes a scene float, fall apart, or stay dark."),
    "R": ("The plan against the scene", "Whether the planned scene was built."),
    "T": (
        "The planned motion against the real one",
        "Whether the planned actors move, when and how they should.",
    ),
}

_HEAD = """\
The verifier measures what a render cannot show. It reads a scene's facts, has Blender measure what the rules need \
(distances, penetrations, extents, trajectories, on evaluated geometry), and judges by the rules below. It changes \
nothing, and always gives the same result for the same scene.

```text
simworlds verify scene.blend                          # by the scene's own tags
simworlds verify scene.blend --plan plan.json         # and against the plan
simworlds verify scene.blend --rules C,G,V1 --json    # some rules, for machines
simworlds verify scene.blend --image findings.png     # a picture of the findings
```

The exit code is 0 if no hard rule is broken, 1 if one is, and 2 if the scene could not be fully checked: the file \
cannot be opened, the plan contradicts itself, or a rule could not be decided. In a live Blender, the tool \
`blender_verify` does the same ([blender-tools.md](blender-tools.md)).

A broken **hard** rule must be fixed; a **soft** one is advice. What could not be measured is a finding of its own, \
never a pass. A rule with nothing to judge (no plan, no tags, no contacts) is not checked, and the report says why."""


def rule_pages() -> dict[str, str]:
    """File name below docs → text."""
    pages = {"rules.md": _index()}
    for place, rule in enumerate(RULES):
        before = RULES[place - 1] if place else None
        after = RULES[place + 1] if place + 1 < len(RULES) else None
        pages[f"{FOLDER}/{rule.id}.md"] = _page(rule, before, after)
    return pages


def _index() -> str:
    parts = ["# Rules", GENERATED, _HEAD]
    for letter, (title, about) in FAMILIES.items():
        rules = [rule for rule in RULES if rule.id[0] == letter]
        parts += [f"## {letter}: {title}", about, _rule_table(rules)]
    return page(
        *parts,
        "## Tolerances",
        "A plan may tighten them by name (`tolerances` in its JSON), never loosen them.",
        _tolerance_table(field.name for field in fields(TOLERANCES)),
    )


def _rule_table(rules: Iterable[Rule]) -> str:
    rows = [
        (
            f"[{rule.id} {rule.name}]({FOLDER}/{rule.id}.md)",
            cell(rule.about),
            rule.severity,
            "the plan" if rule.needs_plan else "the scene",
        )
        for rule in rules
    ]
    return table(("rule", "checks", "severity", "compares with"), rows)


def _page(rule: Rule, before: Rule | None, after: Rule | None) -> str:
    links = [f"[← {before.id}]({before.id}.md)"] if before else []
    links += ["[all rules](../rules.md)"]
    links += [f"[{after.id} →]({after.id}.md)"] if after else []
    return page(
        f"# {rule.id} {rule.name}",
        GENERATED,
        " · ".join(links),
        f"**{rule.about}**",
        f"{rule.severity.capitalize()}; {'needs a plan' if rule.needs_plan else 'needs no plan'}.",
        f"![Left: {rule.id} holds. Right: {rule.id} is broken.]({rule.id}.png)",
        "## Why",
        rule.why,
        "## Tolerance",
        _tolerance_table(rule.tolerances) if rule.tolerances else "None: the rule either holds or does not.",
        "## How to fix",
        rule.fix,
    )


def _tolerance_table(names: Iterable[str]) -> str:
    meanings = {field.name: str(field.metadata["meaning"]) for field in fields(TOLERANCES)}
    rows = [(f"`{name}`", format_tolerance(name), cell(meanings[name])) for name in names]
    return table(("name", "value", "meaning"), rows)
