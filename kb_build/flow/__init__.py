"""Reads Python as text and lets types flow through it: nothing is imported or run.

``analysis`` is where it starts. Each room imports only from those before it: ``syntax``, ``values``, ``blender``,
``state``, ``evaluation``, ``calls``, ``execution``.
"""
