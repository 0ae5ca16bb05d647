"""Fluids: domains, flows, effectors, and caches on disk."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from bench.audit.predicates.predicate import PredicateParams, PredicateVerdict, verdict_of
from bench.audit.predicates.shared_readings import (
    admits,
    has_files,
    members,
    moved,
    number,
    parts_of,
    range_seen,
    reaches,
    travel,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Domain, Fluid, Object
    from bench.audit.predicates.predicate import AuditContext, Unit


FlowKind = Literal["LIQUID", "SMOKE", "BOTH", "FIRE"]
FluidKind = FlowKind | Literal["GAS", "COLLISION", "GUIDE"]
Behavior = Literal["INFLOW", "OUTFLOW", "GEOMETRY"]


class FluidType(PredicateParams):
    """``type``: DOMAIN, FLOW, EFFECTOR. ``kind``: of a domain LIQUID, GAS; of a flow LIQUID, SMOKE, BOTH, FIRE; of an
    effector COLLISION, GUIDE; or a list of accepted kinds. ``behavior``: of a flow. None: any.
    """

    type: Literal["DOMAIN", "FLOW", "EFFECTOR"]
    kind: FluidKind | tuple[FluidKind, ...] | None = None
    behavior: Behavior | None = None


class DomainKind(PredicateParams):
    """``kind``: LIQUID or GAS; None: either."""

    kind: Literal["LIQUID", "GAS"] | None = None


class FlowCount(PredicateParams):
    """``min``: how many at least. ``kind``, ``behavior``: as for fluid_type; None: any (of behaviors, not OUTFLOW)."""

    min: int = Field(default=1, ge=1)
    kind: FlowKind | tuple[FlowKind, ...] | None = None
    behavior: Behavior | None = None


class MinResolution(PredicateParams):
    """``min``: least divisions of the domain's longest side."""

    min: int = Field(default=32, ge=1)


def _fluids(objects: tuple[Object, ...], kind: str) -> Iterator[tuple[Object, Fluid]]:
    """Fluid modifiers of a type, with the objects that they stand on."""
    for obj in objects:
        for modifier in obj.of_type("FLUID"):
            if modifier.fluid is not None and modifier.fluid.type == kind:
                yield obj, modifier.fluid


def _domains(objects: tuple[Object, ...]) -> Iterator[tuple[Object, Domain]]:
    for obj, fluid in _fluids(objects, "DOMAIN"):
        if fluid.domain is not None:
            yield obj, fluid.domain


def _working(objects: tuple[Object, ...], kind: str) -> Iterator[tuple[Object, Fluid]]:
    for obj, fluid in _fluids(objects, kind):
        if fluid.used and any(modifier.on for modifier in obj.of_type("FLUID")):
            yield obj, fluid


def fluid_modifier(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor takes part in a fluid simulation: one of its objects has a FLUID modifier with a type other than
    NONE, on or off (see solver_enabled).
    """
    del context, params
    types = {
        obj.name: modifier.fluid.type
        for obj, modifier in unit.modifiers("FLUID")
        if modifier.fluid is not None and modifier.fluid.type != "NONE"
    }
    return verdict_of(types, types=dict(sorted(types.items())[:8]))


def fluid_type(unit: Unit, context: AuditContext, params: FluidType) -> PredicateVerdict:
    """The actor has the right part in the fluid simulation: one of its FLUID modifiers has the required type, and the
    required kind and behavior if these are given. A flow of smoke does not pass where liquid is required.
    """
    del context
    fluids = [
        (obj.name, modifier.fluid)
        for obj, modifier in unit.modifiers("FLUID")
        if modifier.fluid is not None and modifier.fluid.type != "NONE"
    ]
    fits = any(
        fluid.type == params.type
        and admits(params.kind, fluid.kind)
        and admits(params.behavior, fluid.behavior)
        for _, fluid in fluids
    )
    seen = [
        {"name": name, "type": fluid.type, "kind": fluid.kind, "behavior": fluid.behavior}
        for name, fluid in fluids
    ]
    return verdict_of(fits, fluids=seen[:8])


def _takes_in(domain: Domain, obj: Object, context: AuditContext, *, flow: bool) -> bool:
    """Whether a flow or effector acts in a domain: it is in the domain's collection and touches its box."""
    within = members(context.scene, domain.flows if flow else domain.effectors)
    return (within is None or obj.name in within) and reaches(domain, obj)


def fluid_domain_exists(unit: Unit, context: AuditContext, params: DomainKind) -> PredicateVerdict:
    """The actor has a fluid domain: an object of the scene with a FLUID modifier of type DOMAIN, of the required kind.
    If the actor is a flow or an effector, its bounds must overlap the domain's at the start, middle or end of the clip,
    and it must be in the domain's flow or effector collection if there is one: elsewhere it has no effect. An actor
    whose role is flow or effector but that has no such modifier fails.
    """
    domains = [
        (obj, domain) for obj, domain in _domains(context.scene.objects) if admits(params.kind, domain.kind)
    ]
    parts = [(obj, True) for obj, _ in _fluids(unit.objects, "FLOW")]
    parts += [(obj, False) for obj, _ in _fluids(unit.objects, "EFFECTOR")]
    anywhere = not parts and unit.role not in ("fluid_flow", "fluid_effector")
    reached = [
        owner.name
        for owner, domain in domains
        if anywhere or any(_takes_in(domain, obj, context, flow=flow) for obj, flow in parts)
    ]
    return verdict_of(reached, domains=[obj.name for obj, _ in domains][:8], reached=reached[:8])


def fluid_flow_count(unit: Unit, context: AuditContext, params: FlowCount) -> PredicateVerdict:
    """Enough fluid flows into the scene's domains: at least ``min`` objects have a FLUID modifier of type FLOW that is
    on and used, has the required kind and behavior (outflows count only if required), overlaps a domain, and is in the
    domain's flow collection if there is one.
    """
    del unit
    domains = list(_domains(context.scene.objects))
    names = sorted(
        {
            obj.name
            for obj, flow in _working(context.scene.objects, "FLOW")
            if admits(params.kind, flow.kind)
            and (params.behavior == flow.behavior if params.behavior else flow.behavior != "OUTFLOW")
            and any(_takes_in(domain, obj, context, flow=True) for _, domain in domains)
        }
    )
    return verdict_of(len(names) >= params.min, flows=names[:12], count=len(names), min=params.min)


def fluid_cache_baked(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The fluid's motion is baked: the domain's cache range covers 95 % of the scene's frames and of the clip's minimum
    length, and 95 % of these frames have files on disk for every part that is shown (data; mesh and noise if they are
    used). Blender must also mark these parts as baked, unless the cache type is REPLAY, which has no bake and plays
    what is on disk. Both are checked because the flag outlives deleted files, and files outlive the flag. If the actor
    is not a domain, the domains in which it acts are checked.
    """
    del params
    domains = list(_domains(unit.objects))
    if not domains:
        parts = [(obj, True) for obj, _ in _fluids(unit.objects, "FLOW")]
        parts += [(obj, False) for obj, _ in _fluids(unit.objects, "EFFECTOR")]
        domains = [
            (owner, domain)
            for owner, domain in _domains(context.scene.objects)
            if any(_takes_in(domain, obj, context, flow=flow) for obj, flow in parts)
        ]
    baked = [_is_baked(domain, context) for _, domain in domains]
    return verdict_of(any(baked), domains=[_cache_seen(obj, domain, context) for obj, domain in domains][:4])


def _is_baked(domain: Domain, context: AuditContext) -> bool:
    flagged = domain.cache.kind == "REPLAY" or set(parts_of(domain)) <= set(domain.cache.baked)
    return flagged and has_files(domain, context)


def _cache_seen(obj: Object, domain: Domain, context: AuditContext) -> dict[str, Any]:
    cache = domain.cache
    return {
        "domain": obj.name,
        "kind": cache.kind,
        "baked": list(cache.baked),
        "needed": list(parts_of(domain)),
        "on_disk": {part.name: [part.first, part.last, part.frames] for part in cache.parts},
        **range_seen(cache.range, context),
        "found_elsewhere": cache.moved,
    }


def fluid_dynamic_effector(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor pushes the fluid by moving: one of its objects has a FLUID modifier of type EFFECTOR that is on and
    used, and by the middle or the end of the clip that object has moved at least 1 cm or turned at least 1 degree from
    its start, as played from keys and caches. Unbaked physics is not played and counts as no motion.
    """
    del context, params
    effectors = [obj for obj, _ in _working(unit.objects, "EFFECTOR")]
    travels = {obj.name: [number(value) for value in travel(obj) or ()] for obj in effectors}
    return verdict_of(
        any(moved(obj) for obj in effectors), metres_and_degrees=dict(sorted(travels.items())[:8])
    )


def fluid_guiding(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The fluid is guided: a domain of the actor (or, if the actor is not a domain, any domain of the scene) uses
    guiding and has a guide: an object with an EFFECTOR of kind GUIDE that is on and used, or, if the guide source is a
    domain, that domain. If the actor is an effector, it must be such a guide itself.
    """
    del params
    guides = [obj.name for obj, fluid in _working(context.scene.objects, "EFFECTOR") if fluid.kind == "GUIDE"]
    effectors = [obj.name for obj, _ in _fluids(unit.objects, "EFFECTOR")]
    domains = list(_domains(unit.objects)) or list(_domains(context.scene.objects))
    led = [
        obj.name
        for obj, domain in domains
        if domain.use_guide
        and (domain.guide_domain is not None if domain.guide_source == "DOMAIN" else bool(guides))
    ]
    by_actor = not effectors or bool(set(effectors) & set(guides))
    return verdict_of(led and by_actor, led=led[:8], guides=guides[:8])


def fluid_resolution(unit: Unit, context: AuditContext, params: MinResolution) -> PredicateVerdict:
    """The fluid is resolved finely enough: a domain of the actor has at least ``min`` divisions along its longest side.
    Below 32, a stream a tenth of that side wide is only three cells wide and breaks into blobs.
    """
    del context
    resolutions = {obj.name: domain.resolution for obj, domain in _domains(unit.objects)}
    return verdict_of(
        any(value >= params.min for value in resolutions.values()), resolution=resolutions, min=params.min
    )


def fluid_mesh(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The liquid has a surface: a domain of the actor is of kind LIQUID and makes a mesh. Without a mesh, a render
    shows the domain's box, or particles.
    """
    del context, params
    domains = {
        obj.name: {"kind": domain.kind, "mesh": domain.use_mesh} for obj, domain in _domains(unit.objects)
    }
    return verdict_of(
        any(obj["kind"] == "LIQUID" and obj["mesh"] for obj in domains.values()), domains=domains
    )
