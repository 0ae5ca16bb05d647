"""How a topic's work is done, step by step, in a new scene.

``order`` is where it starts. What stands here imports only from what is before it: ``names``, ``scene``, ``making``,
``node_trees``, ``operators``, ``setting``, ``main_classes``, ``made_groups``.
"""
