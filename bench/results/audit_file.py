"""The parts of an audit.json that a report reads; fields of other versions are ignored."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True)


class Check(_Part):
    """See ``bench.audit.audit.Checked``."""

    predicate: str
    wanted: Literal["must_have", "must_not_have"]
    outcome: Literal["passed", "failed", "not_applicable"]
    params: dict[str, Any] = {}
    seen: dict[str, Any] = {}


class Actor(_Part):
    """See ``bench.audit.audit.ActorAudit``."""

    name: str
    role: str
    outcome: str
    by: str = ""
    evidence: dict[str, Any] = {}
    checks: tuple[Check, ...] = ()
    score: float | None = None


class Moment(_Part):
    """See ``bench.audit.spr.At``."""

    when: str
    unit: str
    outcome: str
    seen: dict[str, Any] = {}


class Relation(_Part):
    """See ``bench.audit.spr.Related``."""

    type: str
    a: str
    b: str
    outcome: Literal["holds", "does not hold", "not scored"]
    why: str = ""
    moments: tuple[Moment, ...] = ()


class AuditFile(_Part):
    """See ``bench.audit.audit.Audit``."""

    actors: tuple[Actor, ...] = ()
    relations: tuple[Relation, ...] = ()
    assertions: tuple[Check, ...] = ()
    blend: dict[str, Any] = {}
