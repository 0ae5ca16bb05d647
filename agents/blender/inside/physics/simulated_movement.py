# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a simulation moves its points between some frames.

A sample is a dict from a key (a vertex, a particle, a corner of a body, the middle of a fluid) to a place in metres.
"""

from array import array

from mathutils import Vector

from . import caches

_POINTS = 2000  # of one object that are sampled
_CORNERS = 8
_NO_GAS = 1e-6  # density in all cells together
_STILL = 0.005  # of its size that something must move to count as moving


def sample(cache, scene, graph):
    """The sample at the frame that ``graph`` is evaluated at; {} where nothing exists yet."""
    if cache.kind == caches.RIGID_BODY:
        return _bodies(scene, graph)
    owner = cache.owner.evaluated_get(graph)
    if cache.kind == caches.PARTICLES:
        return _particles(_system(owner, cache))
    if cache.kind == caches.HAIR:
        return _hair(owner, _system(owner, cache))
    if cache.kind == caches.FLUID:
        modifier = owner.modifiers[cache.holder.name]
        gas = cache.domain.domain_type == "GAS"
        return (
            _gas(owner, modifier.domain_settings) if gas else _liquid(owner, modifier.domain_settings, cache)
        )
    if cache.kind == caches.DYNAMIC_PAINT and cache.holder.surface_type in {"PAINT", "WEIGHT"}:
        return _paint(owner, cache.holder)
    return _vertices(owner)


def compare(cache, samples):
    """How much moved over some samples, as data.

    ``seen``: there were points at all; ``moved``: the farthest that a point got from where it was first, in ``unit``
    ("m"; for paint "of 1"); ``still``: nothing moved. Of rigid bodies also ``who`` (the one that moved farthest),
    ``bodies`` and ``bodies_moved`` (counts).
    """
    first, distances = {}, {}
    for places in samples:
        for key, place in places.items():
            start = first.setdefault(key, place)
            distances[key] = max(distances.get(key, 0.0), (place - start).length)
    result = {
        "seen": bool(distances),
        "moved": max(distances.values(), default=0.0),
        "unit": "m",
        "who": None,
        "still": None,
    }
    if cache.kind == caches.DYNAMIC_PAINT and cache.holder.surface_type in {"PAINT", "WEIGHT"}:
        result["unit"] = "of 1"
        result["still"] = result["moved"] < _STILL
    elif cache.kind == caches.RIGID_BODY:
        _add_bodies(result, first, distances)
    else:
        result["still"] = result["moved"] < _STILL * max(cache.owner.dimensions.length, 1e-6)
    return result


def _add_bodies(result, first, distances):
    farthest, size = {}, {}
    for name, _ in distances:
        farthest[name] = max(distances[name, corner] for corner in range(_CORNERS))
        size[name] = (first[name, 6] - first[name, 0]).length
    still = [name for name, distance in farthest.items() if distance < _STILL * max(size[name], 1e-6)]
    result["still"] = len(still) == len(farthest)
    result["bodies"], result["bodies_moved"] = len(farthest), len(farthest) - len(still)
    if farthest:
        result["who"] = max(farthest, key=farthest.get)  # pyright: ignore[reportCallIssue]


def _stride(count):
    return max(1, count // _POINTS)


def _bodies(scene, graph):
    """The corners of the bodies that physics is to move."""
    places = {}
    collection = scene.rigidbody_world.collection
    for obj in collection.objects if collection is not None else ():
        body = obj.rigid_body
        if body is None or body.type != "ACTIVE" or body.kinematic:
            continue
        matrix = obj.evaluated_get(graph).matrix_world
        for number, corner in enumerate(obj.bound_box):
            places[obj.name, number] = matrix @ Vector(corner)
    return places


def _vertices(owner):
    """Turned and scaled as in the world, but not moved with the object: that is its animation, not its physics."""
    turned = owner.matrix_world.to_3x3()
    data = owner.data
    if hasattr(data, "vertices"):
        mesh = data
    elif owner.type in {"CURVE", "SURFACE"}:
        mesh = owner.to_mesh()
    elif owner.type == "LATTICE":
        return {number: turned @ point.co_deform for number, point in enumerate(data.points)}
    else:
        return {}
    places = {
        number: turned @ mesh.vertices[number].co
        for number in range(0, len(mesh.vertices), _stride(len(mesh.vertices)))
    }
    if mesh is not data:
        owner.to_mesh_clear()
    return places


def _system(owner, cache):
    return owner.particle_systems[cache.holder.name]


def _particles(system):
    return {
        number: system.particles[number].location.copy()
        for number in range(0, len(system.particles), _stride(len(system.particles)))
        if system.particles[number].alive_state == "ALIVE"
    }


def _hair(owner, system):
    """The tips."""
    step = 2**system.settings.display_step
    return {
        number: system.co_hair(owner, particle_no=number, step=step)
        for number in range(0, len(system.particles), _stride(len(system.particles)))
    }


def _paint(owner, surface):
    places = {}
    if surface.surface_type == "WEIGHT":
        group = owner.vertex_groups.get(surface.output_name_a)
        for vertex in owner.data.vertices if group is not None else ():
            weight = sum(entry.weight for entry in vertex.groups if entry.group == group.index)
            places[vertex.index] = Vector((weight, 0, 0))
        return places
    for name in (surface.output_name_a, surface.output_name_b):
        layer = owner.data.attributes.get(name)
        for number in range(0, len(layer.data), _stride(len(layer.data))) if layer is not None else ():
            red, green, blue, alpha = layer.data[number].color
            places[name, number] = Vector((red, green, blue)) * alpha
    return places


def _liquid(owner, domain, cache):
    """The middle and the extremes of its surface, or of its particles where it has no surface."""
    if not len(domain.velocity_grid):
        return {}
    matrix = owner.matrix_world
    if cache.domain.use_mesh:
        points = _flat_vectors(owner.data.vertices, "co")
    else:
        matrix = matrix.Identity(4)  # a particle's place is in the world
        points = array("f")
        for system in owner.particle_systems:
            if system.settings.type == "FLIP":
                points += _flat_vectors(system.particles, "location")
    if len(points) <= 3 * _CORNERS:
        return {}  # without liquid Blender shows the domain itself
    axes = [points[axis::3] for axis in range(3)]
    middle = Vector([sum(axis) / len(axis) for axis in axes])
    return {
        "middle": matrix @ middle,
        "low": matrix @ Vector(list(map(min, axes))),
        "high": matrix @ Vector(list(map(max, axes))),
    }


def _flat_vectors(items, name):
    """A vector property of all ``items``, as one flat array."""
    values = array("f", bytes(4 * 3 * len(items)))
    items.foreach_get(name, values)
    return values


def _gas(owner, domain):
    """The middle of its smoke, or of its flames where there is no smoke."""
    for grid in (domain.density_grid, domain.flame_grid):
        amounts = array("f", bytes(4 * len(grid)))
        if not amounts:
            continue
        grid.foreach_get(amounts)
        total = sum(amounts)
        if total > _NO_GAS:
            return {"middle": owner.matrix_world @ _middle(domain, amounts, total)}
    return {}


def _middle(domain, amounts, total):
    """The centre of gravity of a grid, in the domain's own space."""
    nx, ny, nz = domain.domain_resolution
    finer = round((len(amounts) / (nx * ny * nz)) ** (1 / 3))  # with noise, every cell is divided
    nx, ny, nz = nx * finer, ny * finer, nz * finer
    layer = nx * ny
    x = sum(i * sum(amounts[i::nx]) for i in range(nx))
    z = sum(k * sum(amounts[k * layer : (k + 1) * layer]) for k in range(nz))
    y = sum(
        j * sum(sum(amounts[k + j * nx : k + (j + 1) * nx]) for k in range(0, layer * nz, layer))
        for j in range(ny)
    )
    cells = (Vector((x, y, z)) / total + Vector((0.5, 0.5, 0.5))) / finer
    return Vector(domain.start_point) + cells * Vector(domain.cell_size)
