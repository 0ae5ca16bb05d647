"""What a name in a query stands for, or is meant for.

Each room imports only from those before it: ``likely``, ``named``, ``elsewhere``, ``by_words``.
"""
