"""A real browser for pages.

Needs Chromium, as the operating system's package or playwright's own; without it the tests that use it are
skipped, or fail where the environment says CI=true.
"""

import os
import shutil
from collections.abc import Iterator

import pytest
from playwright import sync_api


@pytest.fixture(scope="module")
def browser() -> Iterator[sync_api.Browser]:
    installed = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    with sync_api.sync_playwright() as playwright:
        try:
            started = playwright.chromium.launch(
                executable_path=installed, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
            )
        except sync_api.Error as error:
            give_up = pytest.fail if os.environ.get("CI") == "true" else pytest.skip
            give_up(f"no browser: {str(error).splitlines()[0]}")
        yield started
        started.close()
