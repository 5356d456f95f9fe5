"""``python -m terrain_lod``: the command line."""

from .cli.app import main

main()
