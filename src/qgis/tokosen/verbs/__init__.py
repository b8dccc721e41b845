"""The tools, one file each."""
from .check import Check
from .compare import Compare
from .contour import Contour
from .dem import Dem
from .densify import Densify
from .derive import Derive
from .mesh import Mesh
from .profile import Profile
from .regions import Regions
from .skeleton import Skeleton
from .volume import Volume

VERBS = [Densify, Contour, Dem, Derive, Check, Compare, Profile, Volume, Regions, Skeleton, Mesh]
