"""The studio: a scene in the browser, or in a notebook, where a click says what shall be sharp.

A page holds the state and sends it; Python answers with pictures, first coarse, then fine.

- what a page asks for, checked                                   `refdof.studio.state`
- one thread that renders; of a page's requests the newest wins   `refdof.studio.desk`
- views of a scene, kept so that a new focus only traces          `refdof.studio.pictures`, `refdof.studio.overlays`
- messages between a page and all this                            `refdof.studio.session`
- the files that a page may open and write                        `refdof.studio.folder`
- the server of the page, and the notebook's widget               `refdof.studio.server`, `refdof.studio.notebook`
"""
