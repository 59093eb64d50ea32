"""Whether kernels were compiled before this process began."""

import os


def compiled_before() -> bool:
    """Tell whether the cache of compiled kernels holds any file."""
    from rps_exudyn.base.kernel_cache import cache_folder  # loads numba

    return any(files for _, _, files in os.walk(cache_folder()))
