"""What is answered to a query, in Markdown and within a budget.

``composer`` is where it starts. What stands here imports only from what is before it: ``budget``, ``pages``, ``facts``,
``ways``, ``render`` for one symbol; ``steps``, ``topic`` for a topic; ``hits``, ``hit_lines``, ``hit_blocks`` for what
was found, ``known`` for what one has to know of it; ``docs_answer``, ``next_call``, ``said_twice``, ``drafts`` for the
whole.
"""
