"""The general mesh: curved, displaced and parametric patches through the same tessellator."""
