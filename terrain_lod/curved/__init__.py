"""What is curved besides terrain: formulas for factors, patches, parametric surfaces, decals.

The two ways in for any mesh, :func:`terrain_lod.pn_triangles` and :func:`terrain_lod.displace`,
stand at the top; this is what they are given, and what needs no mesh to begin with.

>>> import terrain_lod as tl
>>> ring = tl.curved.surface("torus", factor=7)
>>> tl.pn_triangles(ring, lod=tl.curved.SilhouetteFactor(), camera=tl.Camera((5, 0, 3), (0, 0, 0)))
... # doctest: +SKIP
"""

from ..files.meshes.bpt import load_bpt, save_bpt
from .bezier import b_spline, bezier
from .bezier_curves import bezier_curve
from .catmull_clark import catmull_clark
from .continuity import Continuity, curve_continuity, patch_continuity
from .control_mesh import ControlMesh
from .creases import split_at_creases
from .curved_mesh import CurvedMesh
from .curves import ParametricCurve, Polyline, curve
from .decals import Decal, dent, shoot
from .displaced_maps import variation_factors
from .patch_factors import (
    CurvatureFactor,
    DistanceFactor,
    EdgeFactor,
    LengthFactor,
    OrientationFactor,
    SilhouetteFactor,
    UniformFactor,
)
from .posed import PosedMesh
from .surfaces import ParametricSurface, surface

__all__ = [
    "Continuity",
    "ControlMesh",
    "CurvatureFactor",
    "CurvedMesh",
    "Decal",
    "DistanceFactor",
    "EdgeFactor",
    "LengthFactor",
    "OrientationFactor",
    "ParametricCurve",
    "ParametricSurface",
    "Polyline",
    "PosedMesh",
    "SilhouetteFactor",
    "UniformFactor",
    "b_spline",
    "bezier",
    "bezier_curve",
    "catmull_clark",
    "curve",
    "curve_continuity",
    "dent",
    "load_bpt",
    "patch_continuity",
    "save_bpt",
    "shoot",
    "split_at_creases",
    "surface",
    "variation_factors",
]
