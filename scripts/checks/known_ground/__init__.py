"""Random ground of known heights, the maps that are made from it, and what must hold of all that tokosen makes of them."""
