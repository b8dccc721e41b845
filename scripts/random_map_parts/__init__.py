"""Random ground, the maps that are cut from it, and what must hold of everything that tokosen makes from them."""
