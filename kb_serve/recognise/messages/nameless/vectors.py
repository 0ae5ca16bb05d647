"""Messages of vectors that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_NO_FACTOR = (
    "A tuple or list is no factor: make it a vector first, `matrix @ Vector(value)`, `Vector(value) * 2`; two vectors "
    "are multiplied number by number: `Vector(value) * v`."
)
_IS_NONE = (
    "One side is None: `normalize()`, `invert()`, `transpose()`, `rotate()` and the like change their own value and "
    "return nothing. `normalized()`, `inverted()`, `transposed()` return another one."
)
_ONE_BY_ONE = (
    "A vector is no single number: take its length, `v.length`, or each number by itself, `tuple(round(n, 2) for n in "
    'v)`, `[abs(n) for n in v]`, `f"{v.x:.2f}"`.'
)
_IS_ARRAY = (
    "Numbers that a property holds are not always a vector (the corners of `bound_box`, colours of four numbers are "
    "none): make one, `matrix @ Vector(corner)`. All corners of an object in the world: "
    "`[obj.matrix_world @ Vector(corner) for corner in obj.bound_box]`."
)
VECTORS = (
    NamelessMessage(
        ("mathutils.Matrix(): expects no args or a single arg",),
        ("mathutils.Matrix",),
        "The rows are given as one sequence: `Matrix(((1, 0, 0), (0, 1, 0), (0, 0, 1)))`.",
    ),
    NamelessMessage(
        ("[begin:end] = [...]: sequence size is ",),
        ("mathutils.Vector",),
        "A slice takes as many numbers as it has: three for `location[:]`, two for `location[:2]` or `location.xy`.",
    ),
    NamelessMessage(
        ("matrix[i] = value assignment: sequence length is ",),
        ("mathutils.Matrix.translation", f"{T}Object.matrix_world"),
        "A row of a matrix of 4 × 4 has four numbers. The place that it moves to is `matrix.translation = (x, y, z)`.",
    ),
    NamelessMessage(
        ("vector[index] = x: assignment index out of range",),
        ("mathutils.Vector",),
        "A location or a scale has three numbers, `[0]` to `[2]`.",
    ),
    NamelessMessage(
        ("multiplication: not supported between ", "'bpy_prop_array'"),
        ("mathutils.Vector", "mathutils.Matrix"),
        _IS_ARRAY,
    ),
    NamelessMessage(
        ("unsupported operand type(s) for ", "'bpy_prop_array'"),
        ("mathutils.Vector", f"{T}bpy_prop_array"),
        "Numbers that a property holds are not always a vector (the corners of `bound_box`, colours of four numbers "
        "are none): make one, `Vector(corner) * 0.5`.",
    ),
    *(
        NamelessMessage((part,), ("mathutils.Vector.length", "mathutils.Vector"), _ONE_BY_ONE)
        for part in (
            "must be real number, not Vector",
            "unsupported format string passed to Vector.__format__",
            "type Vector doesn't define __round__ method",
            "bad operand type for abs(): 'Vector'",
        )
    ),
    NamelessMessage(
        ("zero length vectors have no valid angle",),
        ("mathutils.Vector.angle",),
        "One of the vectors has no length, and so no direction: `a.angle(b, 0.0)` gives the second value then, instead "
        "of an error.",
    ),
    NamelessMessage(
        ("matrix does not have an inverse",),
        ("mathutils.Matrix.inverted_safe", "mathutils.Matrix.inverted"),
        "A scale of 0 leaves nothing to invert: `matrix.inverted_safe()` gives a matrix nevertheless, "
        "`matrix.inverted(None)` None.",
    ),
    NamelessMessage(
        ("multiplication: not supported between ", "'NoneType'"),
        ("mathutils.Matrix.inverted", "mathutils.Vector.normalized"),
        _IS_NONE,
    ),
    NamelessMessage(
        ("Vector ", "NoneType", "invalid type for this operation"),
        ("mathutils.Vector.normalized", "mathutils.Matrix.inverted"),
        _IS_NONE,
    ),
    NamelessMessage(
        ("number of columns and the matrix2 number of rows must be the same",),
        ("mathutils.Matrix.to_3x3", "mathutils.Matrix.to_4x4"),
        "One matrix is 3×3, the other 4×4: `m.to_4x4()` makes the first kind the second, `m.to_3x3()` the other way "
        "round, without the translation.",
    ),
    *(
        NamelessMessage(
            (part,),
            ("mathutils.Vector.to_3d", "mathutils.Vector.to_4d", "mathutils.Matrix.to_3x3"),
            "A vector has as many numbers as the matrix has rows, or three where that is 4×4: `v.to_3d()`, "
            "`v.to_4d()`, `m.to_3x3()`, `m.to_4x4()`.",
        )
        for part in ("matrix * vector: len(matrix.col) and len(vector)", "vector * matrix: ")
    ),
    NamelessMessage(
        ("Can't have the same axis for track and up",),
        ("mathutils.Vector.to_track_quat",),
        "`track` and `up` name two axes: `v.to_track_quat('-Z', 'Y')` for cameras and lights.",
    ),
    NamelessMessage(
        ("Vector is not frozen (mutable), call freeze first",),
        ("mathutils.Vector.freeze", "mathutils.Vector.is_frozen"),
        "A vector that can change is no key: `d[v.copy().freeze()]`, or `d[tuple(v)]`.",
    ),
    NamelessMessage(
        ("Vector ", "vectors must have the same dimensions for this operation"),
        ("mathutils.Vector.to_3d", "mathutils.Vector.to_2d", "mathutils.Vector.resized"),
        "One vector has more numbers than the other: `v.to_3d()` adds what lacks, `v.to_2d()` drops what is too much.",
    ),
    NamelessMessage(
        ("Vector addition: (int + Vector) invalid type",),
        ("mathutils.Vector",),
        "`sum` begins with the number 0: give it a vector to begin with, `sum(vectors, Vector())`.",
    ),
    NamelessMessage(
        ("matrix assign array with 1 dimensions",),
        ("mathutils.Matrix.translation", "mathutils.Matrix.decompose"),
        "A matrix is no row of numbers: take its part, `matrix.translation`, `matrix.to_euler()`, `matrix.to_scale()`.",
    ),
    NamelessMessage(
        ("matrix assign dimension size mismatch",),
        ("mathutils.Matrix.to_4x4", f"{T}Object.matrix_world"),
        "The matrices of objects and bones have four rows and columns: `matrix.to_4x4()` makes one of a rotation.",
    ),
    NamelessMessage(
        ("unsupported operand type(s) for ", "'Euler'"),
        ("mathutils.Euler.rotate", "mathutils.Euler.to_matrix"),
        "An Euler is not computed with: change one of its angles (`euler.z += 0.5`), turn it by `euler.rotate(other)`, "
        "or compute with `euler.to_matrix()`.",
    ),
    NamelessMessage(
        ("Vector ", "invalid type for this operation"),
        ("mathutils.Vector",),
        "Vectors are added to vectors: `v + Vector(value)`, with a value of as many numbers; `Vector((n, n, n))` for "
        "one number.",
        without=("NoneType", "(int + Vector)"),
    ),
    NamelessMessage(
        ("multiplication: not supported between ", "'tuple'"),
        ("mathutils.Vector", "mathutils.Matrix"),
        _NO_FACTOR,
    ),
    NamelessMessage(
        ("multiplication: not supported between ", "'list'"),
        ("mathutils.Vector", "mathutils.Matrix"),
        _NO_FACTOR,
    ),
    NamelessMessage(
        ("assigned value not a number",),
        ("mathutils.Vector",),
        "One number of a vector is set to something else, as a text or None: `float(value)`.",
    ),
)
