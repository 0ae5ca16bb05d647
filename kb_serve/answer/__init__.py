"""What is answered to a query, in Markdown and within a budget.

``composer`` is where it starts. What stands here imports only from what is before it: ``budget``, ``pages``, ``facts``,
``ways``, ``render`` for one symbol; ``steps``, ``topic`` for a topic; ``hits``, ``hit_lines``, ``known`` for what is
told besides; ``docs_answer``, ``next_call``, ``drafts`` for the whole.
"""
