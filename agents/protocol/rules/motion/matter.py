"""T8: a liquid keeps its volume, a gas leaves its source, and the domain's box cuts neither."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agents.protocol.measures.motion import MatterRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import ObjectFacts
    from agents.protocol.findings import Finding
    from agents.protocol.measures.motion import MatterMeasure
    from agents.protocol.measures.requests import Names

_PARTS = 4  # of the timeline, at whose ends matter is measured
_GROSS = 0.5  # change of volume that is no inexactness of the solver any more

_Samples = list[tuple[int, "MatterMeasure"]]


def _domains(context: RuleContext) -> list[ObjectFacts]:
    """The domains whose fluid is baked. Raises NotApplicable."""
    baked = {cache.object for cache in context.facts.caches if cache.kind == "fluid" and cache.baked}
    domains = [item for item in context.facts.objects if item.is_fluid_domain and item.name in baked]
    if not domains:
        raise NotApplicable("no fluid is baked")
    return domains


def _flows(context: RuleContext, *behaviors: str) -> Names:
    return tuple(
        item.name
        for item in context.facts.objects
        if item.fluid is not None and item.fluid.role == "flow" and item.fluid.behavior in behaviors
    )


def _requests_of(context: RuleContext, domain: ObjectFacts) -> list[MatterRequest]:
    start, end = context.facts.frame_start, context.facts.frame_end
    frames = sorted({start + (end - start) * part // _PARTS for part in range(_PARTS + 1)})
    sources = _flows(context, "geometry", "inflow")
    return [MatterRequest(domain.name, sources, frame) for frame in frames]


def _requests(context: RuleContext) -> Iterator[MatterRequest]:
    for domain in _domains(context):
        yield from _requests_of(context, domain)


def _judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for domain in _domains(context):
        name = _name(context, domain)
        try:
            samples = [(request.frame or 0, measures[request]) for request in _requests_of(context, domain)]
        except Unmeasured as reason:
            yield T8.undecided((name,), reason)
            continue
        there = [(frame, sample) for frame, sample in samples if sample.away is not None]
        kind = "gas" if domain.is_gas else "liquid"
        if not there:
            yield T8.finding(
                (name,),
                f"There is no {kind} of {name!r} at any of the frames {', '.join(str(frame) for frame, _ in samples)}.",
                fix="Let the flow lie within the domain, emit from the first frame on, and be switched on; then bake.",
                measured=0.0,
            )
        elif domain.is_gas:
            yield from _wrong_gas(context, name, there)
        else:
            yield from _wrong_liquid(context, name, there)


def _name(context: RuleContext, domain: ObjectFacts) -> str:
    """What a domain's fluid is called: its logical object, if it has one."""
    obj = context.structure.logical_object_of(domain.name)
    return obj.name if obj is not None else domain.name


def _wrong_gas(context: RuleContext, name: str, samples: _Samples) -> Iterator[Finding]:
    tolerances = context.tolerances
    frame, last = samples[-1]
    if (away := last.away or 0.0) < tolerances.leave_share:
        yield T8.finding(
            (name,),
            f"Only {away:.0%} of the gas of {name!r} is outside its source at frame {frame}.",
            fix="Give it buoyancy (heat, density) or an initial velocity, and free the way out of the source.",
            frame=frame,
            measured=away,
            tolerance=tolerances.leave_share,
        )
    frame, worst = max(samples, key=lambda sample: max(sample[1].lid or 0.0, sample[1].sides or 0.0))
    if (cut := max(worst.lid or 0.0, worst.sides or 0.0)) > tolerances.lid_share:
        border = "top" if (worst.lid or 0.0) >= (worst.sides or 0.0) else "sides"
        finding = T8.finding(
            (name,),
            f"{cut:.0%} of the gas of {name!r} is at the {border} of its domain at frame {frame}, which cuts it off.",
            fix="Make the domain larger there, or let the gas dissolve before; leave it if no camera sees it.",
            frame=frame,
            measured=cut,
            tolerance=tolerances.lid_share,
        )
        yield replace(finding, severity="soft")


def _wrong_liquid(context: RuleContext, name: str, samples: _Samples) -> Iterator[Finding]:
    tolerances = context.tolerances
    # A body of liquid may begin right below the lid; what matters is where it gets to.
    frame, worst = max(samples[1:] or samples, key=lambda sample: sample[1].lid or 0.0)
    if (lid := worst.lid or 0.0) > tolerances.lid_share:
        yield T8.finding(
            (name,),
            f"{lid:.0%} of the surface of {name!r} is at the top of its domain at frame {frame}, which cuts it off.",
            fix="Make the domain higher, so that no splash reaches its top.",
            frame=frame,
            measured=lid,
            tolerance=tolerances.lid_share,
        )
    volumes = [(frame, sample.volume) for frame, sample in samples if sample.volume]
    if len(volumes) < 2 or _flows(context, "inflow", "outflow"):
        return  # its volume may change
    (start, before), (frame, after) = volumes[0], volumes[-1]
    change = after / before - 1
    if abs(change) > tolerances.volume_share:
        finding = T8.finding(
            (name,),
            f"The volume of {name!r} {'grows' if change > 0 else 'shrinks'} by {abs(change):.0%}, from {before:.3g} m³ "
            f"at frame {start} to {after:.3g} m³ at frame {frame}.",
            fix="Lower the domain's particle radius and raise its resolution."
            if change > 0
            else "Raise the resolution, close gaps and thicken the walls of what holds it, and keep it off the "
            "domain's open borders.",
            frame=frame,
            measured=abs(change),
            tolerance=tolerances.volume_share,
        )
        yield finding if abs(change) > _GROSS else replace(finding, severity="soft")


T8 = Rule(
    "T8",
    "matter",
    "hard",
    "A liquid keeps its volume, below its domain's top; a gas leaves its source.",
    "A liquid that doubles while it falls, or a flat top where the domain ends, gives the simulation away.",
    "Change the domain's size and resolution or the flow, and bake again.",
    _judge,
    _requests,
    tolerances=("volume_share", "lid_share", "leave_share"),
)
RULES = (T8,)
