# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects are fluid domains, and what their meshes are."""


def domain_of(obj, *, shown_only=False):
    """The fluid domain settings of an object; None if it is not a domain.

    ``shown_only``: a domain whose modifier is switched off in the viewport does not count.
    """
    for modifier in obj.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
            return modifier.domain_settings if modifier.show_viewport or not shown_only else None
    return None


def is_empty_domain(evaluated):
    """Whether the mesh of an evaluated object is only the box of a fluid domain, without liquid."""
    return domain_of(evaluated) is not None and len(evaluated.data.vertices) == len(
        evaluated.original.data.vertices
    )
