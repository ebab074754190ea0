"""Cluster: tasks on the processes of a Dask scheduler, here or on other machines."""

from refdof.cluster.completed import Cluster, completed
from refdof.cluster.connection import connected

__all__ = ["Cluster", "completed", "connected"]
