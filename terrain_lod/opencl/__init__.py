"""What ``device.py`` is made of: the machine's devices, kernel text, arguments, times, linking."""
