"""The pages of the check's rules: docs/check-rules.md, and docs/check/ID.md for each, from the rules' docstrings."""

from __future__ import annotations

from docs.generate.markdown import GENERATED, cell, page, table
from kb_check.rule import Rule, all_rules

FOLDER = "check"

_HEAD = """\
What `simworlds check` finds in Python code; [check.md](check.md) explains the command. An **error** is what Blender \
refuses when the line runs, a **warning** what does something else than it seems to, a **note** what is worth a look. \
The severity is that of most of a rule's findings; some have another."""


def check_pages() -> dict[str, str]:
    """File name below docs → text."""
    rules = list(all_rules().values())
    pages = {"check-rules.md": _index(rules)}
    for rule in rules:
        pages[f"{FOLDER}/{rule.id}.md"] = _page(rule)
    return pages


def _index(rules: list[Rule]) -> str:
    rows = [(f"[{rule.id}]({FOLDER}/{rule.id}.md)", cell(rule.title), rule.severity) for rule in rules]
    return page("# What the check finds", GENERATED, _HEAD, table(("rule", "reports", "severity"), rows))


def _page(rule: Rule) -> str:
    return page(
        f"# {rule.id}",
        GENERATED,
        f"[all rules](../check-rules.md) · {rule.severity}",
        rule.page,
        f"Ignore it on a line with `# simworlds: ignore[{rule.id}]`.",
    )
