"""When a relation may hold: a plan says what there is, not when. Also where things are at those times."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agents.protocol.measures.measure import Poses

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy.typing as npt

    from agents.protocol.facts import Matrix
    from agents.protocol.measures.measure import Measures
    from agents.protocol.rule import Subject

    Array = npt.NDArray[np.float64]


def moments(subject: Subject, *nodes: str) -> tuple[int | None, ...]:
    """Frames at which a relation of ``nodes`` is looked at; it suffices that it holds at one of them.

    Now (None), for what stands still. Of what moves: the first and the last frame of the timeline, for a chair that
    is thrown over stands first, and a ball that drops into a bowl is in it at last.
    """
    if any(moves(subject, node) for node in nodes):
        return (subject.facts.frame_start, subject.facts.frame_end)
    return (None,)


def beginning(subject: Subject, node: str) -> int | None:
    """The frame at which something stands where the plan puts it: the first, of what moves."""
    return subject.facts.frame_start if moves(subject, node) else None


def moves(subject: Subject, node: str) -> bool:
    """Whether anything moves or deforms what a node stands for."""
    structure = subject.structure
    thing = structure.thing_of(node)
    names = (
        [*structure.find(node), *(root.name for root in thing.roots)] if thing else [*structure.find(node)]
    )
    return any(structure.moves(name) for name in names)


def anchor(subject: Subject, node: str) -> str | None:
    """The object whose transform is the node's: its root Empty, or the mesh that a part is."""
    structure = subject.structure
    if "/" not in node and node in structure.by_name:
        roots = structure.by_name[node].roots
        if roots:
            return roots[0].name
    found = structure.find(node)
    return found[0] if found else (node if node in structure.objects else None)


def poses(subject: Subject, nodes: Iterable[str], frame: int | None) -> Poses | None:
    """The request for where the nodes' anchors are; None if one of them has none."""
    names = [anchor(subject, node) for node in nodes]
    return None if None in names or not names else Poses(tuple(name for name in names if name), frame)


def pose(subject: Subject, measures: Measures, node: str, frame: int | None) -> tuple[Array, Array]:
    """(place, axes) of a node's anchor: the rows of ``axes`` are its own X, Y and Z in the world.

    Raises Unmeasured.
    """
    name = anchor(subject, node)
    assert name is not None
    return placed(measures[Poses((name,), frame)].matrices[name])


def placed(matrix: Matrix) -> tuple[Array, Array]:
    """(place, unit axes as rows) of a world matrix. An axis of no length is left as zeros."""
    whole = np.array(matrix, dtype=float).reshape(4, 4)
    axes = whole[:3, :3].T.copy()
    lengths = np.linalg.norm(axes, axis=1)
    axes[lengths > 0] /= lengths[lengths > 0, None]
    return whole[:3, 3], axes


def angle(a: Array, b: Array) -> float:
    """Degrees between two directions; 180 where one has none."""
    lengths = float(np.linalg.norm(a) * np.linalg.norm(b))
    if lengths == 0:
        return 180.0
    return float(np.degrees(np.arccos(np.clip(np.dot(a, b) / lengths, -1.0, 1.0))))


def rotation(euler: tuple[float, float, float]) -> Array:
    """The axes (rows) of something turned by Euler angles in degrees, in Blender's XYZ order."""
    x, y, z = np.radians(euler)
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    about_z = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    return (about_z @ about_y @ about_x).T


def turned(a: Array, b: Array) -> float:
    """Degrees by which axes ``a`` would have to be turned to be ``b``."""
    cosine = (np.trace(a @ b.T) - 1) / 2
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
