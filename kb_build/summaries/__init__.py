"""One short summary for every page of documentation; see :mod:`kb_build.summaries.methods`."""
