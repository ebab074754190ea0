"""What pyproject.toml cannot say: every package below refdof/, and the folder data/ as `refdof.data`."""

from setuptools import find_packages, setup

setup(
    packages=[
        *find_packages(include=["refdof", "refdof.*"]),
        "refdof.data",
        "refdof.data.lenses",
        "refdof.data.scenes",
    ],
    package_dir={
        "refdof": "refdof",
        "refdof.data": "data",
        "refdof.data.lenses": "data/lenses",
        "refdof.data.scenes": "data/scenes",
    },
    # `refdof golden` makes the core pack anew: it is in the source archive only, for the tests.
    exclude_package_data={"refdof.data": ["packs/**"]},
)
