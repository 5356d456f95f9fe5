"""Every level of detail and peer."""
