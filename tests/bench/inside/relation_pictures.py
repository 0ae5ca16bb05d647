"""Scenes for the pictures of relations between the objects ``A`` and ``B``."""

import bpy
from picture_parts import A, B, Shot, ball, box


def supported_by(holds):
    box("B", (0, 0, 0), (0.8, 0.8, 0.5), B)
    ball("A", (0, 0, 0.7 if holds else 0.8), 0.2, A)


def on_top_of(holds):
    box("B", (0, 0, 0), (0.8, 0.8, 0.5), B)
    plate = box("A", (0.1, 0, 0.5), (0.64, 0.5, 0.06), A)
    if not holds:
        flap = box("flap", (0.43, 0, 0.2), (0.04, 0.5, 0.36), A)
        with bpy.context.temp_override(active_object=plate, selected_editable_objects=[plate, flap]):
            bpy.ops.object.join()


def inside(holds):
    sides = [box("B", (0, 0, 0), (0.9, 0.9, 0.05), B)]
    sides += [box("side", (x, 0, 0.05), (0.05, 0.9, 0.35), B) for x in (-0.425, 0.425)]
    sides += [box("side", (0, y, 0.05), (0.8, 0.05, 0.35), B) for y in (-0.425, 0.425)]
    with bpy.context.temp_override(active_object=sides[0], selected_editable_objects=sides):
        bpy.ops.object.join()
    ball("A", (0, 0, 0.2) if holds else (0.75, -0.3, 0.15), 0.15, A)


def in_contact(holds):
    box("B", (0, 0, 0), (1.4, 1, 0.25), B)
    box("A", (0, 0, 0 if holds else 0.35), (0.12, 0.12, 0.8), A)


def against(holds):
    box("B", (0, 0.3, 0), (1.6, 0.15, 1), B)
    box("A", (0, -0.075 if holds else -0.3, 0), (0.9, 0.6, 0.45), A)


def attached_to(holds):
    box("B", (0, 0, 0.8), (1.4, 0.15, 0.15), B)
    ball("A", (0, 0, 0.6 if holds else 0.45), 0.2, A)


def next_to(holds):
    box("B", (-0.3, 0, 0), (0.5, 0.5, 0.5), B)
    ball("A", (0.25 if holds else 0.9, 0, 0.2), 0.2, A)


def above(holds):
    box("B", (-0.2, 0, 0), (0.8, 0.6, 0.3), B)
    ball("A", (-0.2 if holds else 0.7, 0, 0.8), 0.15, A)


def left_of(holds):
    box("B", (0, 0, 0), (0.4, 0.4, 0.5), B)
    ball("A", (-0.7 if holds else 0.7, 0, 0.2), 0.2, A)


def in_front_of(holds):
    box("B", (0, 0, 0), (0.4, 0.4, 0.5), B)
    ball("A", (0.2, -0.8 if holds else 0.8, 0.2), 0.2, A)


SHOTS = {
    "SupportedBy": Shot(supported_by),
    "OnTopOf": Shot(on_top_of),
    "Inside": Shot(inside),
    "InContact": Shot(in_contact),
    "Against": Shot(against),
    "AttachedTo": Shot(attached_to),
    "NextTo": Shot(next_to),
    "Above": Shot(above),
    "LeftOf": Shot(left_of, away=(0, -4, 1.2)),
    "InFrontOf": Shot(in_front_of, away=(0, -3.6, 2)),
}
