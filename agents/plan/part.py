"""What all parts of a plan share: the base class, types of fields, and the stages of construction."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field

# In the order in which a scene is built (paper, section "Staged Construction Pipeline").
Stage = Literal["modeling", "uv", "texture", "deformation_setup", "motion", "camera", "light", "render"]
STAGES: tuple[Stage, ...] = get_args(Stage)
ALWAYS: frozenset[Stage] = frozenset(
    {"modeling", "camera", "light", "render"}
)  # no scene can leave these out

# Blender's names have at most 63 bytes. A slash separates an object from its part.
Name = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[^/\x00-\x1f]+$")]
Node = Annotated[
    str,
    Field(
        min_length=1,
        max_length=121,
        pattern=r"^[^/\x00-\x1f]+(/[^/\x00-\x1f]+)?$",
        description="An object of the plan, or one of its parts as `Object/Part`.",
    ),
]
Metres = Annotated[float, Field(ge=-1e5, le=1e5)]
Length = Annotated[float, Field(gt=0, le=1e5, description="Metres.")]
Vector = tuple[Metres, Metres, Metres]
Share = Annotated[float, Field(ge=0, le=1)]
Frame = Annotated[int, Field(ge=-100_000, le=1_000_000)]


class PlanPart(BaseModel):
    """Base class of a plan's parts: frozen; unknown fields and numbers that are not finite are rejected."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


def owner_of(node: str) -> str:
    """The object that a node of the relation graph belongs to: ``Table`` for both ``Table`` and ``Table/Leg``."""
    return node.partition("/")[0]
