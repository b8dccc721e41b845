"""What objects show in notebooks: a picture, figures, findings."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape


def page(title: str, figures: Iterable[tuple[str, object]], notes: Iterable[str] = (), picture: bytes | str | None = None) -> str:
    """A piece of HTML: a picture (PNG, or a data URI), a table of figures, and sentences below."""
    image = ""
    if picture is not None:
        uri = picture if isinstance(picture, str) else f"data:image/png;base64,{base64.b64encode(picture).decode()}"
        image = f'<img alt="{escape(title)}" src="{uri}" style="max-width:480px;max-height:480px">'
    rows = "".join(f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in figures)
    items = "".join(f"<li>{escape(note)}</li>" for note in notes)
    below = f"<ul>{items}</ul>" if items else ""
    table = f'<table style="text-align:left">{rows}</table>'
    return f'<div><b>{escape(title)}</b><div style="display:flex;gap:1em">{image}<div>{table}{below}</div></div></div>'
