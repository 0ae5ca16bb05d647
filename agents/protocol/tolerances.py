"""All tolerances of the rules. A plan may tighten them by name."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any

CONTACT = ("contact", "contact_share", "contact_most")  # together they are ε
PENETRATION = ("penetration", "penetration_share")


def _tolerance(value: float, unit: str, meaning: str, *, least: bool = False) -> Any:
    """``least``: the value is a minimum, so that a larger one is tighter."""
    return field(default=value, metadata={"unit": unit, "meaning": meaning, "least": least})


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Lengths in metres, angles in degrees, shares from 0 to 1."""

    contact: float = _tolerance(0.002, "m", "largest gap that still counts as contact")
    contact_share: float = _tolerance(
        0.005, "", "… or this share of the diagonal of the smallest mesh of the two, if that is more"
    )
    contact_most: float = _tolerance(0.01, "m", "… but never more than this")
    penetration: float = _tolerance(0.001, "m", "largest depth of penetration that counts as numerical noise")
    penetration_share: float = _tolerance(
        0.01, "", "… or this share of the smallest dimension, if that is more"
    )
    dimension_share: float = _tolerance(
        0.10, "", "largest deviation of an extent, as a share of the planned one"
    )
    sheet: float = _tolerance(0.02, "m", "planned thickness that a flat sheet may have")
    place: float = _tolerance(0.01, "m", "largest distance of a root from its planned position")
    place_share: float = _tolerance(0.05, "", "… or this share of the object's diagonal, if that is more")
    turn: float = _tolerance(5.0, "°", "largest angle between a root's rotation and the planned one")
    unit_scale: float = _tolerance(1e-3, "", "largest deviation from scale 1 of a simulated body")
    opposed: float = _tolerance(
        -0.99,
        "",
        "largest cosine between the normals of two faces in contact (-1: the faces lie flat on each other)",
    )
    balance_share: float = _tolerance(
        0.05,
        "",
        "smallest distance of the centre of mass from the edge of the support area, as a share of √area",
        least=True,
    )
    flush_angle: float = _tolerance(8.0, "°", "largest angle between two faces that lie against each other")
    flush_overhang: float = _tolerance(0.01, "m", "largest overhang of such a face beyond the other one")
    rim_gap: float = _tolerance(0.01, "m", "largest gap between a filler and the rim of its opening")
    rim_opening: float = _tolerance(
        180.0, "°", "largest angle around a filler in which its opening has no rim"
    )
    outside_share: float = _tolerance(0.02, "", "largest share of a content outside its container")
    outside_partial: float = _tolerance(0.5, "", "… if the plan says that the content is only partly inside")
    depth_share: float = _tolerance(0.10, "", "largest deviation of a depth, as a share of the planned one")
    footprint: float = _tolerance(
        0.25, "", "smallest share of the upper object's footprint over the lower object", least=True
    )
    distance: float = _tolerance(0.01, "m", "largest deviation of a gap from its planned range")
    distance_share: float = _tolerance(0.05, "", "… or this share of the range's bound, if that is more")
    cone: float = _tolerance(
        45.0, "°", "largest angle between where an object lies and the planned direction"
    )
    upright: float = _tolerance(3.0, "°", "largest tilt of an upright object")
    toppled: float = _tolerance(30.0, "°", "… of one that deforms, at the end")
    parallel: float = _tolerance(5.0, "°", "largest angle between parallel axes")
    facing: float = _tolerance(15.0, "°", "largest angle between an object's front and what it faces")
    radius_share: float = _tolerance(
        0.03, "", "largest deviation of a member from the radius of its circle, as a share of the radius"
    )
    ring_angle: float = _tolerance(2.0, "°", "largest deviation of a gap around a circle from an even gap")
    ring_angle_share: float = _tolerance(0.05, "", "… or this share of an even gap, if that is more")
    ring_plane_share: float = _tolerance(
        0.01, "", "largest distance of a member from the plane of its circle, as a share of the radius"
    )
    ring_facing: float = _tolerance(
        10.0, "°", "largest angle between a member's front and the line through the circle's centre"
    )
    line_share: float = _tolerance(
        0.02,
        "",
        "largest distance of a member from its line, as a share of the length; largest deviation from even spacing",
    )
    spacing_share: float = _tolerance(
        0.03, "", "largest distance of a member from its grid point, and of the spacing from the planned one"
    )
    mirror_share: float = _tolerance(
        0.03, "", "largest distance of a member from its mirrored place, as a share of the extent"
    )
    dense_keys: float = _tolerance(
        0.1,
        "/frame",
        "keyframes per frame from which keys count as an imitated simulation (at least five keys)",
    )
    origin_share: float = _tolerance(
        0.05, "", "largest way of a body's origin outside its mesh, as a share of its diagonal"
    )
    out_of_frame: float = _tolerance(0.20, "", "largest share of a subject outside the picture")
    frame_cover: float = _tolerance(
        0.01, "", "smallest share of the picture that a subject covers", least=True
    )
    occluded: float = _tolerance(0.50, "", "largest share of a subject that other objects hide")
    comove: float = _tolerance(0.01, "m", "largest shift of an object relative to what it moves with")
    comove_share: float = _tolerance(0.02, "", "… or this share of its diagonal, if that is more")
    comove_turn: float = _tolerance(3.0, "°", "largest rotation of an object relative to what it moves with")
    moving_share: float = _tolerance(
        0.05, "", "share of a phase's top speed from which an actor counts as moving"
    )
    onset: float = _tolerance(2.0, "frames", "how early or late a phase may start")
    onset_share: float = _tolerance(0.05, "", "… or this share of the phase, if that is more")
    onset_caused: float = _tolerance(
        0.25, "", "… or this share of its cause's phase, if another actor causes it and that is more"
    )
    order: float = _tolerance(1.0, "frames", "how long after its effect a cause may start")
    extent_share: float = _tolerance(
        0.10, "", "largest deviation of a displacement, amplitude or turn, as a share of the planned one"
    )
    course: float = _tolerance(
        10.0, "°", "largest angle between a motion's direction, or a turn, and the planned one"
    )
    flow_course: float = _tolerance(
        60.0, "°", "… of a liquid or gas, whose middle also sinks, spreads or drifts"
    )
    gravity_share: float = _tolerance(0.10, "", "largest deviation of a fall's acceleration from gravity")
    tunnel_share: float = _tolerance(
        0.05, "", "largest depth of a moving object in a collider, as a share of the smallest dimension"
    )
    jump: float = _tolerance(1.5, "", "largest step in a frame, as a multiple of the top planned speed")
    volume_share: float = _tolerance(
        0.15, "", "largest change of a liquid's volume that nothing is added to or taken from"
    )
    lid_share: float = _tolerance(0.03, "", "largest share of a liquid or gas at a border that cuts it off")
    leave_share: float = _tolerance(
        0.2, "", "smallest share of a gas that leaves its source by the end", least=True
    )
    rest_speed: float = _tolerance(
        0.01, "m/s", "largest speed of an object at rest; for objects above 1 m, per metre of size"
    )
    rest_turn: float = _tolerance(0.1, "rad/s", "largest turn rate of an object at rest")

    def contact_gap(self, diagonal: float) -> float:
        """ε for a pair whose smaller object has that diagonal."""
        return min(self.contact_most, max(self.contact, self.contact_share * diagonal))

    def noise(self, dimension: float) -> float:
        """The depth that counts as noise for a pair whose smallest dimension is ``dimension``."""
        return max(self.penetration, self.penetration_share * dimension)

    def tightened(self, wanted: dict[str, float]) -> tuple[Tolerances, list[str]]:
        """(the tolerances with those of ``wanted`` that are tighter, why each of the others is refused)."""
        least = {tolerance.name: tolerance.metadata["least"] for tolerance in fields(self)}
        refused = [f"there is no tolerance {name!r}" for name in wanted if name not in least]
        kept: dict[str, float] = {}
        for name in (name for name in wanted if name in least):
            value, default = wanted[name], getattr(self, name)
            if value < default if least[name] else value > default:
                refused.append(f"{name} cannot be loosened from {default:g} to {value:g}")
            else:
                kept[name] = value
        return replace(self, **kept), refused


TOLERANCES = Tolerances()
