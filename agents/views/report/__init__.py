"""The report of a run: one page that opens from the disk, made from the journal and the run's folder alone."""
