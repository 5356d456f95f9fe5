"""References of the kernels in ``kernels/streaming/``."""
