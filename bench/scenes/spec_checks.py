"""What a spec must be beyond its schema, and the fifty together: predicates, prompts, levels, relations.

The rules follow the paper's "Benchmark Details" (composition, authoring protocol). Each yields faults, in words.
"""

from __future__ import annotations

import re
from collections import Counter
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

from bench.audit.audit import check_predicates
from bench.audit.names import match, words_of
from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.particle import DEFORMERS
from bench.scenes.levels import SOLVER_GROUPS, level_of, solver_groups
from bench.scenes.spec import CATEGORIES, FOLDER, BadSpec

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from bench.scenes.spec import Spec

# Printed in the paper, word for word; the rules for our own words do not bind them.
PUBLISHED = frozenset({"cloth_D1_01", "soft_D3_01", "static_D1_01"})
# A clip is filmed within seconds; relations are few enough to be looked through by eye.
_SECONDS = (2.0, 6.0)
_RELATIONS = {"dynamic": (2, 5), "static": (8, 15)}
_ROOM = (15, 20)
_SCENE_SCALE = 12
_CELLS = {"static": {"D1": 3, "D2": 2}}
_CELL = {"D1": 3, "D2": 3, "D3": 3}
# Scenes that share so much of their prompts' words, or of their actors' names, are the same scene.
_SAME_WORDS, _SAME_ACTORS = 0.35, 0.6

_PLACEHOLDERS = re.compile(r"\b(ball|object|thing|item|shape|cube|sphere|mesh|prop)s?\b", re.IGNORECASE)
_SENTENCE = re.compile(r"[^.!?]+[.!?](?=\s|$)")
# Words that tell where, when and of what. A prompt has one of each kind at least.
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
# What an actor of a solver's role is asked for, and what it must not be instead.
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
    """What is wrong with a spec, each fault a line that starts with its id; of unknown predicates, only these."""
    try:
        check_predicates(spec)
    except BadSpec as error:
        return (str(error),)
    rules = (_predicates, _roles, _prompt, _naming, _level, _clip, _relations, _still)
    return tuple(f"{spec.id}: {fault}" for rule in rules for fault in rule(spec))


def faults_together(specs: Sequence[Spec]) -> tuple[str, ...]:
    """What is wrong with all scenes as a set: how many, what they exercise, whether two are alike."""
    return tuple(fault for rule in (_composition, _coverage, _files, _twice) for fault in rule(specs))


# One spec


def _predicates(spec: Spec) -> Iterator[str]:
    """Each where it belongs, none twice of an actor, partners that are others."""
    for actor in spec.actors:
        for check in actor.must_have:
            if PREDICATES[check.predicate].group == "anti-cheat":
                yield f"{actor.name}: {check.predicate} is for must_not_have"
            if check.params.get("deformer", DEFORMERS[0]) not in DEFORMERS:
                yield f"{actor.name}: no modifier that deforms is called {check.params['deformer']}"
            if actor.name in check.params.get("partners", ()):
                yield f"{actor.name}: is its own partner in {check.predicate}"
        for check in actor.must_not_have:
            row = PREDICATES[check.predicate]
            if row.group != "anti-cheat" or row.scope == "scene":
                yield f"{actor.name}: {check.predicate} is not for must_not_have"
        asked = Counter(check.predicate for check in (*actor.must_have, *actor.must_not_have))
        yield from (f"{actor.name}: {name} twice" for name, times in asked.items() if times > 1)
    for check in spec.assertions:
        if PREDICATES[check.predicate].scope != "scene" or PREDICATES[check.predicate].group != "anti-cheat":
            yield f"assertions: {check.predicate} is not about the whole scene"


def _roles(spec: Spec) -> Iterator[str]:
    """What a role stands for is asked for; what is seen is renderable, and has a size."""
    for actor in spec.actors:
        asked = {check.predicate for check in actor.must_have}
        ruled_out = {check.predicate for check in actor.must_not_have}
        wanted, unwanted = _BY_ROLE.get(actor.role, ((), ()))
        yield from (f"{actor.name}: {actor.role} without {name}" for name in wanted if name not in asked)
        yield from (f"{actor.name}: {name} is not ruled out" for name in unwanted if name not in ruled_out)
        if actor.role not in ("force", "fluid_flow") and "renderable" not in asked:
            yield f"{actor.name}: need not be renderable"
        if actor.role != "force":
            size = actor.hints.size
            if size is None or not 0 < size[0] < size[1]:
                yield f"{actor.name}: no band of sizes"


def _prompt(spec: Spec) -> Iterator[str]:
    """One to three sentences, no placeholders, and words for place, time and material."""
    text = spec.prompt
    sentences = _SENTENCE.findall(text)
    if not 1 <= len(sentences) <= 3 or "".join(sentences).strip() != text.strip():
        yield f"prompt: {len(sentences)} sentences"
    if found := _PLACEHOLDERS.search(text):
        yield f"prompt: {found[0]!r} is no proper noun"
    if spec.id not in PUBLISHED:
        words = {*re.findall(r"[a-z]+", text.casefold()), *words_of(text)}
        for kind, known in _ANCHORS.items():
            if words.isdisjoint(known.split()):
                yield f"prompt: no word for a {kind}"


def _naming(spec: Spec) -> Iterator[str]:
    """The prompt names every actor that is not implied; no phrase stands for two actors."""
    owners: dict[tuple[str, ...], str] = {}
    for actor in spec.actors:
        phrases = (actor.name, *actor.synonyms)
        named = match(spec.prompt, phrases) is not None
        if named == actor.implied:
            yield f"{actor.name}: {'implied, yet the prompt names it' if named else 'not in the prompt'}"
        for phrase in phrases:
            other = owners.setdefault(words_of(phrase), actor.name)
            if other != actor.name:
                yield f"{actor.name}: {phrase!r} is {other}'s"


def _level(spec: Spec) -> Iterator[str]:
    """The category's solver is there, and the predicates ask for no more and no less than the level says."""
    if spec.category != "static" and SOLVER_GROUPS[spec.category] not in solver_groups(spec):
        yield f"no actor is simulated as {spec.category}"
    if (level := level_of(spec)) != spec.level:
        yield f"what it asks for is {level}"


def _clip(spec: Spec) -> Iterator[str]:
    """Seconds that can be filmed, and a phase for something."""
    if spec.frames is None:
        return
    seconds = spec.frames.min / spec.frames.fps
    if not _SECONDS[0] <= seconds <= _SECONDS[1]:
        yield f"frames: {seconds:.1f} seconds"
    if not spec.phases:
        yield "phases: nothing moves"
    yield from (
        f"phases: {one.actor}: {one.kind} ends before it starts"
        for one in spec.phases
        if one.end <= one.start
    )


def _relations(spec: Spec) -> Iterator[str]:
    """As many as can be looked through, of two actors each that have a surface, none said twice or both ways."""
    least, most = _RELATIONS["static" if spec.category == "static" else "dynamic"]
    if not least <= len(spec.relations) <= most:
        yield f"relations: {len(spec.relations)}, not {least} to {most}"
    seen = set[tuple[str, str, str, str]]()
    for one in spec.relations:
        if one.a == one.b:
            yield f"relations: {one.a} {one.type} itself"
        for end in (one.a, one.b):
            actor = spec.actor(end)
            if actor is not None and actor.role == "force":
                yield f"relations: {end} has no surface"
        if not one.when or len(set(one.when)) < len(one.when):
            yield f"relations: {one.a} {one.type} {one.b}: when?"
        for when in one.when:
            if (one.type, one.a, one.b, when) in seen:
                yield f"relations: {one.a} {one.type} {one.b} twice at the {when}"
            if one.type in _ONE_WAY and any((kind, one.b, one.a, when) in seen for kind in _ONE_WAY):
                yield f"relations: {one.a} and {one.b} above each other at the {when}"
            seen.add((one.type, one.a, one.b, when))


_ONE_WAY = ("SupportedBy", "OnTopOf", "Above")


def _still(spec: Spec) -> Iterator[str]:
    """A static scene has things and no physics; only such a scene says so."""
    scene_wide = {
        name for name, row in PREDICATES.items() if row.group == "anti-cheat" and row.scope == "scene"
    }
    asserted = {check.predicate for check in spec.assertions}
    if spec.category != "static":
        if asserted:
            yield "assertions: for static scenes alone"
        return
    yield from (f"assertions: {name} is not ruled out" for name in sorted(scene_wide - asserted))
    if any(actor.role != "static" for actor in spec.actors):
        yield "actors: not all static"
    if spec.phases:
        yield "phases: nothing moves in a static scene"
    if spec.level == "D1" and not _ROOM[0] <= len(spec.actors) <= _ROOM[1]:
        yield f"actors: {len(spec.actors)} in a room, not {_ROOM[0]} to {_ROOM[1]}"
    if spec.level == "D2" and len(spec.actors) < _SCENE_SCALE:
        yield f"actors: {len(spec.actors)}, not {_SCENE_SCALE}"


# All of them


def _composition(specs: Sequence[Spec]) -> Iterator[str]:
    """Nine of each solver, three a level; five static ones."""
    found = Counter((spec.category, spec.level) for spec in specs)
    wanted = Counter(
        {
            (category, level): number
            for category in CATEGORIES
            for level, number in _CELLS.get(category, _CELL).items()
        }
    )
    for cell in sorted({*found, *wanted}):
        if found[cell] != wanted[cell]:
            yield f"{'_'.join(cell)}: {found[cell]} scenes, not {wanted[cell]}"


def _coverage(specs: Sequence[Spec]) -> Iterator[str]:
    """Every predicate is asked for somewhere."""
    asked = {check.predicate for spec in specs for check in spec.assertions}
    for spec in specs:
        for actor in spec.actors:
            asked.update(check.predicate for check in (*actor.must_have, *actor.must_not_have))
    yield from (f"no scene asks for {name}" for name in PREDICATES if name not in asked)


def _files(specs: Sequence[Spec]) -> Iterator[str]:
    """Ids count from 01 in their cell, and every file is called as its scene is."""
    for cell in sorted({spec.cell for spec in specs}):
        numbers = sorted(int(spec.id[-2:]) for spec in specs if spec.cell == cell)
        if numbers[0] != 1 or any(after != before + 1 for before, after in pairwise(numbers)):
            yield f"{cell}: numbered {', '.join(map(str, numbers))}"
    ids = {spec.id for spec in specs}
    yield from (
        f"{path.name}: not called as its scene is"
        for path in sorted(FOLDER.glob("*.yaml"))
        if path.stem not in ids
    )


def _twice(specs: Sequence[Spec]) -> Iterator[str]:
    """No two scenes alike: in words, in what is simulated, or, beyond one actor, in how."""
    for one, other in combinations(specs, 2):
        if _shared(words_of(one.prompt), words_of(other.prompt)) >= _SAME_WORDS:
            yield f"{one.id} and {other.id}: prompts of the same words"
        if _shared(_names(one), _names(other)) >= _SAME_ACTORS:
            yield f"{one.id} and {other.id}: the same actors"
        if (
            one.cell == other.cell
            and one.level != "D1"
            and _mechanism(one) == _mechanism(other) != frozenset()
        ):
            yield f"{one.id} and {other.id}: the same mechanism"


def _shared(one: Iterable[str], other: Iterable[str]) -> float:
    mine, yours = set(one), set(other)
    return len(mine & yours) / max(1, len(mine | yours))


def _names(spec: Spec) -> tuple[str, ...]:
    return tuple(actor.name for actor in spec.actors)


def _mechanism(spec: Spec) -> frozenset[tuple[str, int, str, str]]:
    """Which roles are asked for what, whatever the actors are called."""
    return frozenset(
        (actor.role, actor.count, check.predicate, str(check.params.get("type", "")))
        for actor in spec.actors
        for check in actor.must_have
        if check.predicate != "renderable"
    )
