"""Hard cases of every kernel."""
