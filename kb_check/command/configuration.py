"""What a project wants checked: ``[tool.simworlds.check]`` in its pyproject.toml, and which findings are left by it."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast, get_args

from kb_check.command.files import matches
from kb_check.findings import Finding, Severity
from kb_check.rule import all_rules
from simworlds.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

_FILE = "pyproject.toml"
_TABLE = "check"  # of tool.simworlds
_SEVERITIES: tuple[Severity, ...] = get_args(Severity)  # the worst first


class BadConfiguration(UserError):  # noqa: N818 - reads as the state it names
    """The configuration cannot be used; the message says what is wrong and what there is."""


@dataclass(frozen=True, slots=True)
class Configuration:
    """What is checked. Patterns are below ``folder``; ``gitignore``: in folders, what git leaves out is left out.

    ``rules`` are those that are asked (all, if empty), ``ignore`` those that are not; ``per_file_ignores`` are more of
    them by pattern. ``fail_on`` is the least severity that makes the command fail.
    """

    folder: Path = field(default_factory=Path.cwd)
    blender: tuple[str, ...] = ()
    rules: tuple[str, ...] = ()
    ignore: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    gitignore: bool = True
    per_file_ignores: tuple[tuple[str, tuple[str, ...]], ...] = ()
    severity: tuple[tuple[str, Severity], ...] = ()
    fail_on: Severity = "error"

    @property
    def file(self) -> Path:
        """The file that says so, where anything is said."""
        return self.folder / _FILE

    def kept(self, path: Path, findings: Iterable[Finding]) -> list[Finding]:
        """The findings of a file that are wanted, with the severity that they are given."""
        ignored = {*self.ignore}
        for pattern, rules in self.per_file_ignores:
            if matches(path, (pattern,), self.folder):
                ignored.update(rules)
        severities = dict(self.severity)
        return [
            replace(finding, severity=severities.get(finding.rule, finding.severity))
            for finding in findings
            if finding.rule not in ignored and (not self.rules or finding.rule in self.rules)
        ]

    def fails(self, finding: Finding) -> bool:
        """Whether a finding makes the command fail."""
        return _SEVERITIES.index(finding.severity) <= _SEVERITIES.index(self.fail_on)


def read_configuration(start: Path) -> Configuration:
    """What the nearest pyproject.toml at or above ``start`` says, if it has the table. Raises BadConfiguration."""
    folder = start.absolute()
    for here in (folder, *folder.parents):
        file = here / _FILE
        try:
            document = tomllib.loads(file.read_text(encoding="utf-8"))
        except (FileNotFoundError, NotADirectoryError):
            continue
        except (OSError, ValueError, RecursionError) as error:
            raise BadConfiguration(f"{file} cannot be read: {error}") from error
        tables = _entry(_entry(document, "tool"), "simworlds")
        if isinstance(tables, dict) and (unknown := tables.keys() - {_TABLE}):
            raise BadConfiguration(f"{file}: tool.simworlds.{min(unknown)} is unknown. There is: {_TABLE}.")
        table = _entry(tables, _TABLE)
        if table is not None:
            return _configuration(table, here, str(file))
    return Configuration()


def versions_in(texts: Iterable[str]) -> tuple[str, ...]:
    """The versions in texts such as ``4.5,5.1``, each once."""
    names = (name.strip() for text in texts for name in text.split(","))
    return tuple(dict.fromkeys(name for name in names if name))


def known_rules(names: Iterable[str], where: str) -> tuple[str, ...]:
    """The names, if all are rules. Raises BadConfiguration."""
    names = tuple(names)
    for name in names:
        if name not in all_rules():
            raise BadConfiguration(
                f"{where}: there is no rule {name!r}. There are: {', '.join(all_rules())}."
            )
    return names


def _entry(table: Any, name: str) -> Any:
    return cast("dict[str, Any]", table).get(name) if isinstance(table, dict) else None


def _configuration(table: Any, folder: Path, file: str) -> Configuration:
    if not isinstance(table, dict):
        raise BadConfiguration(f"{file}: tool.simworlds.check must be a table.")
    values: dict[str, Any] = {}
    for key, value in cast("dict[str, Any]", table).items():
        where = f"{file}: tool.simworlds.check.{key}"
        if key not in _KEYS:
            raise BadConfiguration(f"{where} is unknown. There are: {', '.join(_KEYS)}.")
        values[key.replace("-", "_")] = _KEYS[key](value, where)
    return Configuration(folder, **values)


def _texts(value: Any, where: str) -> tuple[str, ...]:
    if isinstance(value, list) and all(isinstance(entry, str) for entry in cast("list[Any]", value)):
        return tuple(cast("list[str]", value))
    raise BadConfiguration(f"{where} must be a list of strings.")


def _truth(value: Any, where: str) -> bool:
    if isinstance(value, bool):
        return value
    raise BadConfiguration(f"{where} must be true or false.")


def _versions(value: Any, where: str) -> tuple[str, ...]:
    texts: list[Any] = cast("list[Any]", value) if isinstance(value, list) else [value]
    if all(isinstance(text, str) and versions_in([text]) for text in texts):
        return versions_in(texts)
    raise BadConfiguration(f'{where} must be a version in quotes, as "5.1", or a list of such versions.')


def _rules(value: Any, where: str) -> tuple[str, ...]:
    return known_rules(_texts(value, where), where)


def _table(value: Any, where: str) -> dict[str, Any]:
    if isinstance(value, dict):
        return cast("dict[str, Any]", value)
    raise BadConfiguration(f"{where} must be a table.")


def _rules_by_pattern(value: Any, where: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    return tuple((key, _rules(rules, f"{where}.{key}")) for key, rules in _table(value, where).items())


def _severity(value: Any, where: str) -> Severity:
    if value in _SEVERITIES:
        return value
    raise BadConfiguration(f"{where} must be one of: {', '.join(_SEVERITIES)}.")


def _severities(value: Any, where: str) -> tuple[tuple[str, Severity], ...]:
    rows = _table(value, where)
    known_rules(rows, where)
    return tuple((rule, _severity(severity, f"{where}.{rule}")) for rule, severity in rows.items())


_KEYS: Mapping[str, Callable[[Any, str], Any]] = {
    "blender": _versions,
    "rules": _rules,
    "ignore": _rules,
    "exclude": _texts,
    "gitignore": _truth,
    "per-file-ignores": _rules_by_pattern,
    "severity": _severities,
    "fail-on": _severity,
}
