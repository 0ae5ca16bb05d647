"""The scene plan, written once and never changed (paper, "Scene Plan" and "Implementation Details")."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from agents.plan.motion import MotionPlan
from agents.plan.part import STAGES, Frame, Length, Name, Node, PlanPart, Share, Stage, Vector
from agents.plan.relations import Relation

if TYPE_CHECKING:
    from agents.protocol.vocabulary import DeformationKind, MotionKind

PhysicsRole = Literal[
    "ground", "static", "collider", "rigid", "cloth", "soft", "fluid", "container", "emitter", "force", "rig",
    "keyframed", "hair",
]  # fmt: skip

# Role → (deformation_kind, motion_kind): the tags that the object's L3 collection must carry.
MECHANISMS: dict[str, tuple[DeformationKind, MotionKind]] = {
    "ground": ("none", "none"),
    "static": ("none", "none"),
    "collider": ("none", "none"),
    "container": ("none", "none"),
    "force": ("none", "none"),
    "hair": ("none", "none"),
    "rigid": ("sim_rigid", "bake"),
    "cloth": ("sim_cloth", "bake"),
    "soft": ("sim_soft", "bake"),
    "fluid": ("sim_fluid", "bake"),
    "emitter": ("sim_particle", "bake"),
    "rig": ("rig", "keyframe"),
    "keyframed": ("none", "keyframe"),
}


class Material(PlanPart):
    """A physically based material. Colours are linear RGB from 0 to 1."""

    name: Name
    base_color: tuple[Share, Share, Share]
    metallic: Share = 0.0
    roughness: Share = 0.5
    transmission: Share = 0.0
    ior: Annotated[float, Field(ge=1, le=4)] = 1.45
    emission_strength: Annotated[float, Field(ge=0)] = 0.0
    texture: str = Field(default="", max_length=300, description="What the surface looks like, in words.")


FluidKind = Literal["liquid", "smoke", "fire", "smoke_and_fire"]


class PlannedObject(PlanPart):
    """One logical object: an L3 collection with a root Empty and one or more meshes.

    ``dimensions`` are the extents of the whole object in metres along its own axes; ``position`` (metres) and
    ``rotation`` (degrees, XYZ) are those of its root. ``systems`` are the L2 collections that it belongs to, ``parts``
    the names of meshes that relations refer to. ``holds_volume``: its meshes must be closed surfaces.
    ``fluid_kind``: what a ``fluid`` is; a liquid is planned as the body that it starts as, smoke and fire as their
    source. ``inflow``: it keeps coming out of its source.
    """

    name: Name
    description: str = Field(default="", max_length=1000)
    systems: tuple[Name, ...] = Field(min_length=1)
    dimensions: tuple[Length, Length, Length]
    position: Vector
    rotation: Vector = (0.0, 0.0, 0.0)
    role: PhysicsRole = "static"
    material: Material | None = None
    parts: tuple[Name, ...] = ()
    allows_disconnected: bool = False
    holds_volume: bool = False
    fluid_kind: FluidKind | None = None
    inflow: bool = False

    @property
    def mechanism(self) -> tuple[DeformationKind, MotionKind]:
        """(deformation_kind, motion_kind): the tags that its role requires."""
        return MECHANISMS[self.role]


class ObjectGroup(PlanPart):
    """Objects that are alike or belong together. ``same`` names what they share."""

    name: Name
    members: tuple[Name, ...] = Field(min_length=2)
    same: tuple[Literal["dimensions", "material", "role", "mesh"], ...] = ()


class Joint(PlanPart):
    """A joint of rigid bodies as wholes. ``axis`` in the world; ``limits`` in degrees, of a slider in metres."""

    kind: Literal["hinge", "slider", "ball", "fixed"]
    part: Name
    host: Name
    axis: Vector = (0.0, 0.0, 1.0)
    limits: tuple[float, float] | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Joint:
        if self.limits is not None and self.limits[0] > self.limits[1]:
            raise ValueError(
                f"limits: the lower one, {self.limits[0]}, is above the upper one, {self.limits[1]}"
            )
        if not any(self.axis):
            raise ValueError("axis: (0, 0, 0) has no direction; give the joint's direction")
        return self


class Light(PlanPart):
    """A light object, or the world's light. ``energy`` is in Blender's unit for its kind (W; for a sun W/m²)."""

    name: Name
    kind: Literal["sun", "point", "area", "spot", "world"]
    position: Vector = (0.0, 0.0, 0.0)
    target: Node | Vector | None = None
    energy: Annotated[float, Field(ge=0)]
    color: tuple[Share, Share, Share] = (1.0, 1.0, 1.0)


class Camera(PlanPart):
    """The camera, as it is at the first frame. ``lens`` is in millimetres; the camera must show the ``subjects``."""

    name: Name = "Camera"
    position: Vector
    target: Node | Vector
    lens: Annotated[float, Field(gt=1, le=5000)] = 50.0
    subjects: tuple[Name, ...] = ()
    moves: bool = False


class RenderSettings(PlanPart):
    """How the scene is rendered. ``resolution`` is in pixels."""

    kind: Literal["still", "animation"]
    engine: Literal["CYCLES", "BLENDER_EEVEE", "BLENDER_WORKBENCH"] = "CYCLES"
    resolution: tuple[Annotated[int, Field(ge=16, le=8192)], Annotated[int, Field(ge=16, le=8192)]] = (
        1280,
        720,
    )
    samples: Annotated[int, Field(ge=1, le=65536)] = 64


class ScenePlan(PlanPart):
    """Everything to build."""

    title: str = Field(min_length=1, max_length=200)
    frame_start: Frame = 1
    frame_end: Frame = 1
    fps: Annotated[int, Field(ge=1, le=240)] = 24
    systems: tuple[Name, ...] = Field(min_length=1, description="The L2 collections; one is `ground`.")
    objects: tuple[PlannedObject, ...] = Field(min_length=1)
    relations: tuple[Relation, ...] = ()
    groups: tuple[ObjectGroup, ...] = ()
    joints: tuple[Joint, ...] = ()
    lighting: tuple[Light, ...] = Field(min_length=1)
    camera: Camera
    render: RenderSettings
    motion: MotionPlan = MotionPlan()
    opt_out: tuple[Stage, ...] = Field(default=(), description="Stages to skip for this scene.")
    strict_grounding: bool = False
    tolerances: dict[str, Annotated[float, Field(gt=0)]] = Field(
        default_factory=dict[str, float], description="Tolerances to tighten for this scene, by name."
    )

    @model_validator(mode="after")
    def _ordered(self) -> ScenePlan:
        if self.frame_end < self.frame_start:
            raise ValueError(f"frame_end: frame {self.frame_end} is before frame_start, {self.frame_start}")
        return self

    def object(self, name: str) -> PlannedObject | None:
        """The planned object with that name."""
        return next((planned for planned in self.objects if planned.name == name), None)

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages that are not opted out, in order."""
        return tuple(stage for stage in STAGES if stage not in self.opt_out)
