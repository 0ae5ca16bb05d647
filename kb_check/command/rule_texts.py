"""What the rules find, for whoever asks on the command line."""

from __future__ import annotations

from kb_check.command.configuration import known_rules
from kb_check.rule import all_rules, rule_named


def rule_page(name: str) -> str:
    """What there is to know about a rule, as Markdown. Raises BadConfiguration for a name that is none."""
    (name,) = known_rules([name], "--explain")
    rule = rule_named(name)
    return (
        f"# {rule.id}\n\n{rule.title}: {rule.severity}.\n\n{rule.page}\n\n"
        f"Ignore it on a line with `# simworlds: ignore[{rule.id}]`."
    )


def rule_lines() -> list[str]:
    """A line for each rule: its id, severity and title."""
    rules = all_rules().values()
    width = max(len(rule.id) for rule in rules)
    return [f"{rule.id:<{width}}  {rule.severity:<7}  {rule.title}" for rule in rules]
