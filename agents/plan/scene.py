"""The scene plan, which is written once and never changed (paper, "Scene Plan" and "Implementation Details")."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from agents.plan.motion import MotionPlan
from agents.plan.part import STAGES, Frame, Length, Name, Node, Part, Share, Stage, Vector
from agents.plan.relations import Relation

PhysicsRole = Literal[
    "ground", "static", "collider", "rigid", "cloth", "soft", "fluid", "container", "emitter", "force", "rig",
    "keyframed",
]  # fmt: skip
DeformationKind = Literal["rig", "sim_cloth", "sim_fluid", "sim_rigid", "sim_soft", "sim_particle", "none"]
MotionMechanism = Literal["keyframe", "bake", "none"]

# Role → (what deforms or moves it, how its motion is kept): the tags that its L3 is to carry.
MECHANISMS: dict[str, tuple[DeformationKind, MotionMechanism]] = {
    "ground": ("none", "none"),
    "static": ("none", "none"),
    "collider": ("none", "none"),
    "container": ("none", "none"),
    "force": ("none", "none"),
    "rigid": ("sim_rigid", "bake"),
    "cloth": ("sim_cloth", "bake"),
    "soft": ("sim_soft", "bake"),
    "fluid": ("sim_fluid", "bake"),
    "emitter": ("sim_particle", "bake"),
    "rig": ("rig", "keyframe"),
    "keyframed": ("none", "keyframe"),
}


class Material(Part):
    """A physically based surface. Colours are linear RGB from 0 to 1."""

    name: Name
    base_color: tuple[Share, Share, Share]
    metallic: Share = 0.0
    roughness: Share = 0.5
    transmission: Share = 0.0
    ior: Annotated[float, Field(ge=1, le=4)] = 1.45
    emission_strength: Annotated[float, Field(ge=0)] = 0.0
    texture: str = Field(default="", max_length=300, description="What the surface shows, in words.")


class PlannedObject(Part):
    """One logical object: an L3 collection with a root Empty and one or more meshes.

    ``dimensions`` are the extents of the whole in metres along its own axes, ``position`` is its root's in metres,
    ``rotation`` its root's in degrees (XYZ). ``systems`` are the L2 collections it belongs to, ``parts`` the names of
    meshes that relations speak of. ``holds_volume``: it must be a closed surface.
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

    @property
    def mechanism(self) -> tuple[DeformationKind, MotionMechanism]:
        """The tags that its role asks for."""
        return MECHANISMS[self.role]


class Group(Part):
    """Objects that are alike, or belong together: ``same`` names what they share."""

    name: Name
    members: tuple[Name, ...] = Field(min_length=2)
    same: tuple[Literal["dimensions", "material", "role", "mesh"], ...] = ()


class Light(Part):
    """A lamp, or the world's own light. ``energy`` is in Blender's unit for its kind (watts; the sun: W/m²)."""

    name: Name
    kind: Literal["sun", "point", "area", "spot", "world"]
    position: Vector = (0.0, 0.0, 0.0)
    target: Node | Vector | None = None
    energy: Annotated[float, Field(ge=0)]
    color: tuple[Share, Share, Share] = (1.0, 1.0, 1.0)


class Camera(Part):
    """Where the scene is seen from. ``lens`` in millimetres; ``subjects`` must be seen."""

    name: Name = "Camera"
    position: Vector
    target: Node | Vector
    lens: Annotated[float, Field(gt=1, le=5000)] = 50.0
    subjects: tuple[Name, ...] = ()
    moves: bool = False


class Render(Part):
    """What comes out. ``resolution`` in pixels."""

    kind: Literal["still", "animation"]
    engine: Literal["CYCLES", "BLENDER_EEVEE", "BLENDER_WORKBENCH"] = "CYCLES"
    resolution: tuple[Annotated[int, Field(ge=16, le=8192)], Annotated[int, Field(ge=16, le=8192)]] = (
        1280,
        720,
    )
    samples: Annotated[int, Field(ge=1, le=65536)] = 64


class ScenePlan(Part):
    """Everything that is to be built."""

    title: str = Field(min_length=1, max_length=200)
    frame_start: Frame = 1
    frame_end: Frame = 1
    fps: Annotated[int, Field(ge=1, le=240)] = 24
    systems: tuple[Name, ...] = Field(min_length=1, description="The L2 collections; one is `ground`.")
    objects: tuple[PlannedObject, ...] = Field(min_length=1)
    relations: tuple[Relation, ...] = ()
    groups: tuple[Group, ...] = ()
    lighting: tuple[Light, ...] = Field(min_length=1)
    camera: Camera
    render: Render
    motion: MotionPlan = MotionPlan()
    opt_out: tuple[Stage, ...] = Field(default=(), description="Stages that this scene does without.")
    strict_grounding: bool = False
    tolerances: dict[str, Annotated[float, Field(gt=0)]] = Field(
        default_factory=dict[str, float], description="Tolerances tightened for this scene, by their names."
    )

    @model_validator(mode="after")
    def _ordered(self) -> ScenePlan:
        if self.frame_end < self.frame_start:
            raise ValueError(f"frame_end: {self.frame_end} is before frame_start, {self.frame_start}")
        return self

    def object(self, name: str) -> PlannedObject | None:
        """The object of that name."""
        return next((one for one in self.objects if one.name == name), None)

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages that are not opted out, in order."""
        return tuple(stage for stage in STAGES if stage not in self.opt_out)
