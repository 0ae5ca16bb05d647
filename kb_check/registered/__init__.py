"""What scripts and the files beside them register: classes, properties, handlers, whole add-ons."""
