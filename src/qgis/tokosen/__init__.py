"""Rebuilds terrain from contour lines: the tools of the program tokosen, in the toolbox of QGIS."""


def classFactory(iface):
    """Called by QGIS when it loads the plugin."""
    from .plugin import Plugin

    return Plugin()
