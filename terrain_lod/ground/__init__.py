"""Heights, and how they are cut."""
