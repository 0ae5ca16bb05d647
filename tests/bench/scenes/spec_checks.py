"""Rules for specs beyond their schema, one by one and as a set: predicates, prompts, levels, relations.

They follow the paper's "Benchmark Details" (composition, authoring protocol). Each rule yields faults, in words.
"""

from __future__ import annotations

import re
from collections import Counter
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

from levels import SOLVER_GROUPS, level_of, solver_groups

from bench.audit.audit import check_predicates
from bench.audit.names import match_name, words_of
from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.particle import DEFORMERS
from bench.scenes.spec import CATEGORIES, FOLDER, BadSpec

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from bench.scenes.spec import Spec

# Prompts that the paper prints, word for word; the rules for wording do not apply to them.
PUBLISHED = frozenset({"cloth_D1_01", "soft_D3_01", "static_D1_01"})
# Clips take seconds to render; relations are few enough to check by eye.
_SECONDS = (2.0, 6.0)
_RELATIONS = {"dynamic": (2, 5), "static": (8, 15)}
_ROOM = (15, 20)
_SCENE_SCALE = 12
_CELLS = {"static": {"D1": 3, "D2": 2}}
_CELL = {"D1": 3, "D2": 3, "D3": 3}
# Scenes that share so much of their prompts' words, or of their actors' names, count as the same.
_SAME_WORDS, _SAME_ACTORS = 0.35, 0.6

_PLACEHOLDERS = re.compile(r"\b(ball|object|thing|item|shape|cube|sphere|mesh|prop)s?\b", re.IGNORECASE)
_SENTENCE = re.compile(r"[^.!?]+[.!?](?=\s|$)")
# Words for a place, a time and a material. A prompt has at least one of each kind.
_ANCHORS = {
    "place": """alley alps attic backyard bakery balcony barnyard basin bathhouse beach brittany cabin cairo casino
    cellar chapel clearing courtyard dune fjord garden greenhouse halt harbour hillside kitchen laboratory nursery
    pantry park pier playroom quarry quay saloon shed shop smithy tearoom temple terrace theatre track windowsill
    workshop yard site""",
    "time": """afternoon breakfast dawn dusk evening golden light midday midnight morning night noon school sunrise
    sunset teatime""",
    "material": """beechwood birch brass brick bronze burlap canvas cardboard china clay concrete copper cotton
    driftwood earthenware enamel glass granite iron ivory leather limestone linen log magnesium marble oak paper pewter
    pine porcelain rubber sandstone silk slate steel stone terracotta timber tin velvet walnut wood wooden wool zinc""",
}
_BOTH_KINDS = ("dense_transform_keys", "animated_shape_keys")
_DENSE = _BOTH_KINDS[:1]
# Role → the checks that an actor of it must have, and those that it must not have.
_BY_ROLE: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "cloth": (("solver_enabled", "cloth_modifier", "cloth_cache_baked"), _BOTH_KINDS),
    "soft": (("solver_enabled", "soft_modifier", "soft_cache_baked"), _BOTH_KINDS),
    "fluid_domain": (("solver_enabled", "fluid_modifier", "fluid_type", "fluid_cache_baked"), _DENSE),
    "fluid_flow": (("solver_enabled", "fluid_type"), ()),
    "fluid_effector": (("solver_enabled", "fluid_type"), ()),
    "rigid_active": (("solver_enabled", "rigid_settings", "rigid_type"), _DENSE),
    "rigid_passive": (("solver_enabled", "rigid_settings"), ()),
    "particle_emitter": (
        ("solver_enabled", "particle_system", "particle_type", "particle_cache_baked"),
        _DENSE,
    ),
    "particle_hair": (("solver_enabled", "particle_system", "particle_type"), _DENSE),
    "collider": (("solver_enabled",), ()),
    "force": (("solver_enabled",), ()),
}


def faults(spec: Spec) -> tuple[str, ...]:
    """The faults of a spec, lines that start with its id. With invalid checks, the first of these is the only fault."""
    try:
        check_predicates(spec)
    except BadSpec as error:
        return (str(error),)
    rules = (_predicates, _roles, _prompt, _naming, _level, _clip, _relations, _still)
    return tuple(f"{spec.id}: {fault}" for rule in rules for fault in rule(spec))


def faults_together(specs: Sequence[Spec]) -> tuple[str, ...]:
    """The faults of all scenes as a set: how many there are, which predicates they use, whether two are alike."""
    return tuple(fault for rule in (_composition, _coverage, _files, _alike) for fault in rule(specs))


# One spec


def _predicates(spec: Spec) -> Iterator[str]:
    """Each check is in the right list, at most once per actor, with partners other than the actor."""
    for actor in spec.actors:
        for check in actor.must_have:
            if PREDICATES[check.predicate].group == "anti-cheat":
                yield f"{actor.name}: {check.predicate} belongs in must_not_have"
            if check.params.get("deformer", DEFORMERS[0]) not in DEFORMERS:
                yield f"{actor.name}: {check.params['deformer']} is not a deforming modifier"
            if actor.name in check.params.get("partners", ()):
                yield f"{actor.name}: it is its own partner in {check.predicate}"
        for check in actor.must_not_have:
            row = PREDICATES[check.predicate]
            if row.group != "anti-cheat" or row.scope == "scene":
                yield f"{actor.name}: {check.predicate} does not belong in must_not_have"
        counts = Counter(check.predicate for check in (*actor.must_have, *actor.must_not_have))
        yield from (f"{actor.name}: {name} is listed twice" for name, times in counts.items() if times > 1)
    for check in spec.assertions:
        if PREDICATES[check.predicate].scope != "scene" or PREDICATES[check.predicate].group != "anti-cheat":
            yield f"assertions: {check.predicate} is not about the whole scene"


def _roles(spec: Spec) -> Iterator[str]:
    """Actors have the checks of their role; visible ones are renderable and have a size."""
    for actor in spec.actors:
        required = {check.predicate for check in actor.must_have}
        ruled_out = {check.predicate for check in actor.must_not_have}
        wanted, unwanted = _BY_ROLE.get(actor.role, ((), ()))
        yield from (
            f"{actor.name}: its role {actor.role} needs {name} in must_have"
            for name in wanted
            if name not in required
        )
        yield from (
            f"{actor.name}: its role {actor.role} needs {name} in must_not_have"
            for name in unwanted
            if name not in ruled_out
        )
        if actor.role not in ("force", "fluid_flow") and "renderable" not in required:
            yield f"{actor.name}: renderable is missing in must_have"
        if actor.role != "force":
            size = actor.hints.size
            if size is None or not 0 < size[0] < size[1]:
                yield f"{actor.name}: hints.size must be a range of sizes above zero"


def _prompt(spec: Spec) -> Iterator[str]:
    """The prompt has one to three sentences, no placeholders, and words for place, time and material."""
    text = spec.prompt
    sentences = _SENTENCE.findall(text)
    if not 1 <= len(sentences) <= 3 or "".join(sentences).strip() != text.strip():
        yield f"prompt: {len(sentences)} sentences instead of 1 to 3"
    if found := _PLACEHOLDERS.search(text):
        yield f"prompt: {found[0]!r} is a placeholder; name the object"
    if spec.id not in PUBLISHED:
        words = {*re.findall(r"[a-z]+", text.casefold()), *words_of(text)}
        for kind, known in _ANCHORS.items():
            if words.isdisjoint(known.split()):
                yield f"prompt: it has no known word for a {kind}"


def _naming(spec: Spec) -> Iterator[str]:
    """The prompt names every actor that is not implied; no name or synonym is of two actors."""
    owners: dict[tuple[str, ...], str] = {}
    for actor in spec.actors:
        phrases = (actor.name, *actor.synonyms)
        named = match_name(spec.prompt, phrases) is not None
        if named == actor.implied:
            yield f"{actor.name}: {'implied, but the prompt names it' if named else 'the prompt does not name it'}"
        for phrase in phrases:
            other = owners.setdefault(words_of(phrase), actor.name)
            if other != actor.name:
                yield f"{actor.name}: {phrase!r} is also a name of {other}"


def _level(spec: Spec) -> Iterator[str]:
    """The category's solver is used, and the checks fit the level."""
    if spec.category != "static" and SOLVER_GROUPS[spec.category] not in solver_groups(spec):
        yield f"no actor has a solver of the category {spec.category}"
    if (level := level_of(spec)) != spec.level:
        yield f"its checks are of level {level}"


def _clip(spec: Spec) -> Iterator[str]:
    """The clip is 2 to 6 seconds long and has a phase."""
    if spec.frames is None:
        return
    seconds = spec.frames.min / spec.frames.fps
    if not _SECONDS[0] <= seconds <= _SECONDS[1]:
        yield f"frames: {seconds:.1f} seconds instead of {_SECONDS[0]:g} to {_SECONDS[1]:g}"
    if not spec.phases:
        yield "phases: there is none"
    yield from (
        f"phases: {phase.actor}: {phase.kind} ends before it starts"
        for phase in spec.phases
        if phase.end <= phase.start
    )


def _relations(spec: Spec) -> Iterator[str]:
    """There are neither too few nor too many, between two actors with a surface, without repeats or contradictions."""
    least, most = _RELATIONS["static" if spec.category == "static" else "dynamic"]
    if not least <= len(spec.relations) <= most:
        yield f"relations: {len(spec.relations)} instead of {least} to {most}"
    seen = set[tuple[str, str, str, str]]()
    for relation in spec.relations:
        kind, a, b = relation.type, relation.a, relation.b
        if a == b:
            yield f"relations: {a} {kind} itself"
        for end in (a, b):
            actor = spec.actor(end)
            if actor is not None and actor.role == "force":
                yield f"relations: {end} has no surface"
        if not relation.when or len(set(relation.when)) < len(relation.when):
            yield f"relations: {a} {kind} {b}: 'when' is empty or repeats a time"
        for when in relation.when:
            if (kind, a, b, when) in seen:
                yield f"relations: {a} {kind} {b} is listed twice for the {when}"
            if kind in _ONE_WAY and any((other, b, a, when) in seen for other in _ONE_WAY):
                yield f"relations: {a} and {b} are above each other at the {when}"
            seen.add((kind, a, b, when))


_ONE_WAY = ("SupportedBy", "OnTopOf", "Above")


def _still(spec: Spec) -> Iterator[str]:
    """A static scene has only static actors and rules physics out; other scenes have no assertions."""
    scene_wide = {
        name for name, row in PREDICATES.items() if row.group == "anti-cheat" and row.scope == "scene"
    }
    asserted = {check.predicate for check in spec.assertions}
    if spec.category != "static":
        if asserted:
            yield "assertions: only static scenes have them"
        return
    yield from (f"assertions: {name} is missing" for name in sorted(scene_wide - asserted))
    if any(actor.role != "static" for actor in spec.actors):
        yield "actors: not all are static"
    if spec.phases:
        yield "phases: nothing moves in a static scene"
    if spec.level == "D1" and not _ROOM[0] <= len(spec.actors) <= _ROOM[1]:
        yield f"actors: {len(spec.actors)} in a room instead of {_ROOM[0]} to {_ROOM[1]}"
    if spec.level == "D2" and len(spec.actors) < _SCENE_SCALE:
        yield f"actors: {len(spec.actors)} instead of at least {_SCENE_SCALE}"


# All of them


def _composition(specs: Sequence[Spec]) -> Iterator[str]:
    """There are nine scenes of each solver, three per level, and five static ones."""
    counts = Counter((spec.category, spec.level) for spec in specs)
    wanted = Counter(
        {
            (category, level): number
            for category in CATEGORIES
            for level, number in _CELLS.get(category, _CELL).items()
        }
    )
    for cell in sorted({*counts, *wanted}):
        if counts[cell] != wanted[cell]:
            yield f"{'_'.join(cell)}: {counts[cell]} scenes instead of {wanted[cell]}"


def _coverage(specs: Sequence[Spec]) -> Iterator[str]:
    """Every predicate is used in some scene."""
    used = {check.predicate for spec in specs for check in spec.assertions}
    for spec in specs:
        for actor in spec.actors:
            used.update(check.predicate for check in (*actor.must_have, *actor.must_not_have))
    yield from (f"no scene uses {name}" for name in PREDICATES if name not in used)


def _files(specs: Sequence[Spec]) -> Iterator[str]:
    """Ids are numbered from 01 in their cell, and every file is named after its scene's id."""
    for cell in sorted({spec.cell for spec in specs}):
        numbers = sorted(int(spec.id[-2:]) for spec in specs if spec.cell == cell)
        if numbers[0] != 1 or any(after != before + 1 for before, after in pairwise(numbers)):
            yield f"{cell}: the ids are numbered {', '.join(map(str, numbers))}, not from 01 without gaps"
    ids = {spec.id for spec in specs}
    yield from (
        f"{path.name}: the file is not named after its scene's id"
        for path in sorted(FOLDER.glob("*.yaml"))
        if path.stem not in ids
    )


def _alike(specs: Sequence[Spec]) -> Iterator[str]:
    """No two scenes share too many words or actors, or, above D1, the same roles and checks."""
    for first, second in combinations(specs, 2):
        if _shared(words_of(first.prompt), words_of(second.prompt)) >= _SAME_WORDS:
            yield f"{first.id} and {second.id}: their prompts share too many words"
        if _shared(_names(first), _names(second)) >= _SAME_ACTORS:
            yield f"{first.id} and {second.id}: they share too many actors"
        if (
            first.cell == second.cell
            and first.level != "D1"
            and _mechanism(first) == _mechanism(second) != frozenset()
        ):
            yield f"{first.id} and {second.id}: their roles and checks are the same"


def _shared(first: Iterable[str], second: Iterable[str]) -> float:
    first_set, second_set = set(first), set(second)
    return len(first_set & second_set) / max(1, len(first_set | second_set))


def _names(spec: Spec) -> tuple[str, ...]:
    return tuple(actor.name for actor in spec.actors)


def _mechanism(spec: Spec) -> frozenset[tuple[str, int, str, str]]:
    """The roles with their checks, whatever the actors are called."""
    return frozenset(
        (actor.role, actor.count, check.predicate, str(check.params.get("type", "")))
        for actor in spec.actors
        for check in actor.must_have
        if check.predicate != "renderable"
    )
