"""Every tolerance of the rules, in one place. A plan may tighten them by name."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any


def _tolerance(value: float, unit: str, meaning: str, *, least: bool = False) -> Any:
    """``least``: it is the least that must be, so that a larger one is tighter."""
    return field(default=value, metadata={"unit": unit, "meaning": meaning, "least": least})


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Lengths in metres, angles in degrees, shares of 1."""

    contact: float = _tolerance(0.002, "m", "gap that still counts as contact")
    contact_share: float = _tolerance(
        0.005, "", "… or that share of the diagonal of the smallest mesh of the two, if that is more"
    )
    contact_most: float = _tolerance(0.01, "m", "… but never more than this")
    penetration: float = _tolerance(0.001, "m", "depth of penetration that is numerical noise")
    penetration_share: float = _tolerance(
        0.01, "", "… or that share of the smallest dimension, if that is more"
    )
    dimension_share: float = _tolerance(0.10, "", "how far an extent may be from the planned one")
    place: float = _tolerance(0.01, "m", "how far a root may be from its planned place")
    place_share: float = _tolerance(0.05, "", "… or that share of the object's diagonal, if that is more")
    turn: float = _tolerance(5.0, "°", "how far a root may be turned from its planned rotation")
    unit_scale: float = _tolerance(1e-3, "", "how far the scale of a simulated body may be from 1")
    opposed: float = _tolerance(
        -0.99,
        "",
        "cosine of the normals at a contact from below, at most: of faces that lie on each other it is -1",
    )
    balance_share: float = _tolerance(
        0.05,
        "",
        "how far inside the hull of what bears it a centre of mass must be, as share of √area",
        least=True,
    )
    flush_angle: float = _tolerance(8.0, "°", "how far faces that are at each other may be from parallel")
    flush_overhang: float = _tolerance(
        0.01, "m", "how far such a face may reach beyond the one that it is at"
    )
    rim_gap: float = _tolerance(0.01, "m", "gap between a filler and the rim of its opening")
    rim_opening: float = _tolerance(
        180.0, "°", "the widest angle around a filler in which its opening may have no rim"
    )
    outside_share: float = _tolerance(0.02, "", "share of a content that may be outside of its container")
    outside_partial: float = _tolerance(0.5, "", "… if the plan says that it is in it in part")
    depth_share: float = _tolerance(0.10, "", "how far a depth may be from the planned one")
    footprint: float = _tolerance(
        0.25, "", "share of the upper object's footprint that must lie over the lower one", least=True
    )
    distance: float = _tolerance(0.01, "m", "how far a gap may be outside of its planned range")
    distance_share: float = _tolerance(0.05, "", "… or that share of it, if that is more")
    cone: float = _tolerance(45.0, "°", "how far one object may be beside the direction that it is to lie in")
    upright: float = _tolerance(3.0, "°", "how far an upright object may lean")
    parallel: float = _tolerance(5.0, "°", "how far parallel axes may differ")
    facing: float = _tolerance(15.0, "°", "how far a front may be turned away from what it faces")
    radius_share: float = _tolerance(0.03, "", "how far a member of a circle may be from its radius")
    ring_angle: float = _tolerance(2.0, "°", "how uneven the gaps around a circle may be")
    ring_angle_share: float = _tolerance(0.05, "", "… or that share of an even gap, if that is more")
    ring_plane_share: float = _tolerance(
        0.01, "", "how far out of its plane a circle may be, as share of the radius"
    )
    ring_facing: float = _tolerance(10.0, "°", "how far members of a circle may be turned from its centre")
    line_share: float = _tolerance(
        0.02,
        "",
        "how far beside its line a member may be, as share of the length; how uneven a line's spacing may be",
    )
    spacing_share: float = _tolerance(
        0.03, "", "how far from its crossing a member of a grid may be, and its spacing from the planned one"
    )
    mirror_share: float = _tolerance(
        0.03, "", "how far from its mirrored place a member may be, as share of the extent"
    )
    dense_keys: float = _tolerance(
        0.1, "/frame", "keyframes a frame, of five or more, that imitate a simulation"
    )
    out_of_frame: float = _tolerance(0.20, "", "share of a subject that may be outside of the picture")
    frame_cover: float = _tolerance(0.01, "", "share of the picture that a subject must cover", least=True)
    occluded: float = _tolerance(0.50, "", "share of a subject that other things may hide")
    comove: float = _tolerance(0.01, "m", "how far something may shift against what it moves with")
    comove_share: float = _tolerance(0.02, "", "… or that share of its diagonal, if that is more")
    comove_turn: float = _tolerance(3.0, "°", "how far it may turn against what it moves with")
    moving_share: float = _tolerance(
        0.05, "", "share of a phase's greatest speed from which on a thing counts as moving"
    )
    onset: float = _tolerance(2.0, "frames", "how early or late a phase may begin")
    onset_share: float = _tolerance(0.05, "", "… or that share of the phase, if that is more")
    order: float = _tolerance(1.0, "frames", "how long after its effect a cause may be seen")
    extent_share: float = _tolerance(
        0.10, "", "how far a way, an amplitude or a turn may be from the planned one"
    )
    course: float = _tolerance(
        10.0, "°", "how far the direction of a way, or a turn, may be from the planned one"
    )
    gravity_share: float = _tolerance(0.10, "", "how far the acceleration of a fall may be from gravity")
    tunnel_share: float = _tolerance(
        0.05, "", "how deep a thing that moves may be in a collider, as share of the smallest dimension"
    )
    jump: float = _tolerance(1.5, "", "how many times the greatest planned speed a step may be")
    rest_speed: float = _tolerance(
        0.01, "m/s", "speed of a thing at rest, for each metre of its size if it is larger than one"
    )
    rest_turn: float = _tolerance(0.1, "rad/s", "turn rate of a thing at rest")

    def contact_gap(self, diagonal: float) -> float:
        """ε for a pair whose smaller object has that diagonal."""
        return min(self.contact_most, max(self.contact, self.contact_share * diagonal))

    def noise(self, smallest: float) -> float:
        """The depth that is noise for a pair whose smallest dimension that is."""
        return max(self.penetration, self.penetration_share * smallest)

    def tightened(self, wanted: dict[str, float]) -> tuple[Tolerances, list[str]]:
        """With the tighter of each; and what could not be taken: unknown names, and values that would loosen."""
        least = {one.name: one.metadata["least"] for one in fields(self)}
        refused = [f"there is no tolerance {name!r}" for name in wanted if name not in least]
        looser = {
            name
            for name, value in wanted.items()
            if name in least and (value < getattr(self, name) if least[name] else value > getattr(self, name))
        }
        refused += [
            f"{name} cannot be loosened from {getattr(self, name):g} to {wanted[name]:g}"
            for name in wanted
            if name in looser
        ]
        kept = {name: value for name, value in wanted.items() if name in least and name not in looser}
        return replace(self, **kept), refused


TOLERANCES = Tolerances()
