"""What keys do, once: help, tooltips and the page's buttons are made of this table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from .settings import Choice, Settings


@dataclass(frozen=True)
class Action:
    """Something to do.

    Attributes
    ----------
    method : str
        Of :class:`~terrain_lod.viewer.controls.Controls`.
    keys : tuple of str
        As VTK calls them; the first is what people are told.
    label : str
        On a button.
    help : str
        What it is for.
    on_page : bool
        Whether the page has a button for it.
    """

    method: str
    keys: tuple[str, ...]
    label: str
    help: str
    on_page: bool = True


ACTIONS: Final = (
    Action("show_help", ("?", "question", "F1"), "help", "show or hide this list"),
    Action("show_details", ("i",), "details", "all that is known of the picture, or what matters"),
    Action("switch_flight", ("g",), "fly", "a drag looks around, or orbits again"),
    Action("reset", ("r",), "reset", "back to the first camera"),
    Action("reload", ("u",), "reload", "read the file again"),
    Action("take_picture", ("c",), "picture", "write a picture as PNG", on_page=False),
    Action("switch_recording", ("v",), "record", "begin or end a GIF", on_page=False),
    Action("hide", ("h",), "hide", "hide texts, bars and sliders, or show them", on_page=False),
    Action("quit", ("q",), "quit", "close the window", on_page=False),
)
_MOUSE: Final = (
    ("drag", "around the target; flying, look around"),
    ("wheel, right drag", "nearer"),
    ("shift or middle drag", "sideways"),
    ("click", "what is known of a place"),
    ("w a s d, arrows", "fly"),
)


def help_lines(settings: Settings) -> tuple[str, ...]:
    """Return what mouse and keys do, a line each."""
    rows = [
        *_MOUSE,
        (f"1 to {len(settings.modes)}", f"show {', '.join(settings.modes)}"),
        *((choice.key, choice_help(choice)) for choice in settings.choices),
        *((action.keys[0], action.help) for action in ACTIONS),
    ]
    wide = max(len(keys) for keys, _ in rows)
    return tuple(f"{keys:<{wide}}  {what}" for keys, what in rows)


def choice_help(choice: Choice) -> str:
    """Return what the key of a choice does."""
    name = choice.label or choice.name.replace("_", " ")
    return f"{name} or not" if isinstance(choice.values[0], bool) else f"next {name}"
