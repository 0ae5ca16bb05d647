"""The rules' pages: docs/rules.md, and docs/rules/ID.md for each, beside its picture ID.png."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

from agents.protocol.guide import told_tolerance
from agents.protocol.rules.catalogue import RULES
from agents.protocol.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Iterable
    from dataclasses import Field

    from agents.protocol.rule import Rule

FOLDER = "rules"
FAMILIES: dict[str, tuple[str, str]] = {
    "C": ("Layout", "How collections are nested and tagged, whatever is in them."),
    "G": ("Parents", "Roots, and the chains of parents that lead to them."),
    "V": ("Contact and penetration", "Whether surfaces meet where they are said to, and only there."),
    "W": ("Warnings", "What makes a scene float, fall apart, or stay dark."),
    "R": ("The plan against the scene", "Whether what was planned was built."),
    "T": ("The planned motion against the real one", "Whether what was to move does, when and as it was to."),
}

_HEAD = """\
The verifier measures what a render cannot show. It reads a scene's facts, has Blender measure what the rules ask for \
(distances, penetrations, extents, trajectories, on evaluated geometry), and judges by the rules below. It changes \
nothing, and says the same of the same scene every time.

```text
simworlds verify scene.blend                          # by the scene's own tags
simworlds verify scene.blend --plan plan.json         # and against the plan
simworlds verify scene.blend --rules C,G,V1 --json    # some rules, for machines
simworlds verify scene.blend --image findings.png     # see what is at fault
```

The exit code is 0 when no hard rule is broken, 1 when one is, and 2 when it could not be told: the file cannot be \
opened, the plan contradicts itself, or a rule could not be decided. In a live Blender, the tool `blender_verify` does \
the same ([blender-tools.md](blender-tools.md)).

A **hard** rule that is broken must be mended; a **soft** one is advice. What could not be measured is a finding of \
its own, never a pass. A rule that has nothing to judge (no plan, no tags, no contacts) is passed over, and the report \
says why."""


def rule_pages(generated: str) -> dict[str, str]:
    """File name below docs → text. ``generated`` is the comment that says where a page comes from."""
    pages = {"rules.md": _index(generated)}
    for place, rule in enumerate(RULES):
        before = RULES[place - 1] if place else None
        after = RULES[place + 1] if place + 1 < len(RULES) else None
        pages[f"{FOLDER}/{rule.id}.md"] = _page(rule, before, after, generated)
    return pages


def _index(generated: str) -> str:
    parts = ["# Rules", generated, _HEAD]
    for letter, (title, about) in FAMILIES.items():
        rules = [rule for rule in RULES if rule.id[0] == letter]
        if rules:
            parts += [f"## {letter}: {title}", about, _table(rules)]
    parts += [
        "## Tolerances",
        "A plan may tighten them by name (`tolerances` in its JSON), never loosen them.",
        _tolerances(field.name for field in fields(TOLERANCES)),
    ]
    return "\n\n".join(parts) + "\n"


def _table(rules: Iterable[Rule]) -> str:
    rows = ["| rule | checks | severity | goes by |", "| --- | --- | --- | --- |"]
    for rule in rules:
        link = f"[{rule.id} {rule.name}]({FOLDER}/{rule.id}.md)"
        rows.append(f"| {link} | {_cell(rule.about)} | {rule.severity} | {_source(rule)} |")
    return "\n".join(rows)


def _source(rule: Rule) -> str:
    return "the plan" if rule.needs_plan else "the scene"


def _page(rule: Rule, before: Rule | None, after: Rule | None, generated: str) -> str:
    needs = "needs a plan" if rule.needs_plan else "needs no plan"
    ways = [f"[← {before.id}]({before.id}.md)"] if before else []
    ways += ["[all rules](../rules.md)"]
    ways += [f"[{after.id} →]({after.id}.md)"] if after else []
    parts = [
        f"# {rule.id} {rule.name}",
        generated,
        " · ".join(ways),
        f"**{rule.about}**",
        f"{rule.severity.capitalize()}; {needs}.",
        f"![Left: {rule.id} holds. Right: {rule.id} is broken.]({rule.id}.png)",
        "## Why",
        rule.why,
        "## Tolerance",
        _tolerances(rule.tolerances) if rule.tolerances else "None: it holds or it does not.",
        "## How to fix",
        rule.fix,
    ]
    return "\n\n".join(parts) + "\n"


def _tolerances(names: Iterable[str]) -> str:
    known: dict[str, Field[float]] = {field.name: field for field in fields(TOLERANCES)}
    rows = ["| name | value | meaning |", "| --- | --- | --- |"]
    for name in names:
        meaning = known[name].metadata["meaning"]
        rows.append(f"| `{name}` | {told_tolerance(name)} | {_cell(meaning)} |")
    return "\n".join(rows)


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
