# SPDX-License-Identifier: GPL-3.0-or-later
"""Asks a Blender, from within, for all that its API is.

``extract_api`` is where it starts. What stands here imports only what is before it: ``wire``, ``apart``, ``classes``,
``outside_rna``, ``instances``, ``passes``, ``nodes``, ``bpy_ops``, ``preconditions``, ``tried``.
"""
