"""Recorded motion is told from posed, pushed and simulated motion, however it is stored."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from in_blender import facts_of

from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.predicate import AuditContext, Unit

if TYPE_CHECKING:
    from bench.audit.facts import Scene

pytestmark = pytest.mark.blender

RECORDED = (
    *(
        "each_frame",
        "turned_each_frame",
        "layered_strip",
        "driven_by_time",
        "driven_by_python",
        "noisy",
        "sampled",
    ),
    *("carried", "simulated_and_recorded", "copied", "on_a_path", "from_alembic"),
)
NOT_RECORDED = (
    *(
        "driven_to_a_constant",
        "carried_and_simulated",
        "posed",
        "pushed",
        "held_still",
        "beyond_the_clip",
        "muted",
    ),
    *("blended", "shaped_and_still"),
)
STORED_SHAPES = ("blended", "blended_by_a_driver", "run_through", "points_keyed", "from_a_mesh_cache")
NO_STORED_SHAPES = ("shaped_and_still", "from_a_hidden_mesh_cache", "each_frame", "carried_and_simulated")


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Scene]:
    return facts_of("cheats.py", tmp_path_factory.mktemp("cheats"))


def holds(predicate: str, scene: Scene) -> bool:
    unit = Unit(tuple(one for one in scene.objects if one.name == "Thing"), "rigid_active")
    assert unit.objects
    row = PREDICATES[predicate]
    return row.judge(unit, AuditContext(scene), row.read({})).outcome == "passed"


@pytest.mark.parametrize("name", RECORDED)
def test_recorded_motion_is_detected(name: str, scenes: dict[str, Scene]) -> None:
    assert holds("dense_transform_keys", scenes[name])


@pytest.mark.parametrize("name", NOT_RECORDED)
def test_posed_pushed_or_simulated_motion_is_not_recorded(name: str, scenes: dict[str, Scene]) -> None:
    assert not holds("dense_transform_keys", scenes[name])


@pytest.mark.parametrize("name", STORED_SHAPES)
def test_stored_shapes_are_detected(name: str, scenes: dict[str, Scene]) -> None:
    assert holds("animated_shape_keys", scenes[name])


@pytest.mark.parametrize("name", NO_STORED_SHAPES)
def test_a_constant_shape_is_not_motion(name: str, scenes: dict[str, Scene]) -> None:
    assert not holds("animated_shape_keys", scenes[name])


def test_python_in_a_driver_is_named_and_not_run(scenes: dict[str, Scene]) -> None:
    scene = scenes["driven_by_python"]
    assert scene.scripts == ("driver of Thing",)
    moments = next(one.moments for one in scene.objects if one.name == "Thing")
    assert len({moment.location for moment in moments}) == 1
