"""Files of this package for `xarray.open_dataset(FILE)`: xarray finds this module by its entry point.

A result is its signals over the time; a table, or a block of cases, is one Dataset of its columns.
"""

from collections.abc import Iterable
from contextlib import ExitStack
from typing import Any

import xarray
from xarray.backends import BackendEntrypoint

GROUPS = {
    "rps_exudyn-result": ("signals",),
    "rps_exudyn-block": ("axes", "summary", "signals"),
    "rps_exudyn-table": ("axes", "outcome", "summary"),
}
"""File type -> groups that make its Dataset."""
CHECKSUM_BEGIN = b"rps-exudyn:"


class Backend(BackendEntrypoint):
    """Files that begin with the package's checksum."""

    description = "Results, blocks and tables of rps-exudyn"
    open_dataset_parameters = ("filename_or_obj", "drop_variables", "group")

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        """Return whether a file begins as those of this package do."""
        try:
            with open(filename_or_obj, "rb") as file:
                return file.read(len(CHECKSUM_BEGIN)) == CHECKSUM_BEGIN
        except (OSError, TypeError, ValueError):
            return False

    def open_dataset(
        self,
        filename_or_obj: Any,
        *,
        drop_variables: str | Iterable[str] | None = None,
        group: str | None = None,
    ) -> xarray.Dataset:
        """Return a group of the file, or those of `GROUPS` as one Dataset."""

        files = ExitStack()

        def opened(name: str) -> xarray.Dataset:
            options: Any = {"group": name, "drop_variables": drop_variables, "phony_dims": "sort"}
            return files.enter_context(xarray.open_dataset(filename_or_obj, engine="h5netcdf", **options))

        if group is not None:
            return opened(group)
        root = opened("/")
        groups = [opened(name) for name in GROUPS[root.attrs["filetype"]]]
        merged = xarray.merge([root, *groups], compat="override", combine_attrs="override")
        merged.set_close(files.close)
        return merged
