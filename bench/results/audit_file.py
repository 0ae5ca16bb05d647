"""The parts of an audit.json that a report reads; fields of other versions are ignored."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True)


class CheckRow(_Part):
    """See ``bench.audit.audit.CheckResult``."""

    predicate: str
    wanted: Literal["must_have", "must_not_have"]
    outcome: Literal["passed", "failed", "not_applicable"]
    params: dict[str, Any] = {}
    seen: dict[str, Any] = {}


class ActorEvidence(_Part):
    """The part of ``bench.audit.actors.ActorResolution.evidence`` that is shown."""

    objects: tuple[str, ...] = ()


class ActorRow(_Part):
    """See ``bench.audit.audit.ActorAudit``."""

    name: str
    role: str
    outcome: str
    by: str = ""
    evidence: ActorEvidence = ActorEvidence()
    checks: tuple[CheckRow, ...] = ()
    score: float | None = None


class RelationMomentRow(_Part):
    """See ``bench.audit.spr.RelationMoment``."""

    when: str
    unit: str
    outcome: str
    seen: dict[str, Any] = {}


class AuditedRelation(_Part):
    """See ``bench.audit.spr.RelationResult``."""

    type: str
    a: str
    b: str
    outcome: Literal["holds", "does not hold", "not scored"]
    why: str = ""
    moments: tuple[RelationMomentRow, ...] = ()


class AuditFile(_Part):
    """See ``bench.audit.audit.Audit``."""

    actors: tuple[ActorRow, ...] = ()
    relations: tuple[AuditedRelation, ...] = ()
    assertions: tuple[CheckRow, ...] = ()
    blend: dict[str, Any] = {}
