"""The studio: a scene in the browser, or in a notebook, where a click says what shall be sharp.

A page holds the state and sends it; Python answers with pictures, first coarse, then fine.

- what a page asks for, checked                                   `refdof.studio.state`
- one thread that renders; of a page's requests the newest wins   `refdof.studio.desk`
- views of a scene, kept so that a new focus only traces          `refdof.studio.pictures`, `refdof.studio.overlays`
- messages between a page and all this                            `refdof.studio.session`
- the files that a page may open and write                        `refdof.studio.folder`
- the server of the page, and the notebook's widget               `refdof.studio.server`, `refdof.studio.notebook`
"""

from typing import Any

from refdof._check import InputError, as_path
from refdof.scene.load import load_scene
from refdof.scene.scene import Scene
from refdof.studio.folder import Folder

__all__ = ["widget"]


def widget(scene: Any, folder: Any = ".") -> Any:
    """The studio as a widget of a notebook; it needs the extra refdof[notebook].

    Parameters
    ----------
    scene : Scene, str or Path
        A scene, or what `refdof.load_scene` takes.
    folder : str or Path
        Its files, and no others, may be opened and written by the widget.

    Returns
    -------
    anywidget.AnyWidget

    Raises
    ------
    InputError
        If the extra is not installed, or there is no such scene.
    """
    try:
        from refdof.studio.notebook import StudioWidget
    except ModuleNotFoundError as error:
        raise InputError(
            f"widget: needs {error.name}, which is not installed; allowed is refdof with its extra, refdof[notebook]"
        ) from None
    if isinstance(scene, Scene):
        return StudioWidget(scene, scene.name, Folder(as_path("folder", folder)))
    return StudioWidget(load_scene(scene), str(scene), Folder(as_path("folder", folder)))
