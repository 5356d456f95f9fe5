"""``python -m terrain_lod``: the command line."""

from .cli import main

main()
