"""Ground of any size, read window by window."""
