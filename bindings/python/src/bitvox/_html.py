"""What notebooks show: a line of facts, and a picture where there is one."""

from __future__ import annotations

import base64
from typing import Any


def shown(thing: Any, facts: dict[str, Any], png: bytes | None = None) -> str:
    """A small HTML table of facts about a thing, beside its picture."""
    rows = "".join(f"<tr><th style='text-align:left'>{escape(name)}</th><td>{escape(_plain(value))}</td></tr>" for name, value in facts.items())
    table = f"<div><b>bitvox.{type(thing).__name__}</b><table>{rows}</table></div>"
    if png is None:
        return table
    picture = base64.b64encode(png).decode("ascii")
    return f"<div style='display:flex;gap:1em;align-items:center'>{table}<img alt='' src='data:image/png;base64,{picture}'></div>"


def escape(text: str) -> str:
    """Text for HTML."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def _plain(value: Any) -> str:
    """Numbers short, tuples without brackets."""
    if isinstance(value, (tuple, list)):
        return ", ".join(_plain(one) for one in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)
