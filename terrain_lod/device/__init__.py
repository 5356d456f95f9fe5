"""OpenCL: arrays, kernels, memory, time."""
